//! What places send back along eight rays, and the rays they send on.

use fearless_simd::{Simd, prelude::*};
use senca_math::LinearRgb;
use senca_math::glam::{DVec2, DVec3, Vec3};
use senca_shading::{Incident, PhongConstants};

use super::forms::{Rank, Through};
use super::looks::{Lamp, Look, Looks, Way};
use super::power::power;
use super::rays::{Packet, Rays, gather};
use super::{BALLS, GENERAL, MOST_SHADOWS, Pass, SHADOW_LISTS, SHEETS, Stream};
use crate::intersect::BLOCK;
use crate::lanes::{F, LANES, M, V, bits_of, channels, eight, first_lanes, lanes_of, larger};
use crate::recursive::Tracer;
use crate::recursive::lamps::ToLight;
use crate::recursive::reflector::Reflector;
use crate::world::spawn::{MARGIN, UP_TO};

/// The smallest light that single precision holds; less is none.
const LEAST_LIGHT: f64 = 7.1e-46;

/// Cosine of the angle that reflected rays have to the surface at least.
const LEAST_COSINE: f64 = 1e-4;

/// Eight places on surfaces, seen along eight rays.
#[derive(Clone, Copy)]
struct Places<S: Simd> {
    t: F<S>,
    point: V<S>,
    /// Of the surface itself, on its outside.
    normal: V<S>,
    /// The side that is seen, bent by smooth normals and maps.
    face: V<S>,
    /// See [`crate::Interaction::error`].
    error: F<S>,
    entering: M<S>,
    looks: Looks<S>,
}

/// Light that comes to eight places from one place of a lamp.
struct Coming<S: Simd> {
    to_light: V<S>,
    intensity: [F<S>; 3],
    shines: M<S>,
    /// The shadow rays: origins, unit directions and ends.
    origin: V<S>,
    way: V<S>,
    t_max: F<S>,
}

