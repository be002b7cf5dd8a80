//! How a solve ended.

use crate::problem::error::ProblemError;
use costate::EvalError;
use costate::robot::{escape_hidden, printable};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Why an evaluation failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluationFailure {
    /// The dynamics could not be evaluated.
    #[error("{}", in_words(.0))]
    Dynamics(#[from] EvalError),
    /// A continuation led to a problem that cannot be posed.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The integration between two nodes took too many steps.
    #[error("the motion between two nodes cannot be integrated: it grows without bound; raise solver.nodes")]
    Integration,
    /// A failure that was read from a file.
    #[error("{0}")]
    Saved(String),
}

/// What is not finite along a motion was computed from what a user gave.
fn in_words(error: &EvalError) -> String {
    match error {
        EvalError::NonFinite { joint, .. } => format!(
            "numbers of joint '{}' become too large to be computed with; check the units and sizes of what is given \
             (rad, m, s, kg)",
            printable(joint)
        ),
        error => error.to_string(),
    }
}

/// Where a motion exceeds the bounds of a control most.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BoundViolation {
    /// The control, counted from 0: for a robot the joint.
    pub control: usize,
    /// Time (s).
    pub time: f64,
    /// The control at this time, before the gain (N m, N).
    pub u: f64,
    /// The bound that it exceeds.
    pub bound: f64,
    /// Distance from the middle of the bounds, relative to half the distance between them: 1 at a bound, more
    /// beyond.
    pub factor: f64,
}

/// How a solve ended. [`Converged`](Self::Converged) and [`ConvergedSmoothed`](Self::ConvergedSmoothed) are
/// solutions; with any other status the motion is the best iterate, or as the status
/// says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
#[non_exhaustive]
pub enum Status {
    /// The conditions of the problem hold, the error that the mesh is estimated to have is below the
    /// tolerance, and the verification that was asked for ([`Verify`](crate::Verify)) passed, which allows
    /// eight tolerances for the gap (of jerks 100, or a hundredth of the cost); no motion nearby was found
    /// that costs less: [`Solution::verified`](crate::Solution#structfield.verified) says what it found.
    Converged,
    /// The same for a smoothed control, with a tolerance of at least 1e-8; the last reduction of the
    /// smoothing, to about a third, changed the cost by less than a relative 2e-5. The motion has no isolated
    /// switching times. The weight of the smoothing is [`Motion::smoothing`](crate::Motion::smoothing).
    ConvergedSmoothed,
    /// The equations are solved to the tolerance, but a check failed, as
    /// [`Solution::verified`](crate::Solution#structfield.verified) says; of extremals that is typical of
    /// unstable motions. Of the direct method, where that is not there, not even parts of the motion end
    /// where they should.
    /// With [`Verify::Factors`](crate::Verify::Factors) nothing is integrated: rounding errors are amplified
    /// too much, or too much is cut off torques between points.
    NotVerified,
    /// No damped Newton step reduced the correction.
    NewtonFailed,
    /// Newton's method used up its iterations.
    IterationLimit,
    /// The tolerance needs more nodes than allowed; of the direct method also where 16 meshes, or six that
    /// did not resolve the motion one after the other, did not reach it, or where least time was solved only
    /// with a cost of torques that may cost too much.
    MeshLimit,
    /// The linearised equations are singular: at a conjugate point, or where the motion is not determined.
    Singular,
    /// The dynamics could not be evaluated.
    EvaluationFailed(EvaluationFailure),
    /// A homotopy (in the final time, the bounds or the smoothing) stopped before its end.
    ContinuationFailed,
    /// The switching times belong to a smoothed problem: arcs read off from it did not solve the problem
    /// itself.
    SwitchesNotRefined,
    /// A motion was found with wider bounds only: they could not be tightened to those of the problem.
    /// There is no motion then; [`Motion::bound_violation`](crate::Motion::bound_violation) says how much is
    /// missing.
    BoundsNotReached,
    /// No extremal was found. The motion is that of the direct method from which the search began: it meets
    /// both ends and keeps the bounds, and is not quite optimal.
    PathOnly,
    /// No motion was found that keeps all hard limits. The motion is the one with which the search stopped,
    /// or one that keeps them at its points and not between them;
    /// [`Solution::limits`](crate::Solution::limits) says which limits it exceeds, and by how much.
    LimitsNotKept,
    /// It is proven that no motion keeps all hard limits, whatever is free takes as its value.
    /// [`Infeasibility::proof`](crate::Infeasibility::proof) says why.
    Infeasible,
    /// No motion was found that keeps all hard limits: at the motion, which exceeds them, the violation has a
    /// local minimum. [`LimitReport::infeasible`](crate::LimitReport::infeasible) says which limits, when,
    /// and by how much. Another guess may lead to a motion that keeps them.
    LocallyInfeasible,
    /// Cancelled by the caller.
    Cancelled,
    /// The time limit was reached.
    TimeLimit,
}

