//! Whether a mesh holds together.

use crate::Mesh;

/// Why a mesh does not hold together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MeshError {
    /// An index names something that is not there.
    #[error("{list}[{at}] is {index}, but there are only {count} {kind}")]
    IndexOutOfRange {
        /// The list that holds the index.
        list: &'static str,
        /// Position in the list.
        at: usize,
        /// The index.
        index: u32,
        /// What it names.
        kind: &'static str,
        /// How many there are.
        count: usize,
    },
    /// Lists that run in parallel have different lengths.
    #[error("{list} has {length} entries, but must have {expected}")]
    Length {
        /// The list.
        list: &'static str,
        /// Its length.
        length: usize,
        /// What it should be.
        expected: usize,
    },
    /// The starts of faces do not divide the corners.
    #[error(
        "faces.starts must begin with 0, not decrease and end with the number of corners: wrong at entry {at}"
    )]
    Starts {
        /// First wrong entry.
        at: usize,
    },
    /// A face has fewer than three corners.
    #[error("face {face} has {corners} corners, but needs at least 3")]
    FewCorners {
        /// The face.
        face: usize,
        /// Its corners.
        corners: usize,
    },
    /// There are faces but no surface.
    #[error("there are faces, but no surface they could belong to")]
    NoSurface,
    /// A number is NaN or infinite.
    #[error("{list}[{at}] is not finite")]
    NotFinite {
        /// The list.
        list: &'static str,
        /// Position in the list.
        at: usize,
    },
}

fn indices(list: &'static str, indices: &[u32], kind: &'static str, count: usize) -> Result<(), MeshError> {
    // One pass without a branch per entry; the culprit is looked for only when there is one.
    if indices.iter().fold(0, |most, &i| most.max(i)) < count as u32 || indices.is_empty() {
        return Ok(());
    }
    let bad = indices.iter().enumerate().find(|(_, i)| **i as usize >= count);
    bad.map_or(Ok(()), |(at, &index)| Err(MeshError::IndexOutOfRange { list, at, index, kind, count }))
}

fn length<T>(list: &'static str, entries: &[T], expected: usize) -> Result<(), MeshError> {
    if entries.is_empty() || entries.len() == expected {
        return Ok(());
    }
    Err(MeshError::Length { list, length: entries.len(), expected })
}

fn finite<T>(list: &'static str, entries: &[T], is_finite: impl Fn(&T) -> bool) -> Result<(), MeshError> {
    entries.iter().position(|e| !is_finite(e)).map_or(Ok(()), |at| Err(MeshError::NotFinite { list, at }))
}

impl Mesh {
    /// Checks all that the functions on meshes rely on: every index names an entry, parallel lists
    /// have one length, faces have three corners or more and a surface. Numbers are not looked at.
    ///
    /// # Errors
    /// [`MeshError`] for the first thing found wrong.
    pub fn check(&self) -> Result<(), MeshError> {
        let (v, points, count) = (&self.vertices, self.points.len(), self.vertices.point.len());
        indices("vertices.point", &v.point, "points", points)?;
        length("vertices.normal", &v.normal, count)?;
        length("vertices.texcoord0", &v.texcoord0, count)?;
        length("vertices.texcoord1", &v.texcoord1, count)?;
        length("vertices.color", &v.color, count)?;
        length("vertices.tangent", &v.tangent, count)?;
        self.check_faces()?;
        indices("lines", self.lines.as_flattened(), "vertices", count)?;
        indices("dots", &self.dots, "vertices", count)?;
        length("joints", &self.joints, points)?;
        for target in &self.morph_targets {
            length("morph_targets.points", &target.points, points)?;
            length("morph_targets.normals", &target.normals, count)?;
            length("morph_targets.tangents", &target.tangents, count)?;
        }
        Ok(())
    }

    fn check_faces(&self) -> Result<(), MeshError> {
        let faces = &self.faces;
        indices("faces.corners", &faces.corners, "vertices", self.vertices.point.len())?;
        if faces.starts.is_empty() {
            let expected = faces.corners.len() / 3 * 3;
            length("faces.corners", &faces.corners, expected)?;
            if faces.corners.len() != expected {
                return Err(MeshError::FewCorners {
                    face: expected / 3,
                    corners: faces.corners.len() - expected,
                });
            }
        } else {
            check_starts(&faces.starts, faces.corners.len())?;
        }
        length("faces.surface", &faces.surface, faces.len())?;
        if faces.is_empty() {
            return Ok(());
        }
        if self.surfaces.is_empty() {
            return Err(MeshError::NoSurface);
        }
        indices("faces.surface", &faces.surface, "surfaces", self.surfaces.len())
    }