impl Tracer<'_> {
    /// Rays that meet spheres.
    #[inline(always)]
    pub(super) fn balls<S: Simd>(&self, simd: S, stream: &Stream, pass: &mut Pass<'_>) {
        let list = std::mem::take(&mut pass.desk.lists[BALLS]);
        for eight in list[..pass.desk.lengths[BALLS]].chunks(LANES) {
            let (rays, live, t, ranks) = meeting(simd, pass, eight);
            let looks = looks_of(simd, stream, &ranks);
            let numbers = Numbers::new(simd, stream, &ranks);
            let center = numbers.vector(0);
            let from_center = rays.origin.add(rays.direction.times(t)).sub(center);
            let normal = from_center.times(F::splat(simd, 1.0) / from_center.dot(from_center).sqrt());
            let point = center.add(normal.times(numbers.at(3)));
            let error = numbers.at(4) + rounding(simd, &rays, point);
            self.flat_places(simd, stream, pass, rays, live, t, point, normal, error, looks);
        }
        pass.desk.lists[BALLS] = list;
    }

    /// Rays that meet flat pieces.
    #[inline(always)]
    pub(super) fn sheets<S: Simd>(&self, simd: S, stream: &Stream, pass: &mut Pass<'_>) {
        let list = std::mem::take(&mut pass.desk.lists[SHEETS]);
        for eight in list[..pass.desk.lengths[SHEETS]].chunks(LANES) {
            let (rays, live, t, ranks) = meeting(simd, pass, eight);
            let mut looks = looks_of(simd, stream, &ranks);
            let numbers = Numbers::new(simd, stream, &ranks);
            let normal = numbers.vector(0);
            let near = rays.origin.add(rays.direction.times(t));
            let point = near.sub(normal.times(normal.dot(near) - numbers.at(3)));
            let u = numbers.vector(6).dot(point) + numbers.at(9);
            let v = numbers.vector(10).dot(point) + numbers.at(13);
            let error =
                numbers.at(4) + numbers.at(5) * larger(u.abs(), v.abs()) + rounding(simd, &rays, point);
            self.lay_pictures(simd, stream, &ranks, [u, v], &mut looks);
            self.flat_places(simd, stream, pass, rays, live, t, point, normal, error, looks);
        }
        pass.desk.lists[SHEETS] = list;
    }

    /// Multiplies textures in, where there are some.
    #[inline(always)]
    fn lay_pictures<S: Simd>(
        &self,
        simd: S,
        stream: &Stream,
        ranks: &[u32; LANES],
        [u, v]: [F<S>; 2],
        looks: &mut Looks<S>,
    ) {
        let ranks: [&Rank; LANES] = eight!(lane => &stream.forms.ranks[ranks[lane] as usize]);
        if ranks.iter().all(|rank| stream.looks[rank.material].way != Way::Textured) {
            return;
        }
        let x = picture_place(simd, &ranks, 0, [u, v]);
        let y = picture_place(simd, &ranks, 1, [u, v]);
        let alike = ranks.iter().all(|rank| rank.material == ranks[0].material);
        let texture = self.materials.base_texture(ranks[0].material).filter(|_| alike);
        let found = texture.and_then(
            #[inline(always)]
            |texture| texture.sample_eight(simd, [x, y]),
        );
        let mut texels = [[1.0; LANES]; 3];
        if let Some(found) = found {
            for k in 0..3 {
                texels[k] = eight!(lane => f64::from(found[lane][k]));
            }
        } else {
            let (x, y) = (x.to_array(), y.to_array());
            for lane in 0..LANES {
                let place = DVec2::new(x[lane], y[lane]);
                if let Some(texel) = self.materials.base_texel(ranks[lane].material, place) {
                    for k in 0..3 {
                        texels[k][lane] = f64::from(texel[k]);
                    }
                }
            }
        }
        for (k, texels) in texels.into_iter().enumerate() {
            let texel = F::load_array(simd, texels);
            looks.ambient[k] *= texel;
            looks.diffuse[k] *= texel;
        }
    }

    /// Places that are shaded with the normal of the surface itself.
    #[inline(always)]
    pub(super) fn flat_places<S: Simd>(
        &self,
        simd: S,
        stream: &Stream,
        pass: &mut Pass<'_>,
        rays: Packet<S>,
        live: M<S>,
        t: F<S>,
        point: V<S>,
        normal: V<S>,
        error: F<S>,
        looks: Looks<S>,
    ) {
        let entering = normal.dot(rays.direction).simd_lt(F::splat(simd, 0.0));
        let unseen = live & !entering & looks.hides_back;
        if unseen.any_true() {
            pass.desk.again.push(unseen, &Packet { t_min: t, ..rays });
        }
        let face = V::select(entering, normal, normal.opposite());
        let places = Places { t, point, normal, face, error, entering, looks };
        self.shade(simd, stream, pass, &rays, live & !unseen, &places, None);
    }

    /// Rays that meet anything else, looked at one by one up to the light of the lamps.
    #[inline(always)]
    pub(super) fn general<S: Simd>(&self, simd: S, stream: &Stream, pass: &mut Pass<'_>) {
        let list = std::mem::take(&mut pass.desk.lists[GENERAL]);
        let mut seen = [None; LANES];
        let mut numbers = [0; LANES];
        let mut count = 0;
        for &number in &list[..pass.desk.lengths[GENERAL]] {
            let Some(place) = self.look_at(stream, number as usize, pass) else { continue };
            (seen[count], numbers[count]) = (Some(place), number);
            count += 1;
            if count == LANES {
                self.shade_general(simd, stream, pass, &numbers, &seen, count);
                count = 0;
            }
        }
        if count > 0 {
            let first = numbers[0];
            numbers[count..].fill(first);
            self.shade_general(simd, stream, pass, &numbers, &seen, count);
        }
        pass.desk.lists[GENERAL] = list;
    }

    /// The place where a ray meets something; `None` where it is not seen, or not shaded here.
    fn look_at(&self, stream: &Stream, number: usize, pass: &mut Pass<'_>) -> Option<Seen> {
        let desk = &mut *pass.desk;
        let ray = desk.rays.ray(number);
        let (rank, t) = (desk.rank[number] as usize, desk.t[number]);
        let hit = stream.forms.hit(rank, t, &desk.hits[number]);
        let at = self.world.interaction(&ray, &hit);
        let material = (!self.is_left_out(&at)).then(|| self.material_at(&at));
        match material {
            Some(material) if material.coverage >= 1.0 && !material.transmits() => {
                let reflector = Reflector::new(&material, at.to_viewer.as_vec3(), self.settings.light_model);
                let look = Look::at(self, &material);
                let is_matte = look.is_some();
                let ambient = || reflector.ambient(&self.ambient, material.occlusion);
                let none = PhongConstants::matte(LinearRgb::BLACK);
                let look = look.unwrap_or_else(|| Look::new(&material, ambient(), &none));
                let face = self.seen_normal(&at, &material);
                Some(Seen {
                    point: at.point,
                    normal: at.normal,
                    face,
                    error: at.error,
                    entering: at.entering,
                    t,
                    look,
                    reflector: (!is_matte).then_some(reflector),
                })
            }
            Some(material) if material.coverage > 0.0 => {
                desk.handed.push(number as u32);
                None
            }
            _ => {
                desk.again.push_again(&desk.rays, number, t);
                None
            }
        }
    }

    #[inline(always)]
    fn shade_general<S: Simd>(
        &self,
        simd: S,
        stream: &Stream,
        pass: &mut Pass<'_>,
        numbers: &[u32; LANES],
        seen: &[Option<Seen>; LANES],
        count: usize,
    ) {
        let Some(first) = &seen[0] else { return };
        let at = |lane: usize| if lane < count { seen[lane].as_ref().unwrap_or(first) } else { first };
        let all: [&Seen; LANES] = eight!(lane => at(lane));
        let rays = pass.desk.rays.gather(simd, numbers);
        let number = |of: fn(&Seen) -> f64| F::load_array(simd, eight!(lane => of(all[lane])));
        let vector = |of: fn(&Seen) -> DVec3| V {
            x: F::load_array(simd, eight!(lane => of(all[lane]).x)),
            y: F::load_array(simd, eight!(lane => of(all[lane]).y)),
            z: F::load_array(simd, eight!(lane => of(all[lane]).z)),
        };
        let places = Places {
            t: number(|seen| seen.t),
            point: vector(|seen| seen.point),
            normal: vector(|seen| seen.normal),
            face: vector(|seen| seen.face),
            error: number(|seen| seen.error),
            entering: number(|seen| f64::from(u8::from(seen.entering))).simd_gt(F::splat(simd, 0.5)),
            looks: Looks::of(simd, &eight!(lane => &all[lane].look)),
        };
        let live = first_lanes(simd, count);
        let any = all.iter().any(|seen| seen.reflector.is_some());
        let reflectors = any.then(|| eight!(lane => all[lane].reflector));
        self.shade(simd, stream, pass, &rays, live, &places, reflectors.as_ref());
    }

    /// Adds what the places send back, and puts the rays that they send on into the list. Compiled once,
    /// whatever the places are on.
    #[inline(never)]
    fn shade<S: Simd>(
        &self,
        simd: S,
        stream: &Stream,
        pass: &mut Pass<'_>,
        rays: &Packet<S>,
        live: M<S>,
        places: &Places<S>,
        reflectors: Option<&[Option<Reflector>; LANES]>,
    ) {
        if !live.any_true() {
            return;
        }
        simd.vectorize(
            #[inline(always)]
            || {
                let (weight, mut light) = self.own_light(simd, rays, places);
                self.look_for_lamps(simd, stream, pass, rays, live, places, weight, reflectors, &mut light);
                let alpha = if pass.nest == 0 { 1.0 } else { 0.0 };
                let slots = rays.slot.to_array();
                let red_green: [f32; 2 * LANES] = light[0].narrow(light[1]).into();
                let blue: [f32; 2 * LANES] = light[2].narrow(light[2]).into();
                for lane in lanes_of(live.to_bitmask()) {
                    let light = LinearRgb::new(red_green[lane], red_green[LANES + lane], blue[lane]);
                    pass.desk.add(slots[lane] as usize, light, alpha);
                }
                self.reflect(simd, pass, rays, live, places, weight);
            },
        );
    }

    /// I_l of equation 3.2. What arrives for certain is added to `light` at once; the other rays towards lights
    /// are put into lists.
    #[inline(always)]
    fn look_for_lamps<S: Simd>(
        &self,
        simd: S,
        stream: &Stream,
        pass: &mut Pass<'_>,
        rays: &Packet<S>,
        live: M<S>,
        places: &Places<S>,
        weight: [F<S>; 3],
        reflectors: Option<&[Option<Reflector>; LANES]>,
        light: &mut [F<S>; 3],
    ) {
        if pass.desk.shadows.iter().any(|list| list.len() >= MOST_SHADOWS) {
            self.cast_shadows(simd, stream, pass);
        }
        for (number, lamp) in stream.lamps.iter().enumerate() {
            let count = self.lights[number].places(self.settings.soft_shadows);
            for index in 0..count {
                let coming = match lamp {
                    Lamp::Simple(to_light, color, _) => from_simple(simd, places, *to_light, *color, live),
                    Lamp::General => self.lamp_light(simd, pass, rays, live, places, number, index),
                };
                let mut reflected = reflected(simd, rays, places, &coming);
                if let Some(reflectors) = reflectors {
                    by_reflectors(simd, reflectors, &coming, &mut reflected);
                }
                let most = larger(reflected[0], larger(reflected[1], reflected[2]));
                let lit = live & coming.shines & most.simd_gt(F::splat(simd, LEAST_LIGHT));
                if !lit.any_true() {
                    continue;
                }
                let arriving = channels!(k => reflected[k] * weight[k]);
                let Coming { origin, way, t_max, .. } = coming;
                let (direction, distance) = (way, F::splat(simd, 0.0));
                let shadow =
                    Packet { origin, direction, t_min: t_max, weight: arriving, distance, slot: rays.slot };
                let (now, later) = self.clear_at_once(simd, stream, pass, lamp.through(), &shadow, lit);
                for k in 0..3 {
                    light[k] += now.select(arriving[k], F::splat(simd, 0.0));
                }
                if later.any_true() {
                    pass.desk.shadows[number % SHADOW_LISTS].push_more(later, &shadow);
                }
            }
        }
    }

    /// Which of the rays towards lights arrive, and of which that is not known yet.
    #[inline(always)]
    fn clear_at_once<S: Simd>(
        &self,
        simd: S,
        stream: &Stream,
        pass: &mut Pass<'_>,
        through: Through<'_>,
        shadow: &Packet<S>,
        lit: M<S>,
    ) -> (M<S>, M<S>) {
        let none = M::splat(simd, false);
        if !self.settings.shadows {
            return (lit, none);
        }
        if !stream.shades_at_once() {
            return (none, lit);
        }
        pass.counts.rays.shadow += u64::from(lit.to_bitmask().count_ones());
        let (objects, counters) = (self.world.objects(), &mut pass.counts.work);
        let Packet { origin, direction, t_min: t_max, .. } = *shadow;
        let blocked = stream.forms.occluded(simd, objects, through, origin, direction, t_max, lit, counters);
        let clear = lit & !blocked;
        if stream.forms.patched.is_empty() {
            return (clear, none);
        }
        let later = clear & stream.forms.meet_patched(simd, origin, direction, t_max);
        (clear & !later, later)
    }

    /// Looks which of the rays towards lights arrive, and adds their light to the samples: S_i of
    /// equation 3.2.
    #[inline(never)]
    pub(super) fn cast_shadows<S: Simd>(&self, simd: S, stream: &Stream, pass: &mut Pass<'_>) {
        simd.vectorize(
            #[inline(always)]
            || self.cast_all(simd, stream, pass),
        );
    }

    #[inline(always)]
    fn cast_all<S: Simd>(&self, simd: S, stream: &Stream, pass: &mut Pass<'_>) {
        let mut lists = std::mem::take(&mut pass.desk.shadows);
        for list in &mut lists {
            if !stream.shades_at_once() {
                pass.counts.rays.shadow += list.len() as u64;
            }
            for first in (0..list.len()).step_by(BLOCK) {
                let clear = self.clear_of_block(simd, stream, pass, list, first);
                for lane in bits_of(clear) {
                    let (slot, light, _) = list.leaving(first + lane);
                    let light = if stream.asks {
                        let ray = list.shadow_ray(first + lane);
                        light * self.visibility(&ray, &mut pass.counts.work)
                    } else {
                        light
                    };
                    pass.desk.add(slot, light, 0.0);
                }
            }
            list.clear(0);
        }
        pass.desk.shadows = lists;
    }

    /// Which of the 64 rays towards lights from number `first` on meet nothing opaque.
    #[inline(always)]
    fn clear_of_block<S: Simd>(
        &self,
        simd: S,
        stream: &Stream,
        pass: &mut Pass<'_>,
        list: &Rays,
        first: usize,
    ) -> u64 {
        let counters = &mut pass.counts.work;
        if stream.shades_at_once() {
            let all = u64::MAX >> (BLOCK - (list.len() - first).min(BLOCK));
            return self.blocked_by_patches(simd, stream, list, first, all, (&mut pass.desk.block, counters));
        }
        let mut clear = 0;
        for from in (0..BLOCK.min(list.len() - first)).step_by(LANES) {
            let (rays, live) = list.load(simd, first + from);
            let blocked = if stream.is_flat {
                let (objects, Packet { origin, direction, t_min: t_max, .. }) = (self.world.objects(), rays);
                let anywhere = Through::Anywhere;
                stream.forms.occluded(simd, objects, anywhere, origin, direction, t_max, live, counters)
            } else {
                M::splat(simd, false)
            };
            clear |= (live & !blocked).to_bitmask() << from;
        }
        if stream.is_flat {
            let room = (&mut pass.desk.block, counters);
            return self.blocked_by_patches(simd, stream, list, first, clear, room);
        }
        if !stream.asks {
            for lane in bits_of(clear) {
                let is_seen = self.visibility(&list.shadow_ray(first + lane), counters).max_component() > 0.0;
                clear &= !(u64::from(!is_seen) << lane);
            }
        }
        clear
    }

    /// The light of a lamp, asked place by place.
    #[inline(always)]
    fn lamp_light<S: Simd>(
        &self,
        simd: S,
        pass: &Pass<'_>,
        rays: &Packet<S>,
        live: M<S>,
        places: &Places<S>,
        lamp: usize,
        index: u32,
    ) -> Coming<S> {
        let (points, slots) = (places.point.to_array(), rays.slot.to_array());
        let (mut targets, mut afar) = ([DVec3::ZERO; LANES], 0u64);
        let (mut to_light, mut colors, mut shines) = ([Vec3::ZERO; LANES], [LinearRgb::BLACK; LANES], 0u64);
        for lane in lanes_of(live.to_bitmask()) {
            let sampler = &pass.places[slots[lane] as usize].sampler;
            let sampler = self.sampler_at(sampler, pass.nest, lamp, index);
            let per_side = self.settings.soft_shadows;
            let (light, way) = self.lights[lamp].place(index, per_side, sampler, points[lane]);
            match way {
                ToLight::Place(place) => targets[lane] = place,
                ToLight::Far(direction) => {
                    targets[lane] = direction;
                    afar |= 1 << lane;
                }
            }
            if let Some(incident) = light.incident(points[lane].as_vec3()) {
                (to_light[lane], colors[lane]) = (incident.to_light, incident.intensity);
                shines |= 1 << lane;
            }
        }
        let afar = M::from_bitmask(simd, afar);
        let targets = lanes_from(simd, &targets);
        let to_target = V::select(afar, targets, targets.sub(places.point));
        let origin = beside(simd, places, to_target);
        let way = V::select(afar, targets, targets.sub(origin));
        let length = way.dot(way).sqrt();
        let endless = F::splat(simd, f64::INFINITY);
        Coming {
            to_light: lanes_from(simd, &eight!(lane => to_light[lane].as_dvec3())),
            intensity: channels!(k => F::load_array(simd, eight!(lane => f64::from(colors[lane].to_array()[k])))),
            shines: M::from_bitmask(simd, shines),
            origin,
            way: way.times(F::splat(simd, 1.0) / length),
            t_max: afar.select(endless, length * F::splat(simd, UP_TO)),
        }
    }

    /// The share of the places in the picture, and the light that no lamp sends.
    #[inline(always)]
    fn own_light<S: Simd>(&self, simd: S, rays: &Packet<S>, places: &Places<S>) -> ([F<S>; 3], [F<S>; 3]) {
        let Looks { emission, ambient, .. } = places.looks;
        let mut weight = rays.weight;
        let mut light = channels!(k => (emission[k] + ambient[k]) * weight[k]);
        if let Some(fog) = &self.fog {
            let (distance, t) = (rays.distance.to_array(), places.t.to_array());
            let clear =
                F::load_array(simd, eight!(lane => f64::from(self.clear_share(distance[lane], t[lane]))));
            let veil = F::splat(simd, 1.0) - clear;
            for k in 0..3 {
                let color = F::splat(simd, f64::from(fog.color.to_array()[k]));
                light[k] = light[k] * clear + color * veil * weight[k];
                weight[k] *= clear;
            }
        }
        (weight, light)
    }

    /// Puts the reflected rays into the list, unless they go too deep or cannot be seen.
    #[inline(always)]
    fn reflect<S: Simd>(
        &self,
        simd: S,
        pass: &mut Pass<'_>,
        rays: &Packet<S>,
        live: M<S>,
        places: &Places<S>,
        weight: [F<S>; 3],
    ) {
        let zero = F::splat(simd, 0.0);
        let Looks { mirror: mut share, fresnel, ior, .. } = places.looks;
        let most = larger(share[0], larger(share[1], share[2]));
        let mirrors = live & most.simd_gt(zero);
        if pass.nest >= self.settings.max_depth || !mirrors.any_true() {
            return;
        }
        let d = rays.direction;
        // The surface itself, where a bent normal leans away.
        let seen = V::select(places.entering, places.normal, places.normal.opposite());
        let towards = places.face.dot(d).simd_lt(zero);
        let normal = V::select(towards, places.face, seen);
        let cos = normal.dot(d);
        if (mirrors & fresnel).any_true() {
            let reflected = fresnel_shares(simd, -cos, ior);
            share = channels!(k => fresnel.select(share[k] * reflected, share[k]));
        }
        let weight = channels!(k => weight[k] * share[k]);
        let most = larger(weight[0], larger(weight[1], weight[2]));
        let least = F::splat(simd, f64::from(self.settings.adaptive_depth));
        let sent = mirrors & most.simd_ge(least) & most.simd_gt(zero);
        if !sent.any_true() {
            return;
        }
        let direction = d.sub(normal.times(cos + cos));
        let direction = above(simd, direction, seen);
        let origin = beside(simd, places, direction);
        let distance = rays.distance + places.t;
        let packet = Packet { origin, direction, t_min: zero, weight, distance, slot: rays.slot };
        pass.desk.next.push(sent, &packet);
    }
}

