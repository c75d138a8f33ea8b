//! What pixels hold beside colour: depth, normals, numbers.
//!
//! They come from the visibility pass alone, at the middle of each pixel. A transparent surface counts
//! as seen, one that a mask cuts away does not.

use senca_math::glam::Vec3;

use crate::settings::{Channel, Shading};
use crate::shade::Shader;
use crate::surface::TriangleSetup;

/// A seen place.
pub(crate) struct Seen {
    /// Index into `World::placed`.
    pub(crate) placed: usize,
    /// Identifier of the triangle, line or point.
    pub(crate) id: u32,
    /// Place in the world.
    pub(crate) position: Vec3,
    /// Unit normal of the world, zero for lines and points.
    pub(crate) normal: Vec3,
}

impl Channel {
    /// The value where nothing is seen.
    pub(crate) const fn of_nothing(self) -> [f32; 4] {
        match self {
            Self::Depth => [f32::INFINITY, f32::INFINITY, f32::INFINITY, 1.0],
            _ => [0.0, 0.0, 0.0, 1.0],
        }
    }

    /// The value at a seen place.
    pub(crate) fn of(self, shader: &Shader<'_>, seen: &Seen) -> [f32; 4] {
        let [a, b, c] = match self {
            Self::Depth => [shader.depth_along_axis(seen.position); 3],
            Self::Normals => seen.normal.to_array(),
            Self::Objects => [(seen.placed + 1) as f32; 3],
            Self::Triangles => [(seen.id + 1) as f32; 3],
            Self::Color => [0.0; 3],
        };
        [a, b, c, 1.0]
    }
}

impl Shader<'_> {
    /// What is seen of `triangle` at (x, y), pixels from the picture's upper left corner; `depth` is the
    /// window depth there.
    pub(crate) fn seen(&self, triangle: &TriangleSetup<'_>, x: f64, y: f64, depth: f32) -> Seen {
        let weights = triangle.weights(x, y);
        let normal = match self.settings.shading {
            Shading::Flat => triangle.plane_normal(),
            _ => self.shading_normal(triangle, &weights, x, y, depth),
        };
        let position = triangle.position(&weights);
        Seen { placed: triangle.part.placed, id: triangle.id, position, normal }
    }

    /// Distance from the eye's plane along the axis of the view, in world units.
    fn depth_along_axis(&self, position: Vec3) -> f32 {
        -self.view.view_from_world.transform_point3(position.as_dvec3()).z as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Raster, RenderError, Settings, render};
    use senca_math::glam::{DMat4, DVec3};
    use senca_math::{Image, View};
    use senca_scene::{AlphaMode, Geometry, Material, Node, Scene, Shape, Transform};

    const SIDE: u32 = 33;

    /// A box of side 2 about the origin, and a transparent one of side 1 behind and to the right.
    fn two_boxes() -> Scene {
        let mut scene = Scene::default();
        let glass = Material { alpha_mode: AlphaMode::Blend, ..Material::default() };
        for (side, at, material) in
            [(2.0, DVec3::ZERO, Material::default()), (1.0, DVec3::new(2.0, 0.0, -3.0), glass)]
        {
            let material = Some(scene.add_material(material));
            let shape = Shape::Box { size: DVec3::splat(side) };
            let geometry = Some(scene.add_geometry(Geometry { name: String::new(), shape, material }));
            let transform = Transform::Matrix(DMat4::from_translation(at));
            let node = scene.add_node(Node { geometry, transform, ..Node::default() });
            scene.roots.push(node);
        }
        scene
    }

    /// From z = 10 along -z: 45 degrees to each side.
    fn drawn(channel: Channel, raster: Raster) -> Image {
        let camera = DMat4::from_translation(DVec3::Z * 10.0);
        let view = View::perspective(&camera, 0.8, 1.0, 0.5, Some(50.0)).expect("regular");
        let settings = Settings { channel, raster, ..Settings::default() };
        let mut image = Image::new(SIDE, SIDE, [9.0; 4]);
        render(&two_boxes(), &view, &settings, &mut image).expect("draws");
        image
    }

    /// Values in the middle of the picture, on the box behind, and in a corner.
    fn three(channel: Channel) -> [[f32; 4]; 3] {
        let image = drawn(channel, Raster::Tiled);
        assert_eq!(image, drawn(channel, Raster::Scanline));
        [image.pixel(16, 16), image.pixel(22, 16), image.pixel(0, 0)]
    }

    #[test]
    fn depth_is_measured_along_the_axis() {
        let [middle, behind, corner] = three(Channel::Depth);
        assert!((middle[0] - 9.0).abs() < 1e-4 && (behind[0] - 12.5).abs() < 1e-4, "{middle:?} {behind:?}");
        assert_eq!(corner, [f32::INFINITY, f32::INFINITY, f32::INFINITY, 1.0]);
    }

    #[test]
    fn normals_are_those_of_the_world() {
        let [middle, behind, corner] = three(Channel::Normals);
        assert_eq!(
            [middle, behind, corner],
            [[0.0, 0.0, 1.0, 1.0], [0.0, 0.0, 1.0, 1.0], [0.0, 0.0, 0.0, 1.0]]
        );
    }

    #[test]
    fn objects_and_triangles_are_numbered_from_one() {
        let [middle, behind, corner] = three(Channel::Objects).map(|p| p[0]);
        assert_eq!([middle, behind, corner], [1.0, 2.0, 0.0]);
        let [middle, behind, corner] = three(Channel::Triangles).map(|p| p[0]);
        assert!((1.0..=12.0).contains(&middle) && (13.0..=24.0).contains(&behind) && corner == 0.0);
    }

    #[test]
    fn numbers_have_no_mean() {
        let settings = Settings { channel: Channel::Objects, samples: 4, ..Settings::default() };
        let mut image = Image::new(4, 4, [0.0; 4]);
        let camera = View::look_at(DVec3::Z * 9.0, DVec3::ZERO, DVec3::Y).expect("regular");
        let view = View::perspective(&camera, 0.8, 1.0, 0.5, Some(50.0)).expect("regular");
        let error = render(&two_boxes(), &view, &settings, &mut image).expect_err("refused");
        assert!(matches!(error, RenderError::Setting { name: "samples", .. }));
    }
}
