//! Meshes: primitives of one mesh put together into one `senca_scene::Mesh` (glTF 2.0, section 3.7).
//!
//! 1. Primitives with the same attributes form a *group*, whose vertices are read once. Its two sets of
//!    texture coordinates are those that its materials name.
//! 2. Elements that name missing or not finite vertices are left out, with a warning; then vertices
//!    that no element uses are left out too, so that a large array shared by many meshes is not
//!    copied into each.
//! 3. Groups follow each other in the mesh. Where one has an attribute that another lacks, the other
//!    gets a neutral value: white, texture coordinates (0, 0), the faces' own normals.

use std::collections::BTreeMap;

use senca_scene::math::glam::{Vec2, Vec3, Vec4};
use senca_scene::{
    Geometry, JointInfluence, Material, MaterialId, Mesh, MorphTarget, Shape, Surface, Vertices,
};

use super::accessor::Accessor;
use super::document::{Document, name_or};
use super::json;
use super::json::Whole;
use super::material;
use super::topology::Elements;
use crate::{Location, ReadError};

/// A mesh with what its nodes need to know.
pub(super) struct ReadMesh {
    pub(super) geometry: Geometry,
    /// Largest joint that pulls at a point.
    pub(super) largest_joint: Option<u16>,
    /// Morph weights for nodes that give none.
    pub(super) weights: Vec<f32>,
    /// Number of morph targets.
    pub(super) targets: usize,
}

/// Vertices of primitives with the same attributes.
#[derive(Default)]
struct Group {
    points: Vec<Vec3>,
    /// Place of each vertex in `points`; `None` when they are one to one.
    vertex_point: Option<Vec<u32>>,
    normal: Option<Vec<Vec3>>,
    texcoord: [Option<Vec<Vec2>>; 2],
    color: Option<Vec<Vec4>>,
    tangent: Option<Vec<Vec4>>,
    joints: Option<Vec<JointInfluence>>,
    targets: Vec<Target>,
    /// Number of the primitive in the mesh, and its elements over this group's vertices.
    primitives: Vec<(usize, Elements)>,
}

/// Offsets of one morph target.
#[derive(Default)]
struct Target {
    points: Option<Vec<Vec3>>,
    normals: Option<Vec<Vec3>>,
    tangents: Option<Vec<Vec3>>,
}

type Attributes = BTreeMap<String, Whole>;

/// Reads mesh `index`. `materials` are the scene's, in the order of the file's.
pub(super) fn read(
    document: &Document<'_>,
    index: usize,
    materials: &[Material],
) -> Result<ReadMesh, ReadError> {
    let json = &document.root.meshes[index];
    let mut groups = gather_groups(document, index, json)?;
    settle_normals(&mut groups);
    settle_tangents(document, json, &mut groups, materials);
    let mut mesh = merge(document, &groups)?;
    for (target, name) in mesh.morph_targets.iter_mut().zip(target_names(json)) {
        target.name = name;
    }
    let material = add_elements(document, index, json, &groups, materials.len(), &mut mesh);
    let largest_joint = mesh.joints.iter().flat_map(|j| j.joints).max();
    let targets = mesh.morph_targets.len();
    let weights = json.weights.iter().take(targets).map(|&w| finite_or_zero(w as f32)).collect();
    let geometry = Geometry { name: json.name.clone(), shape: Shape::Mesh(mesh), material };
    Ok(ReadMesh { geometry, largest_joint, weights, targets })
}

/// Names of morph targets, which exporters put into the mesh's extras.
fn target_names(json: &json::Mesh) -> Vec<String> {
    let names = json.extras.as_ref().and_then(|extras| extras.get("targetNames")?.as_array());
    names.into_iter().flatten().map(|name| name.as_str().unwrap_or_default().to_owned()).collect()
}

