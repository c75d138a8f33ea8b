//! From a scene and a caller's wishes to what a renderer takes: a scene in its pose, with light, and
//! a view.

use std::borrow::Cow;

use senca_math::glam::DVec3;
use senca_math::{View, ViewError, world_from_look_at};
use senca_pipeline::Channel;
use senca_scene::{
    AnimationId, Background, Camera, DEFAULT_YFOV, MaterialId, PlacedCamera, Projection, Scene, Shape,
    frame_bounds,
};

use crate::lamps::{bounds_of_lamps, show_lamps};
use crate::traced::{CameraOptics, optics_of};
use crate::{Error, LookAt, Method, Moment, Settings, Viewpoint};

/// The box that pictures without a size fit into, in pixels.
const DEFAULT_SIZE: [u32; 2] = [1024, 768];

/// What a renderer takes.
#[derive(Clone, Debug)]
pub struct Prepared<'s> {
    /// The scene in its pose, with light; borrowed when nothing had to be changed.
    pub scene: Cow<'s, Scene>,
    /// Where it is seen from.
    pub view: View,
    /// Width and height of the whole picture in pixels.
    pub size: [u32; 2],
    /// What the camera has beyond its view.
    pub camera: CameraOptics,
}

/// Brings the scene into its pose, finds the camera, and adds light where there is none. A scene that
/// is given away is changed in place, a borrowed one is copied when it has to change.
///
/// # Errors
/// [`Error::UnknownCamera`], [`Error::UnknownAnimation`], [`Error::View`].
pub fn prepare<'s>(scene: Cow<'s, Scene>, settings: &Settings) -> Result<Prepared<'s>, Error> {
    let mut scene = posed(scene, settings.moment.as_ref())?;
    let found = camera_of_scene(&scene, &settings.viewpoint)?;
    let size = settings.size.unwrap_or_else(|| default_size(found.as_ref()));
    let aspect = f64::from(size[0].max(1)) / f64::from(size[1].max(1));
    let placed = match (found, &settings.viewpoint, settings.yfov) {
        (Some(placed), _, yfov) => with_yfov(placed, yfov),
        (None, Viewpoint::LookAt(wish), yfov) => camera_of_caller(&scene, wish, yfov, aspect)?,
        (None, _, None) => scene.frame_all(aspect),
        (None, _, yfov) => camera_of_caller(&scene, &LookAt::default(), yfov, aspect)?,
    };
    let bounds = scene.bounds().union(bounds_of_lamps(&scene));
    let view = placed.camera.view(&placed.world_from_camera, aspect, &bounds)?;
    if !is_lit(&scene, settings.method) {
        scene.to_mut().light_by_default(&placed.world_from_camera);
    }
    if shows_lamps(settings) && !bounds_of_lamps(&scene).is_empty() {
        show_lamps(scene.to_mut(), &view);
    }
    Ok(Prepared { scene, view, size, camera: optics_of(&placed.camera) })
}

/// Whether area lights become shining surfaces. Paths meet them as they are, radiosity shows them when
/// light is computed, and lines and numbers have no light.
fn shows_lamps(settings: &Settings) -> bool {
    let lit = !settings.drawing.shading.is_lines() && settings.drawing.channel == Channel::Color;
    match settings.method {
        Method::Raster => lit,
        Method::Trace => true,
        Method::Path | Method::Radiosity => false,
    }
}

/// Whether the scene has light for the method. Paths and radiosity also know what comes from glowing
/// surfaces and from any background, by which nothing else is lit.
fn is_lit(scene: &Scene, method: Method) -> bool {
    let spreads = matches!(method, Method::Path | Method::Radiosity);
    scene.is_lit() || spreads && (shines(scene.background) || glows(scene))
}

/// Whether the background is brighter than black.
fn shines(background: Background) -> bool {
    match background {
        Background::Color(color) => color.max_component() > 0.0,
        Background::Gradient { bottom, top } => bottom.max_component().max(top.max_component()) > 0.0,
        Background::None | Background::Environment { .. } => false,
    }
}

/// Whether a surface that is placed in the world gives off light.
fn glows(scene: &Scene) -> bool {
    let glows =
        |id: MaterialId| scene.materials.get(id.index()).is_some_and(|m| m.emission.max_component() > 0.0);
    scene.instances().into_iter().any(|instance| {
        let geometry = &scene.geometries[instance.geometry.index()];
        let whole = scene.nodes[instance.node.index()].material.or(geometry.material);
        let of_surfaces = match &geometry.shape {
            Shape::Mesh(mesh) => mesh.surfaces.as_slice(),
            _ => &[],
        };
        // What is more, a surface of a mesh may name its own.
        whole.is_some_and(glows) || of_surfaces.iter().filter_map(|s| s.material).any(glows)
    })
}

