//! Limits that are active.

use super::iterate::Interior;

impl<D> Interior<D> {
    /// Whether an entry is active: its multiplier is larger than its slack, both without unit. On the central
    /// path their product is mu, so that one of them is small. Equations are active.
    pub(crate) fn is_active(&self, at: usize) -> bool {
        let barrier = &self.barrier;
        if !barrier.is_on(at) || barrier.side(at).is_equation {
            return barrier.is_on(at);
        }
        self.activity(at) > 1.0
    }

    /// The multiplier of an entry by its slack, both without unit; 0 for what is no limit.
    pub(crate) fn activity(&self, at: usize) -> f64 {
        if !self.barrier.is_limit(at) {
            return 0.0;
        }
        let [multiplier, slack] = self.without_unit(at);
        multiplier / slack
    }

    /// Multiplier and slack of an entry, both without unit.
    pub(crate) fn without_unit(&self, at: usize) -> [f64; 2] {
        let barrier = &self.barrier;
        let multiplier = barrier.multiplier[at] / (barrier.weight[at] * barrier.unit[at] * self.figures.size);
        [multiplier, barrier.slack[at] * barrier.unit[at]]
    }
}
