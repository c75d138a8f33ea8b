//! Whether two places see each other.

use senca_math::glam::DVec3;
use senca_trace::{Counters, Ray, World};

/// Whether two places see each other: H of the course text, equation 4.7. Asked from several threads.
pub trait Visibility: Sync {
    /// Whether nothing is between `from` and `to`. What the two places themselves lie on does not count.
    fn visible(&self, from: DVec3, to: DVec3) -> bool;
}

/// Nothing is in the way anywhere.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unoccluded;

impl Visibility for Unoccluded {
    fn visible(&self, _: DVec3, _: DVec3) -> bool {
        true
    }
}

impl<F: Fn(DVec3, DVec3) -> bool + Sync> Visibility for F {
    fn visible(&self, from: DVec3, to: DVec3) -> bool {
        self(from, to)
    }
}

/// The exact surfaces of a scene as obstacles: all of them, those that let light pass too.
#[derive(Clone, Copy, Debug)]
pub struct WorldVisibility<'w, 's> {
    world: &'w World<'s>,
    margin: f64,
}

impl<'w, 's> WorldVisibility<'w, 's> {
    /// Surfaces within `margin` of either place, in world units and 0 or more, are not in the way. Places on
    /// patches that stand for curved surfaces are beside those by as much as the patches are: the margin has
    /// to be larger.
    #[must_use]
    pub const fn new(world: &'w World<'s>, margin: f64) -> Self {
        Self { world, margin }
    }
}

impl Visibility for WorldVisibility<'_, '_> {
    fn visible(&self, from: DVec3, to: DVec3) -> bool {
        let share = self.margin / from.distance(to);
        let (t_min, t_max) = (share, 1.0 - share);
        if t_min.is_nan() || t_min >= t_max {
            return true;
        }
        let ray = Ray { t_min, t_max, ..Ray::new(from, to - from) };
        !self.world.occluded(&ray, &mut Counters::default(), &|_| true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_scene::{Scene, Shape};

    #[test]
    fn a_ball_is_in_the_way_of_what_is_behind_it() {
        let scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
        let world = World::new(&scene).expect("a ball");
        let sees = WorldVisibility::new(&world, 1e-3);
        assert!(!sees.visible(DVec3::Z * 2.0, DVec3::Z * -2.0));
        assert!(sees.visible(DVec3::new(1.5, 0.0, 2.0), DVec3::new(1.5, 0.0, -2.0)));
        assert!(sees.visible(DVec3::Z * 2.0, DVec3::Z), "on the ball itself");
        assert!(!WorldVisibility::new(&world, 0.0).visible(DVec3::Z * 2.0, DVec3::Z * 0.9));
        assert!(sees.visible(DVec3::ZERO, DVec3::ZERO));
        assert!(sees.visible(DVec3::NAN, DVec3::Z));
    }

    #[test]
    fn a_closure_may_say_what_is_visible() {
        let above = |_: DVec3, to: DVec3| to.z > 0.0;
        assert!(
            Visibility::visible(&above, DVec3::ZERO, DVec3::Z) && Unoccluded.visible(DVec3::ZERO, DVec3::X)
        );
    }
}
