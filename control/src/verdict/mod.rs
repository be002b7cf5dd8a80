//! What there is to say about a solution: one list of [`Remark`]s, from which all outputs take what they
//! show.
//!
//! The command line, its exit status, JSON (`warnings`), the report, and `warnings`, `check` and `print` of
//! the Python package show [`Solution::remarks`], and nothing that is not in it.
//!
//! | key | severity | when |
//! |---|---|---|
//! | `not_solved` | error | the status is no solution: why, and what to do |
//! | `limit_exceeded` | error | a hard limit is exceeded at the points of the motion |
//! | `limit_exceeded_between` | error | a hard limit is exceeded between them; a warning beside a jump |
//! | `unstable` | warning | torques from the start lead elsewhere; parts of the motion are verified |
//! | `saddle` | warning | the motion is stationary, no local minimum |
//! | `not_minimal` | warning | a conjugate time lies before the end |
//! | `torque_cut` | warning | torques are cut to their limits between points |
//! | `robot_limit` | warning | limits of the robot are exceeded that the problem does not ask for |
//! | `sudden_acceleration` | warning | an acceleration that no arm with gears reaches |
//! | `dearer_converged` | warning | the motion beats the best converged one: what that one costs |
//! | `polish_left` | note | a polish led to an extremal that is not verified |
//! | `skipped_starts` | note | the search ended before all starts were tried |
//!
//! A solution with an error is not solved: [`settled`] gives what breaks hard limits, does not repeat, or was
//! not verified the status that says so.

mod advice;
mod between;
mod laws;
mod light_joints;
mod limit_words;
pub(crate) mod numbers;
pub(crate) mod rank;
mod remark;
mod settled;
#[cfg(all(test, feature = "toml"))]
mod tests;
mod words;

use crate::options::Method;
use crate::problem::Problem;
use crate::result::solution::Solution;
pub use remark::{Remark, RemarkKey, Severity, UnfitMotion};
use serde::Serialize;
pub(crate) use settled::settled;

impl Solution {
    /// What there is to say about it, errors first; `problem` is the one that was solved.
    ///
    /// ```
    /// use costate_control::{MotionLimits, Problem, RemarkKey, Solver, SolverOptions};
    /// use costate::robot::Robot;
    /// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
    /// let robot = Robot::from_file("robots/pendulum.toml")?;
    /// let problem = Problem::rest_to_rest(robot, &[0.0], &[3.0], 1.0);
    /// let problem = problem.with_limits(MotionLimits::none().with_v_max(vec![1.0]));
    /// let solution = Solver::new(&problem, SolverOptions::default())?.solve();
    /// let remarks = solution.remarks(&problem);
    /// assert!(remarks[0].key == RemarkKey::NotSolved && remarks[0].is_error());
    /// assert!(solution.check(&problem).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn remarks(&self, problem: &Problem) -> Vec<Remark> {
        let mut all = Vec::new();
        all.extend(words::not_solved(problem, self));
        all.extend(words::exceeded_limits(problem, self));
        all.extend(words::unstable(problem, self));
        all.extend(words::saddle(self));
        all.extend(words::not_minimal(self));
        all.extend(between::cut(self));
        all.extend(words::robot_limits(problem, self));
        all.extend(light_joints::too_sudden(problem, self));
        all.extend(words::dearer_converged(self));
        all.extend(words::left_polish(self));
        all.extend(words::skipped_starts(self));
        all
    }

    /// Whether the motion may be used: it is solved, keeps its hard limits at the points and between them,
    /// and repeats when it is integrated again, as far as that was [verified](crate::Verify).
    ///
    /// # Errors
    /// [`UnfitMotion`] with all [remarks](Self::remarks) that are errors.
    pub fn check(&self, problem: &Problem) -> Result<(), UnfitMotion> {
        let mut remarks = self.remarks(problem);
        remarks.retain(Remark::is_error);
        if remarks.is_empty() { Ok(()) } else { Err(UnfitMotion { remarks }) }
    }

    /// Its status in a sentence: why it is no solution and what to do, or that it is one.
    pub fn message(&self, problem: &Problem) -> String {
        words::not_solved(problem, self).map_or_else(|| self.motion.status.to_string(), |remark| remark.text)
    }

    /// The JSON form with what there is to say, as `warnings`; [`from_json`](Self::from_json) reads it.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn to_json_with_remarks(&self, problem: &Problem) -> Result<String, serde_json::Error> {
        serde_json::to_string(&WithRemarks { solution: self, warnings: self.remarks(problem) })
    }

    /// Whether the motion shown is an extremal: of a polish, also one from a saved motion, which has no
    /// report, or of an indirect method. Motions of the direct method alone have a stationarity.
    fn is_extremal(&self) -> bool {
        let is_polished = self.polish.as_ref().is_some_and(|report| report.outcome.is_polished());
        self.options.method != Method::Direct || is_polished || self.motion.stationarity.is_nan()
    }
}

/// A solution as it is written.
#[derive(Serialize)]
struct WithRemarks<'a> {
    #[serde(flatten)]
    solution: &'a Solution,
    warnings: Vec<Remark>,
}
