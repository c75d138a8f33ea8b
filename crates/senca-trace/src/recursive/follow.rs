//! Following the rays of a tree.

use senca_math::LinearRgb;
use senca_math::glam::DVec3;
use senca_shading::fog_share;

use super::media::{Media, Medium};
use super::optics::fresnel_share;
use super::recorder::{Met, Recorder, ShadowRay, Unrecorded, Unsent};
use super::reflector::Reflector;
use super::stream::Desk;
use super::{Backs, Tracer};
use crate::film::{Integrator, SamplePlace};
use crate::material::seen_normal;
use crate::textbook::{reflect, refract};
use crate::{Interaction, MaterialPoint, Pattern, Ray, Sampler, TraceCounts};

/// Rays of one tree at most, so that any depth ends. A mirror box of depth 10^6 stays below.
pub const MAX_RAYS_PER_SAMPLE: u32 = 1 << 20;

/// Rays that wait at most; a tree that branches deeper loses branches.
const MAX_PENDING: usize = 1 << 12;

/// Dimension of the random numbers of the first light at the first hit; those before belong to the
/// camera.
const FIRST_LIGHT_DIMENSION: u32 = 16;

/// Places of an area light at most.
const MAX_PLACES: u32 = 1 << 12;

/// What a ray of a tree is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// From the eye.
    Primary,
    /// Mirrored.
    Reflected,
    /// Through a body.
    Transmitted,
    /// Goes on behind a surface that is there in part only.
    SeenThrough,
}

/// A ray that is still to be followed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pending {
    pub(crate) ray: Ray,
    pub(crate) kind: RayKind,
    /// Nest of the text.
    pub(crate) nest: u32,
    /// Product of the coefficients on the way: the share of what it brings in the picture.
    pub(crate) weight: LinearRgb,
    /// Share of the pixel that only this ray covers; 0 once the way is not straight.
    pub(crate) open: f32,
    pub(crate) media: Media,
    /// Length of the way from the eye to the ray's origin.
    pub(crate) distance: f64,
    /// Number of the ray it comes from.
    pub(crate) parent: u32,
}

/// What a thread needs to follow rays. Keep it from one sample to the next.
#[derive(Debug, Default)]
pub struct Work {
    pending: Vec<Pending>,
    pub(super) desk: Desk,
    /// What it did.
    pub counts: TraceCounts,
}

/// Sum of what the rays of a tree bring, and the share of the pixel that is covered.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    light: LinearRgb,
    alpha: f32,
}

/// Where a tree begins.
#[derive(Clone, Copy, Debug)]
struct Root {
    ray: Ray,
    media: Media,
    /// From the eye to the ray's origin.
    distance: f64,
    /// Row of the picture, where the ray belongs to one.
    row: Option<u32>,
    sampler: Sampler,
}

/// A tree of rays being followed.
struct Tree<'a, R> {
    row: Option<u32>,
    sampler: Sampler,
    work: &'a mut Work,
    recorder: &'a mut R,
    /// Number of the ray being followed.
    number: u32,
    sum: Sum,
}

/// A surface that a ray sees.
pub(super) struct Seen {
    pub(super) t: f64,
    pub(super) at: Interaction,
    pub(super) material: MaterialPoint,
}

/// Rays that a surface sends on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Children {
    pub(super) reflected: Option<Child>,
    pub(super) transmitted: Option<Child>,
}

/// A ray that a surface sends on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Child {
    pub(super) direction: DVec3,
    /// k_r or k_t.
    pub(super) share: LinearRgb,
    pub(super) media: Media,
}