fn gather_groups(document: &Document<'_>, index: usize, json: &json::Mesh) -> Result<Vec<Group>, ReadError> {
    let mut known: BTreeMap<(&Attributes, &[Attributes], [u64; 2]), usize> = BTreeMap::new();
    let mut members: Vec<Vec<(usize, Elements)>> = Vec::new();
    for (p, primitive) in json.primitives.iter().enumerate() {
        let place = format!("meshes[{index}].primitives[{p}]");
        let Some(elements) = read_elements(document, &place, primitive)? else { continue };
        let sets = coordinate_sets(document, primitive);
        let key = (&primitive.attributes, primitive.targets.as_slice(), sets);
        let group = *known.entry(key).or_insert(members.len());
        if group == members.len() {
            members.push(Vec::new());
        }
        members[group].push((p, elements));
    }
    members.into_iter().map(|primitives| read_group(document, index, json, primitives)).collect()
}

/// The sets of texture coordinates that the primitive's material asks for.
fn coordinate_sets(document: &Document<'_>, primitive: &json::Primitive) -> [u64; 2] {
    let material = primitive.material.and_then(|m| document.root.materials.get(m.0 as usize));
    material.map_or([0, 1], material::coordinate_sets)
}

/// The elements of one primitive over the vertices of its accessors; `None` when it has no positions.
fn read_elements(
    document: &Document<'_>,
    place: &str,
    primitive: &json::Primitive,
) -> Result<Option<Elements>, ReadError> {
    let Some(&position) = primitive.attributes.get("POSITION") else {
        document.warn(format!("{place}.attributes: has no POSITION; the primitive is left out"));
        return Ok(None);
    };
    let count = Accessor::open(document, &format!("{place}.attributes.POSITION"), position)?.count;
    let corners = read_corners(document, place, primitive, count)?;
    let mode = primitive.mode.map_or(4, |m| m.0);
    document.charge(&place, corners.len() as u64)?;
    let Some(mut elements) = Elements::expand(mode, &corners) else {
        return Err(document.malformed(format!("{place}.mode: {mode} is none of glTF's 0 to 6")));
    };
    let left_over = Elements::left_over(mode, corners.len());
    if left_over > 0 {
        document.warn(format!("{place}: {left_over} vertices at the end make no element"));
    }
    let before = elements.len();
    elements.retain(|v| (v as usize) < count);
    if elements.len() < before {
        let lost = before - elements.len();
        document.warn(format!("{place}.indices: {lost} elements name vertices that are not there; left out"));
    }
    Ok(Some(elements))
}

/// Vertex numbers in drawing order.
fn read_corners(
    document: &Document<'_>,
    place: &str,
    primitive: &json::Primitive,
    count: usize,
) -> Result<Vec<u32>, ReadError> {
    let Some(indices) = primitive.indices else {
        document.charge(&place, count as u64)?;
        return Ok((0..count as u32).collect());
    };
    let place = format!("{place}.indices");
    let accessor = Accessor::open(document, &place, indices)?;
    if accessor.width() != 1 || !accessor.component.is_unsigned() {
        let message = format!("{place}: accessors[{}] must hold unsigned scalars", indices.0);
        return Err(document.malformed(message));
    }
    Ok(accessor.integers::<1>(document, None)?.into_iter().flatten().collect())
}

/// Reads the vertices that `primitives`, all of the same attributes, use.
fn read_group(
    document: &Document<'_>,
    index: usize,
    json: &json::Mesh,
    mut primitives: Vec<(usize, Elements)>,
) -> Result<Group, ReadError> {
    let primitive = &json.primitives[primitives[0].0];
    let place = format!("meshes[{index}].primitives[{}]", primitives[0].0);
    let Some(&position) = primitive.attributes.get("POSITION") else { return Ok(Group::default()) };
    let positions = Accessor::open(document, &format!("{place}.attributes.POSITION"), position)?;
    if positions.width() != 3 {
        return Err(document.malformed(format!("{place}.attributes.POSITION: must be of type VEC3")));
    }
    document.charge(&place, positions.count as u64)?;
    let (used, points) = used_points(document, &place, &positions, &mut primitives)?;
    let count = positions.count;
    let select = (used.len() < count).then_some(used.as_slice());
    renumber(&used, count, &mut primitives);
    let source = Source { document, place: &place, attributes: &primitive.attributes, count, select };
    let targets = primitive.targets.iter().enumerate().map(|(t, attributes)| {
        let place = format!("{place}.targets[{t}]");
        read_target(&Source { document, place: &place, attributes, count, select })
    });
    let sets = coordinate_sets(document, primitive);
    let normal = source.vectors("NORMAL")?.map(|(normals, _)| normals);
    Ok(Group {
        normal: normal.map(|normals| sound_normals(normals, &points, &primitives)),
        points,
        vertex_point: None,
        texcoord: [source.texcoords(sets[0])?, source.texcoords(sets[1])?],
        color: source.colors()?,
        tangent: source.tangents()?,
        joints: source.joints()?,
        targets: targets.collect::<Result<_, _>>()?,
        primitives,
    })
}

