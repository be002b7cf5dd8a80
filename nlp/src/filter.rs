//! The filter: pairs of violation and objective that no later iterate may be worse than. The barrier
//! parameter changes from one iteration to the next, so entries keep cost and logarithms apart.

use crate::iterate::Iterate;

/// Constants of the filter line search.
///
/// Source: A. Waechter, L. T. Biegler, "On the implementation of an interior-point filter line-search
/// algorithm for large-scale nonlinear programming", Mathematical Programming 106 (2006), 25-57, section 2.3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterSettings {
    /// gamma_theta, gamma_phi: least relative decrease of the violation, and least decrease of the objective
    /// relative to the violation.
    pub margins: [f64; 2],
    /// delta, s_theta, s_phi of the switching condition `alpha (-d)^s_phi > delta theta^s_theta`.
    pub switching: [f64; 3],
    /// eta_phi: part of the predicted decrease of the objective that is asked for.
    pub armijo: f64,
    /// Violations above this many times that of the start are refused; below the second, relative to it as
    /// well, the switching condition may hold.
    pub violations: [f64; 2],
    /// Steps along which the objective rises by more than this many times its size, or that of 1, are
    /// refused: the linear equations of a step hold near the point alone. IPOPT has 1e5 (obj_max_inc).
    pub increase: f64,
    /// kappa_soc, and how many second-order corrections are tried.
    pub correction: (f64, usize),
}

impl Default for FilterSettings {
    fn default() -> Self {
        Self {
            margins: [1e-5, 1e-8],
            switching: [1.0, 1.1, 2.3],
            armijo: 1e-8,
            violations: [1e4, 1e-4],
            increase: 100.0,
            correction: (0.99, 4),
        }
    }
}

/// Most entries.
const MOST_ENTRIES: usize = 256;

/// How often entries are forgotten because no step is better than all of them.
const MOST_FORGOTTEN: usize = 5;

/// Rounding of the objective that counts as no increase, in units of its size.
const ROUNDING: f64 = 10.0 * f64::EPSILON;

/// What an iterate is judged by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Measure {
    pub violation: f64,
    pub cost: f64,
    /// Sum of the logarithms of the distances to bounds.
    pub logarithms: f64,
}

impl Measure {
    pub fn of(iterate: &Iterate) -> Self {
        Self { violation: iterate.violation(), cost: iterate.values.cost, logarithms: iterate.logarithms() }
    }

    /// The objective of the barrier problem.
    pub fn objective(&self, mu: f64) -> f64 {
        if mu > 0.0 { self.cost - mu * self.logarithms } else { self.cost }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Filter {
    settings: FilterSettings,
    entries: Vec<Measure>,
    /// Largest and small violations.
    limits: [f64; 2],
    /// How often entries were forgotten.
    forgotten: usize,
}

/// Why a trial point is accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Acceptance {
    /// It lowers the objective as predicted.
    Objective,
    /// It is better than the current iterate in violation or objective: the current one enters the filter.
    Either,
}

impl Filter {
    pub fn new(settings: FilterSettings) -> Self {
        Self {
            settings,
            entries: Vec::with_capacity(MOST_ENTRIES),
            limits: [f64::INFINITY, 0.0],
            forgotten: 0,
        }
    }

    /// Forgets all entries, for a start with this violation.
    pub fn restart(&mut self, settings: FilterSettings, violation: f64) {
        self.settings = settings;
        self.entries.clear();
        self.limits = self.settings.violations.map(|factor| factor * violation.max(1.0));
        self.forgotten = 0;
    }

    /// Forgets all entries: objectives of other barriers make it narrow. False if there are none, or if that
    /// happened too often: then the iterate itself is what is left to compare with.
    pub fn forget(&mut self) -> bool {
        let again = !self.entries.is_empty() && self.forgotten < MOST_FORGOTTEN;
        self.entries.clear();
        self.forgotten += 1;
        again
    }

    /// Judges a trial point at the step length alpha from the current iterate, where `slope` is the
    /// derivative of the objective for mu along the step.
    pub fn judge(
        &self,
        [current, trial]: [Measure; 2],
        mu: f64,
        (alpha, slope): (f64, f64),
    ) -> Option<Acceptance> {
        let [gamma_theta, gamma_phi] = self.settings.margins;
        let [largest, small] = self.limits;
        let [now, next] = [current, trial].map(|measure| measure.objective(mu));
        let rounding = ROUNDING * now.abs();
        if !(trial.violation.is_finite() && next.is_finite()) || trial.violation > largest {
            return None;
        }
        if next - now > self.settings.increase * now.abs().max(1.0) || self.beats(trial, mu, rounding) {
            return None;
        }
        if current.violation <= small && self.switches(current.violation, alpha, slope) {
            let allowed = now + self.settings.armijo * alpha * slope + rounding;
            return (next <= allowed).then_some(Acceptance::Objective);
        }
        let better = trial.violation <= (1.0 - gamma_theta) * current.violation
            || next <= now - gamma_phi * current.violation + rounding;
        better.then_some(Acceptance::Either)
    }