impl Status {
    /// A name for files: "converged", "newton_failed" and so on.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::ConvergedSmoothed => "converged_smoothed",
            Self::NotVerified => "not_verified",
            Self::NewtonFailed => "newton_failed",
            Self::IterationLimit => "iteration_limit",
            Self::MeshLimit => "mesh_limit",
            Self::Singular => "singular",
            Self::EvaluationFailed(_) => "evaluation_failed",
            Self::ContinuationFailed => "continuation_failed",
            Self::SwitchesNotRefined => "switches_not_refined",
            Self::BoundsNotReached => "bounds_not_reached",
            Self::PathOnly => "path_only",
            Self::LimitsNotKept => "limits_not_kept",
            Self::Infeasible => "infeasible",
            Self::LocallyInfeasible => "locally_infeasible",
            Self::Cancelled => "cancelled",
            Self::TimeLimit => "time_limit",
        }
    }

    /// Whether it is [`Converged`](Self::Converged).
    pub fn is_converged(&self) -> bool {
        *self == Self::Converged
    }

    /// Whether the motion is a solution: of the problem, or of its smoothed form.
    pub fn is_solved(&self) -> bool {
        matches!(self, Self::Converged | Self::ConvergedSmoothed)
    }

    /// Whether no motion was found that keeps all limits: the one that is shown exceeds some.
    pub fn exceeds_limits(&self) -> bool {
        matches!(self, Self::LimitsNotKept | Self::Infeasible | Self::LocallyInfeasible)
    }

    /// Whether the best iterate need not be near a solution: Newton's method did not converge.
    pub(crate) fn is_far(&self) -> bool {
        matches!(
            self,
            Self::NewtonFailed | Self::IterationLimit | Self::EvaluationFailed(_) | Self::ContinuationFailed
        )
    }

    /// Whether the search was stopped by the caller or by the time limit.
    pub fn is_interruption(&self) -> bool {
        matches!(self, Self::Cancelled | Self::TimeLimit)
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::Converged => "converged",
            Self::ConvergedSmoothed => {
                "converged, with a smoothed control: the motion has no isolated switching times"
            }
            Self::NotVerified => {
                "the equations are solved, but the verification of the motion (solver.verify) failed; raise solver.nodes, or \
                 lower solver.tolerance"
            }
            Self::NewtonFailed => {
                "Newton's method found no step that reduces the error; \
                 raise solver.starts or solver.nodes, or allow more time (time.final, time.guess)"
            }
            Self::IterationLimit => {
                "Newton's method used up its iterations; raise solver.starts or solver.nodes, or allow more time (time.final, time.guess)"
            }
            Self::MeshLimit => {
                "no mesh with as many nodes as allowed resolves the motion to solver.tolerance; raise solver.starts or \
                 solver.nodes, or solver.tolerance where the error is little above it"
            }
            Self::Singular => {
                "the linearised equations are singular: a conjugate point, or a motion that is not determined; \
                 raise solver.starts, or change time.final a little"
            }
            Self::EvaluationFailed(failure) => {
                return write!(f, "the dynamics could not be evaluated: {failure}");
            }
            Self::ContinuationFailed => {
                "the homotopy from an easier problem stopped; check that bounds.u_min and bounds.u_max allow the \
                 motion in this time"
            }
            Self::SwitchesNotRefined => {
                "solved for a smoothed control only; the switching times read off from it were not confirmed; \
                 use solver.method = \"direct\""
            }
            Self::BoundsNotReached => {
                "no motion within the bounds was found; widen bounds.u_min and bounds.u_max, or allow more time (time.final, time.guess)"
            }
            Self::PathOnly => {
                "no optimal motion was found; this one meets both ends and keeps the bounds, and its cost is \
                 an upper limit; raise solver.starts or solver.nodes, or allow more time (time.final, time.guess)"
            }
            Self::LimitsNotKept => {
                "no motion that keeps all limits was found; widen [limits], allow more time (time.final, time.guess), or raise \
                 solver.starts"
            }
            Self::Infeasible => {
                "no motion keeps all limits, which is proven; relax the limits that are named, or allow more time (time.final)"
            }
            Self::LocallyInfeasible => {
                "no motion that keeps all limits was found: at this one the violation has a local minimum; raise \
                 solver.starts, widen [limits], or allow more time (time.final, time.guess)"
            }
            Self::Cancelled => "cancelled; this is the best iterate so far",
            Self::TimeLimit => "the time limit was reached; raise solver.time_limit or --time-limit",
        };
        f.write_str(text)
    }
}