/// The vertices that elements use, rising, with their places. Elements with a corner that is not
/// finite are left out.
fn used_points(
    document: &Document<'_>,
    place: &str,
    positions: &Accessor<'_>,
    primitives: &mut [(usize, Elements)],
) -> Result<(Vec<u32>, Vec<Vec3>), ReadError> {
    let mut used = used_vertices(positions.count, primitives);
    let points = positions.floats::<3>(document, Some(&used))?;
    let mut points: Vec<Vec3> = points.into_iter().map(Vec3::from_array).collect();
    if points.iter().all(|p| p.is_finite()) {
        return Ok((used, points));
    }
    let mut sound = vec![false; positions.count];
    used.iter().zip(&points).for_each(|(&v, p)| sound[v as usize] = p.is_finite());
    let before: usize = primitives.iter().map(|(_, e)| e.len()).sum();
    primitives.iter_mut().for_each(|(_, e)| e.retain(|v| sound[v as usize]));
    let lost = before - primitives.iter().map(|(_, e)| e.len()).sum::<usize>();
    document.warn(format!("{place}.attributes.POSITION: {lost} elements are not finite; left out"));
    used = used_vertices(positions.count, primitives);
    points = positions.floats::<3>(document, Some(&used))?.into_iter().map(Vec3::from_array).collect();
    Ok((used, points))
}

fn used_vertices(count: usize, primitives: &[(usize, Elements)]) -> Vec<u32> {
    let mut is_used = vec![false; count];
    primitives.iter().flat_map(|(_, e)| e.vertices()).for_each(|v| is_used[v as usize] = true);
    (0..count as u32).filter(|&v| is_used[v as usize]).collect()
}

/// Makes elements name places in `used` instead of the vertices there.
fn renumber(used: &[u32], count: usize, primitives: &mut [(usize, Elements)]) {
    if used.len() == count {
        return;
    }
    let mut place = vec![0; count];
    used.iter().enumerate().for_each(|(i, &v)| place[v as usize] = i as u32);
    primitives.iter_mut().flat_map(|(_, e)| e.vertices_mut()).for_each(|v| *v = place[*v as usize]);
}

/// Attributes of one primitive or morph target.
struct Source<'a> {
    document: &'a Document<'a>,
    place: &'a str,
    attributes: &'a Attributes,
    /// Vertices that every attribute must have.
    count: usize,
    /// Those to read.
    select: Option<&'a [u32]>,
}