    /// Whether no entry is better.
    pub fn accepts(&self, trial: Measure, mu: f64) -> bool {
        trial.violation.is_finite() && trial.objective(mu).is_finite() && !self.beats(trial, mu, 0.0)
    }

    /// Whether an entry is better, its objective by more than rounding.
    fn beats(&self, trial: Measure, mu: f64, rounding: f64) -> bool {
        let objective = trial.objective(mu);
        let is_better = |entry: &Measure| {
            trial.violation >= entry.violation && objective >= entry.objective(mu) + rounding
        };
        self.entries.iter().any(is_better)
    }

    /// Whether the objective decides: `alpha (-slope)^s_phi > delta theta^s_theta`.
    pub fn switches(&self, violation: f64, alpha: f64, slope: f64) -> bool {
        let [delta, s_theta, s_phi] = self.settings.switching;
        slope < 0.0 && alpha * (-slope).powf(s_phi) > delta * violation.powf(s_theta)
    }

    /// Adds the current iterate.
    pub fn add(&mut self, current: Measure) {
        let [gamma_theta, gamma_phi] = self.settings.margins;
        let entry = Measure {
            violation: (1.0 - gamma_theta) * current.violation,
            cost: current.cost - gamma_phi * current.violation,
            ..current
        };
        if self.entries.len() == MOST_ENTRIES {
            // The oldest one: nothing is allocated.
            self.entries.remove(0);
        }
        self.entries.push(entry);
    }

    /// Step lengths below this are refused, whatever they lead to.
    pub fn least_length(&self, violation: f64, slope: f64) -> f64 {
        let [gamma_theta, gamma_phi] = self.settings.margins;
        let [delta, s_theta, s_phi] = self.settings.switching;
        let mut least = gamma_theta;
        if slope < 0.0 {
            least = least.min(gamma_phi * violation / -slope);
            if violation <= self.limits[1] {
                least = least.min(delta * violation.powf(s_theta) / (-slope).powf(s_phi));
            }
        }
        0.05 * least
    }
}

#[cfg(test)]
mod tests {
    use super::{Acceptance, Filter, FilterSettings, Measure};

    #[test]
    fn a_point_that_is_worse_in_both_is_refused() {
        let at = |violation, cost| Measure { violation, cost, logarithms: 0.0 };
        let mut filter = Filter::new(FilterSettings::default());
        filter.restart(FilterSettings::default(), 1.0);
        let current = at(1.0, 5.0);
        assert_eq!(filter.judge([current, at(0.5, 9.0)], 0.1, (1.0, 1.0)), Some(Acceptance::Either));
        assert_eq!(filter.judge([current, at(2.0, 4.0)], 0.1, (1.0, 1.0)), Some(Acceptance::Either));
        assert_eq!(filter.judge([current, at(1.0, 5.1)], 0.1, (1.0, 1.0)), None);
        assert_eq!(filter.judge([current, at(f64::NAN, 0.0)], 0.1, (1.0, 1.0)), None);
        assert_eq!(filter.judge([current, at(1e5, 0.0)], 0.1, (1.0, 1.0)), None, "too far from feasible");
        filter.add(at(0.6, 4.0));
        assert_eq!(
            filter.judge([current, at(0.7, 4.5)], 0.1, (1.0, 1.0)),
            None,
            "an earlier iterate was better"
        );
        assert_eq!(filter.judge([current, at(0.5, 4.5)], 0.1, (1.0, 1.0)), Some(Acceptance::Either));
        // Feasible: the objective has to fall as its slope says, but for rounding.
        let feasible = at(0.0, 5.0);
        assert_eq!(filter.judge([feasible, at(0.0, 4.0)], 0.1, (1.0, -1.0)), Some(Acceptance::Objective));
        assert_eq!(
            filter.judge([feasible, at(0.0, 5.0 + 1e-15)], 0.1, (1.0, -1e-20)),
            Some(Acceptance::Objective)
        );
        assert_eq!(filter.judge([feasible, at(0.0, 5.1)], 0.1, (1.0, -1.0)), None);
    }
}
