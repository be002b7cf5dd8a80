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
        let multiplier = barrier.multiplier[at] / (barrier.weight[at] * barrier.unit[at] * self.figures.size);
        barrier.is_limit(at) && multiplier > barrier.slack[at] * barrier.unit[at]
    }
}