impl Tracer<'_> {
    /// Light that comes to the eye from a place of the picture, times the share of the place that is
    /// covered, and that share.
    #[must_use]
    pub fn sample(&self, place: &SamplePlace, work: &mut Work) -> [f32; 4] {
        self.sample_recorded(place, work, &mut Unrecorded)
    }

    /// [`Tracer::sample`], telling all that happens.
    pub(crate) fn sample_recorded<R: Recorder>(
        &self,
        place: &SamplePlace,
        work: &mut Work,
        recorder: &mut R,
    ) -> [f32; 4] {
        let (ray, media, distance) = self.primary(place, &mut work.counts.work);
        let root = Root { ray, media, distance, row: Some(place.row), sampler: place.sampler };
        self.tree(root, work, recorder)
    }

    /// Light that comes to the origin of `ray` (of unit direction) along it, and the share that is
    /// covered: [`Tracer::ray_trac`] for one who needs it fast, or deep.
    #[must_use]
    pub fn light_along(&self, ray: Ray, work: &mut Work) -> [f32; 4] {
        let sampler = Sampler::new(Pattern::Sobol, self.settings.seed, 0, 0, 0);
        let media = self.media_at(ray.origin, &mut work.counts.work);
        let root = Root { ray, media, distance: 0.0, row: None, sampler };
        self.tree(root, work, &mut Unrecorded)
    }

    /// Follows a ray and all that come of it.
    fn tree<R: Recorder>(&self, root: Root, work: &mut Work, recorder: &mut R) -> [f32; 4] {
        work.pending.clear();
        work.pending.push(Pending {
            ray: root.ray,
            kind: RayKind::Primary,
            nest: 0,
            weight: LinearRgb::WHITE,
            open: 1.0,
            media: root.media,
            distance: root.distance,
            parent: u32::MAX,
        });
        let Root { row, sampler, .. } = root;
        let tree = Tree { row, sampler, work, recorder, number: 0, sum: Sum::default() };
        self.grow(tree)
    }

    /// What a ray of a tree brings, with all that come of it. `number` counts the rays before it.
    pub(super) fn subtree(
        &self,
        pending: Pending,
        number: u32,
        place: &SamplePlace,
        work: &mut Work,
    ) -> [f32; 4] {
        work.pending.clear();
        work.pending.push(pending);
        let (row, sampler, recorder) = (Some(place.row), place.sampler, &mut Unrecorded);
        self.grow(Tree { row, sampler, work, recorder, number, sum: Sum::default() })
    }

    /// Follows the rays that wait.
    fn grow<R: Recorder>(&self, mut tree: Tree<'_, R>) -> [f32; 4] {
        while let Some(pending) = tree.work.pending.pop() {
            if tree.number == MAX_RAYS_PER_SAMPLE {
                break;
            }
            self.follow(pending, &mut tree);
            tree.number += 1;
        }
        let LinearRgb { r, g, b } = tree.sum.light;
        [r, g, b, tree.sum.alpha]
    }

    /// Adds what one ray brings by itself, and puts the rays it sends on into the list.
    fn follow<R: Recorder>(&self, mut pending: Pending, tree: &mut Tree<'_, R>) {
        count(&mut tree.work.counts, pending.kind);
        if R::RECORDS {
            tree.recorder.ray(tree.number, &pending);
        }
        let Some(seen) = self.see(&mut pending.ray, &mut tree.work.counts) else {
            return self.leave(&pending, tree);
        };
        let Seen { t, at, material } = &seen;
        if material.coverage < 1.0 {
            let kind = RayKind::SeenThrough;
            let around = 1.0 - material.coverage;
            let (weight, open) = (pending.weight * around, pending.open * around);
            let ray = Ray { t_min: *t, ..pending.ray };
            send(tree, Pending { ray, kind, weight, open, parent: tree.number, ..pending });
        }
        let reached = pending.weight * self.absorbed(&pending.media, *t) * material.coverage;
        let clear = self.clear_share(pending.distance, *t);
        let fog = self.fog.map_or(LinearRgb::BLACK, |fog| reached * fog.color * (1.0 - clear));
        let weight = reached * clear;
        if R::RECORDS {
            tree.recorder.meets(tree.number, &Met { t: *t, at, material, fog, weight });
        }
        let local = self.local(&seen, tree);
        tree.recorder.local(tree.number, local);
        tree.sum.light += weight * local + fog;
        tree.sum.alpha += pending.open * material.coverage;
        self.send_on(&pending, &seen, weight, tree);
    }

    /// The first surface that a ray sees; the ray starts there then.
    #[inline]
    pub(super) fn see(&self, ray: &mut Ray, counts: &mut TraceCounts) -> Option<Seen> {
        if !ray.is_valid() {
            return None;
        }
        loop {
            let hit = self.world.closest(ray, &mut counts.work)?;
            let t = hit.crossing.t;
            let at = self.world.interaction(ray, &hit);
            if !self.is_left_out(&at) {
                let material = self.material_at(&at);
                if material.coverage > 0.0 {
                    return Some(Seen { t, at, material });
                }
            }
            ray.t_min = t;
        }
    }

    /// Whether a surface is not seen because it shows its back.
    #[inline]
    pub(super) fn is_left_out(&self, at: &Interaction) -> bool {
        if at.entering {
            return false;
        }
        let shown = match self.settings.backs {
            Backs::ByMaterial => self.materials.is_double_sided(at.material),
            Backs::Hidden => false,
            Backs::Shown => true,
        };
        !shown && !self.materials.is_transparent(at.material)
    }

    /// The ray sees nothing but the background.
    fn leave<R: Recorder>(&self, pending: &Pending, tree: &mut Tree<'_, R>) {
        let direction = pending.ray.direction;
        let seen = match tree.row.filter(|_| pending.open > 0.0) {
            Some(row) => self.sky.in_row(row, direction).unwrap_or(LinearRgb::BLACK),
            None => self.sky.towards(direction),
        };
        tree.sum.alpha += if self.sky.is_transparent() { 0.0 } else { pending.open };
        let weight = pending.weight * self.absorbed(&pending.media, f64::INFINITY);
        tree.sum.light += weight * seen;
        if R::RECORDS {
            tree.recorder.leaves(tree.number, seen, weight);
        }
    }

    /// Share of light that fog leaves on the way to t of a ray that starts `distance` from the eye.
    #[inline]
    pub(super) fn clear_share(&self, distance: f64, t: f64) -> f32 {
        let Some(fog) = &self.fog else { return 1.0 };
        let until = fog_share(&fog.falloff, (distance + t) as f32);
        let before = fog_share(&fog.falloff, distance as f32);
        if before > 0.0 { (until / before).min(1.0) } else { 0.0 }
    }

    /// I_l: light of the lamps that the place sends towards the ray's origin, and light of its own.
    /// Source: course text, section 3.1, equation 3.2.
    #[inline]
    fn local<R: Recorder>(&self, seen: &Seen, tree: &mut Tree<'_, R>) -> LinearRgb {
        let Seen { at, material, .. } = seen;
        let reflector = Reflector::new(material, at.to_viewer.as_vec3(), self.settings.light_model);
        let (mut sum, is_lit) = self.unlit_part(at, material, &reflector);
        if !is_lit {
            return sum;
        }
        let position = at.point.as_vec3();
        for (number, light) in self.lights.iter().enumerate() {
            let per_side = self.settings.soft_shadows;
            for index in 0..light.places(per_side) {
                let sampler = self.sampler_of_light(tree, number, index);
                let (light, to_light) = light.place(index, per_side, sampler, at.point);
                let Some(incident) = light.incident(position) else { continue };
                let reflected = reflector.reflected(&incident);
                if reflected == LinearRgb::BLACK {
                    continue;
                }
                if !self.settings.shadows {
                    sum += reflected;
                    continue;
                }
                let ray = self.shadow_ray(at, to_light);
                tree.work.counts.rays.shadow += 1;
                let share = self.visibility(&ray, &mut tree.work.counts.work);
                sum += reflected * share;
                if R::RECORDS {
                    let blocker = self.first_blocker(&ray, &mut tree.work.counts.work);
                    let blocker = blocker.filter(|_| share != LinearRgb::WHITE);
                    let blocker = blocker.map(|(hit, place)| (hit.object, place));
                    let light_reflected = reflected * share;
                    let shadow = ShadowRay { light: number as u32, ray, share, light_reflected, blocker };
                    tree.recorder.shadow(tree.number, &shadow);
                }
            }
        }
        sum
    }

    /// Random numbers for one place of one light, seen from where the ray being followed ends.
    #[inline]
    fn sampler_of_light<R>(&self, tree: &Tree<'_, R>, light: usize, place: u32) -> Sampler {
        self.sampler_at(&tree.sampler, tree.number, light, place)
    }

    /// The same for ray `number` of a tree.
    #[inline]
    pub(super) fn sampler_at(&self, sampler: &Sampler, number: u32, light: usize, place: u32) -> Sampler {
        let mut sampler = *sampler;
        let number = number.wrapping_mul(self.lights.len() as u32).wrapping_add(light as u32);
        sampler.set_dimension(
            FIRST_LIGHT_DIMENSION.wrapping_add(number.wrapping_mul(MAX_PLACES)).wrapping_add(place),
        );
        sampler
    }

    /// Puts the reflected and the transmitted ray into the list, unless they go too deep or cannot be
    /// seen.
    #[inline]
    fn send_on<R: Recorder>(
        &self,
        pending: &Pending,
        seen: &Seen,
        weight: LinearRgb,
        tree: &mut Tree<'_, R>,
    ) {
        let Seen { t, at, material } = seen;
        if material.mirror == LinearRgb::BLACK && !material.transmits() {
            return;
        }
        if pending.nest >= self.settings.max_depth {
            return tree.recorder.unsent(tree.number, Unsent::TooDeep);
        }
        let children = self.children(pending.ray.direction, seen, &pending.media);
        let sent = [(children.reflected, RayKind::Reflected), (children.transmitted, RayKind::Transmitted)];
        for (child, kind) in sent {
            let Some(Child { direction, share, media }) = child else { continue };
            let weight = weight * share;
            if self.is_negligible(weight) {
                tree.recorder.unsent(tree.number, Unsent::Negligible);
                continue;
            }
            let ray = self.world.spawn(at, direction);
            let (nest, distance) = (pending.nest + 1, pending.distance + t);
            send(tree, Pending { ray, kind, nest, weight, open: 0.0, media, distance, parent: tree.number });
        }
    }

    /// Whether a ray with this product of coefficients is not sent (course text, section 3.3, adaptive
    /// depth).
    #[inline]
    pub(super) fn is_negligible(&self, weight: LinearRgb) -> bool {
        let most = weight.max_component();
        most < self.settings.adaptive_depth || most <= 0.0
    }

    /// The rays that a surface sends on for a ray along `direction` in `media`.
    pub(super) fn children(&self, direction: DVec3, seen: &Seen, media: &Media) -> Children {
        let Seen { at, material, .. } = seen;
        let face = if at.entering { at.normal } else { -at.normal };
        let normal = bent_normal(self.seen_normal(at, material), face, direction);
        let cos1 = -normal.dot(direction);
        let crossing = if material.transmits() { self.cross(at, material, media) } else { None };
        let (mirror, transmission) = (material.mirror, material.transmission);
        let eta = crossing.map_or(f64::from(material.ior).recip(), |crossing| crossing.eta);
        let bent = crossing
            .filter(|crossing| !crossing.thin)
            .map(|crossing| refract(normal, direction, crossing.eta, 1.0));
        let total = bent == Some(None);
        let (k_r, k_t) = match (material.fresnel, total) {
            // All light is reflected, the share k_t with it.
            (_, true) => ((mirror + transmission).map(|k| k.min(1.0)), LinearRgb::BLACK),
            (false, _) => (mirror, transmission),
            (true, _) => {
                let thin = crossing.is_some_and(|crossing| crossing.thin);
                let share = fresnel_share(cos1, eta);
                // Both faces of a thin pane reflect, to and fro.
                let share = if thin { 2.0 * share / (1.0 + share) } else { share } as f32;
                (mirror * share, transmission * (1.0 - share))
            }
        };
        let reflected = (k_r != LinearRgb::BLACK).then(|| {
            let direction = above(reflect(normal, direction), face);
            Child { direction, share: k_r, media: *media }
        });
        let transmitted = crossing.filter(|_| k_t != LinearRgb::BLACK).map(|crossing| {
            let through = bent.flatten().map_or(direction, |t| -above(-t, face));
            Child { direction: through, share: k_t, media: crossing.media }
        });
        Children { reflected, transmitted }
    }

    /// The normal to shade with, in all its digits where no map has bent it: mirrors enlarge errors.
    #[inline]
    pub(super) fn seen_normal(&self, at: &Interaction, material: &MaterialPoint) -> DVec3 {
        if material.normal != seen_normal(at) {
            return material.normal.as_dvec3();
        }
        if at.entering { at.shading_normal } else { -at.shading_normal }
    }

    /// What becomes of the media of a ray that goes through a surface.
    fn cross(&self, at: &Interaction, material: &MaterialPoint, media: &Media) -> Option<MediaCrossing> {
        if !self.bodies[at.object as usize] {
            let eta = f64::from(material.ior).recip();
            return Some(MediaCrossing { media: *media, eta, thin: true });
        }
        let own = Medium { object: at.object, material: at.material as u32 };
        let before = *media;
        let (before, after) = match at.entering {
            true => (before, before.entered(own)),
            // It has been inside all along without knowing.
            false if !before.holds(at.object) => (before.entered(own), before),
            false => (before, before.left(at.object)),
        };
        Some(MediaCrossing { media: after, eta: self.ior_in(&before) / self.ior_in(&after), thin: false })
    }
}

