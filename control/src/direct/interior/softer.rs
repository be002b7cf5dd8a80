//! Softer equations where rounding of their squares hides the curvature of the cost.
//!
//! Squares of equations are in Newton's matrix, far stiffer than all else, and what its factors are rounded by
//! is in proportion to them. On fine meshes that may exceed the curvature of the cost: the matrix is told to
//! be indefinite then, and steps are damped by as much as it takes to exceed rounding.
//!
//! With softer squares the matrix is smaller along all changes. So where it is positive definite with no more
//! damping than was too little for the stiffer one, that was rounding, and the equations stay softer. Where a
//! whole step leaves much of them afterwards they [become stiffer](Interior::stiffen) again.

use super::iterate::Interior;
use crate::constants::direct as constants;
use crate::direct::points::values::PointDynamics;
use crate::result::stage_times::Stage;

/// When softer equations are tried: after a few damped steps, and after they did not help k times, one after
/// the other, 2^k steps later.
#[derive(Clone, Copy, Debug)]
pub(super) struct Softer {
    failed: u32,
    wait: usize,
}

impl Default for Softer {
    fn default() -> Self {
        Self { failed: 0, wait: constants::FIRST_WAIT }
    }
}

impl Softer {
    /// Whether it is time for a trial.
    fn is_due(&mut self) -> bool {
        let is_due = self.wait == 0;
        self.wait = self.wait.saturating_sub(1);
        is_due
    }

    fn learn(&mut self, helped: bool) {
        self.failed = if helped { 0 } else { (self.failed + 1).min(constants::MOST_WAITS) };
        self.wait = if helped { 0 } else { 1 << self.failed };
    }
}

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
#[path = "softer_tests.rs"]
mod tests;
