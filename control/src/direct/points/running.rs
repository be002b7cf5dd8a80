//! The running cost of a motion: time, effort, energy, penalties, user terms, tools.

use super::energy::Energy;
use super::panels::{GAUSS, Panels, next_panel};
use super::rates::RateCosts;
use super::values::Points;
use crate::direct::motion::spline::Spline;
use crate::extremal::penalty::Penalties;
use crate::extremal::user_terms::UserTerms;
use crate::problem::{Problem, TaskError, ToolOrientation};
use crate::task::build::TaskRows;
use crate::task::costs::ToolCosts;
use crate::task::references::References;

/// `c_t + 1/2 sum r_i tau_i^2 + energy + penalties + terms + tools + references + jerks + rates of torques`,
/// per second. References depend on the time since the start of the motion.
#[derive(Debug)]
pub(crate) struct Running {
    /// c_t.
    pub time: f64,
    /// r_i over the square of the gain.
    pub effort: Vec<f64>,
    pub energy: Energy,
    pub rates: RateCosts,
    penalties: Penalties,
    terms: UserTerms<f64>,
    tools: ToolCosts,
    pub references: References,
    /// How references are integrated on each interval.
    pub panels: Panels,
}

/// Derivatives of the running cost at a point by the time since the start of the motion, with the weight w of
/// the point and the time T of its phase.
#[derive(Clone, Debug, Default)]
pub(crate) struct ByClock {
    /// `w l_t`.
    pub rate: f64,
    /// `T w l_t` and `T w l_tt`.
    pub first: f64,
    pub second: f64,
    /// `T w l_zt`, z = (q, v, a).
    pub mixed: Vec<f64>,
}

impl Running {
    /// Whether torques cost anything.
    pub fn costs_torques(&self) -> bool {
        self.effort.iter().any(|weight| *weight > 0.0)
    }

    /// That of a problem with the functions of its task.
    pub fn new(problem: &Problem, rows: &TaskRows) -> Self {
        let n = problem.coordinates();
        let tools = ToolCosts::new(rows.costs.clone(), rows.weights.clone(), n);
        let references = References::new(&problem.task.references, rows.references.clone(), n);
        let effort =
            problem.cost.effort.iter().zip(&problem.gain).map(|(r, gain)| r / (gain * gain)).collect();
        let terms = UserTerms::new(n, &problem.terms);
        let penalties = Penalties::new(n, problem.penalty.as_ref());
        let energy = Energy::new(&problem.cost);
        let rates = RateCosts::new(&problem.cost);
        let (time, panels) = (problem.cost.time, Panels::new(n));
        Self { time, effort, energy, rates, penalties, terms, tools, references, panels }
    }

    /// Changes the value at which a row of a tool costs nothing.
    pub fn set_tool_value(&mut self, row: usize, value: f64) {
        self.tools.set_value(row, value);
    }

    /// Changes the orientation at which a tool costs nothing, whose first row this is.
    ///
    /// # Errors
    /// The cause: no orientation, or one of the other kind.
    pub fn orient_tool(&mut self, row: usize, to: &ToolOrientation) -> Result<(), TaskError> {
        self.tools.orient(row, to)
    }

    /// The cost of a motion.
    pub fn cost(&mut self, spline: &Spline, points: &Points) -> f64 {
        let rates = points.rates.cost(spline, &self.rates);
        if !self.split(spline) {
            let cost = |p: usize| spline.weight(p) * self.rate(spline.time_of(p), points.z(p), points.tau(p));
            return (0..points.count()).map(cost).sum::<f64>() + rates;
        }
        let mut sum = rates;
        for p in 0..points.count() {
            sum += spline.weight(p) * self.rate_without_references(points.z(p), points.tau(p));
            let weight = self.panels.weight(spline, p) * spline.clock(spline.mesh.interval_of(p).0);
            if weight > 0.0 {
                sum += weight * self.rate_of_references(spline.time_of(p), points.z(p));
            }
        }
        for k in 0..spline.mesh.intervals() {
            if self.panels.is_split(k) {
                sum += spline.length(k) * self.mean_of_references(spline, k, &GAUSS);
            }
        }
        sum
    }

