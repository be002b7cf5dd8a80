//! How the refinement of a mesh ended.

use super::last_solved::LastSolved;
use super::prepare::Dynamics;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::outcome::verify::Again;
use crate::direct::refine::resolution::Resolution;
use crate::options::{SolverOptions, Verify};
use crate::result::infeasibility::Infeasibility;
use crate::result::verification::Verification;
use crate::status::Status;
use costate::EvalError;

/// How the refinement ended.
pub(super) struct Refined {
    pub status: Status,
    /// Estimated error of the cost, relative to it.
    pub error: f64,
    /// By how much the cost changes on halved intervals, relative to it, if that is known.
    pub finer_mesh: Option<f64>,
    /// By about how much motions beside a saddle cost less that were not solved, relative to the cost.
    pub beside: f64,
    /// The motion integrated again, if that was done on its last mesh.
    pub again: Option<Again>,
    /// What the verification that is independent of the points found, if that was done.
    pub verified: Option<Verification>,
    /// Why there is no motion that keeps all limits.
    pub infeasible: Option<Infeasibility>,
    /// Whether mesh after mesh did not resolve its motion: another search, from the motion that is left, may
    /// lead on.
    pub gave_up: bool,
    /// The most accurate motion that was solved before it gave up, if it is not the one that is left.
    pub last_solved: Option<LastSolved>,
}

impl Refined {
    /// Of a smoothed problem whose solution costs more than that of the problem by at most `bound`, relative
    /// to it, its own tolerance included: the problem itself is solved if that is twice the tolerance at
    /// most.
    pub fn smoothed(self, bound: f64, options: &SolverOptions) -> Self {
        let status = match self.status {
            Status::Converged if bound > constants::SMOOTHED_ENOUGH => Status::MeshLimit,
            Status::Converged if bound > 2.0 * options.tolerance => Status::ConvergedSmoothed,
            status => status,
        };
        Self { status, ..self }
    }

    /// Without a motion that was solved.
    pub fn without(status: Status) -> Self {
        Self {
            status,
            error: f64::INFINITY,
            finer_mesh: None,
            beside: 0.0,
            again: None,
            verified: None,
            infeasible: None,
            gave_up: false,
            last_solved: None,
        }
    }

    /// Falls back to the most accurate motion that was solved, with its accuracy, unless it ended with a
    /// solution, or with what says more.
    ///
    /// # Errors
    /// A motion that cannot be evaluated, which one that was evaluated before is not.
    pub fn fall_back_to(
        &mut self,
        last: LastSolved,
        (interior, resolution): (&mut Interior<Dynamics>, &mut Resolution),
        options: &SolverOptions,
    ) -> Result<(), EvalError> {
        let ends_well = self.status.is_converged() || self.status == Status::NotVerified;
        // What no motion nearby keeps is not contradicted by one that exceeds it between its points.
        let is_refuted = self.infeasible.as_ref().is_none_or(|found| !found.is_global && last.keeps_limits);
        if ends_well || !is_refuted {
            return Ok(());
        }
        interior.take_again(last.snapshot)?;
        resolution.measure(interior)?;
        if !self.status.is_interruption() {
            let is_unverified = last.accurate && options.verify != Verify::None;
            self.status = if is_unverified { Status::NotVerified } else { Status::MeshLimit };
        }
        (self.error, self.again, self.infeasible) = (last.error, None, None);
        Ok(())
    }
}
