//! How a surface scatters light: value, density and choice of directions.
//!
//! A [`Bsdf`] is made at a hit for one direction to the viewer. It is a sum of
//!
//! - a matt part, `Od / pi` (Lambert 1760);
//! - a gloss: a Phong lobe made to keep energy and to be reciprocal, `Os (n + 2) / (2 pi) cos^n(alpha)`
//!   (Lafortune and Willems 1994), or GGX facets as [`senca_shading::metallic_roughness_brdf`] has them,
//!   which may let light through (Walter et al. 2007);
//! - a perfect mirror and a smooth border of two media, which know single directions only.
//!
//! Matt part, gloss and single directions together never send out more than came in: where the
//! coefficients of a Phong material add up to more than 1 they are scaled down together.
//!
//! Radiance is what paths carry: light that crosses into a medium of index n gathers there by n^2
//! (and is spread again when it leaves), so weights of transmitted directions have that factor.
//!
//! Which side a direction is on is for the surface itself to say, not for its interpolated or mapped
//! normal: no light leaks through (Veach 1997, section 5.3.2).

use senca_math::LinearRgb;
use senca_math::glam::DVec3;
use std::f64::consts::{FRAC_1_PI, TAU};

use super::warp;
use crate::fresnel::{dielectric, mirrored, refracted};
use crate::{MaterialPoint, ReflectionPoint};

/// Smallest width of facets; as in the other renderers.
const LEAST_ALPHA: f64 = 1e-3;

/// Smallest cosine between the shading normal and the viewer; normals are bent to have it.
const LEAST_COSINE: f64 = 1e-4;

/// What the surface lies between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Border {
    /// Index of refraction beyond the surface over that on the viewer's side.
    pub(super) eta: f64,
    /// Whether there is no body beyond it, but the same medium again: light goes straight on.
    pub(super) thin: bool,
}

impl Border {
    /// Share that a smooth border reflects at this cosine, and the cosine of the way on, 0 at total
    /// reflection. Light goes to and fro between the two faces of a thin pane.
    fn reflectance(&self, cos: f64) -> (f64, f64) {
        if self.thin {
            let (face, _) = dielectric(cos, self.eta.max(1.0 / self.eta));
            (2.0 * face / (1.0 + face), cos)
        } else {
            dielectric(cos, self.eta)
        }
    }

    /// Factor on the radiance of light that comes from beyond.
    fn gathered(&self) -> f64 {
        if self.thin { 1.0 } else { 1.0 / (self.eta * self.eta) }
    }

    /// Direction beyond in which `w` goes on, about `normal` on the side of `w`.
    fn beyond(&self, w: DVec3, normal: DVec3, cos_beyond: f64) -> DVec3 {
        if self.thin { -w } else { refracted(w, normal, self.eta, cos_beyond) }
    }
}

/// Scattering at one place, seen from one direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bsdf {
    /// World from local: columns are two tangents and the shading normal.
    axes: [DVec3; 3],
    /// Normal of the surface itself, on the viewer's side.
    side: DVec3,
    /// Unit direction to the viewer, local, z > 0.
    view: DVec3,
    border: Border,
    diffuse: LinearRgb,
    gloss: Gloss,
    /// Share of light from the mirrored direction.
    mirror: LinearRgb,
    /// Share of light from the refracted direction.
    through: LinearRgb,
    /// Chance of each part, in the order of [`Part`]; they add up to 1 unless all is black.
    chances: [f64; 4],
}

#[derive(Clone, Copy, Debug)]
enum Gloss {
    None,
    Phong { specular: LinearRgb, exponent: f64 },
    Facets(Facets),
}

/// A field of GGX facets.
#[derive(Clone, Copy, Debug)]
struct Facets {
    alpha: f64,
    /// Reflectance of the metal at right angles, and its share.
    metal: LinearRgb,
    metallic: f32,
    /// Whether the dielectric share reflects by the exact law at the border (bodies that let
    /// light through), or by Schlick's approximation of it at 1.5.
    exact: bool,
    /// What is let through of what is not reflected.
    transmit: LinearRgb,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    Diffuse,
    Gloss,
    Mirror,
    Through,
}

const PARTS: [Part; 4] = [Part::Diffuse, Part::Gloss, Part::Mirror, Part::Through];