    /// Checks that positions, normals and the other numbers are finite.
    ///
    /// # Errors
    /// [`MeshError::NotFinite`] for the first that is not.
    pub fn check_finite(&self) -> Result<(), MeshError> {
        let v = &self.vertices;
        finite("points", &self.points, |p| p.is_finite())?;
        finite("vertices.normal", &v.normal, |n| n.is_finite())?;
        finite("vertices.texcoord0", &v.texcoord0, |t| t.is_finite())?;
        finite("vertices.texcoord1", &v.texcoord1, |t| t.is_finite())?;
        finite("vertices.color", &v.color, |c| c.is_finite())?;
        finite("vertices.tangent", &v.tangent, |t| t.is_finite())?;
        finite("joints", &self.joints, |j| j.weights.iter().all(|w| w.is_finite()))?;
        for target in &self.morph_targets {
            finite("morph_targets.points", &target.points, |p| p.is_finite())?;
            finite("morph_targets.normals", &target.normals, |n| n.is_finite())?;
            finite("morph_targets.tangents", &target.tangents, |t| t.is_finite())?;
        }
        Ok(())
    }
}

fn check_starts(starts: &[u32], corners: usize) -> Result<(), MeshError> {
    if starts[0] != 0 {
        return Err(MeshError::Starts { at: 0 });
    }
    if let Some(at) = starts.windows(2).position(|s| s[0] > s[1]) {
        return Err(MeshError::Starts { at: at + 1 });
    }
    if starts[starts.len() - 1] as usize != corners {
        return Err(MeshError::Starts { at: starts.len() - 1 });
    }
    let few = starts.windows(2).position(|s| s[1] - s[0] < 3);
    few.map_or(Ok(()), |face| {
        Err(MeshError::FewCorners { face, corners: (starts[face + 1] - starts[face]) as usize })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Faces, MorphTarget, Surface, Vertices};
    use senca_math::glam::{Vec2, Vec3};

    fn triangle() -> Mesh {
        Mesh {
            points: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            vertices: Vertices { point: vec![0, 1, 2], ..Vertices::default() },
            faces: Faces { corners: vec![0, 1, 2], ..Faces::default() },
            surfaces: vec![Surface::default()],
            ..Mesh::default()
        }
    }

    fn broken(change: impl FnOnce(&mut Mesh)) -> MeshError {
        let mut mesh = triangle();
        assert_eq!(mesh.check(), Ok(()));
        change(&mut mesh);
        mesh.check().and_then(|()| mesh.check_finite()).expect_err("the mesh was broken")
    }

    #[test]
    fn every_break_is_found() {
        let range = |e| matches!(e, MeshError::IndexOutOfRange { .. });
        let length = |e| matches!(e, MeshError::Length { .. });
        assert!(range(broken(|m| m.vertices.point[1] = 3)));
        assert!(range(broken(|m| m.faces.corners[2] = 7)));
        assert!(range(broken(|m| m.lines.push([0, 3]))));
        assert!(range(broken(|m| m.dots.push(u32::MAX))));
        assert!(range(broken(|m| m.faces.surface = vec![1])));
        assert!(length(broken(|m| m.faces.surface = vec![0, 0])));
        assert!(length(broken(|m| m.vertices.normal = vec![Vec3::Z])));
        assert!(length(broken(|m| m.vertices.texcoord0 = vec![Vec2::ZERO; 4])));
        assert!(length(broken(|m| m
            .morph_targets
            .push(MorphTarget { points: vec![Vec3::Z], ..MorphTarget::default() }))));
        assert!(matches!(broken(|m| m.faces.starts = vec![1, 3]), MeshError::Starts { at: 0 }));
        assert!(matches!(broken(|m| m.faces.starts = vec![0, 4]), MeshError::Starts { at: 1 }));
        assert!(matches!(broken(|m| m.faces.starts = vec![0, 3, 0, 3]), MeshError::Starts { at: 2 }));
        assert!(matches!(
            broken(|m| m.faces.starts = vec![0, 2, 3]),
            MeshError::FewCorners { face: 0, corners: 2 }
        ));
        assert!(matches!(
            broken(|m| m.faces.corners.truncate(2)),
            MeshError::Length { .. } | MeshError::FewCorners { .. }
        ));
        assert_eq!(broken(|m| m.surfaces.clear()), MeshError::NoSurface);
        assert!(matches!(
            broken(|m| m.points[0].x = f32::NAN),
            MeshError::NotFinite { list: "points", at: 0 }
        ));
        assert!(matches!(
            broken(|m| m.vertices.normal = vec![Vec3::INFINITY; 3]),
            MeshError::NotFinite { .. }
        ));
    }
}
