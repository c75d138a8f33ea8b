//! Welding: points at one place become one.
//!
//! Files that store triangles one by one (STL) or repeat points along seams give meshes that fall
//! apart; welding gives them back their connectivity. Of points that are one the first stays.

use std::collections::HashMap;

use senca_math::glam::Vec3;

use crate::Mesh;

/// Says "nothing here" in the lists of this module.
const NONE: u32 = u32::MAX;

impl Mesh {
    /// Makes points one that are no farther apart than `tolerance`, in object units; 0 means equal
    /// coordinates. A point joins the first earlier point that is near enough and that moves alike
    /// under morph targets and joints; points with NaN stay alone. Vertices that then agree in
    /// everything, and belong to one surface, become one too. Faces stay, even those that collapse. Returns the number of points
    /// that went.
    ///
    /// Negative and NaN tolerances count as 0.
    ///
    /// # Panics
    /// When the mesh does not hold together (see [`Mesh::check`]).
    pub fn weld(&mut self, tolerance: f32) -> usize {
        let leaders = if tolerance > 0.0 && tolerance.is_finite() {
            self.near_leaders(tolerance)
        } else {
            self.equal_leaders()
        };
        let removed = self.keep_leaders(&leaders);
        self.join_equal_vertices();
        removed
    }

    /// Whether two points move alike.
    fn moves_alike(&self, a: usize, b: usize) -> bool {
        self.joints.get(a) == self.joints.get(b)
            && self.morph_targets.iter().all(|target| target.points.get(a) == target.points.get(b))
    }

    /// For every point the first point at the same coordinates.
    fn equal_leaders(&self) -> Vec<u32> {
        let key = |p: Vec3| p.to_array().map(|x| u64::from((x + 0.0).to_bits()));
        let hash = |i: usize| key(self.points[i]).into_iter().fold(0, mix);
        first_of_equals(self.points.len(), hash, |a, b| {
            self.points[a] == self.points[b] && self.moves_alike(a, b)
        })
    }

    /// For every point the first leader within `tolerance`, or itself.
    fn near_leaders(&self, tolerance: f32) -> Vec<u32> {
        let cell = |p: Vec3| (p.as_dvec3() / f64::from(tolerance)).floor().to_array().map(|x| x as i64);
        let mut heads: HashMap<[i64; 3], u32> = HashMap::new();
        let mut next = vec![NONE; self.points.len()];
        let mut leaders: Vec<u32> = (0..self.points.len() as u32).collect();
        for (i, &p) in self.points.iter().enumerate() {
            if !p.is_finite() {
                continue;
            }
            let [x, y, z] = cell(p);
            let mut found = NONE;
            for k in 0..27 {
                let around = [
                    x.saturating_add(k % 3 - 1),
                    y.saturating_add(k / 3 % 3 - 1),
                    z.saturating_add(k / 9 - 1),
                ];
                let mut candidate = heads.get(&around).copied().unwrap_or(NONE);
                while candidate != NONE {
                    let c = candidate as usize;
                    if candidate < found && self.points[c].distance(p) <= tolerance && self.moves_alike(c, i)
                    {
                        found = candidate;
                    }
                    candidate = next[c];
                }
            }
            if found == NONE {
                next[i] = heads.insert([x, y, z], i as u32).unwrap_or(NONE);
            } else {
                leaders[i] = found;
            }
        }
        leaders
    }

    /// Drops points that do not lead and renumbers. Returns how many went.
    fn keep_leaders(&mut self, leaders: &[u32]) -> usize {
        let keep: Vec<bool> = leaders.iter().enumerate().map(|(i, &leader)| leader as usize == i).collect();
        let mut count = 0;
        let renumbered: Vec<u32> = keep
            .iter()
            .map(|&keep| {
                count += u32::from(keep);
                count.wrapping_sub(1)
            })
            .collect();
        let new_index = |point: u32| renumbered[leaders[point as usize] as usize];
        self.vertices.point.iter_mut().for_each(|point| *point = new_index(*point));
        retain(&mut self.points, &keep);
        retain(&mut self.joints, &keep);
        self.morph_targets.iter_mut().for_each(|target| retain(&mut target.points, &keep));
        leaders.len() - count as usize
    }

