//! Step 4 by shooting: progressive refinement (Cohen, Chen, Wallace and Greenberg 1988).
//!
//! The patch with most unsent power sends it to all others, by one row of form factors, which is computed
//! when the patch sends for the first time. So there is a picture after the first step, and memory for all
//! factors is not needed: rows beyond [`BookSettings::max_factors`] are forgotten, and computed
//! again when they are wanted.
//!
//! 1. Unsent light begins with E, and with what lamps send and the patch reflects.
//! 2. A row sums to 1 where the patch is surrounded, and to 1 at most elsewhere, so what is sent arrives
//!    or leaves the scene: power is kept at every step.
//! 3. A patch that fills too much of what a sender sees is divided before it receives. Its
//!    parts begin with its light.
//! 4. What is still on its way is shown as if it were everywhere alike: of the unsent power the share that
//!    has met surfaces so far, spread over all area that light has met, and reflected as often as the
//!    mean reflectance there has it.
//!
//! [`crate::system::Shooting`] is the textbook form, for a matrix that is there already.

use senca_math::{Control, LinearRgb};

use super::factors::is_surrounded;
use super::{Book, ShootingRule};
use crate::system::{Outcome, Rgb64, largest};
use crate::{RadiosityError, Solution};

/// Rows that are computed at a time: those of the patches that are most likely to be wanted next.
const ROWS_AT_ONCE: usize = 16;

/// Light on its way. Entries are by element; those of patches count.
#[derive(Clone, Debug, Default)]
pub(super) struct Shots {
    /// What arrived from patches, and the part of it that they gave off themselves.
    received: Vec<Rgb64>,
    direct: Vec<Rgb64>,
    /// Light not sent yet, and the part of it that the patch gives off itself.
    unsent: Vec<Rgb64>,
    own: Vec<Rgb64>,
    /// Lamps' light that is in `unsent`, or was.
    lamps: Vec<Rgb64>,
    /// Divisions of patches because of too large factors.
    divisions: Vec<u8>,
    /// Power that was sent, and the part of it that left the scene.
    sent: Rgb64,
    lost: Rgb64,
    steps: u32,
}

impl Book<'_> {
    /// Steps 3 to 6, with shooting in place of a system that is set up and solved.
    pub(super) fn rounds_by_shooting(
        &mut self,
        rule: ShootingRule,
        control: &Control<'_>,
        watch: &mut impl FnMut(&Solution),
    ) -> Result<(), RadiosityError> {
        let mut shots = Shots::new(self);
        loop {
            shots.take_lamps(self);
            let shot = shots.shoot(self, rule, control, watch);
            // Interrupted between dividing and lighting, the picture before is the best there is.
            if shot.is_ok() || self.lamps.len() == self.mesh.elements().len() {
                self.solution = shots.on_elements(self, rule);
            }
            let settled = shot?;
            watch(&self.solution);
            if !settled || self.report.rounds >= self.settings.rounds || !self.divide_elements()? {
                return Ok(());
            }
            self.report.rounds += 1;
            self.illuminate(control)?;
            self.element_factors(control)?;
        }
    }
}

impl Shots {
    fn new(book: &Book<'_>) -> Self {
        let mut shots = Self::default();
        shots.follow(book);
        for &patch in &book.patches {
            let emission = rgb64(book.mesh.surface(patch).emission);
            (shots.unsent[patch as usize], shots.own[patch as usize]) = (emission, emission);
        }
        shots
    }

    /// Room for new elements.
    fn follow(&mut self, book: &Book<'_>) {
        let n = book.mesh.elements().len();
        let all = [&mut self.received, &mut self.direct, &mut self.unsent, &mut self.own, &mut self.lamps];
        all.into_iter().for_each(|values| values.resize(n, [0.0; 3]));
        self.divisions.resize(n, 0);
    }

