//! Scenes at one moment: animated nodes, morphed and skinned meshes.

use std::borrow::Cow;

use senca_math::glam::{DMat3, DMat4, Vec3};

use crate::{
    AnimationId, ChannelValue, Geometry, JointInfluence, Mesh, Node, NodeId, Scene, Shape, SkinId, Transform,
};

impl Scene {
    /// The scene as it is `seconds` into `animation`, with nodes moved and meshes morphed and skinned
    /// as their nodes say. `None` for the animation leaves nodes where they are but still morphs and
    /// skins. A scene in which nothing moves or bends is borrowed.
    ///
    /// Skinned meshes end up in world space, on a new root node; their own node's transform does not
    /// count (glTF 2.0, section 3.7.3). Deformed geometries are appended as new ones. Channels and
    /// skins that do not hold together are passed over; see [`Scene::validate`].
    #[must_use]
    pub fn at_time(&self, animation: Option<AnimationId>, seconds: f64) -> Cow<'_, Self> {
        let moves =
            animation.is_some_and(|a| self.animations.get(a.index()).is_some_and(|a| !a.channels.is_empty()));
        if !moves && !self.nodes.iter().any(|node| self.bends(node)) {
            return Cow::Borrowed(self);
        }
        let mut posed = self.clone();
        posed.pose(animation, seconds);
        Cow::Owned(posed)
    }

    /// Does to the scene itself what [`Scene::at_time`] does to a copy. Animations stay, so nodes can
    /// be moved again; meshes that were bent stay bent.
    pub fn pose(&mut self, animation: Option<AnimationId>, seconds: f64) {
        if let Some(animation) = animation {
            self.move_nodes(animation, seconds);
        }
        self.bend_meshes();
    }

    /// Whether a node deforms its geometry.
    fn bends(&self, node: &Node) -> bool {
        let Some(geometry) = node.geometry.and_then(|g| self.geometries.get(g.index())) else { return false };
        let Shape::Mesh(mesh) = &geometry.shape else { return false };
        let skinned = node.skin.is_some() && !mesh.joints.is_empty();
        skinned || (!mesh.morph_targets.is_empty() && node.morph_weights.iter().any(|&w| w != 0.0))
    }

    fn move_nodes(&mut self, animation: AnimationId, seconds: f64) {
        let Self { animations, nodes, .. } = self;
        let channels = animations.get(animation.index()).map_or(&[][..], |a| &a.channels);
        for channel in channels {
            let value = channel.sample(seconds);
            if let (Some(node), Some(value)) = (nodes.get_mut(channel.target.node.index()), value) {
                apply(node, value);
            }
        }
    }

    /// Replaces deformed meshes by what they look like.
    fn bend_meshes(&mut self) {
        let world_from_nodes = self.world_from_nodes();
        for i in 0..self.nodes.len() {
            let node = &self.nodes[i];
            if world_from_nodes[i].is_none() || !self.bends(node) {
                continue;
            }
            let joints = node.skin.map(|skin| self.joint_matrices(skin, &world_from_nodes));
            let Some((geometry, bent)) = self.bent_geometry(NodeId(i as u32), joints.as_deref()) else {
                continue;
            };
            let bent = self.add_geometry(bent);
            let node = &mut self.nodes[i];
            node.morph_weights.clear();
            node.skin = None;
            let was_skinned = joints.is_some_and(|j| !j.is_empty())
                && matches!(&self.geometries[geometry.index()].shape, Shape::Mesh(m) if !m.joints.is_empty());
            let node = &mut self.nodes[i];
            if was_skinned {
                node.geometry = None;
                let in_world = Node {
                    name: node.name.clone(),
                    geometry: Some(bent),
                    material: node.material,
                    ..Node::default()
                };
                let root = self.add_node(in_world);
                self.roots.push(root);
            } else {
                node.geometry = Some(bent);
            }
        }
    }

    /// The geometry of a node and its deformed copy.
    fn bent_geometry(&self, node: NodeId, joints: Option<&[DMat4]>) -> Option<(crate::GeometryId, Geometry)> {
        let node = self.nodes.get(node.index())?;
        let id = node.geometry?;
        let geometry = self.geometries.get(id.index())?;
        let Shape::Mesh(mesh) = &geometry.shape else { return None };
        let shape = Shape::Mesh(posed_mesh(mesh, &node.morph_weights, joints.unwrap_or(&[])));
        Some((id, Geometry { name: geometry.name.clone(), shape, material: geometry.material }))
    }

    /// `world_from_mesh` of every joint of a skin.
    fn joint_matrices(&self, skin: SkinId, world_from_nodes: &[Option<DMat4>]) -> Vec<DMat4> {
        let Some(skin) = self.skins.get(skin.index()) else { return Vec::new() };
        let matrix = |(i, joint): (usize, &NodeId)| {
            let world_from_joint =
                world_from_nodes.get(joint.index()).copied().flatten().unwrap_or(DMat4::IDENTITY);
            let joint_from_mesh = skin.inverse_bind_matrices.get(i).copied().unwrap_or(DMat4::IDENTITY);
            world_from_joint * joint_from_mesh
        };
        skin.joints.iter().enumerate().map(matrix).collect()
    }
}