/// What a direction is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scatter {
    /// Value times the cosine of the direction.
    pub(super) value: LinearRgb,
    /// Density, per steradian, with which [`Bsdf::sample`] takes it; single directions aside.
    pub(super) pdf: f64,
}

/// A direction that was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chosen {
    /// Unit, world.
    pub(super) direction: DVec3,
    /// Value times cosine over density.
    pub(super) weight: LinearRgb,
    /// Its density; `None` for single directions.
    pub(super) pdf: Option<f64>,
    /// Whether it is beyond the surface.
    pub(super) through: bool,
    /// Factor of `weight` that comes from the change of medium.
    pub(super) gathered: f64,
}

const NOTHING: Scatter = Scatter { value: LinearRgb::BLACK, pdf: 0.0 };

impl Bsdf {
    /// Of a material's point seen along `to_viewer` (unit, world). `side` is the surface's own unit
    /// normal on the viewer's side.
    pub(super) fn new(point: &MaterialPoint, side: DVec3, to_viewer: DVec3, border: Border) -> Self {
        let normal = facing(point.normal.as_dvec3().normalize_or(side), to_viewer, side);
        let (x, y) = normal.any_orthonormal_pair();
        let view = DVec3::new(x.dot(to_viewer), y.dot(to_viewer), normal.dot(to_viewer));
        let mut bsdf = Self {
            axes: [x, y, normal],
            side,
            view,
            border,
            diffuse: LinearRgb::BLACK,
            gloss: Gloss::None,
            mirror: LinearRgb::BLACK,
            through: LinearRgb::BLACK,
            chances: [0.0; 4],
        };
        match &point.reflection {
            ReflectionPoint::Phong(constants) => {
                let (specular, exponent) = (constants.specular, f64::from(constants.exponent.max(0.0)));
                bsdf.set_borders(point);
                bsdf.diffuse = constants.diffuse;
                if specular != LinearRgb::BLACK {
                    bsdf.gloss = Gloss::Phong { specular, exponent };
                }
                bsdf.keep_energy();
            }
            ReflectionPoint::MetallicRoughness { base_color, metallic, roughness } => {
                bsdf.set_metallic_roughness(point, *base_color, *metallic, *roughness);
            }
            ReflectionPoint::Unlit(_) => {}
        }
        bsdf.weigh_parts();
        bsdf
    }

    /// Mirror and border with constant shares, or by Fresnel's law where the material says so. What
    /// cannot be refracted is reflected.
    fn set_borders(&mut self, point: &MaterialPoint) {
        if point.mirror == LinearRgb::BLACK && !point.transmits() {
            return;
        }
        let (reflected, cos_beyond) = self.border.reflectance(self.view.z);
        if cos_beyond <= 0.0 && point.transmits() {
            self.mirror = (point.mirror + point.transmission).map(|k| k.min(1.0));
            return;
        }
        let (r, t) = if point.fresnel { (reflected as f32, 1.0 - reflected as f32) } else { (1.0, 1.0) };
        self.mirror = point.mirror * r;
        self.through = point.transmission * t;
    }

    fn set_metallic_roughness(
        &mut self,
        point: &MaterialPoint,
        base: LinearRgb,
        metallic: f32,
        roughness: f32,
    ) {
        let (metallic, base) = (metallic.clamp(0.0, 1.0), base.map(|c| c.clamp(0.0, 1.0)));
        let matt = base * (1.0 - metallic);
        let transmit = min(point.transmission, matt);
        let clear = point.transmits();
        let alpha = f64::from(roughness * roughness);
        let facets = Facets { alpha: alpha.max(LEAST_ALPHA), metal: base, metallic, exact: clear, transmit };
        self.diffuse = matt - transmit;
        self.gloss = Gloss::Facets(facets);
        if clear && alpha < LEAST_ALPHA {
            // A polished body: its border is smooth. The metal's share is a mirror too.
            self.gloss = Gloss::None;
            let (reflectance, rest) = facets.reflectance(self.view.z, &self.border);
            self.mirror = reflectance;
            self.through = transmit * rest;
            self.diffuse *= rest;
        }
        if point.mirror != LinearRgb::BLACK {
            // A lacquer on top: it takes what it reflects from what is below.
            let share = if point.fresnel { self.border.reflectance(self.view.z).0 as f32 } else { 1.0 };
            let lacquer = point.mirror * share;
            let below = lacquer.map(|c| (1.0 - c).max(0.0));
            self.dim(below);
            self.mirror += lacquer;
        }
    }