impl<'a> Source<'a> {
    /// The accessor of attribute `name`. One of the wrong length or type is passed over with a
    /// warning, as the picture without it is better than none.
    fn open(&self, name: &str, widths: &[usize]) -> Result<Option<Accessor<'a>>, ReadError> {
        let Some(&index) = self.attributes.get(name) else { return Ok(None) };
        let place = format!("{}.attributes.{name}", self.place);
        let accessor = Accessor::open(self.document, &place, index)?;
        if accessor.count < self.count {
            let (has, needs) = (accessor.count, self.count);
            self.document.warn(format!("{place}: has {has} elements instead of {needs}; left out"));
            return Ok(None);
        }
        if !widths.contains(&accessor.width()) {
            self.document.warn(format!("{place}: is of the wrong type; left out"));
            return Ok(None);
        }
        Ok(Some(accessor))
    }

    fn floats<const N: usize>(&self, accessor: &Accessor<'_>) -> Result<Vec<[f32; N]>, ReadError> {
        match self.select {
            None if accessor.count > self.count => {
                let all: Vec<u32> = (0..self.count as u32).collect();
                accessor.floats(self.document, Some(&all))
            }
            select => accessor.floats(self.document, select),
        }
    }

    /// Vectors, and how many components the file gives them.
    fn vectors(&self, name: &str) -> Result<Option<(Vec<Vec3>, usize)>, ReadError> {
        let Some(accessor) = self.open(name, &[3])? else { return Ok(None) };
        let vectors = self.floats::<3>(&accessor)?.into_iter().map(Vec3::from_array).collect();
        Ok(Some((vectors, accessor.width())))
    }

    fn texcoords(&self, set: u64) -> Result<Option<Vec<Vec2>>, ReadError> {
        let Some(accessor) = self.open(&format!("TEXCOORD_{set}"), &[2])? else { return Ok(None) };
        let texcoords = self.floats::<2>(&accessor)?.into_iter();
        Ok(Some(texcoords.map(|uv| Vec2::from_array(uv.map(finite_or_zero))).collect()))
    }

    fn colors(&self) -> Result<Option<Vec<Vec4>>, ReadError> {
        let Some(accessor) = self.open("COLOR_0", &[3, 4])? else { return Ok(None) };
        let has_alpha = accessor.width() == 4;
        let color = |c: [f32; 4]| {
            let [r, g, b, a] = c.map(|v| finite_or_zero(v).max(0.0));
            Vec4::new(r, g, b, if has_alpha { a.min(1.0) } else { 1.0 })
        };
        Ok(Some(self.floats::<4>(&accessor)?.into_iter().map(color).collect()))
    }

    fn tangents(&self) -> Result<Option<Vec<Vec4>>, ReadError> {
        let Some(accessor) = self.open("TANGENT", &[4])? else { return Ok(None) };
        let tangent = |t: [f32; 4]| {
            let along = unit(Vec3::new(t[0], t[1], t[2])).unwrap_or(Vec3::X);
            along.extend(if t[3] < 0.0 { -1.0 } else { 1.0 })
        };
        Ok(Some(self.floats::<4>(&accessor)?.into_iter().map(tangent).collect()))
    }

    /// The four strongest influences of all sets.
    fn joints(&self) -> Result<Option<Vec<JointInfluence>>, ReadError> {
        let Some(mut influences) = self.joint_set(0)? else { return Ok(None) };
        for set in 1.. {
            let Some(more) = self.joint_set(set)? else { break };
            self.document.warn(format!("{}: more than 4 joints pull; the 4 strongest are kept", self.place));
            for (influence, more) in influences.iter_mut().zip(more) {
                *influence = strongest(*influence, more);
            }
        }
        influences.iter_mut().for_each(settle_influence);
        Ok(Some(influences))
    }

    /// Influences of `JOINTS_n` and `WEIGHTS_n` as they are.
    fn joint_set(&self, set: u32) -> Result<Option<Vec<JointInfluence>>, ReadError> {
        let (joints, weights) = (format!("JOINTS_{set}"), format!("WEIGHTS_{set}"));
        let (Some(joints), Some(weights)) = (self.open(&joints, &[4])?, self.open(&weights, &[4])?) else {
            return Ok(None);
        };
        let all: Vec<u32> = if self.select.is_none() { (0..self.count as u32).collect() } else { Vec::new() };
        let select = self.select.unwrap_or(&all);
        let joints = joints.integers::<4>(self.document, Some(select))?;
        let weights = weights.floats::<4>(self.document, Some(select))?;
        let influence = |(joints, weights): ([u32; 4], [f32; 4])| JointInfluence {
            joints: joints.map(|j| u16::try_from(j).unwrap_or(u16::MAX)),
            weights: weights.map(|w| finite_or_zero(w).max(0.0)),
        };
        Ok(Some(joints.into_iter().zip(weights).map(influence).collect()))
    }
}