/// A place that a single ray sees.
#[derive(Clone, Copy, Debug)]
struct Seen {
    point: DVec3,
    normal: DVec3,
    face: DVec3,
    error: f64,
    entering: bool,
    t: f64,
    look: Look,
    /// Where the reflection is not that of the books.
    reflector: Option<Reflector>,
}

/// The rays of these numbers, which of them there are, and t and rank of what they meet.
#[inline(always)]
pub(super) fn meeting<S: Simd>(
    simd: S,
    pass: &Pass<'_>,
    eight: &[u32],
) -> (Packet<S>, M<S>, F<S>, [u32; LANES]) {
    let mut numbers = [eight[0]; LANES];
    numbers[..eight.len()].copy_from_slice(eight);
    let desk = &pass.desk;
    let ranks = eight!(lane => desk.rank[numbers[lane] as usize] as u32);
    let live = first_lanes(simd, eight.len());
    (desk.rays.gather(simd, &numbers), live, gather(simd, &desk.t, &numbers), ranks)
}

/// The materials of what has these ranks.
#[inline(always)]
pub(super) fn looks_of<S: Simd>(simd: S, stream: &Stream, ranks: &[u32; LANES]) -> Looks<S> {
    let materials = eight!(lane => stream.forms.ranks[ranks[lane] as usize].material);
    if materials.iter().all(|material| *material == materials[0]) {
        return Looks::splat(simd, &stream.looks[materials[0]]);
    }
    Looks::of(simd, &eight!(lane => &stream.looks[materials[lane]]))
}

