//! From a pixel and the triangle seen there back to the surface.
//!
//! With the corners' homogeneous pixel coordinates `q_i = (x w, y w, w)`, the weights of the corners
//! at pixel (x, y) that are right under perspective are proportional to `(q_j x q_k) . (x, y, 1)`.
//! This needs no division by w, so it holds for triangles that reach behind the eye too (Olano and
//! Greer 1997). Weights come in f64 from the untouched object, so they do not depend on the
//! rasterizer's grid.

use senca_math::glam::{DMat4, DVec2, DVec3, Vec2, Vec3, Vec4};
use senca_scene::Mesh;

use crate::geometry::{Part, Placed, World};
use crate::material::TexturePoint;

/// How clip coordinates become pixels of the whole picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PixelGrid {
    /// Half the picture's width and height in pixels.
    half: DVec2,
}

impl PixelGrid {
    pub(crate) fn new(width: u32, height: u32) -> Self {
        Self { half: 0.5 * DVec2::new(f64::from(width), f64::from(height)) }
    }

    /// `(x w, y w, w)` in pixels, y down, of a point given in the space that `clip_from` starts from.
    #[inline]
    pub(crate) fn homogeneous(&self, clip_from: &DMat4, point: DVec3) -> DVec3 {
        let clip = *clip_from * point.extend(1.0);
        DVec3::new((clip.w + clip.x) * self.half.x, (clip.w - clip.y) * self.half.y, clip.w)
    }

    /// Pixel coordinates to normalised x and y, -1 to 1, y up.
    pub(crate) fn normalized(&self, x: f64, y: f64) -> DVec2 {
        DVec2::new(x / self.half.x - 1.0, 1.0 - y / self.half.y)
    }
}

/// A triangle ready to be asked for what is seen at a pixel.
pub(crate) struct TriangleSetup<'w> {
    pub(crate) id: u32,
    /// Index into `World::parts`.
    pub(crate) part_index: usize,
    pub(crate) part: &'w Part,
    pub(crate) placed: &'w Placed<'w>,
    pub(crate) mesh: &'w Mesh,
    /// Vertex numbers of the corners.
    pub(crate) corners: [u32; 3],
    /// `edges[i] . (x, y, 1)` is proportional to the weight of corner i.
    edges: [DVec3; 3],
    /// w of the corners.
    w: [f64; 3],
    /// Places of the corners in the world.
    positions: [Vec3; 3],
    /// Normals at the corners in the world, on the side that is seen; zero where the mesh has none.
    normals: [Vec3; 3],
    /// Whether the front is seen.
    pub(crate) front: bool,
}

/// Weights of the corners at a pixel, of sum 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Weights(pub(crate) [f32; 3]);

impl<'w> TriangleSetup<'w> {
    /// Triangle `id` of `world`, which belongs to its part.
    pub(crate) fn new(world: &'w World<'w>, id: u32, clip_from_object: &[DMat4], grid: &PixelGrid) -> Self {
        let part_index = world.part_of(id);
        let part = &world.parts[part_index];
        let (placed, mesh) = (&world.placed[part.placed], world.mesh(part));
        let first = 3 * (id - part.first_id) as usize;
        let corners = world.corners(part);
        let corners = [corners[first], corners[first + 1], corners[first + 2]];
        let clip_from_object = &clip_from_object[part.placed];
        let q = corners.map(|c| grid.homogeneous(clip_from_object, mesh.position(c).as_dvec3()));
        let edges = [q[1].cross(q[2]), q[2].cross(q[0]), q[0].cross(q[1])];
        // y runs down here, so counter-clockwise corners have a negative determinant.
        let clockwise = q[0].dot(edges[0]) > 0.0;
        let w = q.map(|q| q.z);
        let front = clockwise == placed.mirrored;
        let positions = corners.map(|c| placed.world_from_object_f32.transform_point3(mesh.position(c)));
        let side = if front { 1.0 } else { -1.0 };
        let normals = corners.map(|c| {
            let normal = mesh.vertices.normal.get(c as usize).copied().unwrap_or_default();
            (placed.world_from_object_normals * normal) * side
        });
        Self { id, part_index, part, placed, mesh, corners, edges, w, positions, normals, front }
    }

    /// Weights at (x, y), pixels from the picture's upper left corner, not limited to the triangle.
    fn unlimited(&self, x: f64, y: f64) -> [f64; 3] {
        let p = DVec3::new(x, y, 1.0);
        let l = self.edges.map(|e| e.dot(p));
        let sum = l[0] + l[1] + l[2];
        let scale = if sum == 0.0 { 0.0 } else { 1.0 / sum };
        l.map(|l| l * scale)
    }

    /// Weights at (x, y). The rasterizer's grid may count a pixel whose centre is just outside:
    /// weights are limited to the triangle.
    pub(crate) fn weights(&self, x: f64, y: f64) -> Weights {
        let b = self.unlimited(x, y).map(|b| b.clamp(0.0, 1.0) as f32);
        let sum = b[0] + b[1] + b[2];
        if sum > 0.0 { Weights(b.map(|v| v / sum)) } else { Weights([1.0 / 3.0; 3]) }
    }

