//! How the refinement of a mesh ended.

use crate::constants::direct as constants;
use crate::direct::outcome::verify::Again;
use crate::options::SolverOptions;
use crate::result::infeasibility::Infeasibility;
use crate::result::verification::Verification;
use crate::status::Status;

/// How the refinement ended.
pub(super) struct Refined {
    pub status: Status,
    /// Estimated error of the cost, relative to it.
    pub error: f64,
    /// By how much the cost changes on halved intervals, relative to it, if that is known.
    pub finer_mesh: Option<f64>,
    /// The motion integrated again, if that was done on its last mesh.
    pub again: Option<Again>,
    /// What the verification that is independent of the points found, if that was done.
    pub verified: Option<Verification>,
    /// Why there is no motion that keeps all limits.
    pub infeasible: Option<Infeasibility>,
    /// Whether mesh after mesh did not resolve its motion: another search, from the motion that is left, may
    /// lead on.
    pub gave_up: bool,
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
            again: None,
            verified: None,
            infeasible: None,
            gave_up: false,
        }
    }
}