/// One of the coordinates in the pictures on flat pieces.
#[inline(always)]
fn picture_place<S: Simd>(simd: S, ranks: &[&Rank; LANES], axis: usize, [u, v]: [F<S>; 2]) -> F<S> {
    let [start, along_u, along_v] = channels!(k => {
        F::load_array(simd, eight!(lane => ranks[lane].texture[k].to_array()[axis]))
    });
    start + u * along_u + v * along_v
}

/// The numbers of what has these ranks.
struct Numbers<'a, S> {
    simd: S,
    stream: &'a Stream,
    ranks: &'a [u32; LANES],
    /// Whether all are the same.
    alike: bool,
}

impl<'a, S: Simd> Numbers<'a, S> {
    #[inline(always)]
    fn new(simd: S, stream: &'a Stream, ranks: &'a [u32; LANES]) -> Self {
        Self { simd, stream, ranks, alike: *ranks == [ranks[0]; LANES] }
    }

    #[inline(always)]
    fn at(&self, k: usize) -> F<S> {
        if self.alike {
            return F::splat(self.simd, self.stream.forms.ranks[self.ranks[0] as usize].numbers[k]);
        }
        F::from_fn(
            self.simd,
            #[inline(always)]
            |lane| self.stream.forms.ranks[self.ranks[lane] as usize].numbers[k],
        )
    }