    /// What lamps send now, and did not before, is reflected and unsent.
    fn take_lamps(&mut self, book: &Book<'_>) {
        self.follow(book);
        for (&patch, lamps) in book.patches.iter().zip(book.patch_means(&book.lamps)) {
            let (i, rho) = (patch as usize, rgb64(book.mesh.surface(patch).reflectance));
            let lamps = rgb64(lamps);
            (0..3).for_each(|c| self.unsent[i][c] += rho[c] * (lamps[c] - self.lamps[i][c]));
            self.lamps[i] = lamps;
        }
    }

    /// Sends until little is left. False when the steps ran out.
    fn shoot(
        &mut self,
        book: &mut Book<'_>,
        rule: ShootingRule,
        control: &Control<'_>,
        watch: &mut impl FnMut(&Solution),
    ) -> Result<bool, RadiosityError> {
        loop {
            let (sender, left) = self.brightest(book);
            let given = self.given_power(book);
            book.unsent = if given > 0.0 { left / given } else { 0.0 };
            control.report(progress(book.unsent, rule.unsent));
            let Some(sender) = sender.filter(|_| book.unsent > rule.unsent) else { return Ok(true) };
            if self.steps >= rule.max_steps {
                return Ok(false);
            }
            control.check()?;
            let ready = !book.rows.of(sender).is_empty() || self.prepare(book, sender, control)?;
            if !ready {
                // Patches were divided; there may be a brighter one now.
                continue;
            }
            self.send(book, sender);
            if self.steps.is_power_of_two() && self.steps < rule.max_steps {
                watch(&self.on_elements(book, rule));
            }
        }
    }

    /// One step: what `sender` has goes to all that it sees.
    fn send(&mut self, book: &Book<'_>, sender: u32) {
        let s = sender as usize;
        let (light, own) = (std::mem::take(&mut self.unsent[s]), std::mem::take(&mut self.own[s]));
        let area = book.mesh.elements()[s].area;
        let mut open = area;
        for &(patch, exchange) in book.rows.of(sender) {
            let j = book.patches[patch as usize] as usize;
            let element = &book.mesh.elements()[j];
            let (share, rho) =
                (f64::from(exchange) / element.area, rgb64(book.mesh.surface(j as u32).reflectance));
            open -= f64::from(exchange);
            (0..3).for_each(|c| {
                self.received[j][c] += share * light[c];
                self.direct[j][c] += share * own[c];
                self.unsent[j][c] += rho[c] * share * light[c];
            });
        }
        (0..3).for_each(|c| {
            self.sent[c] += area * light[c];
            self.lost[c] += open.max(0.0) * light[c];
        });
        self.steps += 1;
    }

    /// Computes the rows of `sender` and of others that are next. False when patches were divided for
    /// it, and nothing is as it was.
    fn prepare(
        &mut self,
        book: &mut Book<'_>,
        sender: u32,
        control: &Control<'_>,
    ) -> Result<bool, RadiosityError> {
        let batch = self.next_senders(book, sender);
        let mut rows = book.rows_of(&batch, control)?;
        let big = self.too_big(book, &batch, &rows);
        if self.divide(book, &big) {
            book.illuminate(control)?;
            self.take_lamps(book);
            return Ok(false);
        }
        if book.rows.count() > book.settings.max_factors {
            book.patches.clone().into_iter().for_each(|patch| book.rows.forget(patch));
        }
        for (&patch, row) in batch.iter().zip(&mut rows) {
            let area = book.mesh.elements()[patch as usize].area;
            let sum: f64 = row.iter().map(|entry| f64::from(entry.1)).sum();
            let share = sum / area;
            book.report.largest_row_sum = book.report.largest_row_sum.max(share);
            if share > 1.0 || (share > 0.0 && is_surrounded(&book.mesh, &book.occluders, patch)) {
                row.iter_mut().for_each(|entry| entry.1 = (f64::from(entry.1) / share) as f32);
            }
        }
        for (patch, row) in batch.into_iter().zip(rows) {
            book.rows.0[patch as usize] = row;
        }
        Ok(true)
    }

