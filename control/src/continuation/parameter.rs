//! The parameters of a continuation, by name.

use crate::problem::continuation_cause::ContinuationCause;
use crate::problem::error::ProblemError;
use crate::problem::{FinalTime, Problem};
use costate::robot::{RobotError, printable};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

/// A number on which a [`Problem`] depends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Parameter {
    /// `penalty.weight`.
    PenaltyWeight,
    /// Smoothing of controls without effort, relative to one that matters as much as time does: 1 is smooth,
    /// 0 the problem itself, which cannot be reached.
    Smoothing,
    /// Factor of the distance between the bounds of each control, about its middle; a bound on one side alone
    /// stays.
    Bounds,
    /// T (s), where it is fixed.
    FinalTime,
    /// Factor of gravity.
    Gravity,
    /// Factor of the armature matrix.
    Armature,
}

impl Parameter {
    /// All.
    pub const ALL: [Self; 6] =
        [Self::PenaltyWeight, Self::Smoothing, Self::Bounds, Self::FinalTime, Self::Gravity, Self::Armature];

    /// "penalty_weight" and so on.
    pub fn name(self) -> &'static str {
        match self {
            Self::PenaltyWeight => "penalty_weight",
            Self::Smoothing => "smoothing",
            Self::Bounds => "bounds",
            Self::FinalTime => "final_time",
            Self::Gravity => "gravity",
            Self::Armature => "armature",
        }
    }

    /// The problem with this value of the parameter. Smoothing is not part of a problem and leaves it
    /// unchanged.
    ///
    /// # Errors
    /// [`ProblemError::Continuation`] where the problem has no such parameter or must not have this value.
    pub fn apply(self, problem: &Problem, value: f64) -> Result<Problem, ProblemError> {
        let refused = |cause| ProblemError::Continuation { parameter: self.name(), value, cause };
        let refuse = |cause| Err(refused(cause));
        let refused_robot = |error: RobotError| refused(ContinuationCause::Robot(Arc::new(error)));
        if !value.is_finite() {
            return refuse(ContinuationCause::NotFinite);
        }
        if problem.limits.are_asked_for() {
            return refuse(ContinuationCause::Limits);
        }
        if !problem.task.is_empty() {
            return refuse(ContinuationCause::Task);
        }
        if problem.cost.has_energy() {
            return refuse(ContinuationCause::Energy);
        }
        if problem.first_of_rates().is_some() {
            return refuse(ContinuationCause::Rates);
        }
        if problem.first_of_phases().is_some() {
            return refuse(ContinuationCause::Phases);
        }
        let mut changed = problem.clone();
        match (self, &mut changed) {
            (Self::PenaltyWeight, Problem { penalty: Some(penalty), .. }) => penalty.weight = value,
            (Self::PenaltyWeight, _) => return refuse(ContinuationCause::NoPenalties),
            (Self::Smoothing, _) if !problem.cost.effort.contains(&0.0) => {
                return refuse(ContinuationCause::NothingToSmooth);
            }
            (Self::Smoothing, _) if value <= 0.0 => return refuse(ContinuationCause::NotPositive),
            (Self::Smoothing, _) => {}
            (Self::Bounds, _) if value <= 0.0 => return refuse(ContinuationCause::NotPositive),
            (Self::Bounds, Problem { bounds: Some(bounds), .. }) => {
                let pairs = bounds.u_min.iter_mut().zip(&mut bounds.u_max);
                for (low, high) in pairs.filter(|(low, high)| low.is_finite() && high.is_finite()) {
                    let (middle, half) = (0.5 * (*low + *high), 0.5 * (*high - *low));
                    (*low, *high) = (middle - value * half, middle + value * half);
                }
            }
            (Self::Bounds, _) => return refuse(ContinuationCause::NoBounds),
            (Self::FinalTime, Problem { time: FinalTime::Fixed(time), .. }) => *time = value,
            (Self::FinalTime, _) => return refuse(ContinuationCause::FreeTime),
            (Self::Gravity, Problem { robot, .. }) => {
                let gravity = (robot.gravity() * value).into();
                *robot = robot.with_gravity(gravity).map_err(refused_robot)?;
            }
            (Self::Armature, Problem { robot, .. }) => {
                let armature = robot.armature_matrix() * value;
                *robot = robot.with_armature(armature).map_err(refused_robot)?;
            }
        }
        changed.check()?;
        Ok(changed)
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name of a parameter that is not known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownParameter {
    /// The name.
    pub name: String,
}

impl fmt::Display for UnknownParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, known) = (printable(&self.name), Parameter::ALL.map(Parameter::name).join(", "));
        write!(f, "there is no parameter '{name}': give one of {known}")
    }
}

impl std::error::Error for UnknownParameter {}

impl FromStr for Parameter {
    type Err = UnknownParameter;

    fn from_str(name: &str) -> Result<Self, UnknownParameter> {
        let known = Self::ALL.into_iter().find(|parameter| parameter.name() == name);
        known.ok_or_else(|| UnknownParameter { name: name.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Bounds;
    use costate::robot::Robot;

    #[test]
    fn a_bound_on_one_side_stays_where_it_is() {
        let robot = Robot::from_file("../robots/two_link.toml").unwrap();
        let mut problem = Problem::rest_to_rest(robot, &[0.0; 2], &[1.0; 2], 1.0);
        problem.bounds = Some(Bounds { u_min: vec![-1.0, f64::NEG_INFINITY], u_max: vec![3.0, 5.0] });
        let bounds = Parameter::Bounds.apply(&problem, 2.0).unwrap().bounds.unwrap();
        assert_eq!(bounds, Bounds { u_min: vec![-3.0, f64::NEG_INFINITY], u_max: vec![5.0, 5.0] });
    }
}
