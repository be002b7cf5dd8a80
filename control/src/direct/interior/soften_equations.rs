//! Softer equations where rounding of their squares hides the curvature of the cost.
//!
//! Squares of equations are in Newton's matrix, far stiffer than all else, and its factors are rounded in
//! proportion to them. On fine meshes that may exceed the curvature of the cost: the matrix seems to be
//! indefinite then, and steps are damped by as much as it takes to exceed rounding.
//!
//! With softer squares the matrix is smaller along all changes. So where it is positive definite with no more
//! damping than was too little for the stiffer one, that was rounding, and the equations stay softer. Where a
//! whole step leaves much of them afterwards they become stiffer again, as always.

use super::iterate::Interior;
use crate::constants::direct as constants;
use crate::direct::points::values::PointDynamics;
use crate::result::stage_times::Stage;

impl<D: PointDynamics> Interior<D> {
    /// Makes equations softer if rounding of them was the reason for this damping, with which the matrix is
    /// factorised; with the damping `failed`, the largest one that was tried before, it was not positive
    /// definite. The damping with which it is factorised then.
    pub(super) fn soften_equations(&mut self, damping: f64, failed: Option<f64>) -> f64 {
        let Some(failed) = failed.filter(|_| damping >= constants::SOFTENS_FROM) else { return damping };
        let (stiffness, least) = (self.barrier.stiffness, constants::LEAST_STIFFNESS * self.figures.size);
        let softer = (constants::SOFTER * stiffness).max(least);
        let has_equations = self.barrier.equations().next().is_some();
        if !(has_equations && softer < stiffness && self.system.exact && self.softer.is_due()) {
            return damping;
        }
        let less = failed.min(constants::LESS_DAMPING * damping);
        let helps = self.factorise_with(softer, less);
        self.softer.learn(helps);
        if helps {
            return less;
        }
        self.factorise_with(stiffness, damping);
        damping
    }

    /// Whether the matrix with equations of this stiffness is positive definite with this damping.
    fn factorise_with(&mut self, stiffness: f64, damping: f64) -> bool {
        self.barrier.stiffness = stiffness;
        self.clock.lap(Stage::Equations);
        self.assemble();
        self.clock.lap(Stage::Assembly);
        self.factorise(damping)
    }
}

#[cfg(test)]
#[path = "soften_equations_tests.rs"]
mod tests;