    /// `sender`, and those with most unsent power that have no row yet.
    fn next_senders(&self, book: &Book<'_>, sender: u32) -> Vec<u32> {
        // The first picture is not to wait for the second.
        let others = if self.steps == 0 { 0 } else { ROWS_AT_ONCE - 1 };
        let wanted = |patch: &u32| *patch != sender && book.rows.of(*patch).is_empty();
        let power = |patch: u32| (self.unsent_power(book, patch), patch);
        let mut next: Vec<(f64, u32)> = book
            .patches
            .iter()
            .copied()
            .filter(wanted)
            .map(power)
            .filter(|(power, _)| *power > 0.0)
            .collect();
        next.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        next.truncate(others);
        std::iter::once(sender).chain(next.into_iter().map(|(_, patch)| patch)).collect()
    }

    /// Patches that fill too much of what one of the senders sees, and may be divided.
    fn too_big(&self, book: &Book<'_>, batch: &[u32], rows: &[Vec<(u32, f32)>]) -> Vec<u32> {
        let mut big = Vec::new();
        for (&sender, row) in batch.iter().zip(rows) {
            let most = book.settings.largest_factor * book.mesh.elements()[sender as usize].area;
            let too_big = row.iter().filter(|(_, exchange)| f64::from(*exchange) > most);
            big.extend(too_big.map(|(patch, _)| book.patches[*patch as usize]));
        }
        big.sort_unstable();
        big.dedup();
        let may_divide = |patch: &u32| {
            // Later on leaves are parts of patches.
            book.report.rounds == 0
                && self.divisions[*patch as usize] < book.settings.depth
                && book.mesh.longest_edge(*patch) > book.settings.smallest
        };
        big.retain(may_divide);
        big
    }

    /// Divides patches; their parts begin with their light.
    fn divide(&mut self, book: &mut Book<'_>, patches: &[u32]) -> bool {
        let mut any = false;
        for &patch in patches {
            if !book.mesh.divide(patch) {
                continue;
            }
            any = true;
            self.follow(book);
            let parts = book.mesh.elements()[patch as usize].part_numbers();
            let whole = patch as usize;
            for part in parts.map(|part| part as usize) {
                self.divisions[part] = self.divisions[whole] + 1;
                self.received[part] = self.received[whole];
                self.direct[part] = self.direct[whole];
                self.unsent[part] = self.unsent[whole];
                self.own[part] = self.own[whole];
                self.lamps[part] = self.lamps[whole];
            }
        }
        if any {
            book.number_patches();
        }
        any
    }

    /// The patch with most unsent power, of equal ones the first, and the unsent power of all.
    fn brightest(&self, book: &Book<'_>) -> (Option<u32>, f64) {
        let (mut best, mut brightest, mut all) = (0.0, None, 0.0);
        for &patch in &book.patches {
            let power = self.unsent_power(book, patch);
            all += power;
            if power > best {
                (best, brightest) = (power, Some(patch));
            }
        }
        (brightest, all)
    }

    /// Unsent power of a patch, all channels. Below 0 where it sent too much before lamps were looked at
    /// more closely; that counts as much.
    fn unsent_power(&self, book: &Book<'_>, patch: u32) -> f64 {
        let unsent = self.unsent[patch as usize].iter().map(|light| light.abs()).sum::<f64>();
        unsent * book.mesh.elements()[patch as usize].area
    }

    /// Power that is given off and reflected from lamps, all channels.
    fn given_power(&self, book: &Book<'_>) -> f64 {
        let power = |&patch: &u32| {
            book.mesh.elements()[patch as usize].area * self.given(book, patch).iter().sum::<f64>()
        };
        book.patches.iter().map(power).sum()
    }

    /// What a patch gives off, and reflects of lamps.
    fn given(&self, book: &Book<'_>, patch: u32) -> Rgb64 {
        let surface = book.mesh.surface(patch);
        let [emission, rho] = [surface.emission, surface.reflectance].map(rgb64);
        std::array::from_fn(|c| emission[c] + rho[c] * self.lamps[patch as usize][c])
    }

    /// Radiosity of a patch.
    fn radiosity(&self, book: &Book<'_>, patch: u32) -> Rgb64 {
        let (given, rho) = (self.given(book, patch), rgb64(book.mesh.surface(patch).reflectance));
        std::array::from_fn(|c| given[c] + rho[c] * self.received[patch as usize][c])
    }

