//! The point of the central path at a barrier.

use super::iterate::Interior;
use crate::constants::direct::CENTRED;
use crate::direct::points::values::PointDynamics;
use costate::EvalError;

impl<D: PointDynamics> Interior<D> {
    /// Newton steps at this barrier, at most so many, until the products of slacks and multipliers are mu times
    /// the weights to [`CENTRED`]. Whether they are; then the equations are factorised near the iterate.
    pub(crate) fn go_to_centre(&mut self, mu: f64, most: usize) -> Result<bool, EvalError> {
        self.filter.clear();
        for _ in 0..most {
            self.mu = mu;
            self.refresh()?;
            self.system.exact = true;
            self.assemble();
            if !self.factorise(0.0) {
                return Ok(false);
            }
            self.solve();
            self.figures.decrement = self.decrement();
            let settled = self.figures.decrement.abs() <= CENTRED * CENTRED * self.figures.size;
            if settled && self.off_centre() <= CENTRED {
                return Ok(true);
            }
            if self.search().is_none() {
                return Ok(false);
            }
        }
        Ok(false)
    }

    /// The largest part by which a product of slack and multiplier is off.
    fn off_centre(&self) -> f64 {
        let barrier = &self.barrier;
        let off =
            |at: usize| barrier.slack[at] * barrier.multiplier[at] / (self.mu * barrier.weight[at]) - 1.0;
        let limits = (0..barrier.count()).filter(|&at| barrier.is_limit(at));
        limits.fold(0.0, |most: f64, at| most.max(off(at).abs()))
    }
}
