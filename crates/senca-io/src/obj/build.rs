//! From arrays as they stand in the file to a scene.

use std::collections::HashMap;

use senca_scene::math::LinearRgb;
use senca_scene::math::color::linear_from_srgb;
use senca_scene::math::glam::{Vec2, Vec3, Vec4};
use senca_scene::{
    Faces, Geometry, Material, MaterialId, Mesh, Node, Scene, Shape, Surface, Vertices, Warning,
};

use super::parse::{Corner, NONE, Run, Smoothing, Soup, SurfaceKey};
use crate::normals::{fill_missing_normals, join_doubled_points, unit};
use crate::{Files, ReadError};

/// Vertices of one point that are looked through one by one; further ones are hashed.
const CHAIN: u32 = 32;

/// Makes the scene.
pub(super) fn build(name: &str, mut soup: Soup, files: &dyn Files) -> Result<Scene, ReadError> {
    let mut scene = Scene { name: crate::stem(name), ..Scene::default() };
    scene.warnings = std::mem::take(&mut soup.warnings).into_iter().map(Warning).collect();
    let materials = materials(&mut scene, &soup, files)?;
    finish_colors(&mut soup.colors);
    let freeforms = std::mem::take(&mut soup.freeforms);
    let object_names = soup.objects.clone();
    let only_points =
        freeforms.is_empty() && soup.face_count == 0 && soup.lines.is_empty() && soup.dots.is_empty();
    if only_points {
        let corner = |point| Corner { point, texcoord: NONE, normal: NONE };
        soup.dots = (0..soup.points.len() as u32).map(|point| (corner(point), 0)).collect();
    }
    for mut part in split(soup) {
        let material_of =
            |key: &SurfaceKey| key.material.as_ref().and_then(|name| materials.get(name).copied());
        let named = part.keys.iter().zip(part.surface_names);
        part.mesh.surfaces = named.map(|(key, name)| surface(name, key, material_of(key))).collect();
        join_doubled_points(&mut part.mesh);
        let name = if part.name.is_empty() { scene.name.clone() } else { part.name };
        let shape = Shape::Mesh(part.mesh);
        let geometry = scene.add_geometry(Geometry { name: name.clone(), shape, material: None });
        let node = scene.add_node(Node { name, geometry: Some(geometry), ..Node::default() });
        scene.roots.push(node);
    }
    for freeform in freeforms {
        let material = freeform.key.material.and_then(|name| materials.get(&name).copied());
        let object = &object_names[freeform.key.object as usize];
        let named = [object, &freeform.name].into_iter().find(|name| !name.is_empty()).cloned();
        let name = named.unwrap_or_else(|| scene.name.clone());
        let geometry = scene.add_geometry(Geometry { name: name.clone(), shape: freeform.shape, material });
        let node = scene.add_node(Node { name, geometry: Some(geometry), ..Node::default() });
        scene.roots.push(node);
    }
    Ok(scene)
}

fn surface(name: String, key: &SurfaceKey, material: Option<MaterialId>) -> Surface {
    let smoothing_group = match key.smoothing {
        Smoothing::Unsaid => 1,
        Smoothing::Off => 0,
        Smoothing::Group(group) => group.saturating_add(1),
    };
    Surface { name, material, smooth: key.smoothing != Smoothing::Off, smoothing_group }
}

/// Decodes colours; ones above 1 anywhere mean that they run to 255.
fn finish_colors(colors: &mut [Vec4]) {
    let scale = if colors.iter().any(|c| c.max_element() > 1.0) { 1.0 / 255.0 } else { 1.0 };
    for color in colors {
        let alpha = if color.w > 1.0 { color.w * scale } else { color.w };
        let rgb =
            LinearRgb::new(color.x, color.y, color.z).map(|v| linear_from_srgb((v * scale).clamp(0.0, 1.0)));
        *color = Vec4::new(rgb.r, rgb.g, rgb.b, alpha.clamp(0.0, 1.0));
    }
}