    #[inline(always)]
    fn vector(&self, k: usize) -> V<S> {
        V { x: self.at(k), y: self.at(k + 1), z: self.at(k + 2) }
    }
}

/// How far places may be from where other rays meet them, by the rounding of their coordinates.
#[inline(always)]
pub(super) fn rounding<S: Simd>(simd: S, rays: &Packet<S>, point: V<S>) -> F<S> {
    let o = rays.origin;
    let sum = V { x: o.x.abs() + point.x.abs(), y: o.y.abs() + point.y.abs(), z: o.z.abs() + point.z.abs() };
    sum.largest() * F::splat(simd, 8.0 * f64::EPSILON)
}

/// Eight vectors side by side.
#[inline(always)]
pub(super) fn lanes_from<S: Simd>(simd: S, vectors: &[DVec3; LANES]) -> V<S> {
    V {
        x: F::load_array(simd, eight!(lane => vectors[lane].x)),
        y: F::load_array(simd, eight!(lane => vectors[lane].y)),
        z: F::load_array(simd, eight!(lane => vectors[lane].z)),
    }
}

/// Where rays along these directions start; see [`crate::World::spawn`].
#[inline(always)]
fn beside<S: Simd>(simd: S, places: &Places<S>, direction: V<S>) -> V<S> {
    let zero = F::splat(simd, 0.0);
    let along = places.normal.dot(direction);
    let outside = along.simd_gt(zero) | (along.simd_eq(zero) & places.entering);
    let offset = places.error * F::splat(simd, MARGIN);
    places.point.add(places.normal.times(outside.select(offset, -offset)))
}

