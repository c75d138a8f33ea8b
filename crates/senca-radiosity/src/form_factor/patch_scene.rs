//! Patches that rays can meet.

use senca_math::LinearRgb;
use senca_math::glam::DVec3;

use super::Visibility;
use crate::{ElementMesh, Occluders, PatchPolygon, RadiosityError};

/// Patches as obstacles: which one does a ray meet first, and do two places see each other? What
/// blocks is said at [`Occluders`].
#[derive(Clone, Debug)]
pub struct PatchScene {
    occluders: Occluders,
    patch_of_polygon: Vec<u32>,
}

/// What a ray from a patch meets first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FirstHit {
    /// The front of a patch, by its number.
    Front(usize),
    /// The back of a patch, which takes nothing.
    Back(usize),
    /// Nothing.
    Nothing,
}

impl PatchScene {
    /// Over patches; those without area, or with corners that are not finite, are not met.
    ///
    /// # Errors
    /// [`RadiosityError::TooManyElements`].
    pub fn new(patches: &[PatchPolygon]) -> Result<Self, RadiosityError> {
        let is_there = |p: &PatchPolygon| {
            let (normal, area) = p.normal_and_area();
            normal != DVec3::ZERO && area > 0.0 && area.is_finite()
        };
        let (patch_of_polygon, polygons): (Vec<u32>, Vec<_>) = (0..)
            .zip(patches)
            .filter(|(_, p)| is_there(p))
            .map(|(k, p)| (k, (p.corners(), LinearRgb::BLACK, LinearRgb::BLACK)))
            .unzip();
        let occluders = Occluders::new(&ElementMesh::of_polygons(&polygons))?;
        Ok(Self { occluders, patch_of_polygon })
    }

    /// What the ray from a place on a patch meets first. `direction` may have any length but zero.
    #[must_use]
    pub fn first_hit(&self, from: DVec3, direction: DVec3) -> FirstHit {
        let Some(hit) = self.occluders.closest(from, direction) else { return FirstHit::Nothing };
        let patch = self.patch_of_polygon[hit.polygon as usize] as usize;
        if hit.front { FirstHit::Front(patch) } else { FirstHit::Back(patch) }
    }
}

impl Visibility for PatchScene {
    fn visible(&self, from: DVec3, to: DVec3) -> bool {
        self.occluders.visible(from, to)
    }
}

impl Visibility for Occluders {
    fn visible(&self, from: DVec3, to: DVec3) -> bool {
        Occluders::visible(self, from, to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: f64, half: f64) -> PatchPolygon {
        let at = |x: f64, y: f64| DVec3::new(x * half, y * half, z);
        PatchPolygon::quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)])
    }

    fn turned(patch: &PatchPolygon) -> PatchPolygon {
        let c = patch.corners();
        PatchPolygon::quad([c[3], c[2], c[1], c[0]])
    }

    #[test]
    fn what_is_between_hides_and_the_ends_do_not() {
        let scene = PatchScene::new(&[square(0.0, 1.0), square(1.0, 0.5), square(2.0, 1.0)]).expect("few");
        let sees = |from: [f64; 3], to: [f64; 3]| scene.visible(from.into(), to.into());
        assert!(!sees([0.0, 0.0, 0.0], [0.0, 0.0, 2.0]));
        assert!(sees([0.9, 0.0, 0.0], [0.9, 0.0, 2.0]));
        assert!(sees([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]));
        assert!(sees([0.0, 0.0, 1.0], [0.0, 0.0, 2.0]));
        assert!(!sees([0.0, 0.0, -1.0], [0.0, 0.0, 0.5]));
    }

    #[test]
    fn walls_that_touch_do_not_hide_each_other() {
        let wall = PatchPolygon::quad(
            [[-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, 1.0, 2.0], [-1.0, -1.0, 2.0]].map(DVec3::from),
        );
        let scene = PatchScene::new(&[square(0.0, 1.0), wall]).expect("few");
        for k in 1..50 {
            let near = 0.5_f64.powi(k);
            assert!(scene.visible(DVec3::new(-1.0 + near, 0.1, 0.0), DVec3::new(-1.0, 0.1, near)), "{k}");
        }
    }

    #[test]
    fn the_front_of_a_sheet_is_met_from_its_side() {
        let sheet = square(1.0, 1.0);
        let scene = PatchScene::new(&[square(0.0, 1.0), sheet, turned(&sheet)]).expect("few");
        let up = scene.first_hit(DVec3::new(0.1, 0.2, 0.0), DVec3::new(0.1, 0.3, 1.0));
        assert_eq!(up, FirstHit::Front(2));
        assert_eq!(scene.first_hit(DVec3::new(0.1, 0.2, 3.0), DVec3::NEG_Z), FirstHit::Front(1));
        assert_eq!(scene.first_hit(DVec3::ZERO, DVec3::X), FirstHit::Nothing);
        let alone = PatchScene::new(&[square(0.0, 1.0), sheet]).expect("few");
        assert_eq!(alone.first_hit(DVec3::ZERO, DVec3::Z), FirstHit::Back(1));
    }

    #[test]
    fn an_empty_scene_and_one_without_sense_hide_nothing() {
        let nan = PatchPolygon::triangle([DVec3::NAN; 3]);
        for patches in [&[][..], &[nan]] {
            let scene = PatchScene::new(patches).expect("few");
            assert!(scene.visible(DVec3::ZERO, DVec3::X));
            assert_eq!(scene.first_hit(DVec3::ZERO, DVec3::X), FirstHit::Nothing);
        }
    }
}
