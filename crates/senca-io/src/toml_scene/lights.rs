//! Lights, attenuation, fog, background.

use senca_math::LinearRgb;
use senca_scene::{
    Attenuation, Background, ColorSpace, Fog, FogFalloff, Light, LightId, LightKind, Node, SpotFalloff,
};

use super::builder::{Builder, Part};
use super::source::{Result, Table};
use super::transforms::read_frame;
use super::values::Value;

#[derive(Clone, Copy)]
enum Kind {
    Ambient,
    Point,
    Parallel,
    Spot,
    Box,
    Area,
}

const KINDS: [(&str, Kind); 6] = [
    ("ambient", Kind::Ambient),
    ("point", Kind::Point),
    ("parallel", Kind::Parallel),
    ("spot", Kind::Spot),
    ("box", Kind::Box),
    ("area", Kind::Area),
];

impl<'a> Builder<'a> {
    /// A light with the node it stands at.
    pub(super) fn light(&mut self, mut table: Table<'a>) -> Result<Part> {
        let name = table.read_or("name", "", Value::string)?.to_owned();
        let kind = table.require("kind")?.choice(&KINDS)?;
        table.set_what(what(kind));
        let color = table.read_or("color", LinearRgb::WHITE, Value::color)?;
        let intensity = table.read_or("intensity", 1.0, Value::not_negative)? as f32;
        let attenuation = match kind {
            Kind::Ambient => Attenuation::None,
            _ => table.read_or("attenuation", self.attenuation, attenuation)?,
        };
        let transform = match kind {
            Kind::Ambient => Default::default(),
            Kind::Point => super::transforms::translation(table.require("position")?.vec3()?),
            _ => {
                require_direction(&mut table)?;
                read_frame(&mut table, "position")?
            }
        };
        let kind = light_kind(&mut table, kind)?;
        table.finish()?;
        self.scene.lights.push(Light { name: name.clone(), color: color * intensity, attenuation, kind });
        let light = Some(LightId(self.scene.lights.len() as u32 - 1));
        Ok(Part::of(Node { name, transform, light, ..Node::default() }))
    }
}

fn what(kind: Kind) -> &'static str {
    match kind {
        Kind::Ambient => "the ambient light",
        Kind::Point => "the point light",
        Kind::Parallel => "the parallel light",
        Kind::Spot => "the spot light",
        Kind::Box => "the box light",
        Kind::Area => "the area light",
    }
}

/// A light that shines one way must say which.
fn require_direction(table: &mut Table<'_>) -> Result<()> {
    if table.first_of(&["direction", "target"]).is_some() {
        return Ok(());
    }
    table.require("direction").map(|_| ()).map_err(|error| match table.first_of(&["position"]) {
        Some(_) => table.error(format!("{} needs \"direction\" or \"target\"", table.what())),
        None => error,
    })
}

fn light_kind(table: &mut Table<'_>, kind: Kind) -> Result<LightKind> {
    Ok(match kind {
        Kind::Ambient => LightKind::Ambient,
        Kind::Point => LightKind::Point,
        Kind::Parallel => LightKind::Parallel,
        Kind::Spot => LightKind::Spot(spot_falloff(table)?),
        Kind::Box => {
            // The text's reflector has its x axis along UP x DIR, a node along DIR x UP.
            let [x, y] = [limits(table, "x")?, limits(table, "y")?];
            let depth = table.require("depth")?.positive()?;
            LightKind::BoxSpot { min: [-x[1], y[0]], max: [-x[0], y[1]], depth }
        }
        Kind::Area => {
            let value = table.require("size")?;
            let size = if value.is_list() {
                value.array("one edge length or two", Value::positive)?
            } else {
                [value.positive()?; 2]
            };
            let visible = table.read_or("visible", true, Value::boolean)?;
            LightKind::Area { size, visible }
        }
    })
}

/// `[min, max]`, in order.
fn limits(table: &mut Table<'_>, key: &'static str) -> Result<[f64; 2]> {
    let value = table.require(key)?;
    let limits: [f64; 2] = value.array("two numbers: smallest and largest", Value::number)?;
    if limits[0] < limits[1] { Ok(limits) } else { Err(value.refuse("must have its smaller limit first")) }
}