    /// Light that arrives everywhere if the unsent power is spread evenly over all that light has met: the
    /// outsides of a room do not count.
    fn ambient(&self, book: &Book<'_>) -> Rgb64 {
        let (mut area, mut unsent, mut rho) = (0.0, [0.0; 3], [0.0; 3]);
        for &patch in &book.patches {
            let size = book.mesh.elements()[patch as usize].area;
            let surface = rgb64(book.mesh.surface(patch).reflectance);
            let met = self.received[patch as usize].into_iter().chain(self.given(book, patch));
            if met.fold(0.0, f64::max) <= 0.0 {
                continue;
            }
            area += size;
            (0..3).for_each(|c| unsent[c] += size * self.unsent[patch as usize][c]);
            (0..3).for_each(|c| rho[c] += size * surface[c]);
        }
        std::array::from_fn(|c| {
            let kept = if self.sent[c] > 0.0 { 1.0 - self.lost[c] / self.sent[c] } else { 1.0 };
            let light = kept * unsent[c] / (area - kept * rho[c]);
            if light.is_finite() { light.max(0.0) } else { 0.0 }
        })
    }

    /// Figures for the report.
    fn note(&self, book: &mut Book<'_>, rule: ShootingRule) {
        let unsent: Vec<Rgb64> = book.patches.iter().map(|&p| self.unsent[p as usize]).collect();
        book.radiosity = book.patches.iter().map(|&p| self.radiosity(book, p)).collect();
        let most = largest(&book.radiosity);
        let change = if most > 0.0 { largest(&unsent) / most } else { 0.0 };
        book.outcome = Outcome { sweeps: self.steps, change, converged: book.unsent <= rule.unsent };
        book.report.equations = book.patches.len() as u64;
        book.report.partial_factors = book.rows.count();
        book.report.factors = book.report.partial_factors;
        self.note_power(book);
    }

    /// Power that is neither absorbed, nor lost, nor still to be sent.
    fn note_power(&self, book: &mut Book<'_>) {
        let (mut given, mut missing) = ([0.0; 3], [0.0; 3]);
        for &patch in &book.patches {
            let (i, surface) = (patch as usize, book.mesh.surface(patch));
            let [emission, rho] = [surface.emission, surface.reflectance].map(rgb64);
            let area = book.mesh.elements()[i].area;
            for c in 0..3 {
                let cast = emission[c] + self.lamps[i][c];
                let kept = (1.0 - rho[c]) * (self.received[i][c] + self.lamps[i][c]);
                given[c] += area * cast;
                missing[c] += area * (cast - kept - self.unsent[i][c]);
            }
        }
        let most = given.into_iter().fold(0.0, f64::max);
        let share = |power: f64| if most > 0.0 { power.abs() / most } else { 0.0 };
        book.report.lost = self.lost.into_iter().map(share).fold(0.0, f64::max);
        book.balance = (0..3).map(|c| share(missing[c] - self.lost[c])).fold(0.0, f64::max);
    }

    /// Step 5, with the light that is still on its way.
    fn on_elements(&self, book: &mut Book<'_>, rule: ShootingRule) -> Solution {
        self.note(book, rule);
        let of =
            |values: &[Rgb64]| -> Vec<Rgb64> { book.patches.iter().map(|&p| values[p as usize]).collect() };
        let ambient = if rule.ambient { self.ambient(book) } else { [0.0; 3] };
        let lit: Vec<Rgb64> =
            of(&self.received).into_iter().map(|h| std::array::from_fn(|c| h[c] + ambient[c])).collect();
        book.solution_of(&lit, &of(&self.direct))
    }
}

/// How far the work has come, on the scale of the unsent share's logarithm.
fn progress(left: f64, wanted: f64) -> f32 {
    let share = left.max(f64::MIN_POSITIVE).ln() / wanted.ln();
    if share.is_finite() { share.clamp(0.0, 1.0) as f32 } else { 1.0 }
}

fn rgb64(color: LinearRgb) -> Rgb64 {
    color.to_array().map(f64::from)
}