impl Integrator for Tracer<'_> {
    type Work = Work;

    fn sample(&self, place: &SamplePlace, work: &mut Work) -> [f32; 4] {
        Self::sample(self, place, work)
    }

    fn sample_many(&self, places: &[SamplePlace], work: &mut Work, out: &mut Vec<[f32; 4]>) {
        self.sample_all(places, work, out);
    }

    fn counts(work: &Work) -> TraceCounts {
        work.counts
    }
}

/// What becomes of a ray's media at a surface.
#[derive(Clone, Copy, Debug)]
struct MediaCrossing {
    /// Behind the surface.
    media: Media,
    /// Index of refraction before it over that behind it.
    eta: f64,
    /// Whether there is no body behind it: the ray goes straight on.
    thin: bool,
}

/// A shading normal that the ray comes onto from its side: the surface's own where it leans away.
#[inline]
fn bent_normal(normal: DVec3, face: DVec3, direction: DVec3) -> DVec3 {
    if normal.dot(direction) < 0.0 { normal } else { face }
}

/// A direction that leaves a face on its side, lifted where a bent normal sent it below.
#[inline]
fn above(direction: DVec3, face: DVec3) -> DVec3 {
    const LEAST: f64 = 1e-4;
    let cos = direction.dot(face);
    if cos >= LEAST { direction } else { (direction + face * (LEAST - cos)).normalize_or(face) }
}

fn send<R>(tree: &mut Tree<'_, R>, pending: Pending) {
    if tree.work.pending.len() < MAX_PENDING {
        tree.work.pending.push(pending);
    }
}

fn count(counts: &mut TraceCounts, kind: RayKind) {
    let rays = &mut counts.rays;
    match kind {
        RayKind::Primary => rays.primary += 1,
        RayKind::Reflected => rays.reflected += 1,
        RayKind::Transmitted => rays.transmitted += 1,
        RayKind::SeenThrough => {}
    }
}