/// Reads the libraries and gives every material that a face uses an entry.
fn materials(
    scene: &mut Scene,
    soup: &Soup,
    files: &dyn Files,
) -> Result<HashMap<String, MaterialId>, ReadError> {
    let mut ids = HashMap::new();
    let missing = crate::mtl::read_libraries(&soup.libraries, files, scene, &mut ids)?;
    let keys = soup.surfaces.iter().chain(soup.freeforms.iter().map(|freeform| &freeform.key));
    let used = keys.filter_map(|key| key.material.as_ref());
    for name in used {
        if ids.contains_key(name) {
            continue;
        }
        if !missing {
            scene.warnings.push(Warning(format!("the material \"{name}\" is not defined")));
        }
        let id = scene.add_material(Material { name: name.clone(), ..Material::default() });
        ids.insert(name.clone(), id);
    }
    Ok(ids)
}

/// One object of the file.
struct Part {
    name: String,
    mesh: Mesh,
    keys: Vec<SurfaceKey>,
    surface_names: Vec<String>,
}

/// The objects that have faces, lines or dots.
fn split(mut soup: Soup) -> Vec<Part> {
    let mut used = vec![false; soup.objects.len()];
    soup.surfaces.iter().for_each(|key| used[key.object as usize] = true);
    soup.lines.iter().for_each(|line| used[line.1 as usize] = true);
    soup.dots.iter().for_each(|dot| used[dot.1 as usize] = true);
    let objects: Vec<u32> = (0..soup.objects.len() as u32).filter(|&o| used[o as usize]).collect();
    if let [object] = objects[..] {
        let keys = std::mem::take(&mut soup.surfaces);
        let name = std::mem::take(&mut soup.objects[object as usize]);
        let surface_names = std::mem::take(&mut soup.surface_names);
        return vec![Part { name, mesh: whole_mesh(soup, &keys), keys, surface_names }];
    }
    split_objects(&soup, &objects)
}

/// The mesh of a file with one object: points and corners move over without copying.
fn whole_mesh(mut soup: Soup, keys: &[SurfaceKey]) -> Mesh {
    let mut mesh = Mesh { points: std::mem::take(&mut soup.points), ..Mesh::default() };
    let (texcoords, normals) = (&soup.texcoords, &soup.normals);
    let source = Attributes { texcoords, normals, colors: &soup.colors };
    let surface = surface_of_faces(&soup.runs, soup.face_count, |s| s);
    let plain = soup.corners.texcoord.is_empty() && soup.corners.normal.is_empty();
    let one_class = keys.iter().all(|key| key.smoothing == keys[0].smoothing);
    let loose = soup.lines.iter().flat_map(|line| line.0).chain(soup.dots.iter().map(|dot| dot.0));
    let loose_plain = loose.clone().all(|c| c.texcoord == NONE && c.normal == NONE);
    if plain && one_class && loose_plain {
        mesh.vertices.point = (0..mesh.points.len() as u32).collect();
        mesh.vertices.color = std::mem::take(&mut soup.colors);
        mesh.lines = soup.lines.iter().map(|([a, b], _)| [a.point, b.point]).collect();
        mesh.dots = soup.dots.iter().map(|(dot, _)| dot.point).collect();
        mesh.faces = Faces { corners: soup.corners.point, starts: soup.starts, surface };
        return mesh;
    }
    let mut unifier = Unifier::new(mesh.points.len());
    let mut corners = Vec::with_capacity(soup.corners.point.len());
    for (i, run) in soup.runs.iter().enumerate() {
        let class = class_of(keys[run.surface as usize].smoothing);
        let last_face = soup.runs.get(i + 1).map_or(soup.face_count, |next| next.first_face);
        let range = corner_of(&soup.starts, run.first_face)..corner_of(&soup.starts, last_face);
        corners.extend(range.map(|c| unifier.vertex(soup.corner(c), class)));
    }
    mesh.lines = soup.lines.iter().map(|(line, _)| line.map(|corner| unifier.loose(corner))).collect();
    mesh.dots = soup.dots.iter().map(|(dot, _)| unifier.loose(*dot)).collect();
    mesh.faces = Faces { corners, starts: soup.starts, surface };
    mesh.vertices = unifier.into_vertices(&source, &|point| point);
    fill_missing_normals(&mut mesh);
    mesh
}

