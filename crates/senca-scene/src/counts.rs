//! How much there is in a scene.

use senca_math::Aabb;

use crate::{Scene, Shape, TessellationSettings, Topology, tessellate};

/// How much there is in a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneCounts {
    /// Nodes.
    pub nodes: usize,
    /// Geometries, placed or not.
    pub geometries: usize,
    /// Geometries that are meshes.
    pub meshes: usize,
    /// Placed geometries.
    pub instances: usize,
    /// Triangles of all instances, polygons counting as the triangles they split into.
    pub triangles: u64,
    /// Vertices of all instances.
    pub vertices: u64,
    /// Line segments of all instances.
    pub lines: u64,
    /// Dots of all instances.
    pub dots: u64,
    /// Triangles of all geometries, each counted once.
    pub stored_triangles: u64,
    /// Materials.
    pub materials: usize,
    /// Textures.
    pub textures: usize,
    /// Pictures of textures.
    pub images: usize,
    /// Lights that nodes place.
    pub lights: usize,
    /// Cameras that nodes place.
    pub cameras: usize,
    /// Animations.
    pub animations: usize,
    /// Skins.
    pub skins: usize,
    /// Whether there are placed shapes and each is a closed surface, its edges having two faces each.
    pub closed: bool,
    /// Box around everything placed but endless planes.
    pub bounds: Aabb,
}

/// What one geometry adds each time it is placed.
#[derive(Clone, Copy, Default)]
struct Share {
    triangles: u64,
    vertices: u64,
    lines: u64,
    dots: u64,
    closed: bool,
}

impl Scene {
    /// Counts what there is, shapes being tessellated by `settings`. Shapes that have no mesh (see
    /// [`crate::ShapeError`]) count as nothing and as open.
    #[must_use]
    pub fn counts(&self, settings: &TessellationSettings) -> SceneCounts {
        let shares: Vec<Share> = self.geometries.iter().map(|g| share(&g.shape, settings)).collect();
        let instances = self.instances();
        let placed = || instances.iter().map(|i| shares[i.geometry.index()]);
        let world_from_nodes = self.world_from_nodes();
        let reached =
            || self.nodes.iter().zip(&world_from_nodes).filter(|(_, w)| w.is_some()).map(|(n, _)| n);
        SceneCounts {
            nodes: self.nodes.len(),
            geometries: self.geometries.len(),
            meshes: self.geometries.iter().filter(|g| matches!(g.shape, Shape::Mesh(_))).count(),
            instances: instances.len(),
            triangles: placed().map(|s| s.triangles).sum(),
            vertices: placed().map(|s| s.vertices).sum(),
            lines: placed().map(|s| s.lines).sum(),
            dots: placed().map(|s| s.dots).sum(),
            stored_triangles: shares.iter().map(|s| s.triangles).sum(),
            materials: self.materials.len(),
            textures: self.textures.len(),
            images: self.images.len(),
            lights: reached().filter(|n| n.light.is_some()).count(),
            cameras: reached().filter(|n| n.camera.is_some()).count(),
            animations: self.animations.len(),
            skins: self.skins.len(),
            closed: !instances.is_empty() && placed().all(|s| s.closed),
            bounds: self.bounds(),
        }
    }
}

fn share(shape: &Shape, settings: &TessellationSettings) -> Share {
    // Normals are not needed here, so meshes are counted as they are.
    if let Shape::Mesh(mesh) = shape {
        return if mesh.check().is_ok() { mesh_share(mesh) } else { Share::default() };
    }
    tessellate(shape, settings).map_or_else(|_| Share::default(), |mesh| mesh_share(&mesh))
}

fn mesh_share(mesh: &crate::Mesh) -> Share {
    Share {
        triangles: mesh.faces.triangle_count() as u64,
        vertices: mesh.vertices.point.len() as u64,
        lines: mesh.lines.len() as u64,
        dots: mesh.dots.len() as u64,
        closed: Topology::new(mesh).is_closed(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{GeometryId, Node, test_support::octagonal_cylinder, triangulated};
    use senca_math::glam::DVec3;

    #[test]
    fn instances_count_each_time() {
        let mut scene = Scene::of_shape("cylinder", Shape::Mesh(octagonal_cylinder()));
        let again = scene.add_node(Node { geometry: Some(GeometryId(0)), ..Node::default() });
        scene.roots.push(again);
        scene.add_node(Node { geometry: Some(GeometryId(0)), ..Node::default() });
        let counts = scene.counts(&TessellationSettings::default());
        let expected = 8 * 2 + 2 * 6;
        assert_eq!(
            (counts.triangles, counts.stored_triangles, counts.vertices),
            (2 * expected, expected, 32)
        );
        assert_eq!((counts.nodes, counts.instances, counts.meshes), (3, 2, 1));
        assert!(counts.closed);
        assert_eq!(counts.bounds.max, DVec3::new(40.0, 40.0, 50.0));
        let split = triangulated(&octagonal_cylinder());
        assert_eq!(split.len() as u64, expected);
    }

    #[test]
    fn open_and_impossible_shapes_are_not_closed() {
        let counts = |shape| Scene::of_shape("", shape).counts(&TessellationSettings::default());
        assert!(counts(Shape::Sphere { radius: 1.0 }).closed);
        assert!(!counts(Shape::Plane { size: Some(1.0) }).closed);
        let impossible = counts(Shape::Sphere { radius: -1.0 });
        assert_eq!((impossible.triangles, impossible.closed), (0, false));
        assert!(!Scene::default().counts(&TessellationSettings::default()).closed);
    }
}
