//! What a continuation can change, by name.

use crate::problem::error::ProblemError;
use crate::problem::{FinalTime, Problem};
use costate::robot::Robot;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A number on which a [`Problem`] depends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Parameter {
    /// `penalty.weight`.
    PenaltyWeight,
    /// Weight of an effort of the controls that cost nothing, in parts of one that makes it matter: 1 is smooth, 0 the problem
    /// itself, which cannot be reached.
    Smoothing,
    /// Factor of the distance between the bounds of each control, about its middle; a bound on one side alone stays.
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

    /// The problem in which it has this value; smoothing is no part of a problem and leaves it as it is.
    ///
    /// # Errors
    /// [`ProblemError::Continuation`] where the problem has no such parameter or must not have this value.
    pub fn apply(self, problem: &Problem, value: f64) -> Result<Problem, ProblemError> {
        let refuse = |reason: &str| {
            Err(ProblemError::Continuation { parameter: self.name(), value, reason: reason.into() })
        };
        if !value.is_finite() {
            return refuse("the value must be finite");
        }
        let mut changed = problem.clone();
        match (self, &mut changed) {
            (Self::PenaltyWeight, Problem { penalty: Some(penalty), .. }) => penalty.weight = value,
            (Self::PenaltyWeight, _) => return refuse("the problem has no penalties; add [penalty]"),
            (Self::Smoothing, _) if !problem.cost.effort.contains(&0.0) => {
                return refuse("every control has a weight of its effort: nothing is to be smoothed");
            }
            (Self::Smoothing, _) if value <= 0.0 => return refuse("it must be positive"),
            (Self::Smoothing, _) => {}
            (Self::Bounds, _) if value <= 0.0 => return refuse("it must be positive"),
            (Self::Bounds, Problem { bounds: Some(bounds), .. }) => {
                let pairs = bounds.u_min.iter_mut().zip(&mut bounds.u_max);
                for (low, high) in pairs.filter(|(low, high)| low.is_finite() && high.is_finite()) {
                    let (middle, half) = (0.5 * (*low + *high), 0.5 * (*high - *low));
                    (*low, *high) = (middle - value * half, middle + value * half);
                }
            }
            (Self::Bounds, _) => return refuse("the problem has no bounds; add [bounds]"),
            (Self::FinalTime, Problem { time: FinalTime::Fixed(time), .. }) => *time = value,
            (Self::FinalTime, _) => return refuse("the final time is free; give time.final"),
            (Self::Gravity, Problem { robot, .. }) => {
                let gravity = (robot.gravity() * value).into();
                self.replace(robot, robot.with_gravity(gravity).map_err(|error| error.to_string()), value)?;
            }
            (Self::Armature, Problem { robot, .. }) => {
                let armature = robot.armature_matrix() * value;
                let new = robot.with_armature(armature).map_err(|error| error.to_string());
                self.replace(robot, new, value)?;
            }
        }
        changed.check()?;
        Ok(changed)
    }

    fn replace(self, robot: &mut Robot, new: Result<Robot, String>, value: f64) -> Result<(), ProblemError> {
        let refused = |reason| ProblemError::Continuation { parameter: self.name(), value, reason };
        *robot = new.map_err(refused)?;
        Ok(())
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Parameter {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|parameter| parameter.name() == name).ok_or_else(|| {
            format!("there is no parameter '{name}': give one of {}", Self::ALL.map(Self::name).join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Bounds;

    #[test]
    fn a_bound_on_one_side_stays_where_it_is() {
        let robot = Robot::from_file("../robots/two_link.toml").unwrap();
        let mut problem = Problem::rest_to_rest(robot, &[0.0; 2], &[1.0; 2], 1.0);
        problem.bounds = Some(Bounds { u_min: vec![-1.0, f64::NEG_INFINITY], u_max: vec![3.0, 5.0] });
        let bounds = Parameter::Bounds.apply(&problem, 2.0).unwrap().bounds.unwrap();
        assert_eq!(bounds, Bounds { u_min: vec![-3.0, f64::NEG_INFINITY], u_max: vec![5.0, 5.0] });
    }
}
