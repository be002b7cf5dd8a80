//! One boundary-value problem solved to a tolerance: Newton's method on better and better meshes.

pub(crate) mod arcs;
pub(crate) mod attempt;
pub(crate) mod crossings;
pub(crate) mod discretisation;
pub(crate) mod free_time;
pub(crate) mod homotopy;
pub(crate) mod multiple_shooting;
pub(crate) mod recorder;
pub(crate) mod violation;

pub(crate) use attempt::Attempt;
pub(crate) use discretisation::{Discretisation, Layout};
pub(crate) use recorder::Recorder;

use crate::bvp::collocation::Collocation;
use crate::bvp::collocation::error::{Estimate, MeshLimits, estimate, next_mesh};
use crate::constants::refinement::FULL;
use crate::extremal::{Extremal, Relaxation};
use crate::options::Method;
use crate::status::{BoundViolation, Status};

/// The outcome of solving a [`Discretisation`]: a solution if the status says so, else the best iterate.
pub(crate) struct Solved {
    pub found: Discretisation,
    pub status: Status,
    /// The relaxed problem that was solved; [`Relaxation::NONE`] for the problem itself.
    pub relaxation: Relaxation,
    /// Estimated errors on the last mesh, if Newton's method converged there.
    pub estimate: Option<Estimate>,
    /// With [`Status::BoundsNotReached`]: by how much the motion exceeds the bounds of the problem.
    pub violation: Option<BoundViolation>,
}

impl Solved {
    /// Whether all conditions of its problem hold to the tolerance.
    pub fn is_converged(&self) -> bool {
        self.status.is_converged()
    }

    /// The same as a motion that exceeds the bounds of the problem.
    pub fn beyond_bounds(self, violation: BoundViolation) -> Self {
        Self { status: Status::BoundsNotReached, violation: Some(violation), ..self }
    }

    /// The same with a status.
    pub fn with_status(self, status: Status) -> Self {
        Self { status, ..self }
    }
}

impl Discretisation {
    /// Solves to the tolerance of the attempt, with as many nodes as that takes.
    pub fn solve(
        self,
        extremal: &mut dyn Extremal,
        attempt: &Attempt,
        recorder: &mut Recorder<'_>,
    ) -> Solved {
        match attempt.method {
            // The direct method is for robots; every other model is solved by collocation.
            Method::Collocation | Method::Direct => self.collocate(extremal, attempt, recorder),
            Method::Shooting => self.shoot(extremal, attempt, recorder),
        }
    }

    /// The values without an attempt to solve.
    pub fn unsolved(self, extremal: &dyn Extremal) -> Solved {
        let (relaxation, status) = (extremal.relaxation(), Status::NewtonFailed);
        Solved { found: self, status, relaxation, estimate: None, violation: None }
    }

    fn collocate(
        mut self,
        extremal: &mut dyn Extremal,
        attempt: &Attempt,
        recorder: &mut Recorder<'_>,
    ) -> Solved {
        let relaxation = extremal.relaxation();
        let mut timed = self.timed(extremal);
        let mut last: Option<Estimate> = None;
        let status = loop {
            let status = recorder.newton(&mut self.equations, &mut timed, attempt);
            if !status.is_converged() {
                break status;
            }
            let found = match estimate(&mut self.equations, &mut timed, Collocation::response) {
                Ok(found) => found,
                Err(error) => break Status::EvaluationFailed(error.into()),
            };
            if found.largest() <= attempt.tolerance {
                last = Some(found);
                break Status::Converged;
            }
            let limits = MeshLimits { tolerance: attempt.tolerance, max_intervals: attempt.max_intervals() };
            let before = last.as_ref().map(Estimate::largest);
            let mesh = next_mesh(&self.equations, &found, before, limits);
            last = Some(found);
            if limits.full(self.equations.mesh.intervals()) {
                break Status::MeshLimit;
            }
            self.refine(&timed, mesh);
        };
        Solved { found: self, status, relaxation, estimate: last, violation: None }
    }
}

impl MeshLimits {
    /// Whether a mesh is so near to the most intervals that refining it is of no use.
    pub fn full(&self, intervals: usize) -> bool {
        intervals >= self.max_intervals - self.max_intervals / FULL
    }
}
