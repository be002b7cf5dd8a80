//! The problems of a continuation.

use super::Parameter;
use crate::bvp::Failure;
use crate::extremal::hamiltonian::RobotExtremal;
use crate::options::JacobianRoute;
use crate::problem::Problem;
use crate::problem::error::ProblemError;
use crate::status::EvaluationFailure;

/// A problem with a parameter that goes from one value to another.
#[derive(Clone, Copy)]
pub(crate) struct Family<'a> {
    pub problem: &'a Problem,
    pub parameter: Parameter,
    pub from: f64,
    pub to: f64,
    pub jacobian: JacobianRoute,
}

impl Family<'_> {
    /// The parameter at s, from 0 to 1.
    pub fn value(&self, s: f64) -> f64 {
        if s == 1.0 { self.to } else { self.from + s * (self.to - self.from) }
    }

    /// The problem for a value of the parameter.
    pub fn problem_at(&self, value: f64) -> Result<Problem, Failure> {
        Ok(self.parameter.apply(self.problem, value)?)
    }

    /// The extremal for a value of the parameter.
    pub fn extremal(&self, value: f64) -> Result<RobotExtremal, Failure> {
        let problem = self.problem_at(value)?;
        let mut extremal = RobotExtremal::new(problem.check()?, self.jacobian)?;
        if self.parameter == Parameter::Smoothing {
            extremal.smooth(value);
        }
        Ok(extremal)
    }
}

impl From<ProblemError> for Failure {
    fn from(error: ProblemError) -> Self {
        Self::Evaluation(EvaluationFailure::Problem(error))
    }
}
