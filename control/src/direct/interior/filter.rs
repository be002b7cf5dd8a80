//! Which trial steps make progress: a filter of infeasibility and of cost with barrier.
//!
//! A. Waechter, L. T. Biegler, "On the implementation of an interior-point filter line-search algorithm for
//! large-scale nonlinear programming", Mathematical Programming 106, 2006, sections 2.3 and 3.3. The barrier
//! changes in each step here, so entries keep cost and logarithms apart.

use crate::constants::direct as constants;

/// What a trial is judged by.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Figure {
    /// Sum of what limits and equations are off, in parts of ranges.
    pub theta: f64,
    pub cost: f64,
    /// Sum of the weighted logarithms of slacks.
    pub logarithms: f64,
}

impl Figure {
    /// Cost with barrier.
    pub fn value(&self, mu: f64) -> f64 {
        self.cost - mu * self.logarithms
    }
}

/// Iterates that no later one may be worse than in both respects.
#[derive(Clone, Debug, Default)]
pub(crate) struct Filter {
    entries: Vec<Figure>,
    forgotten: usize,
}

impl Filter {
    /// Forgets all iterates because no step is better than all of them. False if there is nothing to
    /// forget, or if that happened too often.
    pub fn forget(&mut self) -> bool {
        let again = !self.entries.is_empty() && self.forgotten < constants::RESETS;
        self.entries.clear();
        self.forgotten += 1;
        again
    }

    /// Makes room for all entries that there will be.
    pub fn reserve(&mut self) {
        self.entries.reserve(constants::FILTER - self.entries.len());
    }

    /// Begins anew.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.forgotten = 0;
    }

    /// Adds an iterate from which a step was taken that had to reduce the infeasibility.
    pub fn add(&mut self, figure: Figure) {
        if self.entries.len() == constants::FILTER {
            self.entries.remove(0);
        }
        self.entries.push(figure);
    }

    /// Whether a trial is better than each entry in one respect.
    pub fn accepts(&self, trial: &Figure, mu: f64, rounding: f64) -> bool {
        self.entries.iter().all(|entry| is_better(trial, entry, mu, rounding))
    }
}

/// Whether a trial is better in one respect by a part of the infeasibility of another iterate.
pub(crate) fn is_better(trial: &Figure, than: &Figure, mu: f64, rounding: f64) -> bool {
    trial.theta <= (1.0 - constants::DECREASE) * than.theta
        || trial.value(mu) <= than.value(mu) - constants::DECREASE * than.theta + rounding
}