    /// Finds the intervals that have knots inside. Whether there are any.
    pub fn split(&mut self, spline: &Spline) -> bool {
        let Self { panels: Panels { split, .. }, references, .. } = self;
        split.clear();
        if !references.any() {
            return false;
        }
        let has_knot = |k: usize| next_panel(references, spline, k, 0.0).is_some_and(|to| to < 1.0);
        split.extend((0..spline.mesh.intervals()).map(has_knot));
        split.contains(&true)
    }

    /// The mean cost of references on an interval per second, with this rule, places and weights on [0, 1],
    /// on each panel.
    pub fn mean_of_references(&mut self, spline: &Spline, k: usize, rule: &[[f64; 2]]) -> f64 {
        let mut z = std::mem::take(&mut self.panels.z);
        let (mut sum, mut from) = (0.0, 0.0);
        while let Some(to) = next_panel(&self.references, spline, k, from) {
            for [place, weight] in rule {
                let x = from + place * (to - from);
                spline.in_interval(k, x, &mut z);
                let time = spline.time_at(spline.mesh.nodes[k]) + x * spline.length(k);
                sum += weight * (to - from) * self.rate_of_references(time, &z);
            }
            from = to;
        }
        self.panels.z = z;
        sum
    }

    /// The integral of the magnitudes of those parts that are negative: energy, which its smoothing lets be
    /// so where motors brake, joint by joint, and all user terms together. The other parts never are. A cost
    /// that crosses zero is not small: the sum of the magnitudes of its parts is its size.
    pub fn negative_parts(&self, spline: &Spline, points: &Points) -> f64 {
        let has_energy = !self.energy.weights.is_empty();
        if !has_energy && !self.terms.any() {
            return 0.0;
        }
        let n = points.dof;
        let of = |p: usize| {
            let (z, tau) = (points.z(p), points.tau(p));
            let (q, v) = (&z[..n], &z[n..2 * n]);
            let terms = if self.terms.any() { self.terms.at(q, v) } else { 0.0 };
            spline.weight(p) * (self.energy.negative_parts(v, tau) + (-terms).max(0.0))
        };
        (0..points.count()).map(of).sum()
    }

    /// l at a time without the costs of jerks and of rates of torques; infinite where tools cannot be
    /// evaluated.
    pub fn rate(&mut self, time: f64, z: &[f64], tau: &[f64]) -> f64 {
        self.rate_without_references(z, tau) + self.rate_of_references(time, z)
    }

    /// What references cost per second; `z` has 3n entries.
    pub(super) fn rate_of_references(&mut self, time: f64, z: &[f64]) -> f64 {
        if !self.references.any() {
            return 0.0;
        }
        self.references.evaluate(time, &z[..z.len() / 3]).unwrap_or(f64::INFINITY)
    }

    /// The same of everything else.
    pub fn rate_without_references(&mut self, z: &[f64], tau: &[f64]) -> f64 {
        let n = tau.len();
        let (q, v) = (&z[..n], &z[n..2 * n]);
        let effort: f64 = tau.iter().zip(&self.effort).map(|(tau, r)| 0.5 * r * tau * tau).sum();
        let tools = if self.tools.any() { self.tools.evaluate(q, v).unwrap_or(f64::INFINITY) } else { 0.0 };
        let energy = self.energy.rate(v, tau);
        self.time + effort + energy + self.terms.at(q, v) + self.penalty_rate(z) + tools
    }

    /// The penalties at a point.
    fn penalty_rate(&self, z: &[f64]) -> f64 {
        if !self.penalties.any() {
            return 0.0;
        }
        let n = z.len() / 3;
        let of = |i: usize| self.penalties.position(i, z[i]).value + self.penalties.rate(i, z[n + i]).value;
        (0..n).map(of).sum()
    }