    /// Whether vertices have nothing but a place.
    fn vertices_are_bare(&self) -> bool {
        let v = &self.vertices;
        v.normal.is_empty()
            && v.texcoord0.is_empty()
            && v.texcoord1.is_empty()
            && v.color.is_empty()
            && v.tangent.is_empty()
            && self.morph_targets.iter().all(|t| t.normals.is_empty() && t.tangents.is_empty())
    }

    /// For every vertex the first one at its point.
    fn first_at_point(&self) -> Vec<u32> {
        let mut first = vec![NONE; self.points.len()];
        let leader = |(i, &point): (usize, &u32)| {
            let first = &mut first[point as usize];
            *first = (*first).min(i as u32);
            *first
        };
        self.vertices.point.iter().enumerate().map(leader).collect()
    }

    /// The surface of every vertex: that of the first face that has it. Empty where there is but one.
    fn surface_of_vertices(&self) -> Vec<u32> {
        if self.surfaces.len() < 2 {
            return Vec::new();
        }
        let mut surfaces = vec![NONE; self.vertices.point.len()];
        for (face, corners) in self.faces.iter().enumerate() {
            for &vertex in corners {
                let known = &mut surfaces[vertex as usize];
                if *known == NONE {
                    *known = self.faces.surface_of(face);
                }
            }
        }
        surfaces
    }

    /// Makes vertices one that agree in place, surface and all attributes.
    fn join_equal_vertices(&mut self) {
        let v = &self.vertices;
        let surfaces = self.surface_of_vertices();
        let bits = |x: f32| u64::from((x + 0.0).to_bits());
        let hash = |i: usize| {
            let normal = v.normal.get(i).map_or(0, |n| n.to_array().into_iter().map(bits).fold(0, mix));
            let texcoord = v.texcoord0.get(i).map_or(0, |t| mix(bits(t.x), bits(t.y)));
            mix(mix(u64::from(v.point[i]), normal), texcoord)
        };
        let alike = |a: usize, b: usize| {
            v.point[a] == v.point[b]
                && surfaces.get(a) == surfaces.get(b)
                && v.normal.get(a) == v.normal.get(b)
                && v.texcoord0.get(a) == v.texcoord0.get(b)
                && v.texcoord1.get(a) == v.texcoord1.get(b)
                && v.color.get(a) == v.color.get(b)
                && v.tangent.get(a) == v.tangent.get(b)
                && self
                    .morph_targets
                    .iter()
                    .all(|t| t.normals.get(a) == t.normals.get(b) && t.tangents.get(a) == t.tangents.get(b))
        };
        let leaders = if self.vertices_are_bare() && surfaces.is_empty() {
            self.first_at_point()
        } else {
            first_of_equals(v.point.len(), hash, alike)
        };
        let keep: Vec<bool> = leaders.iter().enumerate().map(|(i, &leader)| leader as usize == i).collect();
        let mut renumbered = vec![0; keep.len()];
        let mut count = 0;
        for (i, &keep) in keep.iter().enumerate() {
            renumbered[i] = count;
            count += u32::from(keep);
        }
        let new_index = |vertex: &mut u32| *vertex = renumbered[leaders[*vertex as usize] as usize];
        self.faces.corners.iter_mut().for_each(new_index);
        self.lines.as_flattened_mut().iter_mut().for_each(new_index);
        self.dots.iter_mut().for_each(new_index);
        let v = &mut self.vertices;
        retain(&mut v.point, &keep);
        retain(&mut v.normal, &keep);
        retain(&mut v.texcoord0, &keep);
        retain(&mut v.texcoord1, &keep);
        retain(&mut v.color, &keep);
        retain(&mut v.tangent, &keep);
        for target in &mut self.morph_targets {
            retain(&mut target.normals, &keep);
            retain(&mut target.tangents, &keep);
        }
    }
}

/// Drops the entries that are not kept; an absent list stays absent.
fn retain<T>(list: &mut Vec<T>, keep: &[bool]) {
    let mut at = 0;
    list.retain(|_| {
        at += 1;
        keep[at - 1]
    });
}

/// Stirs `value` into a hash.
fn mix(hash: u64, value: u64) -> u64 {
    (hash ^ value).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
}

