//! Cost, limits and the conditions of first order of a motion between the points of the solver.
//!
//! The cost is $\int l\\, dt$ by adaptive quadrature along the polynomials of x and u, limits of x are
//! looked at at random times, and the costates are integrated backwards along the motion, with adaptive
//! steps:
//!
//! $$ \dot y = -f_x^\top y + l_x, \qquad G(t) = \sum_i \max_{w} \left( H_{u,i} (w - u_i)
//!    - \tfrac12 l_{uu,ii} (w - u_i)^2 \right), \qquad H_u = f_u^\top y - l_u $$
//!
//! over all w within the limits of the control. G is zero where the maximum principle holds. With f linear
//! in u and a cost that is a sum over the controls, at most quadratic in each, no motion nearby costs less
//! than $J - \int G\\, dt$ but for terms of third order ([`crate::verify::optimality`]). Where f is not
//! linear in u, the curvature is that of $l - y^\top f$, controls for which it is not positive do not
//! count, and neither does what couples two controls.
//!
//! Costates begin at those of the solver at the end of each of [`PARTS`] parts of the motion, and go on over
//! the nodes of a part: what they differ by from those of the solver there counts in the gap of all that lies
//! before it. Where a limit of x is active, its multiplier is a force or an impulse on the costates: these
//! intervals do not count, and behind them the costates of the solver are taken again.

use super::interior::Interior;
use super::points::{Layout, POINTS};
use super::problem::DirectDynamics;
use crate::constants::direct::{ACTIVE, GAP, NARROWEST, PARTS};
use crate::constants::states::EXCESS;
use crate::extremal::dynamics::response::eval_error;
use crate::numerics::dormand_prince::Stopped;
use crate::numerics::gauss_kronrod::integrate;
use crate::numerics::radau::{self, Radau, System};
use crate::numerics::random::Random;
use crate::solve::Recorder;
use crate::verify::adjoint::INSIDE;
use crate::verify::blame::blamed;
use crate::verify::cost::asked;
use crate::verify::optimality::{LEAST_SCALE, place_inside, step_error};
use costate::EvalError;
use costate::dynamics::{Cost, Dynamics};

/// Seed of random times: the same motion is verified in the same way.
const SEED: u64 = 43;
/// Random times of an interval at which limits are looked at.
const TIMES: usize = 4;
/// Intervals that make most of what fails are divided into so many parts. A control that reaches its limit
/// inside of an interval is wrong by the second power of its width, its cost by the third: by 1/27.
const PARTS_OF_BLAMED: usize = 3;

/// What is found between the points, in units of the cost and relative to its size. Infinite where a value
/// cannot be evaluated.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct StateVerification {
    /// J by adaptive quadrature.
    pub cost: f64,
    /// Its difference from the cost of the solver, with the estimated error of the quadrature.
    pub cost_difference: f64,
    /// $\sum |\int G\\, dt|$ over the parts of the motion.
    pub gap: f64,
    /// The largest $|H_{u,i}|$ of a control inside its limits, relative to the largest of what it consists
    /// of.
    pub stationarity: f64,
    /// The time of that (s), and the control.
    pub stationarity_at: Option<(f64, usize)>,
    /// The largest difference of the integrated costates at a node from those of the solver, relative to the
    /// largest ones.
    pub costate_defect: f64,
    /// Largest excess of a limit of x at random times, relative to the largest value of the component.
    pub excess: f64,
    /// The time of that (s), and the component.
    pub excess_at: Option<(f64, usize)>,
    /// What each interval adds to cost, gap and limits that are not within their tolerances, in parts of
    /// them.
    pub(super) blame: Vec<f64>,
    /// Whether the search was stopped meanwhile.
    pub(super) is_interrupted: bool,
}

impl StateVerification {
    /// Nothing known yet.
    pub(super) fn unknown() -> Self {
        Self { cost: f64::NAN, cost_difference: f64::INFINITY, gap: f64::INFINITY, ..Self::default() }
    }

