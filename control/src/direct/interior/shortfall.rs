//! What steps without second derivatives of torques say about a motion.
//!
//! Newton's decrement promises what a quadratic model does: where second derivatives change within a small
//! part of the way to the solution, as those of dry friction do when a joint starts or stops a little later,
//! each step promises little, and there are many more. Squares of torques do not change so. Their decrement
//! is the gap of the maximum principle with the best multipliers on the mesh: were torques linear in the
//! motion, it would cost too much by half of that at most.

use super::iterate::Interior;
use crate::direct::points::values::PointDynamics;
use crate::result::stage_times::Stage;

impl<D: PointDynamics> Interior<D> {
    /// Measures what squares promise, of an iterate whose step was solved with this damping and is so again
    /// afterwards.
    pub(super) fn measure_shortfall(&mut self, damping: f64) {
        let is_exact = self.system.exact;
        if !is_exact && damping == 0.0 {
            self.figures.shortfall = self.figures.decrement.abs();
            return;
        }
        self.system.exact = false;
        self.assemble();
        let is_known = self.factorise(0.0);
        if is_known {
            self.solve();
        }
        self.figures.shortfall = if is_known { self.decrement().abs() } else { 0.0 };
        self.system.exact = is_exact;
        self.assemble();
        self.factorise(damping);
        self.solve();
        self.clock.lap(Stage::Equations);
    }
}