    /// Multiplies all parts.
    fn dim(&mut self, factor: LinearRgb) {
        self.diffuse = self.diffuse * factor;
        self.mirror = self.mirror * factor;
        self.through = self.through * factor;
        match &mut self.gloss {
            Gloss::None => {}
            Gloss::Phong { specular, .. } => *specular = *specular * factor,
            Gloss::Facets(facets) => {
                facets.metal = facets.metal * factor;
                facets.transmit = facets.transmit * factor;
            }
        }
    }

    /// Scales coefficients that add up to more than 1 in any channel.
    fn keep_energy(&mut self) {
        let specular =
            if let Gloss::Phong { specular, .. } = self.gloss { specular } else { LinearRgb::BLACK };
        let most = (self.diffuse + specular + self.mirror + self.through).max_component();
        if most > 1.0 {
            self.dim(LinearRgb::splat(1.0 / most));
        }
    }

    fn weigh_parts(&mut self) {
        let gloss = match &self.gloss {
            Gloss::None => 0.0,
            Gloss::Phong { specular, .. } => mean(*specular),
            Gloss::Facets(facets) => {
                let (reflectance, rest) = facets.reflectance(self.view.z, &self.border);
                mean(reflectance) + mean(facets.transmit) * f64::from(rest)
            }
        };
        let weights = [mean(self.diffuse), gloss, mean(self.mirror), mean(self.through)];
        let sum: f64 = weights.iter().sum();
        if sum > 0.0 {
            self.chances = weights.map(|w| w / sum);
        }
    }

    /// Whether the surface scatters into more than single directions, so that lights can be asked.
    pub(super) fn scatters(&self) -> bool {
        self.chances[0] + self.chances[1] > 0.0
    }

    fn local(&self, w: DVec3) -> DVec3 {
        DVec3::new(self.axes[0].dot(w), self.axes[1].dot(w), self.axes[2].dot(w))
    }

    fn world(&self, w: DVec3) -> DVec3 {
        self.axes[0] * w.x + self.axes[1] * w.y + self.axes[2] * w.z
    }

    /// Value and density of light from `direction` (unit, world), single directions aside.
    pub(super) fn eval(&self, direction: DVec3) -> Scatter {
        let light = self.local(direction);
        let outside = self.side.dot(direction);
        if light.z > 0.0 && outside > 0.0 {
            self.eval_reflected(light)
        } else if light.z < 0.0 && outside < 0.0 {
            self.eval_through(light)
        } else {
            NOTHING
        }
    }

    fn eval_reflected(&self, light: DVec3) -> Scatter {
        let half = (light + self.view).normalize_or(DVec3::Z);
        let [diffuse_chance, gloss_chance, ..] = self.chances;
        let mut value = self.diffuse * (light.z * FRAC_1_PI) as f32;
        let mut pdf = diffuse_chance * warp::cosine_hemisphere_pdf(light.z);
        match &self.gloss {
            Gloss::None => {}
            Gloss::Phong { specular, exponent } => {
                let cos = mirrored(self.view, DVec3::Z).dot(light).max(0.0);
                let lobe = cos.powf(*exponent) / TAU;
                value += *specular * ((exponent + 2.0) * lobe * light.z) as f32;
                pdf += gloss_chance * (exponent + 1.0) * lobe;
            }
            Gloss::Facets(facets) => {
                let (reflectance, rest) = facets.reflectance(half.dot(self.view), &self.border);
                let (cosine_brdf, visible_pdf) = facets.reflect(self.view, light, half);
                value = value * rest + reflectance * cosine_brdf as f32;
                let share = facets.reflected_share(reflectance, rest);
                pdf += gloss_chance * share * visible_pdf;
            }
        }
        Scatter { value, pdf }
    }