    /// Whether all is within the tolerance of the cost and the limits.
    pub(super) fn passes(&self, tolerance: f64) -> bool {
        // Not true for NaN.
        self.cost_difference <= tolerance && self.gap <= GAP * tolerance && self.excess <= EXCESS
    }

    /// Into how many parts each interval is divided where this does not pass: those that make most of the
    /// [blame](blamed). `None` where none is known, or nothing can be divided.
    pub(super) fn parts(&self, widths: &[f64]) -> Option<Vec<usize>> {
        let all: f64 = self.blame.iter().sum();
        if !(all > 0.0 && all.is_finite()) || self.is_interrupted {
            return None;
        }
        let parts = |(is_blamed, width): (bool, &f64)| {
            let is_wide = *width > PARTS_OF_BLAMED as f64 * NARROWEST;
            if is_blamed && is_wide { PARTS_OF_BLAMED } else { 1 }
        };
        let parts: Vec<usize> = blamed(&self.blame).into_iter().zip(widths).map(parts).collect();
        parts.iter().any(|&parts| parts > 1).then_some(parts)
    }
}

impl<D: Dynamics<f64>, C: Cost<f64>> DirectDynamics<D, C> {
    /// Looks at a motion between its points.
    pub(super) fn look_between(
        &mut self,
        mesh: &Interior,
        tolerance: f64,
        recorder: &mut Recorder<'_>,
    ) -> StateVerification {
        let mut found = StateVerification::unknown();
        found.blame = vec![0.0; mesh.layout.intervals];
        (found.excess, found.excess_at) = excess(mesh, &mut found.blame);
        let outcome = self.integrate_cost(mesh, tolerance, recorder, &mut found).and_then(|()| {
            let mut costates = Costates::new(self, mesh, recorder);
            costates.follow(tolerance, &mut found)
        });
        found.is_interrupted = matches!(outcome, Err(Stopped::Interrupted));
        found
    }

    fn integrate_cost(
        &mut self,
        mesh: &Interior,
        tolerance: f64,
        recorder: &mut Recorder<'_>,
        found: &mut StateVerification,
    ) -> Result<(), Stopped> {
        let Layout { n, m, intervals } = mesh.layout;
        let (mut x, mut slope, mut u) = (vec![0.0; n], vec![0.0; n], vec![0.0; m]);
        let (asked, most) = asked([tolerance, mesh.cost_size()], intervals);
        let segments = (0..intervals).map(|k| (k, [0.0, 1.0]));
        let own = integrate(segments, asked, most, |k, s| {
            if recorder.interruption().is_some() {
                return Err(Stopped::Interrupted);
            }
            mesh.state(k, s, &mut x, &mut slope);
            mesh.control(k, s, &mut u);
            Ok(mesh.widths[k] * mesh.time() * self.running(&x, &u)?)
        })?;
        let cost = own.value + self.time_weight() * mesh.time();
        found.cost = self.reference * cost;
        found.cost_difference = ((cost - mesh.cost).abs() + own.error) / mesh.cost_size();
        if found.cost_difference > tolerance {
            let allowed = tolerance * mesh.cost_size();
            for (k, (blame, own)) in found.blame.iter_mut().zip(&own.parts).enumerate() {
                *blame += (own - self.cost_of(mesh, k)?).abs() / allowed;
            }
        }
        Ok(())
    }

    /// What the solver adds up for the running cost of an interval.
    fn cost_of(&mut self, mesh: &Interior, k: usize) -> Result<f64, EvalError> {
        let Layout { n, m, .. } = mesh.layout;
        let mut sum = 0.0;
        for (j, weight) in mesh.radau.weights.iter().enumerate() {
            let (x, u) = mesh.w[mesh.layout.point(k, j)..][..n + m].split_at(n);
            sum += mesh.widths[k] * mesh.time() * weight * self.running(x, u)?;
        }
        Ok(sum)
    }
}