impl From<Status> for String {
    fn from(status: Status) -> Self {
        match status {
            Status::EvaluationFailed(failure) => format!("{EVALUATION_FAILED}{failure}"),
            status => status.name().into(),
        }
    }
}

/// The statuses without a reason of their own.
const NAMED: [Status; 16] = [
    Status::Converged,
    Status::ConvergedSmoothed,
    Status::NotVerified,
    Status::NewtonFailed,
    Status::IterationLimit,
    Status::MeshLimit,
    Status::Singular,
    Status::ContinuationFailed,
    Status::SwitchesNotRefined,
    Status::BoundsNotReached,
    Status::PathOnly,
    Status::LimitsNotKept,
    Status::Infeasible,
    Status::LocallyInfeasible,
    Status::Cancelled,
    Status::TimeLimit,
];
/// What stands before the reason of a failed evaluation.
const EVALUATION_FAILED: &str = "evaluation_failed: ";
/// Longest name or reason that is read from a file (characters).
const LONGEST: usize = 1000;

/// A name of a status that is not known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownStatus {
    /// The name, printable, and shortened if it is very long.
    pub name: String,
}

impl fmt::Display for UnknownStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known = NAMED.map(|status| status.name()).join(", ");
        write!(
            f,
            "there is no status '{}': give one of {known}, or '{EVALUATION_FAILED}' and the reason",
            self.name
        )
    }
}

impl std::error::Error for UnknownStatus {}

impl TryFrom<String> for Status {
    type Error = UnknownStatus;

    fn try_from(name: String) -> Result<Self, UnknownStatus> {
        let shown = |text: &str| escape_hidden(text).chars().take(LONGEST).collect();
        if let Some(reason) = name.strip_prefix(EVALUATION_FAILED) {
            return Ok(Self::EvaluationFailed(EvaluationFailure::Saved(shown(reason))));
        }
        let known = NAMED.into_iter().find(|status| status.name() == name);
        known.ok_or_else(|| UnknownStatus { name: shown(&name) })
    }
}

#[cfg(test)]
mod tests {
    use super::{NAMED, Status};

    #[test]
    fn each_name_is_read_again_and_others_are_refused() {
        for status in NAMED {
            assert_eq!(Status::try_from(String::from(status.clone())), Ok(status));
        }
        let error = serde_json::from_str::<Status>(r#""fo\u001bo""#).unwrap_err().to_string();
        assert!(error.contains(r"no status 'fo\u{1b}o'") && error.contains("not_verified"), "{error}");
        assert!(error.contains("evaluation_failed"), "{error}");
    }
}