/// For every index below `count` the first one that equals it. One open-addressed table, half full.
fn first_of_equals(
    count: usize,
    hash: impl Fn(usize) -> u64,
    equal: impl Fn(usize, usize) -> bool,
) -> Vec<u32> {
    let slots = (2 * count).next_power_of_two().max(2);
    let mut table = vec![NONE; slots];
    let shift = 64 - slots.trailing_zeros();
    let find = |i: usize| {
        let mut slot = (mix(hash(i), 0x2545_f491_4f6c_dd1d) >> shift) as usize;
        loop {
            let there = table[slot];
            if there == NONE {
                table[slot] = i as u32;
                return i as u32;
            }
            if equal(there as usize, i) {
                return there;
            }
            slot = (slot + 1) & (slots - 1);
        }
    };
    (0..count).map(find).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Faces, MorphTarget, Shape, Surface, TessellationSettings, Topology, Vertices, tessellate};
    use proptest::prelude::*;
    use senca_math::glam::Vec2;

    /// A closed mesh taken apart into triangles that share nothing.
    fn soup(shape: &Shape) -> Mesh {
        let whole = tessellate(shape, &TessellationSettings::default()).unwrap();
        let points: Vec<Vec3> = whole.faces.corners.iter().map(|&v| whole.position(v)).collect();
        let all: Vec<u32> = (0..points.len() as u32).collect();
        Mesh {
            points,
            vertices: Vertices { point: all.clone(), ..Vertices::default() },
            faces: Faces { corners: all, ..Faces::default() },
            surfaces: vec![Surface::default()],
            ..Mesh::default()
        }
    }

    #[test]
    fn a_soup_of_triangles_becomes_a_body_again() {
        for tolerance in [0.0, 1e-5] {
            let mut mesh = soup(&Shape::Torus { major_radius: 2.0, minor_radius: 1.0 });
            let before = mesh.points.len();
            let removed = mesh.weld(tolerance);
            assert_eq!(mesh.check(), Ok(()));
            assert_eq!((mesh.points.len() + removed, mesh.vertices.point.len()), (before, mesh.points.len()));
            let topology = Topology::new(&mesh);
            assert!(topology.is_closed());
            assert_eq!(topology.euler_characteristic(&mesh), 0);
            assert_eq!(mesh.weld(tolerance), 0);
        }
    }

    #[test]
    fn seams_keep_their_vertices() {
        let mut mesh = soup(&Shape::Sphere { radius: 1.0 });
        mesh.vertices.texcoord0 = (0..mesh.vertices.point.len()).map(|i| Vec2::splat(i as f32)).collect();
        let vertices = mesh.vertices.point.len();
        assert!(mesh.weld(0.0) > 0);
        assert_eq!(mesh.vertices.point.len(), vertices);
    }

    #[test]
    fn points_that_move_differently_stay_apart() {
        let mut mesh = Mesh {
            points: vec![Vec3::ZERO, -Vec3::ZERO, Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::splat(f32::NAN)],
            vertices: Vertices { point: vec![0, 1, 2, 3, 4], ..Vertices::default() },
            morph_targets: vec![MorphTarget {
                points: vec![Vec3::X, Vec3::X, Vec3::Y, Vec3::X, Vec3::X],
                ..MorphTarget::default()
            }],
            dots: vec![0, 1, 2, 3, 4],
            ..Mesh::default()
        };
        assert_eq!(mesh.weld(0.0), 1);
        assert_eq!(mesh.dots, [0, 0, 1, 2, 3]);
        assert_eq!((mesh.check(), mesh.points.len()), (Ok(()), 4));
        assert_eq!(mesh.weld(0.5), 0);
    }

    proptest! {
        #[test]
        fn welded_points_stay_within_the_tolerance(xs in prop::collection::vec(prop::array::uniform3(-2.0f32..2.0), 1..60), tolerance in 0.0f32..1.0) {
            let points: Vec<Vec3> = xs.iter().map(|&x| x.into()).collect();
            let all: Vec<u32> = (0..points.len() as u32).collect();
            let mut mesh = Mesh {
                points: points.clone(),
                vertices: Vertices { point: all.clone(), ..Vertices::default() },
                dots: all,
                ..Mesh::default()
            };
            mesh.weld(tolerance);
            for (i, &vertex) in mesh.dots.iter().enumerate() {
                prop_assert!(mesh.position(vertex).distance(points[i]) <= tolerance);
            }
            for (i, a) in mesh.points.iter().enumerate() {
                prop_assert!(mesh.points[..i].iter().all(|b| a.distance(*b) > tolerance || (tolerance == 0.0 && a != b)));
            }
        }
    }
}
