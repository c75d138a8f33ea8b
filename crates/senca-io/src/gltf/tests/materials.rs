//! Materials, textures and pictures.

use senca_scene::math::LinearRgb;
use senca_scene::math::glam::Vec3;
use senca_scene::{
    AlphaMode, Filter, ImageData, ImageId, Material, MetallicRoughness, Reflection, TextureId, Wrap,
};
use serde_json::json;

use super::{Builder, Held, warnings};

/// A picture of 2 x 2 texels as PNG.
pub(super) fn png(texels: [[u8; 4]; 4]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 2, 2);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(texels.as_flattened()).expect("texels");
    writer.finish().expect("an end");
    file
}

fn reflection(material: &Material) -> &MetallicRoughness {
    match &material.reflection {
        Reflection::MetallicRoughness(m) => m,
        Reflection::Phong(p) => panic!("not metallic-roughness: {p:?}"),
    }
}

#[test]
fn an_empty_material_has_the_format_s_defaults() {
    let mut file = Builder::new();
    file.json["materials"] = json!([{"name": "plain"}]);
    let scene = file.read();
    let expected = Material {
        name: "plain".to_owned(),
        reflection: Reflection::MetallicRoughness(MetallicRoughness::default()),
        ..Material::default()
    };
    assert_eq!(scene.materials, [expected]);
}

#[test]
fn every_property_arrives() {
    let mut file = Builder::new();
    let view = file.view(&png([[1, 2, 3, 255], [9, 9, 9, 255], [0; 4], [255; 4]]));
    file.json["images"] = json!([{"bufferView": view, "mimeType": "image/png", "name": "picture"}]);
    file.json["samplers"] = json!([{"magFilter": 9728, "wrapS": 33648, "wrapT": 33071}]);
    file.json["textures"] = json!([{"source": 0}, {"source": 0, "sampler": 0}]);
    file.json["materials"] = json!([{
        "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.125, 0.75], "metallicFactor": 0.5,
            "roughnessFactor": 0.25, "baseColorTexture": {"index": 0, "texCoord": 1},
            "metallicRoughnessTexture": {"index": 1}},
        "normalTexture": {"index": 1, "scale": 0.5}, "occlusionTexture": {"index": 1, "strength": 0.25},
        "emissiveTexture": {"index": 0}, "emissiveFactor": [1, 0.5, 0],
        "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true,
        "extensions": {"KHR_materials_unlit": {}, "KHR_materials_ior": {"ior": 1.25},
            "KHR_materials_emissive_strength": {"emissiveStrength": 8},
            "KHR_materials_volume": {"thicknessFactor": 0.1, "attenuationDistance": 2,
                "attenuationColor": [1, 0.5, 0.25]},
            "KHR_materials_transmission": {"transmissionFactor": 0.5}}}]);
    let scene = file.read();
    assert!(scene.warnings.is_empty(), "{}", warnings(&scene));
    assert_eq!((scene.images.len(), scene.images[0].name.as_str()), (1, "picture"));
    let ImageData::Rgba8 { width: 2, height: 2, texels } = &scene.images[0].data else { panic!("2 x 2") };
    assert_eq!(texels[0], [1, 2, 3, 255], "row 0 is on top");
    let sampled = scene.textures.iter().find(|t| t.filter == Filter::Nearest).expect("the second texture");
    assert_eq!((sampled.wrap_u, sampled.wrap_v, sampled.image), (Wrap::Mirror, Wrap::Clamp, ImageId(0)));
    let material = &scene.materials[0];
    let m = reflection(material);
    assert_eq!((m.base_color, m.alpha), (LinearRgb::new(0.5, 0.25, 0.125), 0.75));
    assert_eq!((m.metallic, m.roughness), (0.5, 0.25));
    assert_eq!(m.base_color_texture.map(|t| t.texcoord), Some(1));
    assert_eq!(material.normal_texture.map(|t| t.strength), Some(0.5));
    assert_eq!(material.occlusion_texture.map(|t| t.strength), Some(0.25));
    assert_eq!(material.emission, LinearRgb::new(8.0, 4.0, 0.0));
    assert_eq!(material.alpha_mode, AlphaMode::Mask { cutoff: 0.25 });
    assert!(material.double_sided && material.unlit);
    assert_eq!((material.ior, material.transmission), (1.25, LinearRgb::new(0.125, 0.0625, 0.03125)));
    let half = 0.5 * std::f32::consts::LN_2;
    assert!(material.fresnel && material.absorption.r == 0.0);
    assert!((material.absorption.g - half).abs() < 1e-6 && (material.absorption.b - 2.0 * half).abs() < 1e-6);
}