/// The four strongest of both.
fn strongest(a: JointInfluence, b: JointInfluence) -> JointInfluence {
    let mut pulls: [(u16, f32); 8] = std::array::from_fn(|i| {
        let from = if i < 4 { a } else { b };
        (from.joints[i % 4], from.weights[i % 4])
    });
    pulls.sort_by(|a, b| b.1.total_cmp(&a.1));
    JointInfluence {
        joints: std::array::from_fn(|i| pulls[i].0),
        weights: std::array::from_fn(|i| pulls[i].1),
    }
}

/// Makes the weights sum to 1 (all stay 0 when nothing pulls) and lets joints that do not pull be 0.
fn settle_influence(influence: &mut JointInfluence) {
    for (joint, _) in influence.joints.iter_mut().zip(influence.weights).filter(|(_, w)| *w == 0.0) {
        *joint = 0;
    }
    let sum: f32 = influence.weights.iter().sum();
    if sum > 0.0 && sum.is_finite() && (sum - 1.0).abs() > 1e-5 {
        influence.weights = influence.weights.map(|w| w / sum);
    }
}

fn read_target(source: &Source<'_>) -> Result<Target, ReadError> {
    let offsets = |name: &str| -> Result<Option<Vec<Vec3>>, ReadError> {
        let vectors = source.vectors(name)?;
        let sound = |v: Vec3| if v.is_finite() { v } else { Vec3::ZERO };
        Ok(vectors.map(|(vectors, _)| vectors.into_iter().map(sound).collect()))
    };
    Ok(Target { points: offsets("POSITION")?, normals: offsets("NORMAL")?, tangents: offsets("TANGENT")? })
}

/// `v`, or 0 for what is not a number of reach.
pub(super) fn finite_or_zero(v: f32) -> f32 {
    if v.is_finite() { v } else { 0.0 }
}

/// `v` at length 1; as it is when it is close to that, so that what was unit stays the same bits.
fn unit(v: Vec3) -> Option<Vec3> {
    if (v.length_squared() - 1.0).abs() < 1e-4 { Some(v) } else { crate::normals::unit(v) }
}

/// Unit normals; those without direction are taken from the faces around the vertex.
fn sound_normals(normals: Vec<Vec3>, points: &[Vec3], primitives: &[(usize, Elements)]) -> Vec<Vec3> {
    let normals: Vec<Option<Vec3>> = normals.into_iter().map(unit).collect();
    if normals.iter().all(Option::is_some) {
        return normals.into_iter().flatten().collect();
    }
    let mut around = vec![Vec3::ZERO; points.len()];
    for &triangle in primitives.iter().flat_map(|(_, e)| &e.triangles) {
        let area_normal = area_normal(points, triangle);
        triangle.iter().for_each(|&v| around[v as usize] += area_normal);
    }
    let mended = |(normal, around): (Option<Vec3>, Vec3)| {
        normal.unwrap_or(crate::normals::unit(around).unwrap_or(Vec3::Z))
    };
    normals.into_iter().zip(around).map(mended).collect()
}

/// Normal of a triangle, twice its area long.
fn area_normal(points: &[Vec3], [a, b, c]: [u32; 3]) -> Vec3 {
    let [a, b, c] = [a, b, c].map(|v| points[v as usize]);
    (b - a).cross(c - a)
}

/// Where some groups have normals, the others get those of their faces (glTF 2.0, section 3.7.2.1:
/// flat normals).
fn settle_normals(groups: &mut [Group]) {
    if groups.iter().all(|g| g.normal.is_none()) {
        return;
    }
    groups.iter_mut().filter(|g| g.normal.is_none()).for_each(Group::make_flat);
}

impl Group {
    /// Number of vertices.
    fn len(&self) -> usize {
        self.vertex_point.as_ref().map_or(self.points.len(), Vec::len)
    }