/// The largest excess of a limit of x at random times of each interval, relative to the size of the
/// component, its time (s) and the component.
fn excess(mesh: &Interior, blame: &mut [f64]) -> (f64, Option<(f64, usize)>) {
    let n = mesh.layout.n;
    let (sizes, mut random) = (mesh.sizes(), Random::new(SEED));
    let (mut x, mut slope) = (vec![0.0; n], vec![0.0; n]);
    let (mut most, mut at, mut start) = (0.0, None, 0.0);
    for (k, blame) in blame.iter_mut().enumerate() {
        for _ in 0..TIMES {
            let s = random.uniform();
            mesh.state(k, s, &mut x, &mut slope);
            let first = mesh.layout.point(k, 0);
            for (i, x) in x.iter().enumerate() {
                let excess = match x.is_nan() {
                    true => f64::INFINITY,
                    false => (mesh.low[first + i] - x).max(x - mesh.high[first + i]) / sizes[i],
                };
                *blame = blame.max(if excess > EXCESS { excess / EXCESS } else { 0.0 });
                if excess > most {
                    (most, at) = (excess, Some(((start + s * mesh.widths[k]) * mesh.time(), i)));
                }
            }
        }
        start += mesh.widths[k];
    }
    (most, at)
}

/// The costates along an interval as functions of its part s, with the gap that they leave.
struct Costates<'a, 'r, D, C> {
    task: &'a mut DirectDynamics<D, C>,
    mesh: &'a Interior,
    recorder: &'a mut Recorder<'r>,
    interval: usize,
    /// Start of the interval, in parts of the motion.
    start: f64,
    counts: bool,
    gap: f64,
    /// For each control the largest residual inside its limits with its time, and the largest of what it
    /// consists of.
    worst: Vec<(f64, f64)>,
    largest: Vec<f64>,
    /// Whether f is linear in u.
    is_linear: bool,
    bends: Vec<f64>,
    x: Vec<f64>,
    u: Vec<f64>,
    slope: Vec<f64>,
    first: Vec<f64>,
    second: Vec<f64>,
    y_f: [Vec<f64>; 2],
}

impl<'a, 'r, D: Dynamics<f64>, C: Cost<f64>> Costates<'a, 'r, D, C> {
    fn new(task: &'a mut DirectDynamics<D, C>, mesh: &'a Interior, recorder: &'a mut Recorder<'r>) -> Self {
        let Layout { n, m, .. } = mesh.layout;
        let zeros = |count| vec![0.0; count];
        let is_linear = task.model.structure().affine_in_u;
        Self {
            task,
            mesh,
            recorder,
            interval: 0,
            start: 0.0,
            counts: true,
            gap: 0.0,
            worst: vec![(0.0, 0.0); m],
            largest: zeros(m),
            is_linear,
            bends: zeros(m),
            x: zeros(n),
            u: zeros(m),
            slope: zeros(n),
            first: zeros(n + m),
            second: zeros((n + m) * (n + m)),
            y_f: [zeros(n), zeros(m)],
        }
    }

    /// The costates of the solver at the start of an interval, or, behind the last one, at its end.
    fn at_node(&self, k: usize) -> Vec<f64> {
        let Layout { n, intervals, .. } = self.mesh.layout;
        if k == intervals {
            return (0..n).map(|i| self.mesh.costate(k - 1, 1.0, i)).collect();
        }
        // Those of the defects themselves, which are accurate to the order of the method at nodes.
        let of = |i: usize| {
            let lambda = |j: usize| self.mesh.lambda[(k * POINTS + j) * n + i];
            (0..POINTS).map(|j| -self.mesh.radau.slopes[j][0] * lambda(j)).sum()
        };
        (0..n).map(of).collect()
    }

