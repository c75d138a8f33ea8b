//! The lighting of vertices in RGBA mode (OpenGL 1.5, section 2.13.1).

use crate::state::{Cap, LIGHTS, Light, Material};
use crate::vertex::clamp01;
use crate::{Context, Enum, gl};
use senca_math::glam::{Vec3, Vec4, Vec4Swizzles};
use senca_raster::SimdLevel;

/// A lit vertex; both colours are clamped to [0, 1].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lit {
    pub(crate) color: [f32; 4],
    pub(crate) secondary: [f32; 3],
}

/// A light that is on, with what does not change from vertex to vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightSource {
    pub(crate) light: Light,
    /// Towards the light, when it is infinitely far.
    pub(crate) direction: Option<Vec3>,
    /// Half-way between light and viewer, when both are infinitely far.
    pub(crate) half: Option<Vec3>,
    pub(crate) position: Vec3,
    pub(crate) spot_direction: Vec3,
    /// -1 for none.
    pub(crate) spot_cosine: f32,
    pub(crate) attenuates: bool,
}

impl LightSource {
    fn new(light: Light, local_viewer: bool) -> Self {
        let p = Vec4::from(light.position);
        let direction = (p.w == 0.0).then(|| p.xyz().normalize_or_zero());
        let half = direction.filter(|_| !local_viewer).map(|d| (d + Vec3::Z).normalize_or_zero());
        Self {
            light,
            direction,
            half,
            position: if p.w == 0.0 { Vec3::ZERO } else { p.xyz() / p.w },
            spot_direction: Vec3::from(light.spot_direction).normalize_or_zero(),
            spot_cosine: if light.spot_cutoff == 180.0 { -1.0 } else { light.spot_cutoff.to_radians().cos() },
            attenuates: light.attenuation != [1.0, 0.0, 0.0],
        }
    }
}

/// How vertices are lit, worked out of the state once.
#[derive(Clone, Debug)]
pub(crate) struct LightPlan {
    pub(crate) sources: Vec<LightSource>,
    pub(crate) ambient: Vec3,
    pub(crate) local_viewer: bool,
    pub(crate) separate: bool,
    pub(crate) materials: [Material; 2],
    /// What the colour of a vertex replaces, of front and back.
    pub(crate) color_material: [Option<Enum>; 2],
    /// Vector instructions vertices are lit with.
    pub(crate) level: SimdLevel,
}

impl LightPlan {
    pub(crate) fn new(context: &Context) -> Self {
        let (s, l) = (&context.state, &context.state.lighting);
        let tracked = |side: Enum| {
            let face = l.color_material_face;
            let on = s.enabled.has(Cap::ColorMaterial) && (face == side || face == gl::FRONT_AND_BACK);
            on.then_some(l.color_material_mode)
        };
        let on = (0..LIGHTS).filter(|&k| s.enabled.has_nth(Cap::Light0, k));
        Self {
            sources: on.map(|k| LightSource::new(l.lights[k], l.local_viewer)).collect(),
            ambient: Vec4::from(l.model_ambient).xyz(),
            local_viewer: l.local_viewer,
            separate: l.color_control == gl::SEPARATE_SPECULAR_COLOR,
            materials: l.materials,
            color_material: [tracked(gl::FRONT), tracked(gl::BACK)],
            level: SimdLevel::new(),
        }
    }

    /// Whether the colour of a vertex matters.
    pub(crate) fn color_material(&self) -> bool {
        self.color_material.iter().any(Option::is_some)
    }