    /// Weights that are linear in the picture, for the interpolation of the books. A triangle that
    /// reaches behind the eye has none; it gets those of space.
    pub(crate) fn screen_weights(&self, x: f64, y: f64) -> Weights {
        let Weights(b) = self.weights(x, y);
        if self.w.iter().any(|&w| w <= 0.0) {
            return Weights(b);
        }
        let s: [f32; 3] = std::array::from_fn(|i| b[i] * self.w[i] as f32);
        let sum = s[0] + s[1] + s[2];
        if sum > 0.0 { Weights(s.map(|v| v / sum)) } else { Weights(b) }
    }

    /// Place in the world.
    pub(crate) fn position(&self, weights: &Weights) -> Vec3 {
        weights.of_vec3(self.positions)
    }

    /// Middle of the triangle in the world.
    pub(crate) fn centroid(&self) -> Vec3 {
        self.position(&Weights([1.0 / 3.0; 3]))
    }

    /// Unit normal of the triangle's plane on the side that is seen.
    pub(crate) fn plane_normal(&self) -> Vec3 {
        let [a, b, c] = self.corners.map(|c| self.mesh.position(c));
        self.outward(self.placed.world_from_object_normals * (b - a).cross(c - a))
    }

    /// Unit normal of the surface, interpolated, on the side that is seen. Where the mesh has no
    /// normals or they cancel, that of the plane.
    pub(crate) fn normal(&self, weights: &Weights) -> Vec3 {
        let normal = weights.of_vec3(self.normals).normalize_or_zero();
        if normal == Vec3::ZERO { self.plane_normal() } else { normal }
    }

    fn outward(&self, normal: Vec3) -> Vec3 {
        let unit = normal.normalize_or_zero();
        if self.front { unit } else { -unit }
    }

    /// Colour of the vertices with alpha; white where the mesh has none.
    pub(crate) fn color(&self, weights: &Weights) -> Vec4 {
        let colors = &self.mesh.vertices.color;
        if colors.is_empty() {
            return Vec4::ONE;
        }
        let [a, b, c] = self.corners.map(|c| colors[c as usize]);
        let Weights(w) = *weights;
        a * w[0] + b * w[1] + c * w[2]
    }

    /// Unit tangent of the world with the sign of the bitangent: the mesh's, or the triangle's own
    /// from texture coordinate set `set`.
    pub(crate) fn tangent(&self, weights: &Weights, set: u32) -> Option<Vec4> {
        let tangents = &self.mesh.vertices.tangent;
        let (object, sign) = if tangents.is_empty() {
            let positions = self.corners.map(|c| self.mesh.position(c));
            let t = senca_shading::tangent_frame(positions, self.corner_uvs(set)?)?;
            (t.truncate(), t.w)
        } else {
            let t = self.corners.map(|c| tangents[c as usize]);
            (weights.of_vec3(t.map(Vec4::truncate)), t[0].w)
        };
        let world = self.placed.world_from_object_f32.transform_vector3(object).try_normalize()?;
        let sign = if self.placed.mirrored { -sign } else { sign };
        // Seen from behind the normal is turned over, and with it the bitangent n x t.
        Some(world.extend(if self.front { sign } else { -sign }))
    }

    pub(crate) fn corner_uvs(&self, set: u32) -> Option<[Vec2; 3]> {
        let v = &self.mesh.vertices;
        let uvs = if set == 1 && !v.texcoord1.is_empty() { &v.texcoord1 } else { &v.texcoord0 };
        (!uvs.is_empty()).then(|| self.corners.map(|c| uvs[c as usize]))
    }

    /// Texture coordinates of set `set` at (x, y) with their derivatives; zero where the mesh has
    /// none.
    pub(crate) fn texture_point(&self, x: f64, y: f64, set: u32) -> TexturePoint {
        let Some(uvs) = self.corner_uvs(set) else { return TexturePoint::default() };
        let uvs = uvs.map(|uv| uv.as_dvec2());
        let at = |x: f64, y: f64| {
            let [a, b, c] = self.unlimited(x, y);
            a * uvs[0] + b * uvs[1] + c * uvs[2]
        };
        let Weights([a, b, c]) = self.weights(x, y);
        let here = f64::from(a) * uvs[0] + f64::from(b) * uvs[1] + f64::from(c) * uvs[2];
        let middle = at(x, y);
        TexturePoint {
            uv: here.as_vec2(),
            dx: (at(x + 1.0, y) - middle).as_vec2(),
            dy: (at(x, y + 1.0) - middle).as_vec2(),
        }
    }
}

impl Weights {
    pub(crate) fn of_vec3(&self, [a, b, c]: [Vec3; 3]) -> Vec3 {
        a * self.0[0] + b * self.0[1] + c * self.0[2]
    }
}