/// Directions that leave the seen side, lifted where a bent normal sent them below.
#[inline(always)]
fn above<S: Simd>(simd: S, direction: V<S>, seen: V<S>) -> V<S> {
    let least = F::splat(simd, LEAST_COSINE);
    let cos = direction.dot(seen);
    let low = cos.simd_lt(least);
    if !low.any_true() {
        return direction;
    }
    let lifted = direction.add(seen.times(least - cos));
    let lifted = lifted.times(F::splat(simd, 1.0) / lifted.dot(lifted).sqrt());
    V::select(low, lifted, direction)
}

/// [`crate::fresnel::dielectric`] at eight places.
#[inline(always)]
fn fresnel_shares<S: Simd>(simd: S, cos: F<S>, eta: F<S>) -> F<S> {
    let (zero, one) = (F::splat(simd, 0.0), F::splat(simd, 1.0));
    let cos = larger(cos, zero);
    let cos = cos.simd_lt(one).select(cos, one);
    let squared = one - (one - cos * cos) / (eta * eta);
    let beyond = squared.sqrt();
    let across = (cos - eta * beyond) / (cos + eta * beyond);
    let along = (eta * cos - beyond) / (eta * cos + beyond);
    let share = F::splat(simd, 0.5) * (across * across + along * along);
    squared.simd_gt(zero).select(share, one)
}