/// A mesh for each of `objects`, with the points that it uses in the order of the file.
fn split_objects(soup: &Soup, objects: &[u32]) -> Vec<Part> {
    let place = |object: u32| objects.binary_search(&object).unwrap_or_default();
    let mut contents: Vec<Content> = objects.iter().map(|_| Content::default()).collect();
    for (i, run) in soup.runs.iter().enumerate() {
        let last_face = soup.runs.get(i + 1).map_or(soup.face_count, |next| next.first_face);
        let object = soup.surfaces[run.surface as usize].object;
        contents[place(object)].runs.push((*run, last_face));
    }
    soup.lines.iter().for_each(|(line, object)| contents[place(*object)].lines.push(*line));
    soup.dots.iter().for_each(|(dot, object)| contents[place(*object)].dots.push(*dot));
    let mut local_of_point = vec![NONE; soup.points.len()];
    let mut parts = Vec::with_capacity(objects.len());
    for (&object, content) in objects.iter().zip(&contents) {
        let (mesh, surfaces) = part_mesh(soup, content, &mut local_of_point);
        let keys = surfaces.iter().map(|&s| soup.surfaces[s as usize].clone()).collect();
        let surface_names = surfaces.iter().map(|&s| soup.surface_names[s as usize].clone()).collect();
        parts.push(Part { name: soup.objects[object as usize].clone(), mesh, keys, surface_names });
    }
    parts
}

/// What belongs to one object; runs with the face behind their last.
#[derive(Default)]
struct Content {
    runs: Vec<(Run, u32)>,
    lines: Vec<[Corner; 2]>,
    dots: Vec<Corner>,
}

/// The mesh of one object, and the file's number of each of its surfaces. `local_of_point` is [`NONE`] throughout before and after.
fn part_mesh(soup: &Soup, content: &Content, local_of_point: &mut [u32]) -> (Mesh, Vec<u32>) {
    // Number the points that are used, in their order in the file.
    let corners_of =
        |&(run, last): &(Run, u32)| corner_of(&soup.starts, run.first_face)..corner_of(&soup.starts, last);
    let of_faces = content.runs.iter().flat_map(corners_of).map(|c| soup.corners.point[c]);
    let of_lines = content.lines.iter().flatten().map(|corner| corner.point);
    let mut used: Vec<u32> =
        of_faces.chain(of_lines).chain(content.dots.iter().map(|dot| dot.point)).collect();
    used.sort_unstable();
    used.dedup();
    used.iter().enumerate().for_each(|(local, &point)| local_of_point[point as usize] = local as u32);
    let mut mesh =
        Mesh { points: used.iter().map(|&p| soup.points[p as usize]).collect(), ..Mesh::default() };
    // Make faces, lines and dots over the vertices that they need.
    let mut unifier = Unifier::new(used.len());
    let local = |corner: Corner| Corner { point: local_of_point[corner.point as usize], ..corner };
    let mut surfaces = Vec::new();
    let mut surface_numbers = HashMap::new();
    let mut face = Vec::new();
    for &(run, last_face) in &content.runs {
        let key = &soup.surfaces[run.surface as usize];
        let surface = *surface_numbers.entry(run.surface).or_insert_with(|| {
            surfaces.push(run.surface);
            surfaces.len() as u32 - 1
        });
        for f in run.first_face..last_face {
            face.clear();
            let range = corner_of(&soup.starts, f)..corner_of(&soup.starts, f + 1);
            face.extend(range.map(|c| unifier.vertex(local(soup.corner(c)), class_of(key.smoothing))));
            mesh.faces.push(&face, surface);
        }
    }
    mesh.lines = content.lines.iter().map(|line| line.map(|corner| unifier.loose(local(corner)))).collect();
    mesh.dots = content.dots.iter().map(|&dot| unifier.loose(local(dot))).collect();
    let source = Attributes { texcoords: &soup.texcoords, normals: &soup.normals, colors: &soup.colors };
    mesh.vertices = unifier.into_vertices(&source, &|local| used[local as usize]);
    fill_missing_normals(&mut mesh);
    used.iter().for_each(|&point| local_of_point[point as usize] = NONE);
    (mesh, surfaces)
}

impl Soup {
    fn corner(&self, corner: usize) -> Corner {
        let of = |all: &[u32]| all.get(corner).copied().unwrap_or(NONE);
        Corner {
            point: self.corners.point[corner],
            texcoord: of(&self.corners.texcoord),
            normal: of(&self.corners.normal),
        }
    }
}

/// Where face `face` begins among the corners.
fn corner_of(starts: &[u32], face: u32) -> usize {
    if starts.is_empty() { 3 * face as usize } else { starts[face as usize] as usize }
}