    /// The penalties of a motion.
    pub fn penalty_cost(&self, spline: &Spline, points: &Points) -> f64 {
        (0..points.count()).map(|p| spline.weight(p) * self.penalty_rate(points.z(p))).sum()
    }

    /// Adds the terms at a point: `T w l_z` to the gradient, `w l_z` to the slope, `T w l_zz` to the Hessian,
    /// whose rows are as long as the gradient, 3n or more. The value is l without effort and energy.
    pub fn add_terms(
        &mut self,
        z: &[f64],
        [weight, time]: [f64; 2],
        gradient: &mut [f64],
        slope: &mut [f64],
        hessian: &mut [f64],
    ) -> f64 {
        let (n, width) = (z.len() / 3, gradient.len());
        let mut penalty = 0.0;
        if self.penalties.any() {
            for i in 0..n {
                let terms =
                    [(i, self.penalties.position(i, z[i])), (n + i, self.penalties.rate(i, z[n + i]))];
                for (at, term) in terms {
                    penalty += term.value;
                    gradient[at] += time * weight * term.first;
                    slope[at] += weight * term.first;
                    hessian[width * at + at] += time * weight * term.second;
                }
            }
        }
        let (q, v) = (&z[..n], &z[n..2 * n]);
        let tools = self.add_tools([q, v], [weight, time], gradient, slope, hessian);
        if !self.terms.any() {
            return penalty + tools;
        }
        self.terms.second(q, v);
        for i in 0..2 * n {
            gradient[i] += time * weight * self.terms.gradient[i];
            slope[i] += weight * self.terms.gradient[i];
            for j in 0..2 * n {
                hessian[width * i + j] += time * weight * self.terms.hessian[(i, j)];
            }
        }
        penalty + tools + self.terms.value
    }

    /// The same of the tools.
    fn add_tools(
        &mut self,
        [q, v]: [&[f64]; 2],
        [weight, time]: [f64; 2],
        gradient: &mut [f64],
        slope: &mut [f64],
        hessian: &mut [f64],
    ) -> f64 {
        if !self.tools.any() {
            return 0.0;
        }
        if self.tools.contract(q, v).is_err() {
            return f64::INFINITY;
        }
        let size = self.tools.gradient.len();
        for (i, from) in self.tools.gradient.iter().enumerate() {
            gradient[i] += time * weight * from;
            slope[i] += weight * from;
        }
        let rows = hessian.chunks_exact_mut(gradient.len()).zip(self.tools.hessian.chunks_exact(size));
        for (to, from) in rows {
            to.iter_mut().zip(from).for_each(|(to, from)| *to += time * weight * from);
        }
        self.tools.value
    }

    /// The same of the references at a time, with the derivatives by it. `z` has 3n entries.
    pub fn add_references(
        &mut self,
        (time_since, z): (f64, &[f64]),
        [weight, time]: [f64; 2],
        gradient: &mut [f64],
        slope: &mut [f64],
        hessian: &mut [f64],
        clock: &mut ByClock,
    ) -> f64 {
        let n = z.len() / 3;
        clock.mixed.fill(0.0);
        let Ok(found) = self.references.contract(time_since, &z[..n]) else {
            return f64::INFINITY;
        };
        let [first, second] = found.by_time;
        (clock.rate, clock.first, clock.second) =
            (weight * first, time * weight * first, time * weight * second);
        for i in 0..n {
            gradient[i] += time * weight * found.gradient[i];
            slope[i] += weight * found.gradient[i];
            clock.mixed[i] = time * weight * found.mixed[i];
        }
        let rows = hessian.chunks_exact_mut(gradient.len()).zip(found.hessian.chunks_exact(2 * n));
        for (to, from) in rows.take(n) {
            to.iter_mut().zip(&from[..n]).for_each(|(to, from)| *to += time * weight * from);
        }
        found.value
    }
}
