//! Broken files: one clear error, or a warning and a picture; never a panic.

use serde_json::{Value, json};

use super::{Builder, Held, first_mesh, glb_of, warnings};
use crate::{Files, Limits, NoFiles, ReadError};

/// A small file that uses most of what there is.
fn rich() -> Builder {
    let mut file = Builder::new();
    let (position, indices) = (file.square(), file.indices(&[0, 1, 2, 0, 2, 3]));
    let normal = file.floats("VEC3", 3, &[0., 0., 1.].repeat(4));
    let joints = file.accessor(&[1, 0, 0, 0].repeat(4), 5121, "VEC4", 4);
    let weights = file.floats("VEC4", 4, &[1., 0., 0., 0.].repeat(4));
    let (at, values) = (file.view(&[1, 0, 3, 0]), file.view(&[9f32.to_le_bytes(); 6].concat()));
    let sparse = json!({"count": 2, "indices": {"bufferView": at, "componentType": 5123}, "values": {"bufferView": values}});
    let offsets =
        file.push("accessors", json!({"componentType": 5126, "type": "VEC3", "count": 4, "sparse": sparse}));
    let matrices = file.floats("MAT4", 16, &[1.; 32]);
    let times = file.floats("SCALAR", 1, &[0., 1.]);
    let vectors = file.floats("VEC3", 3, &[1., 2., 3., 4., 5., 6.]);
    file.show(json!({"attributes": {"POSITION": position, "NORMAL": normal, "JOINTS_0": joints, "WEIGHTS_0": weights},
        "indices": indices, "material": 0, "targets": [{"POSITION": offsets}]}));
    file.json["nodes"] = json!([{"mesh": 0, "skin": 0, "children": [1]}, {"children": [2]}, {"camera": 0}]);
    file.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": matrices}]);
    file.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}]);
    file.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    file.json["textures"] = json!([{"source": 0}]);
    file.json["images"] = json!([{"uri": "data:image/png;base64,iVBORw0KGgo="}]);
    file.json["animations"] = json!([{"samplers": [{"input": times, "output": vectors}],
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]);
    file
}

/// No files, and few elements beyond what the file's bytes bear out.
struct Tight;

impl Files for Tight {
    fn read(&self, uri: &str) -> Result<Vec<u8>, ReadError> {
        NoFiles.read(uri)
    }

    fn limits(&self) -> Limits {
        Limits { made_elements: 100_000, ..Limits::default() }
    }
}

fn message(error: &ReadError) -> String {
    error.to_string()
}

fn error_of(file: &Builder) -> String {
    message(&file.try_read().expect_err("a broken file"))
}

#[test]
fn every_truncation_is_an_error() {
    let glb = rich().glb();
    for length in 0..glb.len() {
        let result = super::super::read("cut.glb", &glb[..length], &NoFiles);
        assert!(result.is_err(), "cut after {length} bytes");
    }
    assert!(super::super::read("whole.glb", &glb, &NoFiles).is_ok());
}

#[test]
fn changed_bytes_never_panic() {
    let glb = rich().glb();
    let mut state = 12345u32;
    let mut random = |below: usize| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as usize % below
    };
    for _ in 0..4000 {
        let mut broken = glb.clone();
        for _ in 0..=random(3) {
            let at = random(broken.len());
            broken[at] =
                if random(2) == 0 { b"0123456789-.,[]{}\" e"[random(20)] } else { random(256) as u8 };
        }
        let _ = super::super::read("broken.glb", &broken, &NoFiles);
    }
}

/// Every number in the JSON in turn becomes something else.
#[test]
fn changed_numbers_never_panic() {
    let file = rich();
    let mut paths = Vec::new();
    number_paths(&file.json, String::new(), &mut paths);
    assert!(paths.len() > 80);
    for path in paths {
        for value in [
            json!(0),
            json!(1),
            json!(3),
            json!(255),
            json!(65536),
            json!(4_294_967_295u64),
            json!(1e300),
            json!(-1),
        ] {
            let mut broken = Builder { json: file.json.clone(), bin: file.bin.clone() };
            *broken.json.pointer_mut(&path).expect("a path") = value;
            let _ = broken.try_read();
        }
    }
}

fn number_paths(value: &Value, path: String, paths: &mut Vec<String>) {
    match value {
        Value::Number(_) => paths.push(path),
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, v)| number_paths(v, format!("{path}/{i}"), paths));
        }
        Value::Object(map) => map.iter().for_each(|(k, v)| number_paths(v, format!("{path}/{k}"), paths)),
        _ => {}
    }
}

