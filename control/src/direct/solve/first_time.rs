//! The final time of a guess, where that is free.

use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::barrier::Barrier;
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::PointDynamics;

/// How good a final time is: what limits are exceeded, then the cost.
type Figures = [f64; 2];

impl<D: PointDynamics> Interior<D> {
    /// Gives the guess the best of several final times around its own. That is the one with the least cost
    /// among those with room to all limits, else the one that exceeds them least.
    ///
    /// Far inside of all limits nothing but the barrier would bend the motion of least time, and the first
    /// steps would lead anywhere.
    ///
    /// Where joints move at both ends the times with which there are motions can have gaps: a short way can
    /// be passed at once, or by a turn back. So the times that joints need at the means of their rates are
    /// tried too, and taken if limits are kept and they cost less.
    pub fn choose_time(&mut self, at: impl Fn(f64) -> Spline) {
        let (first, mut best): (Spline, Option<(Figures, Spline)>) = (self.spline.clone(), None);
        // What the slowest motion exceeds too says nothing about the time.
        let mut everywhere = Vec::new();
        let around = |k: i32| first.duration() * 2.0_f64.powf(f64::from(k) * constants::OCTAVES);
        for k in (-constants::TIMES..=constants::TIMES).rev() {
            let spline = at(around(k));
            let Some(mut found) = self.figures_of(&spline) else { continue };
            let barrier = &self.barrier;
            let exceeds = |at: usize| barrier.unit[at] * barrier.distance[at] < 0.0;
            if k == constants::TIMES {
                everywhere = (0..barrier.count()).map(exceeds).collect();
            }
            if everywhere.contains(&true) {
                found[0] = self.exceeded(|_, at| !everywhere.get(at).is_some_and(|exceeds| *exceeds));
            }
            if best.as_ref().is_none_or(|(least, _)| found < *least) {
                best = Some((found, spline));
            }
        }
        for time in times_at_mean_rates(&first) {
            let spline = at(time);
            let Some(found) = self.figures_of(&spline) else { continue };
            let is_kept = found[0] < constants::FIRST_SLACK;
            if best.as_ref().is_none_or(|(least, _)| is_kept && found[1] < least[1]) {
                best = Some((found, spline));
            }
        }
        self.spline = best.map_or(first, |(_, spline)| spline);
    }

    /// How good a guess is, whose spline is that of the iterate then; torques without a cost count with that
    /// of the first motion. `None` where it cannot be evaluated.
    pub(super) fn figures_of(&mut self, spline: &Spline) -> Option<Figures> {
        let smooth = if self.needs_smoothing() { self.smooth_effort() } else { self.running.effort.clone() };
        let effort = std::mem::replace(&mut self.running.effort, smooth);
        let figures = self.evaluate_guess(spline);
        self.running.effort = effort;
        figures
    }

    fn evaluate_guess(&mut self, spline: &Spline) -> Option<Figures> {
        self.spline.copy_from(spline);
        self.prepare();
        self.evaluate().ok()?;
        let cost = self.running.cost(&self.spline, &self.points);
        cost.is_finite().then_some([self.exceeded(|_, _| true), cost])
    }

    /// By how much the limits that count are exceeded, or nearly so, relative to their ranges: what is
    /// exceeded and [`constants::FIRST_SLACK`].
    pub(super) fn exceeded(&self, counts: impl Fn(&Barrier, usize) -> bool) -> f64 {
        let barrier = &self.barrier;
        let limits = (0..barrier.count()).filter(|&at| barrier.weight[at] > 0.0 && counts(barrier, at));
        let limits = limits.filter(|&at| !barrier.side(at).is_equation);
        let exceeded = limits.map(|at| constants::FIRST_SLACK - barrier.unit[at] * barrier.distance[at]);
        exceeded.fold(0.0, f64::max)
    }
}

/// The times in which joints that move at an end pass their ways at the means of the rates at both ends (s).
fn times_at_mean_rates(spline: &Spline) -> Vec<f64> {
    let n = spline.dof;
    let [mut from, mut to] = [vec![0.0; 2 * n], vec![0.0; 2 * n]];
    spline.end(0, &mut from);
    spline.end(spline.mesh.phases(), &mut to);
    let times = (0..n).map(|i| 2.0 * (to[i] - from[i]) / (from[n + i] + to[n + i]));
    times.filter(|time| *time > 0.0 && time.is_finite()).collect()
}
