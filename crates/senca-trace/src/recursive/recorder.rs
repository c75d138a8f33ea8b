//! Those who want to know what happens while rays are followed.

use senca_math::LinearRgb;
use senca_math::glam::DVec3;

use super::follow::Pending;
use crate::{Interaction, MaterialPoint, Ray};

/// Is told of every ray. The numbers of rays count from 0 in the order of following.
pub(crate) trait Recorder {
    /// Whether it wants to know at all.
    const RECORDS: bool;

    /// A ray is followed.
    fn ray(&mut self, number: u32, pending: &Pending) {
        let _ = (number, pending);
    }

    /// It leaves the scene and brings `light`, which counts as `weight` in the picture.
    fn leaves(&mut self, number: u32, light: LinearRgb, weight: LinearRgb) {
        let _ = (number, light, weight);
    }

    /// It meets a surface.
    fn meets(&mut self, number: u32, at: &Met<'_>) {
        let _ = (number, at);
    }

    /// The light of the lamps and of the surface there is known.
    fn local(&mut self, number: u32, local: LinearRgb) {
        let _ = (number, local);
    }

    /// A shadow ray goes from there to a light.
    fn shadow(&mut self, number: u32, shadow: &ShadowRay) {
        let _ = (number, shadow);
    }

    /// Why a ray that the surface asks for was not sent.
    fn unsent(&mut self, number: u32, unsent: Unsent) {
        let _ = (number, unsent);
    }
}

/// A ray meets a surface.
#[derive(Debug)]
pub(crate) struct Met<'a> {
    pub(crate) t: f64,
    pub(crate) at: &'a Interaction,
    pub(crate) material: &'a MaterialPoint,
    /// Light that fog adds before the surface, already weighted.
    pub(crate) fog: LinearRgb,
    /// Share of the place's own light in the picture.
    pub(crate) weight: LinearRgb,
}

/// A shadow ray with what became of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShadowRay {
    /// Number of the light.
    pub(crate) light: u32,
    pub(crate) ray: Ray,
    /// S_i.
    pub(crate) share: LinearRgb,
    /// What the place reflects of it.
    pub(crate) light_reflected: LinearRgb,
    /// Object in the way and where.
    pub(crate) blocker: Option<(u32, DVec3)>,
}

/// Why a ray was not sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unsent {
    /// MaxNest is reached.
    TooDeep,
    /// The product of coefficients is too small.
    Negligible,
}

/// Nobody wants to know.
#[derive(Debug)]
pub(crate) struct Unrecorded;

impl Recorder for Unrecorded {
    const RECORDS: bool = false;
}