#[test]
fn errors_in_json_have_line_and_column_or_the_byte() {
    let text = "{\n  \"asset\": {\"version\": \"2.0\"},\n  \"nodes\": [{\"name\": \"é\", \"mesh\": -4}]\n}";
    let error = super::super::read("a.gltf", text.as_bytes(), &NoFiles).expect_err("a negative index");
    let ReadError::Malformed { at, message } = &error else { panic!("{error}") };
    assert_eq!((at.line, at.column), (Some(3), Some(36)), "{error}");
    assert!(message.contains("-4") && message.contains("whole number"), "{message}");
    let error =
        super::super::read("a.glb", &glb_of("{\"asset\": nonsense}", &[]), &NoFiles).expect_err("not JSON");
    let ReadError::Malformed { at, .. } = &error else { panic!("{error}") };
    assert_eq!(at.byte, Some(20 + 11), "{error}");
}

#[test]
fn json_nested_too_deeply_is_an_error() {
    let text = format!("{{\"asset\": {{\"version\": \"2.0\", \"extras\": {}", "[".repeat(100_000));
    assert!(super::super::read("deep.gltf", text.as_bytes(), &NoFiles).is_err());
}

#[test]
fn other_versions_are_told() {
    for (text, part) in [
        ("{\"asset\": {\"version\": \"1.0\"}, \"nodes\": {\"a\": {}}}", "\"1.0\"; 2.0 is read"),
        ("{\"asset\": {\"version\": \"2.1\", \"minVersion\": \"2.1\"}}", "minVersion"),
        ("{\"asset\": {}}", "asset.version: is missing"),
        ("{}", "asset: is missing"),
    ] {
        let error = super::super::read("v.gltf", text.as_bytes(), &NoFiles).expect_err("not 2.0");
        assert!(message(&error).contains(part), "{error}");
    }
}

#[test]
fn glb_headers_are_checked() {
    let glb = rich().glb();
    let mut longer = glb.clone();
    longer.extend_from_slice(b"rest");
    let scene = super::super::read("l.glb", &longer, &NoFiles).expect("the rest is ignored");
    assert!(warnings(&scene).contains("4 bytes after the end"));
    for (at, byte, part) in [
        (4, 1, "version 1"),
        (10, 9, "the header says"),
        (14, 9, "the chunk says"),
        (16, b'X', "must be JSON"),
    ] {
        let mut broken = glb.clone();
        broken[at] = byte;
        let error = super::super::read("h.glb", &broken, &NoFiles).expect_err("a broken header");
        assert!(message(&error).contains(part), "{error}");
    }
}

#[test]
fn required_extensions_that_are_not_read_are_named() {
    let mut file = rich();
    file.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression", "KHR_texture_transform"]);
    let error = file.try_read().expect_err("draco");
    assert!(matches!(error, ReadError::Unsupported { .. }));
    assert!(message(&error).contains("KHR_draco_mesh_compression (Draco"), "{error}");
    assert!(!message(&error).contains("texture_transform"));
    file.json["extensionsRequired"] = json!([]);
    file.json["extensionsUsed"] = json!(["KHR_materials_sheen", "KHR_lights_punctual"]);
    assert!(warnings(&file.read()).contains("extensions that are not read: KHR_materials_sheen"));
}

#[test]
fn accessors_outside_of_their_buffers_are_named() {
    let change = |path: &str, value: Value| {
        let mut file = rich();
        *file.json.pointer_mut(path).expect("a path") = value;
        error_of(&file)
    };
    let said = change("/accessors/0/bufferView", json!(77));
    assert!(said.contains("accessors[0].bufferView: names buffer view 77, but there are only"), "{said}");
    let said = change("/accessors/0/count", json!(4_000_000_000u64));
    assert!(said.contains("accessors[0]: 4000000000 elements of 12 bytes"), "{said}");
    let said = change("/bufferViews/0/byteOffset", json!(u64::MAX));
    assert!(said.contains("bufferViews[0]"), "{said}");
    let said = change("/bufferViews/0/buffer", json!(5));
    assert!(said.contains("bufferViews[0].buffer: names buffer 5"), "{said}");
    let said = change("/accessors/0/componentType", json!(5130));
    assert!(said.contains("accessors[0].componentType: 5130"), "{said}");
    let said = change("/accessors/0/type", json!("VEC5"));
    assert!(said.contains("accessors[0].type: \"VEC5\""), "{said}");
    let said = change("/meshes/0/primitives/0/attributes/POSITION", json!(99));
    assert!(said.contains("meshes[0].primitives[0].attributes.POSITION: names accessor 99"), "{said}");
    let said = change("/accessors/5/sparse/count", json!(9));
    assert!(said.contains("accessors[5].sparse.count: 9 is above the count 4"), "{said}");
    let said = change("/skins/0/joints/0", json!(9));
    assert!(said.contains("skins[0].joints: names node 9"), "{said}");
}

