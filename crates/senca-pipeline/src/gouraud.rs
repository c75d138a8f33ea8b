//! Light at vertices.

use rayon::prelude::*;
use senca_math::glam::Vec4;
use senca_shading::ShadingPoint;

use crate::geometry::Part;
use crate::shade::Shader;

/// Colours of the vertices that one part uses, with opacity.
#[derive(Default)]
pub(crate) struct VertexColors {
    /// Number of the first vertex.
    first: u32,
    colors: Vec<[f32; 4]>,
}

impl VertexColors {
    /// Colour of vertex `vertex` of the mesh.
    pub(crate) fn of(&self, vertex: u32) -> [f32; 4] {
        self.colors[(vertex - self.first) as usize]
    }
}

/// Lights every vertex of every part once. Vertices face the observer's side of the surface where
/// their normal does.
/// Source: course text, section 2.5; Gouraud 1971.
pub(crate) fn light_vertices(shader: &Shader<'_>) -> Vec<VertexColors> {
    shader.world.parts.iter().map(|part| light_part(shader, part)).collect()
}

fn light_part(shader: &Shader<'_>, part: &Part) -> VertexColors {
    let world = shader.world;
    let corners = world.corners(part);
    let (Some(&first), Some(&last)) = (corners.iter().min(), corners.iter().max()) else {
        return VertexColors::default();
    };
    let (mesh, placed) = (world.mesh(part), &world.placed[part.placed]);
    let material = &shader.materials[part.material];
    let two_sided = shader.settings.draws_backs_of(material.double_sided);
    let light = |vertex: u32| {
        let position = placed.world_from_object_f32.transform_point3(mesh.position(vertex));
        let to_viewer = shader.to_viewer(position);
        let normal = mesh.vertices.normal.get(vertex as usize).copied().unwrap_or_default();
        let normal = (placed.world_from_object_normals * normal).normalize_or(to_viewer);
        let normal = if two_sided { senca_shading::face_towards(normal, to_viewer) } else { normal };
        let color = mesh.vertices.color.get(vertex as usize).copied().unwrap_or(Vec4::ONE);
        shader.vertex_light(material, ShadingPoint { position, normal, to_viewer }, color)
    };
    VertexColors { first, colors: (first..=last).into_par_iter().map(light).collect() }
}