    fn eval_through(&self, light: DVec3) -> Scatter {
        let Gloss::Facets(facets) = &self.gloss else { return NOTHING };
        if facets.transmit == LinearRgb::BLACK {
            return NOTHING;
        }
        if self.border.thin {
            return self.eval_through_pane(facets, light);
        }
        let eta = self.border.eta;
        let half = (self.view + light * eta).normalize_or(DVec3::Z);
        let half = if half.z < 0.0 { -half } else { half };
        let (v_h, l_h) = (self.view.dot(half), light.dot(half));
        if v_h <= 0.0 || l_h >= 0.0 {
            return NOTHING;
        }
        let (reflectance, rest) = facets.reflectance(v_h, &self.border);
        let denominator = (v_h + eta * l_h).powi(2);
        let facing = facets.distribution(half) * v_h * -l_h / denominator;
        let (g1, g2) = facets.masking(self.view, light);
        let share = 1.0 - facets.reflected_share(reflectance, rest);
        Scatter {
            value: facets.transmit * rest * (facing * g2 / self.view.z) as f32,
            pdf: self.chances[1] * share * facing * eta * eta * g1 / self.view.z,
        }
    }

    /// Through a thin pane light goes as it would be reflected, but to the other side
    /// (KHR_materials_transmission).
    fn eval_through_pane(&self, facets: &Facets, light: DVec3) -> Scatter {
        let light = DVec3::new(light.x, light.y, -light.z);
        let half = (light + self.view).normalize_or(DVec3::Z);
        let (reflectance, rest) = facets.reflectance(half.dot(self.view), &self.border);
        let (cosine_brdf, visible_pdf) = facets.reflect(self.view, light, half);
        let share = 1.0 - facets.reflected_share(reflectance, rest);
        Scatter {
            value: facets.transmit * rest * cosine_brdf as f32,
            pdf: self.chances[1] * share * visible_pdf,
        }
    }

    /// Chooses a direction. `choice` and `u` are in [0, 1). `None` where all light is swallowed.
    pub(super) fn sample(&self, choice: f64, u: [f64; 2]) -> Option<Chosen> {
        let (part, rest) = self.choose(choice)?;
        let normal = DVec3::Z;
        match part {
            Part::Diffuse => self.chosen(warp::cosine_hemisphere(u)),
            Part::Gloss => self.chosen(self.sample_gloss(rest, u)?),
            Part::Mirror => {
                let direction = self.world(mirrored(self.view, normal));
                self.single(direction, self.mirror * (1.0 / self.chances[2]) as f32, 1.0)
            }
            Part::Through => {
                let (_, cos_beyond) = self.border.reflectance(self.view.z);
                let direction = self.world(self.border.beyond(self.view, normal, cos_beyond));
                let gathered = self.border.gathered();
                self.single(direction, self.through * (gathered / self.chances[3]) as f32, gathered)
            }
        }
    }

    /// The part that `choice` falls to, and what is left of the choice, in [0, 1) again.
    fn choose(&self, mut choice: f64) -> Option<(Part, f64)> {
        let mut last = None;
        for (part, chance) in PARTS.into_iter().zip(self.chances) {
            if chance > 0.0 {
                if choice < chance {
                    return Some((part, choice / chance));
                }
                choice -= chance;
                last = Some((part, 1.0 - f64::EPSILON));
            }
        }
        last // rounding
    }

    /// Local direction from the gloss.
    fn sample_gloss(&self, choice: f64, u: [f64; 2]) -> Option<DVec3> {
        match &self.gloss {
            Gloss::None => None,
            Gloss::Phong { exponent, .. } => {
                let axis = mirrored(self.view, DVec3::Z);
                let (x, y) = axis.any_orthonormal_pair();
                let w = warp::power_lobe(u, *exponent);
                Some(x * w.x + y * w.y + axis * w.z)
            }
            Gloss::Facets(facets) => {
                let half = warp::visible_facet(u, self.view, facets.alpha);
                let v_h = self.view.dot(half);
                let (reflectance, rest) = facets.reflectance(v_h, &self.border);
                let reflected = Some(mirrored(self.view, half)).filter(|light| light.z > 0.0);
                if choice < facets.reflected_share(reflectance, rest) {
                    return reflected;
                }
                if self.border.thin {
                    return reflected.map(|light| DVec3::new(light.x, light.y, -light.z));
                }
                let (_, cos_beyond) = self.border.reflectance(v_h);
                let through = self.border.beyond(self.view, half, cos_beyond);
                Some(through).filter(|light| light.z < 0.0)
            }
        }
    }

