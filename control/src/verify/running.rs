//! The running cost as the problem states it, with its first derivatives.

use crate::extremal::penalty::Penalties;
use crate::extremal::user_terms::UserTerms;
use crate::problem::Problem;
use crate::task::build::TaskRows;
use crate::task::costs::ToolCosts;
use crate::task::references::References;
use costate::EvalError;

/// $$ l = c_t + \sum_i \left( \tfrac12 r_i \tau_i^2 + e_i \phi(v_i \tau_i) + \tfrac12 w_i j_i^2
/// {}+ \tfrac12 z_i \dot\tau_i^2 \right) + \text{penalties} + \text{terms} + \text{tools} +
/// \text{references} $$
///
/// per second, $\phi(p) = \frac12 (p + \sqrt{p^2 + s^2} - s)$, j the jerk.
#[derive(Clone, Debug)]
pub(crate) struct Running {
    /// c_t.
    pub time: f64,
    /// r_i over the square of the gain, then e_i, w_i and the weights of rates of torques.
    pub effort: Vec<f64>,
    energy: Vec<f64>,
    jerk: Vec<f64>,
    torque_rate: Vec<f64>,
    /// s.
    smoothing: f64,
    penalties: Penalties,
    terms: UserTerms<f64>,
    tools: ToolCosts,
    references: References,
    /// l_x at constant torques, x = (q, v), and l_tau, of [`differentiate`](Self::differentiate).
    pub by_state: Vec<f64>,
    pub by_torque: Vec<f64>,
}

impl Running {
    /// That of a problem with the functions of its task.
    pub fn new(problem: &Problem, rows: &TaskRows) -> Self {
        let (n, cost) = (problem.coordinates(), &problem.cost);
        let list = |list: &Option<Vec<f64>>| {
            list.clone().filter(|list| list.iter().any(|&weight| weight != 0.0)).unwrap_or_default()
        };
        Self {
            time: cost.time,
            effort: cost.effort.iter().zip(&problem.gain).map(|(r, gain)| r / (gain * gain)).collect(),
            energy: list(&cost.energy),
            jerk: list(&cost.jerk),
            torque_rate: list(&cost.torque_rate),
            smoothing: cost.energy_smoothing,
            penalties: Penalties::new(n, problem.penalty.as_ref()),
            terms: UserTerms::new(n, &problem.terms),
            tools: ToolCosts::new(rows.costs.clone(), rows.weights.clone(), n),
            references: References::new(&problem.task.references, rows.references.clone(), n),
            by_state: vec![0.0; 2 * n],
            by_torque: vec![0.0; n],
        }
    }

    /// With these weights of torques in place of those of the problem.
    pub fn with_effort(self, effort: Vec<f64>) -> Self {
        Self { effort, ..self }
    }

    /// Whether rates of torques cost anything.
    pub fn costs_torque_rates(&self) -> bool {
        !self.torque_rate.is_empty()
    }

    /// w_i.
    pub fn jerk_weight(&self, joint: usize) -> f64 {
        self.jerk.get(joint).copied().unwrap_or(0.0)
    }

    /// z_i.
    pub fn torque_rate_weight(&self, joint: usize) -> f64 {
        self.torque_rate.get(joint).copied().unwrap_or(0.0)
    }

    /// l at a time without the penalties, and the penalties; z = (q, v, a, jerk), `rates` of torques where
    /// they cost anything.
    ///
    /// # Errors
    /// States at which tools cannot be evaluated.
    pub fn rate(&mut self, time: f64, z: &[f64], tau: &[f64], rates: &[f64]) -> Result<[f64; 2], EvalError> {
        let n = tau.len();
        let (q, v) = (&z[..n], &z[n..2 * n]);
        let squares = |weights: &[f64], values: &[f64]| -> f64 {
            weights.iter().zip(values).map(|(weight, value)| 0.5 * weight * value * value).sum()
        };
        let mut sum = self.time + squares(&self.effort, tau) + squares(&self.torque_rate, rates);
        if !self.jerk.is_empty() {
            sum += squares(&self.jerk, &z[3 * n..]);
        }
        sum += (0..self.energy.len()).map(|i| self.energy(i, v[i] * tau[i])[0]).sum::<f64>();
        if self.terms.any() {
            sum += self.terms.at(q, v);
        }
        if self.tools.any() {
            sum += self.tools.evaluate(q, v)?;
        }
        if self.references.any() {
            sum += self.references.evaluate(time, q)?;
        }
        let mut penalty = 0.0;
        if self.penalties.any() {
            for i in 0..n {
                penalty += self.penalties.position(i, q[i]).value + self.penalties.rate(i, v[i]).value;
            }
        }
        Ok([sum, penalty])
    }