/// The example in the extension's text: the lower left quadrant, rotated clockwise by 90 degrees.
#[test]
fn texture_transforms_turn_as_the_example_says() {
    let mut file = Builder::new();
    let view = file.view(&png([[0; 4]; 4]));
    file.json["images"] = json!([{"bufferView": view}]);
    file.json["textures"] = json!([{"source": 0}]);
    file.json["materials"] = json!([{"emissiveTexture": {"index": 0, "extensions": {"KHR_texture_transform":
        {"offset": [0, 1], "rotation": std::f64::consts::FRAC_PI_2, "scale": [0.5, 0.5], "texCoord": 1}}}}]);
    let scene = file.read();
    let texture = scene.materials[0].emission_texture.expect("a texture");
    assert_eq!(texture.texcoord, 1);
    let place = |u: f32, v: f32| texture.uv_transform * Vec3::new(u, v, 1.0);
    assert!(place(0.0, 0.0).abs_diff_eq(Vec3::new(0.0, 1.0, 1.0), 1e-6));
    assert!(place(1.0, 0.0).abs_diff_eq(Vec3::new(0.0, 0.5, 1.0), 1e-6));
    assert!(place(0.0, 1.0).abs_diff_eq(Vec3::new(0.5, 1.0, 1.0), 1e-6));
}

#[test]
fn any_two_sets_of_texture_coordinates_serve_a_material() {
    let mut file = Builder::new();
    let view = file.view(&png([[0; 4]; 4]));
    let position = file.square();
    let sets: Vec<usize> = (0..4).map(|set| file.floats("VEC2", 2, &[set as f32; 8])).collect();
    let indices = file.indices(&[0, 1, 2, 0, 2, 3]);
    file.json["images"] = json!([{"bufferView": view}]);
    file.json["textures"] = json!([{"source": 0}]);
    let texture = |set: u32| json!({"index": 0, "texCoord": set});
    file.json["materials"] = json!([
        {"emissiveTexture": texture(3), "normalTexture": texture(2)},
        {"emissiveTexture": texture(1)},
        {"emissiveTexture": texture(0), "normalTexture": texture(2), "occlusionTexture": texture(3)}]);
    let attributes = json!({"POSITION": position, "TEXCOORD_0": sets[0], "TEXCOORD_1": sets[1],
        "TEXCOORD_2": sets[2], "TEXCOORD_3": sets[3]});
    let primitive =
        |material: u32| json!({"indices": indices, "attributes": attributes, "material": material});
    file.json["meshes"] = json!([{"primitives": [primitive(0)]}, {"primitives": [primitive(1)]},
        {"primitives": [primitive(2)]}]);
    let scene = file.read();
    let set_of = |mesh: usize, texture: Option<senca_scene::TextureRef>| {
        let senca_scene::Shape::Mesh(mesh) = &scene.geometries[mesh].shape else { panic!("a mesh") };
        let sets = [&mesh.vertices.texcoord0, &mesh.vertices.texcoord1];
        texture.map(|t| sets[t.texcoord as usize][0].x)
    };
    let m = &scene.materials;
    assert_eq!([m[0].emission_texture, m[0].normal_texture].map(|t| set_of(0, t)), [Some(3.0), Some(2.0)]);
    assert_eq!(set_of(1, m[1].emission_texture), Some(1.0));
    assert_eq!([m[2].emission_texture, m[2].normal_texture].map(|t| set_of(2, t)), [Some(0.0), Some(2.0)]);
    assert_eq!(m[2].occlusion_texture, None);
    assert!(
        warnings(&scene).contains("occlusionTexture.texCoord: set 3 is the third"),
        "{}",
        warnings(&scene)
    );
}