    /// Integrates the costates over all intervals, backwards.
    fn follow(&mut self, tolerance: f64, found: &mut StateVerification) -> Result<(), Stopped> {
        let Layout { n, intervals, .. } = self.mesh.layout;
        let nodes: Vec<Vec<f64>> = (0..=intervals).map(|k| self.at_node(k)).collect();
        let mut radau = Radau::new(n, step_error(tolerance));
        let most = nodes.iter().flatten().fold(f64::MIN_POSITIVE, |most: f64, y| most.max(y.abs()));
        for (i, size) in radau.sizes.iter_mut().enumerate() {
            *size = nodes.iter().fold(LEAST_SCALE * most, |most, y| most.max(y[i].abs()));
        }
        let mut random = Random::new(SEED);
        let mut costate = nodes[intervals].clone();
        let mut gaps = vec![0.0; intervals];
        let (mut end, mut last, mut of_part, mut all) = (1.0, None, 0.0_f64, 0.0);
        for k in (0..intervals).rev() {
            let width = self.mesh.widths[k];
            let (counts, part) = (!self.is_on_arc(k), (PARTS * (end - 0.5 * width)) as usize);
            if last != Some(part) {
                all += of_part.abs();
                of_part = 0.0;
                costate.copy_from_slice(&nodes[k + 1]);
            }
            (self.interval, self.start, self.counts, self.gap) = (k, end - width, counts, 0.0);
            let middle = place_inside(&mut random);
            radau.integrate(&mut costate, 1.0..middle, 1.0, self)?;
            radau.integrate(&mut costate, middle..0.0, 1.0, self)?;
            of_part += self.gap;
            gaps[k] = self.gap.abs();
            if counts {
                let parts = costate.iter().zip(&nodes[k]).zip(&radau.sizes);
                let defect = parts.map(|((a, b), size)| ((a - b) / size).abs()).fold(0.0, f64::max);
                found.costate_defect = found.costate_defect.max(defect);
            }
            (end, last) = (end - width, counts.then_some(part));
        }
        found.gap = (all + of_part.abs()) / self.mesh.cost_size();
        let allowed = GAP * tolerance;
        if found.gap > allowed {
            let allowed = allowed * self.mesh.cost_size();
            found.blame.iter_mut().zip(&gaps).for_each(|(blame, gap)| *blame += gap / allowed);
        }
        for (i, (&(residual, time), largest)) in self.worst.iter().zip(&self.largest).enumerate() {
            if residual > found.stationarity * largest {
                (found.stationarity, found.stationarity_at) = (residual / largest, Some((time, i)));
            }
        }
        Ok(())
    }

    /// Whether a limit of x is active at a point of the interval.
    fn is_on_arc(&self, k: usize) -> bool {
        let Layout { n, .. } = self.mesh.layout;
        let nodes = [self.mesh.layout.node(k)].into_iter();
        let mut points = nodes.chain((0..POINTS).map(|j| self.mesh.layout.point(k, j)));
        points.any(|at| {
            (0..n).any(|i| {
                let (low, high, x) = (self.mesh.low[at + i], self.mesh.high[at + i], self.mesh.w[at + i]);
                let range = if (high - low).is_finite() { high - low } else { self.mesh.size(i) };
                x - low < ACTIVE * range || high - x < ACTIVE * range
            })
        })
    }

    /// H_u with the curvature of each control at the part s, of these costates: G.
    fn gap_at(&mut self, s: f64, y: &[f64]) -> Result<f64, EvalError> {
        let Layout { n, m, .. } = self.mesh.layout;
        self.take(s, y)?;
        if !self.is_linear {
            let all = self.task.model.contract(&self.x, &self.u, y).map_err(eval_error)?;
            let uu = all.uu;
            self.bends.iter_mut().enumerate().for_each(|(i, bend)| *bend = uu.map_or(0.0, |uu| uu[(i, i)]));
        }
        let (mut gap, size) = (0.0, n + m);
        let limits = self.mesh.layout.point(self.interval, 0) + n;
        let time = (self.start + s * self.mesh.widths[self.interval]) * self.mesh.time();
        for i in 0..m {
            let (price, slope, u) = (self.y_f[1][i], self.first[n + i], self.u[i]);
            let curvature = self.second[(n + i) * size + n + i] - self.bends[i];
            let (low, high) = (self.mesh.low[limits + i], self.mesh.high[limits + i]);
            if self.is_linear || curvature > 0.0 {
                gap += gain(price - slope, curvature, [low - u, high - u]);
            }
            self.largest[i] = self.largest[i].max(price.abs()).max(slope.abs());
            let margin = INSIDE * (high - low);
            let is_inside = !margin.is_finite() || (low + margin < u && u < high - margin);
            if is_inside && (price - slope).abs() > self.worst[i].0 {
                self.worst[i] = ((price - slope).abs(), time);
            }
        }
        Ok(gap)
    }