    /// The colours of a vertex at `eye`, with normal and colour, of the front (0) or back (1): the plain form of
    /// [`Self::light_lanes`].
    pub(crate) fn light(&self, eye: Vec4, normal: Vec3, color: [f32; 4], side: usize) -> Lit {
        let mut material = self.materials[side];
        if let Some(mode) = self.color_material[side] {
            material.track(mode, color);
        }
        let rgb = |c: [f32; 4]| Vec4::from(c).xyz();
        let (ambient, diffuse, specular) =
            (rgb(material.ambient), rgb(material.diffuse), rgb(material.specular));
        let mut primary = rgb(material.emission) + ambient * self.ambient;
        let mut shine = Vec3::ZERO;
        let at = eye.xyz() / eye.w;
        for source in &self.sources {
            let (towards, attenuation) = source.towards(at);
            let strength = attenuation * source.spot(towards);
            if strength == 0.0 {
                continue;
            }
            let light = &source.light;
            let cosine = normal.dot(towards).max(0.0);
            primary += strength * (ambient * rgb(light.ambient) + cosine * diffuse * rgb(light.diffuse));
            if cosine > 0.0 {
                let half = source.half.unwrap_or_else(|| {
                    let viewer = if self.local_viewer { (-at).normalize_or_zero() } else { Vec3::Z };
                    (towards + viewer).normalize_or_zero()
                });
                let factor = power(normal.dot(half).max(0.0), material.shininess);
                shine += strength * factor * specular * rgb(light.specular);
            }
        }
        let alpha = clamp01(material.diffuse[3]);
        if !self.separate {
            primary += shine;
            shine = Vec3::ZERO;
        }
        let p = primary.to_array().map(clamp01);
        Lit { color: [p[0], p[1], p[2], alpha], secondary: shine.to_array().map(clamp01) }
    }
}

impl LightSource {
    /// Direction from a point to the light, and how much of the light is left there.
    #[inline]
    fn towards(&self, at: Vec3) -> (Vec3, f32) {
        if let Some(direction) = self.direction {
            return (direction, 1.0);
        }
        let way = self.position - at;
        let distance = way.length();
        let towards = if distance > 0.0 { way / distance } else { Vec3::ZERO };
        if !self.attenuates {
            return (towards, 1.0);
        }
        let [a, b, c] = self.light.attenuation;
        (towards, 1.0 / (a + b * distance + c * distance * distance))
    }

    /// The spot's part of the light that leaves against `towards`.
    #[inline]
    fn spot(&self, towards: Vec3) -> f32 {
        if self.light.spot_cutoff == 180.0 {
            return 1.0;
        }
        let cosine = (-towards).dot(self.spot_direction);
        if cosine < self.spot_cosine { 0.0 } else { power(cosine.max(0.0), self.light.spot_exponent) }
    }
}

/// `base` to the `exponent`, where 0 to the 0 is 1; finite, so that nothing times it is nothing.
#[inline]
fn power(base: f32, exponent: f32) -> f32 {
    if exponent == 0.0 { 1.0 } else { base.powf(exponent).min(f32::MAX) }
}

/// Whether `part` of a material is what `mode` of colour material replaces.
pub(crate) fn tracks(mode: Enum, part: Enum) -> bool {
    mode == part || (mode == gl::AMBIENT_AND_DIFFUSE && (part == gl::AMBIENT || part == gl::DIFFUSE))
}

impl Material {
    /// Puts a colour where `mode` says.
    pub(crate) fn track(&mut self, mode: Enum, color: [f32; 4]) {
        let parts = [
            (gl::AMBIENT, &mut self.ambient),
            (gl::DIFFUSE, &mut self.diffuse),
            (gl::SPECULAR, &mut self.specular),
            (gl::EMISSION, &mut self.emission),
        ];
        parts.into_iter().filter(|(part, _)| tracks(mode, *part)).for_each(|(_, to)| *to = color);
    }
}

impl Context {
    /// Puts the current colour into the materials that track it. They do so at all times, but are only
    /// written when somebody could see that.
    pub(crate) fn settle_color_material(&mut self) {
        if !self.state.enabled.has(Cap::ColorMaterial) {
            return;
        }
        let (color, l) = (self.state.current.color, &mut self.state.lighting);
        for (side, face) in [gl::FRONT, gl::BACK].into_iter().enumerate() {
            if l.color_material_face == face || l.color_material_face == gl::FRONT_AND_BACK {
                l.materials[side].track(l.color_material_mode, color);
            }
        }
    }
}