    /// $e_i \phi(p)$ and its derivative by the power p.
    fn energy(&self, joint: usize, power: f64) -> [f64; 2] {
        let (weight, root) = (self.energy[joint], power.hypot(self.smoothing));
        let slope = if root > 0.0 { power / root } else { 0.0 };
        [0.5 * weight * (power + (root - self.smoothing)), 0.5 * weight * (1.0 + slope)]
    }

    /// l_x at constant torques, and l_tau; all costs but those of jerks and of rates of torques.
    ///
    /// # Errors
    /// As [`rate`](Self::rate).
    pub fn differentiate(&mut self, time: f64, z: &[f64], tau: &[f64]) -> Result<(), EvalError> {
        let n = tau.len();
        let (q, v) = (&z[..n], &z[n..2 * n]);
        self.by_state.fill(0.0);
        for (i, tau) in tau.iter().enumerate() {
            self.by_torque[i] = self.effort.get(i).map_or(0.0, |r| r * tau);
        }
        for i in 0..self.energy.len() {
            let [_, slope] = self.energy(i, v[i] * tau[i]);
            self.by_torque[i] += slope * v[i];
            self.by_state[n + i] += slope * tau[i];
        }
        if self.penalties.any() {
            for i in 0..n {
                self.by_state[i] += self.penalties.position(i, q[i]).first;
                self.by_state[n + i] += self.penalties.rate(i, v[i]).first;
            }
        }
        let mut add = |from: &[f64]| self.by_state.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        if self.terms.any() {
            self.terms.first(q, v);
            add(&self.terms.gradient);
        }
        if self.tools.any() {
            self.tools.contract(q, v)?;
            add(&self.tools.gradient);
        }
        if self.references.any() {
            add(&self.references.contract(time, q)?.gradient);
        }
        Ok(())
    }

    /// What a torque w of a joint at a rate v gains against its cost: $y w - \tfrac12 r w^2 - e \phi(v w)$.
    pub fn gain_of(&self, joint: usize, v: f64, price: f64, torque: f64) -> f64 {
        let effort = self.effort.get(joint).map_or(0.0, |r| 0.5 * r * torque * torque);
        let energy = if self.energy.is_empty() { 0.0 } else { self.energy(joint, v * torque)[0] };
        price * torque - effort - energy
    }

    /// The torque between `lower` and `upper` that gains most at the price y; `None` where it is unbounded.
    ///
    /// The gain is concave: the torque is `y/r` within the bounds, or where the derivative changes its sign.
    pub fn best_torque(&self, joint: usize, v: f64, price: f64, [lower, upper]: [f64; 2]) -> Option<f64> {
        /// Halvings of the range of torques.
        const BISECTIONS: usize = 50;
        let r = self.effort.get(joint).copied().unwrap_or(0.0);
        let best = if self.energy.get(joint).is_some_and(|weight| *weight > 0.0) {
            let slope = |w: f64| price - r * w - self.energy(joint, v * w)[1] * v;
            let size = match r > 0.0 {
                true => (price.abs() + self.energy[joint] * v.abs()) / r,
                false => f64::INFINITY,
            };
            let (mut low, mut high) = (lower.max(-size), upper.min(size));
            if !(low.is_finite() && high.is_finite()) {
                return None;
            }
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (low + high);
                let side = if slope(middle) > 0.0 { &mut low } else { &mut high };
                *side = middle;
            }
            0.5 * (low + high)
        } else if r > 0.0 {
            price / r
        } else if price > 0.0 {
            upper
        } else {
            lower
        };
        let best = best.max(lower).min(upper);
        best.is_finite().then_some(best)
    }
}