#[test]
fn specular_glossiness_is_converted_with_its_textures() {
    let mut file = Builder::new();
    let diffuse = file.view(&png([[255, 0, 0, 128], [0, 0, 0, 255], [255; 4], [255; 4]]));
    let coat = file.view(&png([[0, 0, 0, 255], [255, 255, 255, 0], [0, 0, 0, 128], [0, 0, 0, 0]]));
    file.json["images"] = json!([{"bufferView": diffuse}, {"bufferView": coat}]);
    file.json["textures"] = json!([{"source": 0}, {"source": 1}]);
    file.json["materials"] = json!([
        {"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseTexture": {"index": 0},
            "specularGlossinessTexture": {"index": 1}}}},
        {"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.96, 0.48, 0, 0.5],
            "specularFactor": [0, 0, 0], "glossinessFactor": 0.25}}}]);
    let first = file.json["materials"][0].clone();
    file.push("materials", first);
    let scene = file.read();
    let m = reflection(&scene.materials[0]);
    let texels = |t: Option<senca_scene::TextureRef>| {
        let image = scene.textures[t.expect("a texture").texture.index()].image;
        match &scene.images[image.index()].data {
            ImageData::Rgba8 { texels, .. } => texels.clone(),
            ImageData::RgbaF32 { .. } => panic!("8 bits"),
        }
    };
    let (base, coat) = (texels(m.base_color_texture), texels(m.metallic_roughness_texture));
    assert_eq!((base[0], coat[0]), ([255, 0, 0, 128], [255, 0, 0, 255]), "red, smooth, no metal");
    assert_eq!((base[1], coat[1]), ([255, 255, 255, 255], [255, 255, 255, 255]), "white rough metal");
    assert_eq!(coat[2], [255, 127, 0, 255]);
    assert_eq!(scene.images.len(), 4, "two as they are and two made of them, once");
    assert_eq!(reflection(&scene.materials[2]), m);
    let m = reflection(&scene.materials[1]);
    assert_eq!((m.base_color, m.alpha), (LinearRgb::new(1.0, 0.5, 0.0), 0.5));
    assert_eq!((m.metallic, m.roughness), (0.0, 0.75));
}

#[test]
fn pictures_come_from_files_and_are_shared() {
    let mut file = Builder::new();
    let picture = png([[7, 7, 7, 255]; 4]);
    file.json["images"] = json!([{"uri": "a%20b.png"}, {"uri": "a%20b.png"}, {"uri": "lost.png"}]);
    file.json["textures"] = json!([{"source": 0}, {"source": 1}, {"source": 2}, {}]);
    let uses = |i: u32| json!({"emissiveTexture": {"index": i}});
    file.json["materials"] = json!([uses(0), uses(1), uses(2), uses(3), uses(9)]);
    let held = Held([("a b.png", picture)].into());
    let scene = super::super::read("a.glb", &file.glb(), &held).expect("lost pictures are not fatal");
    assert_eq!((scene.images.len(), scene.images[0].name.as_str()), (1, "a%20b.png"));
    let used: Vec<_> = scene.materials.iter().map(|m| m.emission_texture.map(|t| t.texture)).collect();
    assert_eq!(used, [Some(TextureId(0)), Some(TextureId(1)), None, None, None]);
    let said = warnings(&scene);
    assert!(
        said.contains("images[2]") && said.contains("textures[3]") && said.contains("names texture 9"),
        "{said}"
    );
}

#[test]
fn factors_out_of_range_are_brought_back() {
    let mut file = Builder::new();
    file.json["materials"] = json!([{"pbrMetallicRoughness": {"metallicFactor": 7, "roughnessFactor": -1},
        "alphaMode": "GLASS", "emissiveFactor": [1e300, 0, 0], "extensions": {"KHR_materials_ior": {"ior": -1}}}]);
    let scene = file.read();
    let m = reflection(&scene.materials[0]);
    assert_eq!((m.metallic, m.roughness, scene.materials[0].ior), (1.0, 0.0, 1.5));
    assert_eq!(scene.materials[0].emission, LinearRgb::BLACK);
    assert_eq!(scene.warnings.len(), 5, "{}", warnings(&scene));
}
