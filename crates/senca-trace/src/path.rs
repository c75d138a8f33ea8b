//! Path tracing: the picture that light itself would make (Kajiya 1986).
//!
//! A path starts at the eye and is sent on at each surface into one direction, chosen about as often
//! as light comes from there. What it meets that shines is added, and at every surface that scatters
//! light one lamp is asked directly. The mean over many paths is the picture; it has noise that halves
//! with four times the paths, and no other error but these:
//!
//! - Paths end after [`PathSettings::max_bounces`]. Long ones end by chance, in proportion to what
//!   they still carry, and the survivors carry more (Russian roulette), which costs no accuracy.
//! - Where a lamp without extent, a mirror or a clear body on the way, and a matt surface come together
//!   (the bright spot below a glass ball under a point light) no path can find the lamp: such spots
//!   are missing. Under lights with an extent they are there.
//!
//! A direction can be found by asking the lights and by following the surface. Both ways count, each
//! weighted by how likely it was to find it (Veach and Guibas 1995, power heuristic), so that small
//! lamps on rough surfaces and large ones in mirrors are both smooth.
//!
//! # Light and units
//!
//! As everywhere in Senca a lamp of intensity 1 makes a white matt surface facing it show 1, that is,
//! it has the irradiance pi. Emission and backgrounds are radiances, shown as they are.
//!
//! | what | how it lights |
//! |---|---|
//! | point, spot, parallel, box | as in the other renderers |
//! | area | radiance `pi color / area` to one side, see below; rays meet it |
//! | `emission` | on the outside, on both sides of double-sided surfaces |
//! | background colour, gradient, environment | from all around |
//! | ambient light | not at all: it stands for what surfaces send each other, and that is found here |
//!
//! An area light sends a surface at distance d the share `fatt(d)` of its intensity in every renderer.
//! Its radiance is therefore `pi color / area d^2 fatt(d)`, which for light that falls with the square
//! of the distance is what it says, and for light that does not is brighter the farther it is seen from.
//!
//! # Materials
//!
//! See the module of the scattering functions: matt and glossy parts keep energy, k_r and k_t are
//! perfect mirrors and smooth borders by the same rules as in the recursive tracer, rough glass is
//! metallic-roughness with a transmission. Where a surface shows its back and its material is not
//! double-sided, rays from the eye go through it as in the other renderers; to light it is there.

mod area;
mod bsdf;
mod distribution;
mod glow;
mod lights;
mod settings;
mod sky;
mod tracer;
mod warp;

#[cfg(test)]
mod cornell;
#[cfg(test)]
mod tests;

pub use settings::PathSettings;
pub use tracer::{PathTracer, PathWork};