/// Puts a channel's value into a node. A node placed by a matrix is taken apart first.
fn apply(node: &mut Node, value: ChannelValue) {
    if let ChannelValue::Weights(weights) = value {
        node.morph_weights = weights;
        return;
    }
    let (mut scale, mut rotation, mut translation) = match node.transform {
        Transform::Parts { translation, rotation, scale } => (scale, rotation, translation),
        Transform::Matrix(matrix) => matrix.to_scale_rotation_translation(),
    };
    match value {
        ChannelValue::Translation(value) => translation = value,
        ChannelValue::Rotation(value) => rotation = value,
        ChannelValue::Scale(value) => scale = value,
        ChannelValue::Path { translation: place, rotation: turn } => {
            translation = place;
            rotation = turn.unwrap_or(rotation);
        }
        ChannelValue::Weights(_) => {}
    }
    node.transform = Transform::Parts { translation, rotation, scale };
}

/// `mesh` with its morph targets blended in by `weights` (missing ones are 0) and its points moved by
/// the weighted means of `joint_matrices`, each `target_from_mesh`; without matrices it is not skinned.
/// The result has neither morph targets nor joints left.
///
/// Points whose weights do not sum to 1 are normalised; points without a usable joint stay where they
/// are, and so does what would become NaN. Normals follow by the cofactors of the blended matrix.
///
/// # Panics
/// When the mesh does not hold together (see [`Mesh::check`]).
#[must_use]
pub fn posed_mesh(mesh: &Mesh, weights: &[f32], joint_matrices: &[DMat4]) -> Mesh {
    let mut posed = Mesh {
        points: mesh.points.clone(),
        vertices: mesh.vertices.clone(),
        faces: mesh.faces.clone(),
        surfaces: mesh.surfaces.clone(),
        lines: mesh.lines.clone(),
        dots: mesh.dots.clone(),
        morph_targets: Vec::new(),
        joints: Vec::new(),
    };
    morph(mesh, weights, &mut posed);
    if !joint_matrices.is_empty() && !mesh.joints.is_empty() {
        skin(&mesh.joints, joint_matrices, &mut posed);
    }
    posed
}

/// Adds weighted offsets to positions, normals and tangents.
fn morph(mesh: &Mesh, weights: &[f32], posed: &mut Mesh) {
    let used = mesh.morph_targets.iter().zip(weights).filter(|(_, w)| **w != 0.0 && w.is_finite());
    for (target, &weight) in used {
        let add = |values: &mut [Vec3], offsets: &[Vec3]| {
            for (value, &offset) in values.iter_mut().zip(offsets) {
                let moved = *value + weight * offset;
                *value = if moved.is_finite() { moved } else { *value };
            }
        };
        add(&mut posed.points, &target.points);
        add(&mut posed.vertices.normal, &target.normals);
        for (tangent, &offset) in posed.vertices.tangent.iter_mut().zip(&target.tangents) {
            *tangent += (weight * offset).extend(0.0);
        }
    }
    if weights.iter().any(|&w| w != 0.0) {
        renormalize(posed, mesh);
    }
}

/// Gives normals and tangents unit length again; those that have lost their direction get the old one.
fn renormalize(posed: &mut Mesh, mesh: &Mesh) {
    for (normal, &old) in posed.vertices.normal.iter_mut().zip(&mesh.vertices.normal) {
        *normal = normal.try_normalize().unwrap_or(old);
    }
    for (tangent, &old) in posed.vertices.tangent.iter_mut().zip(&mesh.vertices.tangent) {
        let direction = tangent.truncate().try_normalize().unwrap_or(old.truncate());
        *tangent = direction.extend(old.w);
    }
}