/// `angle` (sharp), `exponent` (cosine), or `inner` and `outer` (smooth); half angles in degrees.
fn spot_falloff(table: &mut Table<'_>) -> Result<SpotFalloff> {
    let smooth = table.first_of(&["inner", "outer"]).is_some();
    let given = [table.has("angle"), table.has("exponent"), smooth];
    if given.into_iter().filter(|&given| given).count() != 1 {
        return Err(table.error(
            "a spot light needs one of: \"angle\" (sharp edge), \"exponent\" (cosine), \
             or \"inner\" and \"outer\" (smooth edge)",
        ));
    }
    if let Some(angle) = table.read("angle", |value| value.angle(0.0, 180.0))? {
        return Ok(SpotFalloff::Sharp { angle });
    }
    if let Some(exponent) = table.read("exponent", Value::not_negative)? {
        return Ok(SpotFalloff::Cosine { exponent });
    }
    let outer = table.require("outer")?.angle(0.0, 90.0)?;
    let Some(value) = table.get("inner") else { return Ok(SpotFalloff::Smooth { inner: 0.0, outer }) };
    let inner = value.within(0.0, 90.0)?.to_radians();
    if inner < outer {
        Ok(SpotFalloff::Smooth { inner, outer })
    } else {
        Err(value.refuse("must be below \"outer\""))
    }
}

/// `"none"`, `"inverse-square"`, `[c0, c1, c2]`, or a table of `constant`, `linear`, `quadratic`, or
/// of `range`.
pub(super) fn attenuation(value: Value<'_>) -> Result<Attenuation> {
    if value.is_list() {
        let [constant, linear, quadratic] = value.array("three numbers: c0, c1, c2", Value::not_negative)?;
        return polynomial(value, constant, linear, quadratic);
    }
    if !value.is_table() {
        let words =
            [("none", Attenuation::None), ("inverse-square", Attenuation::InverseSquare { range: None })];
        return value.choice(&words);
    }
    let mut table = value.table("the attenuation")?;
    let range = table.read("range", Value::positive)?;
    if range.is_some() {
        table.finish()?;
        return Ok(Attenuation::InverseSquare { range });
    }
    let constant = table.read_or("constant", 0.0, Value::not_negative)?;
    let linear = table.read_or("linear", 0.0, Value::not_negative)?;
    let quadratic = table.read_or("quadratic", 0.0, Value::not_negative)?;
    table.finish()?;
    polynomial(value, constant, linear, quadratic)
}

fn polynomial(value: Value<'_>, constant: f64, linear: f64, quadratic: f64) -> Result<Attenuation> {
    if constant == 0.0 && linear == 0.0 && quadratic == 0.0 {
        return Err(value.refuse("needs one constant above 0; for no fall-off write \"none\""));
    }
    Ok(Attenuation::Polynomial { constant, linear, quadratic })
}

/// `[fog]`: `color`, and either `start`, `end`, `min_share`, or `density` with `falloff`.
pub(super) fn fog(value: Value<'_>) -> Result<Fog> {
    let mut table = value.table("the fog")?;
    let color = table.require("color")?.color()?;
    let falloff = if table.has("density") {
        let density = table.require("density")?.not_negative()?;
        let words = [("exponential", false), ("exponential-squared", true)];
        match table.read_or("falloff", false, |value| value.choice(&words))? {
            false => FogFalloff::Exponential { density },
            true => FogFalloff::ExponentialSquared { density },
        }
    } else {
        let start = table.read_or("start", 0.0, Value::not_negative)?;
        let end_value = table.require("end")?;
        let end = end_value.positive()?;
        if end <= start {
            return Err(
                end_value.refuse(format_args!("must be greater than \"start\", {start}, but is {end}"))
            );
        }
        FogFalloff::Linear { start, end, min_share: table.read_or("min_share", 0.0, Value::share)? }
    };
    table.finish()?;
    Ok(Fog { color, falloff })
}

/// A colour, or `{ bottom, top }`, or `{ environment, strength, rotation }`.
pub(super) fn background<'a>(value: Value<'a>, builder: &mut Builder<'a>) -> Result<Background> {
    if !value.is_table() {
        return value.color().map(Background::Color);
    }
    let mut table = value.table("the background")?;
    if let Some(file) = table.get("environment") {
        let image = builder.image_file(file, ColorSpace::Srgb)?;
        let strength = table.read_or("strength", 1.0, Value::not_negative)? as f32;
        let rotation = table.read_or("rotation", 0.0, Value::number)?.to_radians() as f32;
        table.finish()?;
        return Ok(Background::Environment { image, strength, rotation });
    }
    let bottom = table.require("bottom")?.color()?;
    let top = table.require("top")?.color()?;
    table.finish()?;
    Ok(Background::Gradient { bottom, top })
}