    /// Gives every corner its own vertex with the normal of its face.
    fn make_flat(&mut self) {
        let mut source = Vec::new();
        let mut normals = Vec::new();
        for (_, elements) in &mut self.primitives {
            let faces = elements.triangles.iter();
            normals.extend(
                faces.flat_map(|&t| {
                    [crate::normals::unit(area_normal(&self.points, t)).unwrap_or(Vec3::Z); 3]
                }),
            );
            for vertex in elements.vertices_mut() {
                source.push(*vertex);
                *vertex = source.len() as u32 - 1;
            }
            normals.resize(source.len(), Vec3::Z);
        }
        self.normal = Some(normals);
        self.texcoord.iter_mut().for_each(|t| pick(t, &source));
        pick(&mut self.color, &source);
        // Tangents without normals are to be ignored.
        self.tangent = None;
        for target in &mut self.targets {
            target.normals = None;
            target.tangents = None;
        }
        self.vertex_point = Some(source);
    }
}

fn pick<T: Copy>(values: &mut Option<Vec<T>>, source: &[u32]) {
    if let Some(values) = values {
        *values = source.iter().map(|&v| values[v as usize]).collect();
    }
}

/// Tangents are kept when every face that needs them has them; otherwise the renderer makes all.
fn settle_tangents(document: &Document<'_>, json: &json::Mesh, groups: &mut [Group], materials: &[Material]) {
    let needs = |p: usize| {
        let material = json.primitives[p].material.and_then(|m| materials.get(m.0 as usize));
        material.is_some_and(|m| m.normal_texture.is_some())
    };
    groups.iter_mut().filter(|g| g.normal.is_none()).for_each(|g| g.tangent = None);
    let lacks = |g: &Group| g.tangent.is_none() && g.primitives.iter().any(|(p, _)| needs(*p));
    let some = groups.iter().any(|g| g.tangent.is_some());
    if some && groups.iter().any(lacks) {
        document.warn(format!(
            "mesh {:?}: some primitives with a normal map have tangents and some have none; all are computed",
            name_or(&json.name, "mesh", 0)
        ));
        groups.iter_mut().for_each(|g| g.tangent = None);
    } else if some {
        for group in groups.iter_mut().filter(|g| g.tangent.is_none()) {
            let across = |n: &Vec3| n.any_orthonormal_vector().extend(1.0);
            group.tangent = group.normal.as_ref().map(|normals| normals.iter().map(across).collect());
        }
    }
}

/// The vertices of all groups, one after the other.
fn merge(document: &Document<'_>, groups: &[Group]) -> Result<Mesh, ReadError> {
    let total: usize = groups.iter().map(|g| g.len().max(g.points.len())).sum();
    if u32::try_from(total).is_err() {
        let message = format!("a mesh of {total} vertices is above 2^32");
        return Err(ReadError::limit(Location::file(document.name), message));
    }
    let per_vertex = |g: &Group| g.len();
    let per_point = |g: &Group| g.points.len();
    let mut mesh = Mesh {
        points: groups.iter().flat_map(|g| &g.points).copied().collect(),
        vertices: Vertices {
            point: Vec::with_capacity(total),
            normal: join(groups, |g| g.normal.as_ref(), per_vertex, Vec3::Z),
            texcoord0: join(groups, |g| g.texcoord[0].as_ref(), per_vertex, Vec2::ZERO),
            texcoord1: join(groups, |g| g.texcoord[1].as_ref(), per_vertex, Vec2::ZERO),
            color: join(groups, |g| g.color.as_ref(), per_vertex, Vec4::ONE),
            tangent: join(groups, |g| g.tangent.as_ref(), per_vertex, Vec4::new(1.0, 0.0, 0.0, 1.0)),
        },
        joints: join(groups, |g| g.joints.as_ref(), per_point, JointInfluence::default()),
        ..Mesh::default()
    };
    let mut first_point = 0;
    for group in groups {
        let places =
            (0..group.len() as u32).map(|v| group.vertex_point.as_ref().map_or(v, |p| p[v as usize]));
        mesh.vertices.point.extend(places.map(|p| p + first_point));
        first_point += group.points.len() as u32;
    }
    merge_targets(document, groups, &mut mesh)?;
    Ok(mesh)
}

