//! An iterate to come back to.

use super::figures::Figures;
use super::iterate::Interior;
use crate::direct::limits::barrier::Barrier;
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::PointDynamics;
use costate::EvalError;

/// A motion with its slacks and multipliers.
pub(crate) struct Snapshot {
    spline: Spline,
    barrier: Barrier,
    figures: Figures,
    mu: f64,
    least_violation: f64,
}

impl<D: PointDynamics> Interior<D> {
    /// The iterate as it is.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            spline: self.spline.clone(),
            barrier: self.barrier.clone(),
            figures: self.figures,
            mu: self.mu,
            least_violation: self.least_violation,
        }
    }

    /// Takes that iterate again; steps that were made since then count.
    ///
    /// # Errors
    /// A motion that cannot be evaluated, which one that was evaluated before is not.
    pub fn take_again(&mut self, snapshot: Snapshot) -> Result<(), EvalError> {
        let Snapshot { spline, barrier, figures, mu, least_violation } = snapshot;
        let iterations = self.figures.iterations;
        (self.spline, self.barrier, self.mu, self.damping) = (spline, barrier, mu, 0.0);
        self.least_violation = least_violation;
        self.model.resize(&self.spline, &mut self.points);
        self.spline.evaluate(&mut self.points.z);
        self.evaluate()?;
        self.figures = Figures { iterations, ..figures };
        self.refresh()
    }
}