    /// The direction with its weight, `None` where it is worth nothing.
    fn chosen(&self, light: DVec3) -> Option<Chosen> {
        let direction = self.world(light).normalize_or_zero();
        let Scatter { value, pdf } = self.eval(direction);
        let worth = pdf > 0.0 && value != LinearRgb::BLACK;
        let through = light.z < 0.0;
        let gathered = if through { self.border.gathered() } else { 1.0 };
        let weight = value * (1.0 / pdf) as f32;
        worth.then_some(Chosen { direction, weight, pdf: Some(pdf), through, gathered })
    }

    /// A single direction, `None` where the surface itself says it is on the other side.
    fn single(&self, direction: DVec3, weight: LinearRgb, gathered: f64) -> Option<Chosen> {
        let through = self.local(direction).z < 0.0;
        let fits = (self.side.dot(direction) < 0.0) == through;
        fits.then_some(Chosen { direction: direction.normalize(), weight, pdf: None, through, gathered })
    }
}

impl Facets {
    /// Reflectance at the cosine `v_h` between a facet and the viewer, and the share that the
    /// dielectric does not reflect.
    fn reflectance(&self, v_h: f64, between: &Border) -> (LinearRgb, f32) {
        let c = (1.0 - v_h).clamp(0.0, 1.0);
        let c5 = (c * c * c * c * c) as f32;
        let border =
            if self.exact { between.reflectance(v_h.clamp(0.0, 1.0)).0 as f32 } else { 0.04 + 0.96 * c5 };
        let metal = self.metal * (1.0 - c5) + LinearRgb::splat(c5);
        (metal * self.metallic + LinearRgb::splat(border * (1.0 - self.metallic)), 1.0 - border)
    }

    /// Chance of a reflection where both are possible.
    fn reflected_share(&self, reflectance: LinearRgb, rest: f32) -> f64 {
        let (r, t) = (mean(reflectance), mean(self.transmit) * f64::from(rest));
        if t > 0.0 { r / (r + t) } else { 1.0 }
    }

    /// D(h), see [`senca_shading::ggx_distribution`]; in the local frame the square of the sine needs
    /// no difference.
    fn distribution(&self, half: DVec3) -> f64 {
        let a2 = self.alpha * self.alpha;
        let d = half.x * half.x + half.y * half.y + half.z * half.z * a2;
        a2 * FRAC_1_PI / (d * d)
    }

    /// Smith's G1 of the viewer and height-correlated G2 (Heitz 2014).
    fn masking(&self, view: DVec3, light: DVec3) -> (f64, f64) {
        let (v, l) = (self.lambda(view), self.lambda(light));
        (1.0 / (1.0 + v), 1.0 / (1.0 + v + l))
    }

    fn lambda(&self, w: DVec3) -> f64 {
        let tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
        0.5 * ((1.0 + self.alpha * self.alpha * tan2).sqrt() - 1.0)
    }

    /// `G2 D / (4 view.z)`, the BRDF times the light's cosine without Fresnel, and the density of the
    /// mirrored visible facets.
    fn reflect(&self, view: DVec3, light: DVec3, half: DVec3) -> (f64, f64) {
        let d = self.distribution(half) / (4.0 * view.z);
        let (g1, g2) = self.masking(view, light);
        (d * g2, d * g1)
    }
}

/// The shading normal, bent towards the viewer where it faces away; the surface's own normal where
/// that does not help.
fn facing(normal: DVec3, to_viewer: DVec3, side: DVec3) -> DVec3 {
    let cos = normal.dot(to_viewer);
    if cos >= LEAST_COSINE {
        return normal;
    }
    let bent = (normal + to_viewer * (LEAST_COSINE * 1.01 - cos)).normalize_or(side);
    if bent.dot(to_viewer) > 0.0 { bent } else { to_viewer }
}

fn mean(c: LinearRgb) -> f64 {
    f64::from(c.r + c.g + c.b) / 3.0
}

fn min(a: LinearRgb, b: LinearRgb) -> LinearRgb {
    LinearRgb::new(a.r.min(b.r), a.g.min(b.g), a.b.min(b.b))
}

#[cfg(test)]
mod tests;
