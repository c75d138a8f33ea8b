//! From a scene to an STL file.

use std::fmt::Write;

use senca_scene::math::glam::Vec3;
use senca_scene::{Scene, TessellationSettings, triangulated};

use crate::WriteError;
use crate::flatten::placed_meshes;

/// The two kinds of STL files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StlEncoding {
    /// 50 bytes a triangle.
    #[default]
    Binary,
    /// Some 250 bytes a triangle, readable; one solid per node.
    Text,
}

/// Writes all faces of `scene` in world coordinates as triangles with their geometric normals. Shapes
/// other than meshes are tessellated by `settings`. Colours, lines and dots have no place in the
/// format. Numbers read back the same.
///
/// # Errors
/// When a shape or mesh is not sound.
pub fn write(
    scene: &Scene,
    encoding: StlEncoding,
    settings: &TessellationSettings,
) -> Result<Vec<u8>, WriteError> {
    let mut solids = Vec::new();
    for placed in placed_meshes(scene, settings)? {
        let faces = triangulated(&placed.mesh);
        let corner = |&vertex: &u32| placed.mesh.position(vertex);
        let triangles = faces.corners.chunks_exact(3).map(|t| [corner(&t[0]), corner(&t[1]), corner(&t[2])]);
        solids.push((placed.name.to_owned(), triangles.collect::<Vec<_>>()));
    }
    match encoding {
        StlEncoding::Binary => binary(&solids),
        StlEncoding::Text => Ok(text(&solids)),
    }
}

/// A name with its triangles.
type Solid = (String, Vec<[Vec3; 3]>);

/// Unit normal of a triangle; zero where it has no area.
fn normal([a, b, c]: &[Vec3; 3]) -> Vec3 {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}

fn binary(solids: &[Solid]) -> Result<Vec<u8>, WriteError> {
    let count: usize = solids.iter().map(|solid| solid.1.len()).sum();
    let Ok(count) = u32::try_from(count) else {
        let message = format!("{count} triangles are more than a binary STL file can hold");
        return Err(WriteError::Unsupported { message });
    };
    let mut bytes = Vec::with_capacity(super::HEAD + super::FACET * count as usize);
    bytes.extend(b"binary STL");
    bytes.resize(80, b' ');
    bytes.extend(count.to_le_bytes());
    for triangle in solids.iter().flat_map(|solid| &solid.1) {
        for vector in [normal(triangle)].iter().chain(triangle) {
            vector.to_array().iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        }
        bytes.extend([0, 0]);
    }
    Ok(bytes)
}

fn text(solids: &[Solid]) -> Vec<u8> {
    let mut text = String::new();
    for (name, triangles) in solids {
        let name: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let name = name.trim();
        let _ = writeln!(text, "solid {name}");
        for triangle in triangles {
            let n = normal(triangle);
            let _ = writeln!(text, "facet normal {} {} {}\n outer loop", n.x, n.y, n.z);
            for corner in triangle {
                let _ = writeln!(text, "  vertex {} {} {}", corner.x, corner.y, corner.z);
            }
            text.push_str(" endloop\nendfacet\n");
        }
        let _ = writeln!(text, "endsolid {name}");
    }
    if solids.is_empty() {
        text.push_str("solid\nendsolid\n");
    }
    text.into_bytes()
}