fn merge_targets(document: &Document<'_>, groups: &[Group], mesh: &mut Mesh) -> Result<(), ReadError> {
    let targets = groups.iter().map(|g| g.targets.len()).max().unwrap_or(0);
    // Groups without a target are filled with zeros, which no bytes bear out.
    document.charge(&"morph targets", targets as u64 * (mesh.points.len() + groups.len()) as u64)?;
    for t in 0..targets {
        let of = |g: &'_ Group| -> usize { g.points.len() };
        let points = join(groups, |g| g.targets.get(t)?.points.as_ref(), of, Vec3::ZERO);
        let normals = join(groups, |g| g.targets.get(t)?.normals.as_ref(), Group::len, Vec3::ZERO);
        let tangents = join(groups, |g| g.targets.get(t)?.tangents.as_ref(), Group::len, Vec3::ZERO);
        let normals = if mesh.vertices.normal.is_empty() { Vec::new() } else { normals };
        let tangents = if mesh.vertices.tangent.is_empty() { Vec::new() } else { tangents };
        mesh.morph_targets.push(MorphTarget { name: String::new(), points, normals, tangents });
    }
    Ok(())
}

/// Values of all groups one after the other, `neutral` where a group has none; empty when none has.
fn join<'g, T: Copy + 'g>(
    groups: &'g [Group],
    values: impl Fn(&'g Group) -> Option<&'g Vec<T>>,
    count: impl Fn(&Group) -> usize,
    neutral: T,
) -> Vec<T> {
    if groups.iter().all(|g| values(g).is_none()) {
        return Vec::new();
    }
    let mut joined = Vec::new();
    for group in groups {
        match values(group) {
            Some(values) => joined.extend_from_slice(values),
            None => joined.resize(joined.len() + count(group), neutral),
        }
    }
    joined
}

/// Puts the elements of all primitives into the mesh, in the order of the file: each primitive with
/// triangles is a surface. Lines and dots have no surface; the material that the first of them names
/// is returned as the geometry's, when no surface would take it.
fn add_elements(
    document: &Document<'_>,
    index: usize,
    json: &json::Mesh,
    groups: &[Group],
    material_count: usize,
    mesh: &mut Mesh,
) -> Option<MaterialId> {
    let mut order: Vec<(usize, &Elements, &Group, u32)> = Vec::new();
    let mut first_vertex = 0;
    for group in groups {
        order.extend(group.primitives.iter().map(|(p, e)| (*p, e, group, first_vertex)));
        first_vertex += group.len() as u32;
    }
    order.sort_by_key(|(p, ..)| *p);
    let mut loose = None;
    for (p, elements, group, first) in order {
        let place = format!("meshes[{index}].primitives[{p}].material");
        let named = json.primitives[p].material;
        let material =
            named.and_then(|m| document.index_or_warn(&place, m, "material", material_count)).map(MaterialId);
        if !elements.triangles.is_empty() {
            // Faces made flat beside others with normals hold the faces' own normals.
            let smooth = group.normal.is_some() && group.vertex_point.is_none();
            mesh.surfaces.push(Surface { material, smooth, ..Surface::default() });
        } else if loose.is_none() {
            loose = material;
        }
        mesh.faces.corners.extend(elements.triangles.iter().flatten().map(|v| v + first));
        mesh.faces.surface.resize(mesh.faces.corners.len() / 3, mesh.surfaces.len().saturating_sub(1) as u32);
        mesh.lines.extend(elements.lines.iter().map(|l| l.map(|v| v + first)));
        mesh.dots.extend(elements.dots.iter().map(|d| d + first));
    }
    if mesh.surfaces.len() <= 1 {
        mesh.faces.surface.clear();
    }
    loose.filter(|_| mesh.surfaces.iter().all(|s| s.material.is_some()))
}