    /// The motion at the part s, with the derivatives of the running cost and y'f there.
    fn take(&mut self, s: f64, y: &[f64]) -> Result<(), EvalError> {
        self.mesh.state(self.interval, s, &mut self.x, &mut self.slope);
        self.mesh.control(self.interval, s, &mut self.u);
        self.task.running_derivatives(&self.x, &self.u, &mut self.first, &mut self.second)?;
        let [y_f_x, y_f_u] = &mut self.y_f;
        self.task.model.adjoint(&self.x, &self.u, y, y_f_x, y_f_u).map_err(eval_error)
    }
}

/// The largest $g d - \tfrac12 r d^2$ for a step d within these ends, which lie to either side of 0. That of
/// a control without curvature and without an end there has no bound, however small g is, and does not count:
/// such a control is on a singular arc, where g is zero, which [`StateVerification::stationarity`] measures.
fn gain(slope: f64, curvature: f64, [low, high]: [f64; 2]) -> f64 {
    let free = if curvature > 0.0 { slope / curvature } else { f64::INFINITY.copysign(slope) };
    let step = if slope == 0.0 { 0.0 } else { free.max(low).min(high) };
    if step.is_finite() { (slope - 0.5 * curvature * step) * step } else { 0.0 }
}

impl<D: Dynamics<f64>, C: Cost<f64>> System for Costates<'_, '_, D, C> {
    fn linearise(
        &mut self,
        s: f64,
        y: &[f64],
        rate: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<(), EvalError> {
        let n = y.len();
        self.take(s, y)?;
        let h = self.mesh.widths[self.interval] * self.mesh.time();
        for (i, rate) in rate.iter_mut().enumerate() {
            *rate = h * (self.first[i] - self.y_f[0][i]);
        }
        let linear = self.task.model.linearise(&self.x, &self.u).map_err(eval_error)?;
        for (j, row) in linear.f_x.iter_rows().enumerate() {
            row.iter().enumerate().for_each(|(i, f_x)| jacobian[n * i + j] = -h * f_x);
        }
        Ok(())
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn stops(&mut self) -> bool {
        self.recorder.interruption().is_some()
    }

    fn accept(&mut self, from: f64, length: f64, stages: [&[f64]; 3]) -> Result<(), EvalError> {
        if !self.counts {
            return Ok(());
        }
        let whole = length.abs() * self.mesh.widths[self.interval] * self.mesh.time();
        for ((place, weight), y) in radau::PLACES.iter().zip(radau::WEIGHTS).zip(stages) {
            self.gap += whole * weight * self.gap_at(from + place * length, y)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::SolverOptions;
    use crate::solve::recorder::Stop;
    use crate::{DynamicsProblem, EndState, FinalTime};
    use costate::derivative::Function;
    use costate::dynamics::Automatic;
    use costate::scalar::Scalar;

    /// q' = v, v' = u.
    #[derive(Clone)]
    struct Cart;

    impl Function for Cart {
        type Workspace<S: Scalar> = ();
        type Error = std::convert::Infallible;
        fn inputs(&self) -> usize {
            3
        }
        fn outputs(&self) -> usize {
            2
        }
        fn workspace<S: Scalar>(&self) {}
        fn evaluate<S: Scalar>(&self, _: &mut (), z: &[S], f: &mut [S]) -> Result<(), Self::Error> {
            (f[0], f[1]) = (z[1], z[2]);
            Ok(())
        }
    }

    /// The motion over 1 m in 1 s with least effort, u = 6 - 12 t with the cost 6, changed by `change`, which
    /// gets the control and the multiplier of v of each point, and its weight.
    fn looked(change: impl Fn(&mut f64, &mut f64, f64)) -> StateVerification {
        let [from, to] = [[0.0, 0.0], [1.0, 0.0]].map(|x| EndState::fixed(&x));
        let problem = DynamicsProblem::new(from, to, FinalTime::Fixed(1.0), 1);
        let mut task = DirectDynamics::new(Automatic::<Cart>::new(Cart), &problem).unwrap();
        let layout = Layout { n: 2, m: 1, intervals: 8 };
        let guess = task.unknowns(&layout);
        let mut mesh = Interior::new(&task, vec![0.125; 8], guess, false);
        let mut recorder = Recorder::new(None, Stop::new(None, None));
        mesh.solve(&mut task, 1e-9, &SolverOptions::default(), &mut recorder, &mut Vec::new()).unwrap();
        for k in 0..8 {
            for j in 0..POINTS {
                let u = &mut mesh.w[layout.point(k, j) + 2];
                change(u, &mut mesh.lambda[(k * POINTS + j) * 2 + 1], mesh.radau.weights[j]);
            }
        }
        task.look_between(&mesh, 1e-6, &mut recorder)
    }

    #[test]
    fn a_least_effort_has_no_gap() {
        let found = looked(|_, _, _| ());
        assert!(found.gap < 1e-12 && found.costate_defect < 1e-6 && found.stationarity < 1e-6, "{found:?}");
        assert!(found.cost_difference < 1e-12 && (found.cost - 6.0).abs() < 1e-8, "{found:?}");
    }

    /// u is 0.3 too large throughout: the gap is the integral of half the square, relative to the cost 6, and
    /// so is what the cost differs by from that of the solver, as u is zero on average.
    #[test]
    fn a_wrong_control_costs_half_its_square() {
        let found = looked(|u, _, _| *u += 0.3);
        let expected = 0.5 * 0.09 / 6.0;
        assert!((found.gap - expected).abs() < 1e-6, "{found:?}");
        assert!((found.cost_difference - expected).abs() < 1e-6, "{found:?}");
        // Beside the largest u, or its costate.
        assert!((found.stationarity - 0.3 / 6.3).abs() < 1e-3, "{found:?}");
    }

    /// Another y_v, which obeys the equations of the costates as well: the control is not the best one for
    /// it.
    #[test]
    fn wrong_costates_leave_a_gap() {
        let found = looked(|_, lambda, weight| *lambda += 0.3 * weight);
        assert!((found.gap - 0.5 * 0.09 / 6.0).abs() < 1e-6 && found.costate_defect < 1e-6, "{found:?}");
    }

    #[test]
    fn gains_are_those_of_the_best_step() {
        // Inside: g^2/2r. At an end: g d - r d^2/2. Without curvature the end. Nothing to gain at a bound.
        assert_eq!(gain(3.0, 2.0, [-9.0, 9.0]), 2.25);
        assert_eq!(gain(3.0, 2.0, [-9.0, 1.0]), 2.0);
        assert_eq!(gain(-3.0, 0.0, [-2.0, 1.0]), 6.0);
        assert_eq!(gain(3.0, 2.0, [-1.0, 0.0]), 0.0);
        assert_eq!(gain(0.0, 0.0, [f64::NEG_INFINITY, f64::INFINITY]), 0.0);
        assert_eq!(gain(1.0, 0.0, [f64::NEG_INFINITY, f64::INFINITY]), 0.0);
        // A control beyond its limit, by rounding.
        assert_eq!(gain(3.0, 2.0, [-9.0, -1e-9]), -3e-9 - 1e-18);
    }
}