/// Weighted mean of the joints' matrices, or `None` when no joint counts.
fn blended(influence: &JointInfluence, joint_matrices: &[DMat4]) -> Option<DMat4> {
    let mut sum = DMat4::ZERO;
    let mut total = 0.0;
    for (&joint, &weight) in influence.joints.iter().zip(&influence.weights) {
        let matrix = joint_matrices.get(usize::from(joint)).filter(|_| weight > 0.0 && weight.is_finite());
        if let Some(&matrix) = matrix {
            sum += matrix * f64::from(weight);
            total += f64::from(weight);
        }
    }
    let mean = sum * (1.0 / total);
    (total > 0.0 && mean.is_finite()).then_some(mean)
}

/// Matrix that takes normals along, up to length: the cofactors of the linear part.
fn cofactors(m: &DMat4) -> DMat3 {
    let (x, y, z) = (m.x_axis.truncate(), m.y_axis.truncate(), m.z_axis.truncate());
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
}

fn skin(influences: &[JointInfluence], joint_matrices: &[DMat4], posed: &mut Mesh) {
    let means: Vec<Option<DMat4>> = influences.iter().map(|i| blended(i, joint_matrices)).collect();
    for (point, mean) in posed.points.iter_mut().zip(&means) {
        if let Some(mean) = mean {
            let moved = mean.transform_point3(point.as_dvec3()).as_vec3();
            *point = if moved.is_finite() { moved } else { *point };
        }
    }
    let vertices = &mut posed.vertices;
    for (v, &point) in vertices.point.iter().enumerate() {
        let Some(Some(mean)) = means.get(point as usize) else { continue };
        if let Some(normal) = vertices.normal.get_mut(v) {
            let turned = (cofactors(mean) * normal.as_dvec3()).normalize_or_zero().as_vec3();
            *normal = if turned == Vec3::ZERO { *normal } else { turned };
        }
        if let Some(tangent) = vertices.tangent.get_mut(v) {
            let turned = mean.transform_vector3(tangent.truncate().as_dvec3()).normalize_or_zero().as_vec3();
            *tangent = if turned == Vec3::ZERO { *tangent } else { turned.extend(tangent.w) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Animation, Camera, CameraId, Channel, ChannelTarget, ChannelValues, Faces, GeometryId, Interpolation,
        MorphTarget, Projection, Skin, Surface, Vertices,
    };
    use senca_math::glam::DVec3;

    /// A triangle whose point 2 hangs on joint 1, the others on joint 0.
    fn triangle() -> Mesh {
        let bound = |joint: u16| JointInfluence { joints: [joint, 0, 0, 0], weights: [1.0, 0.0, 0.0, 0.0] };
        Mesh {
            points: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            vertices: Vertices { point: vec![0, 1, 2], normal: vec![Vec3::Z; 3], ..Vertices::default() },
            faces: Faces { corners: vec![0, 1, 2], ..Faces::default() },
            surfaces: vec![Surface::default()],
            morph_targets: vec![MorphTarget {
                points: vec![Vec3::ZERO, Vec3::X, Vec3::ZERO],
                normals: vec![Vec3::X; 3],
                ..MorphTarget::default()
            }],
            joints: vec![bound(0), bound(0), bound(1)],
            ..Mesh::default()
        }
    }

    fn channel(node: u32, values: ChannelValues) -> Channel {
        let target = ChannelTarget { node: NodeId(node) };
        Channel { target, times: vec![0.0, 2.0], values, interpolation: Interpolation::Linear }
    }

    fn mesh_of(scene: &Scene, geometry: GeometryId) -> &Mesh {
        let Shape::Mesh(mesh) = &scene.geometries[geometry.index()].shape else { panic!("not a mesh") };
        mesh
    }

    #[test]
    fn nothing_to_move_borrows() {
        let scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
        assert!(matches!(scene.at_time(None, 3.0), Cow::Borrowed(_)));
        assert!(matches!(scene.at_time(Some(AnimationId(7)), 3.0), Cow::Borrowed(_)));
    }

    #[test]
    fn nodes_and_cameras_move_and_matrices_are_taken_apart() {
        let mut scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
        let projection = Projection::Orthographic { height: 2.0, aspect: None, near: None, far: None };
        scene.cameras.push(Camera::new("eye", projection));
        let turned = DMat4::from_scale(DVec3::splat(2.0)) * DMat4::from_rotation_y(1.0);
        scene.nodes[0].transform = Transform::Matrix(turned);
        scene.nodes[0].camera = Some(CameraId(0));
        let to = ChannelValues::Translation(vec![DVec3::ZERO, DVec3::X * 4.0]);
        scene.animations.push(Animation {
            name: String::new(),
            channels: vec![channel(0, to), channel(9, ChannelValues::Scale(vec![]))],
        });
        let posed = scene.at_time(Some(AnimationId(0)), 0.5);
        let expected = DMat4::from_translation(DVec3::X) * turned;
        assert!(posed.placed_cameras()[0].world_from_camera.abs_diff_eq(expected, 1e-12));
        assert_eq!(scene.animations[0].duration(), 2.0);
    }

    #[test]
    fn morph_weights_follow_their_channel() {
        let mut scene = Scene::of_shape("tri", Shape::Mesh(triangle()));
        let values = ChannelValues::Weights { count: 1, values: vec![0.0, 1.0] };
        scene.animations.push(Animation { name: String::new(), channels: vec![channel(0, values)] });
        let posed = scene.at_time(Some(AnimationId(0)), 1.0);
        let mesh = mesh_of(&posed, posed.nodes[0].geometry.unwrap());
        assert_eq!(mesh.points[1], Vec3::X * 1.5);
        assert!((mesh.vertices.normal[0] - Vec3::new(0.5, 0.0, 1.0).normalize()).length() < 1e-6);
        assert!(mesh.morph_targets.is_empty());
        assert_eq!(mesh_of(&scene, GeometryId(0)).points[1], Vec3::X, "the original is as it was");
    }

    #[test]
    fn skins_move_meshes_into_the_world() {
        let mut scene = Scene::of_shape("tri", Shape::Mesh(triangle()));
        scene.nodes[0].transform = Transform::Matrix(DMat4::from_translation(DVec3::splat(99.0)));
        let joints = [DMat4::from_translation(DVec3::Z), DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2)];
        let ids: Vec<NodeId> = joints
            .iter()
            .map(|&m| scene.add_node(Node { transform: Transform::Matrix(m), ..Node::default() }))
            .collect();
        scene.roots.extend(&ids);
        scene.skins.push(Skin { name: String::new(), joints: ids, inverse_bind_matrices: vec![] });
        scene.nodes[0].skin = Some(SkinId(0));
        let posed = scene.at_time(None, 0.0);
        let instances = posed.instances();
        assert_eq!(instances.len(), 1);
        assert_eq!(instances[0].world_from_object, DMat4::IDENTITY);
        let mesh = mesh_of(&posed, instances[0].geometry);
        assert_eq!(mesh.points[1], Vec3::new(1.0, 0.0, 1.0));
        assert!((mesh.points[2] - Vec3::Z).length() < 1e-6);
        assert!((mesh.vertices.normal[2] - Vec3::NEG_Y).length() < 1e-6);
        assert!(matches!(posed.at_time(None, 0.0), Cow::Borrowed(_)), "posing is done");
    }

    #[test]
    fn nonsense_leaves_the_mesh_where_it_is() {
        let mesh = triangle();
        let nan = DMat4::from_cols_array(&[f64::NAN; 16]);
        assert_eq!(posed_mesh(&mesh, &[f32::NAN], &[nan, nan]).points, mesh.points);
        assert_eq!(posed_mesh(&mesh, &[], &[DMat4::IDENTITY]).points, mesh.points, "joint 1 is missing");
        let flat = posed_mesh(&mesh, &[], &[DMat4::ZERO, DMat4::ZERO]);
        assert_eq!(flat.vertices.normal, mesh.vertices.normal);
        let mut loose = triangle();
        loose.joints = vec![JointInfluence::default(); 3];
        assert_eq!(posed_mesh(&loose, &[], &[nan]).points, mesh.points);
        let mut half = triangle();
        half.joints = vec![JointInfluence { joints: [0; 4], weights: [0.25, 0.25, 0.0, 0.0] }; 3];
        let moved = posed_mesh(&half, &[], &[DMat4::from_translation(DVec3::Z)]);
        assert_eq!(moved.points[0], Vec3::Z, "weights are normalised");
    }
}