/// Surface per face, empty if all are on surface 0.
fn surface_of_faces(runs: &[Run], face_count: u32, local: impl Fn(u32) -> u32) -> Vec<u32> {
    if runs.iter().all(|run| local(run.surface) == 0) {
        return Vec::new();
    }
    let mut surfaces = Vec::with_capacity(face_count as usize);
    for (i, run) in runs.iter().enumerate() {
        let last = runs.get(i + 1).map_or(face_count, |next| next.first_face);
        surfaces.resize(last as usize, local(run.surface));
    }
    surfaces
}

/// Corners of different classes share no vertex, unless they name their normal.
fn class_of(smoothing: Smoothing) -> u64 {
    match smoothing {
        Smoothing::Unsaid => 0,
        Smoothing::Off => 1,
        Smoothing::Group(group) => 2 + u64::from(group),
    }
}

/// Finds the vertex of a corner, or makes it.
struct Unifier {
    /// First vertex of each point.
    first: Vec<u32>,
    /// Next vertex of the same point.
    next: Vec<u32>,
    corners: Vec<Corner>,
    classes: Vec<u64>,
    /// Vertices behind the end of a long chain.
    hashed: HashMap<(u32, u32, u32, u64), u32>,
}

/// Attributes as they stand in the file.
struct Attributes<'a> {
    texcoords: &'a [Vec2],
    normals: &'a [Vec3],
    colors: &'a [Vec4],
}

impl Unifier {
    fn new(points: usize) -> Self {
        let (next, corners) = (Vec::with_capacity(points), Vec::with_capacity(points));
        let classes = Vec::with_capacity(points);
        Self { first: vec![NONE; points], next, corners, classes, hashed: HashMap::new() }
    }

    #[inline]
    fn vertex(&mut self, corner: Corner, class: u64) -> u32 {
        let class = if corner.normal == NONE { class } else { 0 };
        let mut last = NONE;
        let mut vertex = self.first[corner.point as usize];
        for _ in 0..CHAIN {
            if vertex == NONE {
                let made = self.make(corner, class);
                match last {
                    NONE => self.first[corner.point as usize] = made,
                    last => self.next[last as usize] = made,
                }
                return made;
            }
            if self.corners[vertex as usize] == corner && self.classes[vertex as usize] == class {
                return vertex;
            }
            last = vertex;
            vertex = self.next[vertex as usize];
        }
        let key = (corner.point, corner.texcoord, corner.normal, class);
        if let Some(&vertex) = self.hashed.get(&key) {
            return vertex;
        }
        let made = self.make(corner, class);
        self.hashed.insert(key, made);
        made
    }

    /// A vertex for the corner of a line or dot: any of the point's that has what the corner names.
    fn loose(&mut self, corner: Corner) -> u32 {
        let mut vertex = self.first[corner.point as usize];
        for _ in 0..CHAIN {
            let Some(known) = self.corners.get(vertex as usize) else { break };
            if corner.texcoord == NONE || corner.texcoord == known.texcoord {
                return vertex;
            }
            vertex = self.next[vertex as usize];
        }
        self.vertex(corner, 0)
    }

    fn make(&mut self, corner: Corner, class: u64) -> u32 {
        self.corners.push(corner);
        self.classes.push(class);
        self.next.push(NONE);
        self.corners.len() as u32 - 1
    }

    /// The vertices with their attributes; `place` gives the point in the file of a local point.
    /// Normals that are missing or have no direction are NaN.
    fn into_vertices(self, source: &Attributes<'_>, place: &dyn Fn(u32) -> u32) -> Vertices {
        let mut vertices = Vertices::default();
        let corners = &self.corners;
        if corners.iter().any(|c| c.texcoord != NONE) {
            let texcoord =
                |c: &Corner| source.texcoords.get(c.texcoord as usize).copied().unwrap_or_default();
            vertices.texcoord0 = corners.iter().map(texcoord).collect();
        }
        if corners.iter().any(|c| c.normal != NONE) {
            let normal = |c: &Corner| {
                source.normals.get(c.normal as usize).and_then(|n| unit(*n)).unwrap_or(Vec3::NAN)
            };
            vertices.normal = corners.iter().map(normal).collect();
        }
        if !source.colors.is_empty() {
            vertices.color = corners.iter().map(|c| source.colors[place(c.point) as usize]).collect();
        }
        vertices.point = corners.iter().map(|c| c.point).collect();
        vertices
    }
}
