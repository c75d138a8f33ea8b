//! Colours of fragments: texturing, colour sum, fog (OpenGL 1.5, sections 3.8 to 3.10).

use super::env::{self, Sources};
use super::real::{Color, Real, clamped};
use super::sample::Sampled;
use crate::gl;
use crate::state::{Fog, TexEnv, TexTarget};
use senca_raster::cube::{face_of, on_face};
use senca_raster::{Fragments, LANES};

/// A texture unit that is on.
#[derive(Clone, Debug)]
pub(crate) struct Unit {
    /// Number of the unit.
    pub(crate) number: usize,
    pub(crate) env: TexEnv,
    pub(crate) texture: Sampled,
    /// Number of the varying that is s.
    pub(crate) coords: usize,
}

/// Fog.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FogPlan {
    pub(crate) state: Fog,
    /// Number of the varying that is the distance.
    pub(crate) coord: usize,
}

impl FogPlan {
    /// Share of the fragment's own colour at a distance.
    pub(crate) fn factor(&self, distance: f32) -> f32 {
        let (f, c) = (&self.state, distance.abs());
        let factor = match f.mode {
            gl::LINEAR => (f.end - c) / (f.end - f.start),
            gl::EXP2 => (-(f.density * c) * (f.density * c)).exp(),
            _ => (-f.density * c).exp(),
        };
        if factor.is_nan() { 0.0 } else { factor.clamp(0.0, 1.0) }
    }

    #[inline(always)]
    pub(crate) fn mixed<R: Real>(&self, color: Color<R>, factor: R) -> Color<R> {
        let fog = self.state.color;
        let mix = |k: usize| factor.like(fog[k]).towards(color[k], factor);
        [mix(0), mix(1), mix(2), color[3]]
    }
}

/// How fragments get their colours.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shader {
    pub(crate) units: Vec<Unit>,
    /// Number of the varying that is red of the secondary colour, if that is added.
    pub(crate) secondary: Option<usize>,
    pub(crate) fog: Option<FogPlan>,
}

/// Coordinates of 16 fragments: s, t, r, divided by q but for cubes, and the value that depths are
/// compared to.
pub(crate) struct Coords {
    pub(crate) at: [[f32; LANES]; 3],
    pub(crate) reference: [f32; LANES],
}

impl Unit {
    pub(crate) fn coords(&self, f: &Fragments<'_>) -> Coords {
        let plane = |k: usize| f.varyings.get(self.coords + k).copied().unwrap_or([0.0; LANES]);
        let (mut at, q) = ([plane(0), plane(1), plane(2)], plane(3));
        let mut reference = at[2];
        if self.texture.target != TexTarget::Cube {
            for plane in &mut at {
                plane.iter_mut().zip(&q).for_each(|(c, q)| *c /= q);
            }
            reference = at[2];
        }
        Coords { at, reference }
    }

    /// Levels of detail; those of fragments side by side are the same.
    pub(crate) fn lods(&self, f: &Fragments<'_>, coords: &Coords) -> [f32; LANES] {
        let mut lods = [0.0; LANES];
        if !self.texture.needs_lod() {
            return lods;
        }
        for lanes in f.quads() {
            if lanes.iter().all(|i| f.mask >> i & 1 == 0) {
                continue;
            }
            let mut at = lanes.map(|i| [0, 1, 2].map(|k| coords.at[k][i]));
            if self.texture.target == TexTarget::Cube {
                // Fragments outside of the mask may look past the edge of the face.
                let seen = lanes.iter().position(|i| f.mask >> i & 1 == 1).unwrap_or(0);
                let face = face_of(at[seen]);
                at = at.map(|direction| {
                    let [s, t] = on_face(face, direction);
                    [s, t, 0.0]
                });
            }
            let change = |a: usize, b: usize| -> [f32; 3] { std::array::from_fn(|k| at[b][k] - at[a][k]) };
            let lod = self.texture.lod([change(0, 1), change(0, 2)]);
            lanes.iter().for_each(|&i| lods[i] = lod);
        }
        lods
    }
}

impl Shader {
    /// Colours of the fragments in the mask: the plain form.
    pub(crate) fn shade_plain(&self, f: &Fragments<'_>, out: &mut [[f32; LANES]; 4]) {
        let inputs: Vec<_> = self
            .units
            .iter()
            .map(|unit| {
                let coords = unit.coords(f);
                let lods = unit.lods(f, &coords);
                (unit, coords, lods)
            })
            .collect();
        let mut texels: Vec<(usize, [f32; 4])> = Vec::with_capacity(inputs.len());
        for i in f.lanes() {
            texels.clear();
            texels.extend(inputs.iter().map(|(unit, c, lods)| {
                let at = [c.at[0][i], c.at[1][i], c.at[2][i]];
                (unit.number, unit.texture.sample(at, c.reference[i], lods[i]))
            }));
            let color = self.colored(f, i, &texels);
            (0..4).for_each(|k| out[k][i] = color[k]);
        }
    }

    fn colored(&self, f: &Fragments<'_>, i: usize, texels: &[(usize, [f32; 4])]) -> [f32; 4] {
        let varying = |k: usize| f.varyings.get(k).map_or(0.0, |plane| plane[i]);
        let primary = clamped([0, 1, 2, 3].map(varying));
        let mut color = primary;
        for (unit, (_, texel)) in self.units.iter().zip(texels) {
            let sources = Sources { primary, previous: color, texel: *texel, texels };
            color = env::apply(&unit.env, unit.texture.base, &sources);
        }
        if let Some(first) = self.secondary {
            (0..3).for_each(|k| color[k] = (color[k] + varying(first + k).clamped()).clamped());
        }
        if let Some(fog) = &self.fog {
            color = fog.mixed(color, fog.factor(varying(fog.coord)));
        }
        color
    }
}