/// Light of a lamp that is the same from everywhere.
#[inline(always)]
fn from_simple<S: Simd>(
    simd: S,
    places: &Places<S>,
    to_light: ToLight,
    color: DVec3,
    live: M<S>,
) -> Coming<S> {
    let (origin, way, t_max) = match to_light {
        ToLight::Far(direction) => {
            let way = V::splat(simd, direction);
            (beside(simd, places, way), way, F::splat(simd, f64::INFINITY))
        }
        ToLight::Place(place) => {
            let place = V::splat(simd, place);
            let origin = beside(simd, places, place.sub(places.point));
            let way = place.sub(origin);
            let length = way.dot(way).sqrt();
            (origin, way.times(F::splat(simd, 1.0) / length), length * F::splat(simd, UP_TO))
        }
    };
    let intensity = [F::splat(simd, color.x), F::splat(simd, color.y), F::splat(simd, color.z)];
    Coming { to_light: way, intensity, shines: live, origin, way, t_max }
}

/// `Od cos(phi) + Os cos^n(alpha)`, times the light.
#[inline(always)]
fn reflected<S: Simd>(simd: S, rays: &Packet<S>, places: &Places<S>, coming: &Coming<S>) -> [F<S>; 3] {
    let zero = F::splat(simd, 0.0);
    let Looks { diffuse, specular, exponent, .. } = places.looks;
    let cos = places.face.dot(coming.to_light);
    let faces = cos.simd_gt(zero);
    let mut highlight = zero;
    let shiny = larger(specular[0], larger(specular[1], specular[2])).simd_gt(zero) & faces;
    if shiny.any_true() {
        let to_viewer = rays.direction.opposite();
        let mirrored = (cos + cos) * places.face.dot(to_viewer) - coming.to_light.dot(to_viewer);
        let shows = shiny & mirrored.simd_gt(zero);
        if shows.any_true() {
            highlight = shows.select(power(simd, mirrored, exponent), zero);
        }
    }
    channels!(k => {
        let share = diffuse[k] * cos + specular[k] * highlight;
        faces.select(coming.intensity[k] * share, zero)
    })
}

/// The same of places with another model, one by one.
fn by_reflectors<S: Simd>(
    simd: S,
    reflectors: &[Option<Reflector>; LANES],
    coming: &Coming<S>,
    reflected: &mut [F<S>; 3],
) {
    let to_light = coming.to_light.to_array();
    let intensity = channels!(k => coming.intensity[k].to_array());
    let mut of_lanes = channels!(k => reflected[k].to_array());
    for lane in 0..LANES {
        let Some(reflector) = &reflectors[lane] else { continue };
        let [r, g, b] = channels!(k => intensity[k][lane] as f32);
        let to_light = to_light[lane].as_vec3();
        let incident = Incident { to_light, intensity: LinearRgb::new(r, g, b) };
        let color = reflector.reflected(&incident).to_array();
        for k in 0..3 {
            of_lanes[k][lane] = f64::from(color[k]);
        }
    }
    *reflected = channels!(k => F::load_array(simd, of_lanes[k]));
}