#[test]
fn counts_without_bytes_stop_at_the_limit() {
    let mut file = Builder::new();
    for count in [4_000_000_000u64, 60_000] {
        let zeros = json!({"componentType": 5126, "type": "VEC3", "count": count});
        file.json["accessors"] = json!([zeros]);
        file.json["meshes"] = json!([{"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}]}]);
        let error = super::super::read("many.glb", &file.glb(), &Tight).expect_err("too many");
        assert!(matches!(error, ReadError::Limit { .. }), "{error}");
    }
}

#[test]
fn indices_out_of_range_cost_their_triangle_only() {
    let mut file = Builder::new();
    let (position, indices) = (file.square(), file.indices(&[0, 1, 2, 0, 2, 9]));
    file.show(json!({"attributes": {"POSITION": position}, "indices": indices}));
    let scene = file.read();
    assert_eq!(first_mesh(&scene).faces.len(), 1);
    assert!(warnings(&scene).contains("1 elements name vertices that are not there"));
}

#[test]
fn points_that_are_not_finite_cost_their_triangles_only() {
    for bad in [f32::NAN, f32::INFINITY] {
        let mut file = Builder::new();
        let position = file.floats("VEC3", 3, &[0., 0., 0., 1., 0., 0., 1., 1., 0., bad, 1., 0.]);
        let indices = file.indices(&[0, 2, 3, 0, 1, 2]);
        file.show(json!({"attributes": {"POSITION": position}, "indices": indices}));
        let scene = file.read();
        let mesh = first_mesh(&scene);
        assert_eq!((mesh.faces.len(), mesh.points.len()), (1, 3));
        assert!(mesh.points.iter().all(|p| p.is_finite()));
        assert!(warnings(&scene).contains("1 elements are not finite"));
    }
}

#[test]
fn files_come_by_name_with_escapes_and_never_from_outside() {
    let mut file = Builder::new();
    let position = file.square();
    file.show(json!({"attributes": {"POSITION": position}, "mode": 0}));
    file.json["buffers"] = json!([{"uri": "my%20data.bin", "byteLength": file.bin.len()}]);
    let text = file.json.to_string();
    let held = Held([("my data.bin", file.bin.clone())].into());
    let scene = super::super::read("a.gltf", text.as_bytes(), &held).expect("the file is there");
    assert_eq!(first_mesh(&scene).points.len(), 4);
    let short = Held([("my data.bin", file.bin[..40].to_vec())].into());
    let error = super::super::read("a.gltf", text.as_bytes(), &short).expect_err("too short");
    assert!(message(&error).contains("buffers[0].byteLength: is 48, but there are only 40"), "{error}");
    let dir = tempfile::tempdir().expect("a temporary folder");
    let files = crate::Directory::new(dir.path());
    let outside = text.replace("my%20data.bin", "%2E%2E/secret.bin");
    let error = super::super::read("a.gltf", outside.as_bytes(), &files).expect_err("outside");
    assert!(message(&error).contains("leads outside"), "{error}");
}

#[test]
fn lost_pictures_are_warnings() {
    let scene = rich().read();
    assert!(warnings(&scene).contains("images[0]"), "{}", warnings(&scene));
    assert!(scene.textures.is_empty() && scene.images.is_empty());
}

/// Small files that name the same thing many times over must not grow without bound.
#[test]
fn what_is_named_many_times_is_bounded() {
    let mut file = Builder::new();
    let zeros = json!({"componentType": 5121, "type": "VEC3", "count": 1000});
    file.json["accessors"] = json!([zeros]);
    let primitives: Vec<Value> = (0..200)
        .map(
            |i| json!({"attributes": {"POSITION": 0, "NORMAL": 0}, "mode": 0, "targets": vec![json!({}); i]}),
        )
        .collect();
    file.json["meshes"] = json!([{"primitives": primitives}]);
    let result = super::super::read("many.glb", &file.glb(), &Tight);
    assert!(matches!(result, Err(ReadError::Limit { .. })));
    let mut file = Builder::new();
    let position = file.square();
    let nothing = vec![json!({}); 2000];
    file.show(json!({"attributes": {"POSITION": position}, "mode": 0, "targets": nothing}));
    file.json["meshes"][0]["weights"] = json!(vec![0; 2000]);
    file.json["nodes"] = json!(vec![json!({"mesh": 0}); 2000]);
    let result = super::super::read("many.glb", &file.glb(), &Tight);
    assert!(matches!(result, Err(ReadError::Limit { .. })));
}

/// A parent with many children that the scene lists one by one, and a long chain above them.
#[test]
fn trees_take_time_in_proportion_to_their_size() {
    let mut file = Builder::new();
    let count = 60_000u32;
    let mut nodes: Vec<Value> = (1..count).map(|i| json!({"children": [i]})).collect();
    nodes.push(json!({"children": (count..2 * count).collect::<Vec<_>>()}));
    nodes.resize(2 * count as usize, json!({}));
    file.json["nodes"] = json!(nodes);
    file.json["scenes"] = json!([{"nodes": (count..2 * count).collect::<Vec<_>>()}]);
    let scene = file.read();
    assert_eq!(scene.roots.len(), count as usize);
    assert!(scene.nodes[count as usize - 1].children.is_empty());
}