/// The scene at the moment asked for, or in the pose of its file; meshes bent as their nodes say.
pub(crate) fn posed<'s>(scene: Cow<'s, Scene>, moment: Option<&Moment>) -> Result<Cow<'s, Scene>, Error> {
    let (animation, seconds) = match moment {
        Some(moment) => (animation_of(&scene, moment)?, moment.seconds),
        None => (None, 0.0),
    };
    Ok(match scene {
        Cow::Borrowed(scene) => scene.at_time(animation, seconds),
        Cow::Owned(scene) => {
            let changed = match scene.at_time(animation, seconds) {
                Cow::Borrowed(_) => None,
                Cow::Owned(posed) => Some(posed),
            };
            Cow::Owned(changed.unwrap_or(scene))
        }
    })
}

/// The animation that the moment names, or the first.
fn animation_of(scene: &Scene, moment: &Moment) -> Result<Option<AnimationId>, Error> {
    let Some(name) = &moment.animation else {
        return Ok((!scene.animations.is_empty()).then_some(AnimationId(0)));
    };
    let found = scene.animations.iter().position(|a| a.name == *name);
    let unknown = || Error::UnknownAnimation {
        name: name.clone(),
        known: scene.animations.iter().map(|a| a.name.clone()).collect(),
    };
    found.map(|i| Some(AnimationId(i as u32))).ok_or_else(unknown)
}

/// The camera that the viewpoint names; `None` when the scene has none or the caller has another.
fn camera_of_scene(scene: &Scene, viewpoint: &Viewpoint) -> Result<Option<PlacedCamera>, Error> {
    let cameras = scene.placed_cameras();
    let found = match viewpoint {
        Viewpoint::LookAt(_) => return Ok(None),
        Viewpoint::First => cameras.first(),
        Viewpoint::Camera(name) => {
            let named =
                |c: &&senca_scene::SceneCamera| c.name == *name || scene.nodes[c.node.index()].name == *name;
            let unknown = || Error::UnknownCamera {
                name: name.clone(),
                known: cameras.iter().map(|c| c.name.clone()).collect(),
            };
            Some(cameras.iter().find(named).ok_or_else(unknown)?)
        }
    };
    Ok(found.map(|found| PlacedCamera {
        camera: scene.cameras[found.camera.index()].clone(),
        world_from_camera: found.world_from_camera,
    }))
}

/// The camera with another angle of view, if it is a perspective one.
fn with_yfov(mut placed: PlacedCamera, wish: Option<f64>) -> PlacedCamera {
    if let (Projection::Perspective { yfov, .. }, Some(wish)) = (&mut placed.camera.projection, wish) {
        *yfov = wish;
    }
    placed
}

/// The largest size of the camera's own proportions within [`DEFAULT_SIZE`].
fn default_size(placed: Option<&PlacedCamera>) -> [u32; 2] {
    let [width, height] = DEFAULT_SIZE;
    let Some(aspect) = placed.and_then(|p| p.camera.natural_aspect()) else { return DEFAULT_SIZE };
    let wide = (f64::from(width) / aspect).round().max(1.0);
    let high = (f64::from(height) * aspect).round().max(1.0);
    if wide <= f64::from(height) { [width, wide as u32] } else { [high as u32, height] }
}

/// A camera as the caller wishes it; what is left open is chosen so that the scene is seen whole.
fn camera_of_caller(
    scene: &Scene,
    wish: &LookAt,
    yfov: Option<f64>,
    aspect: f64,
) -> Result<PlacedCamera, Error> {
    let bounds = scene.bounds();
    let target = wish.target.unwrap_or_else(|| bounds.center());
    let yfov = yfov.unwrap_or(DEFAULT_YFOV);
    let eye = wish.eye.unwrap_or_else(|| {
        let framed = frame_bounds(&bounds, aspect).world_from_camera.w_axis.truncate() - bounds.center();
        let nearer = (0.5 * DEFAULT_YFOV).tan() / (0.5 * yfov).tan();
        target + framed * nearer
    });
    let world_from_camera = match (world_from_look_at(eye, target, wish.up.unwrap_or(DVec3::Y)), wish.up) {
        // Straight down or up, and no word on what is up: the back of the scene is, or its front.
        (Err(ViewError::VupParallelToVpn), None) => {
            world_from_look_at(eye, target, DVec3::Z * (target.y - eye.y).signum())?
        }
        (placed, _) => placed?,
    };
    let projection = Projection::Perspective { yfov, aspect: None, near: None, far: None };
    Ok(PlacedCamera { camera: Camera::new("", projection), world_from_camera })
}

/// What is seen behind a scene that says nothing: a quiet grey that grows lighter towards the top,
/// or white paper behind lines.
pub(crate) fn default_background(lines: bool) -> Background {
    use senca_math::LinearRgb;
    if lines {
        return Background::Color(LinearRgb::WHITE);
    }
    Background::Gradient { bottom: LinearRgb::new(0.33, 0.35, 0.38), top: LinearRgb::new(0.72, 0.76, 0.82) }
}
