//! The feet that stand in the phases of a step.
//!
//! A step with a phase of double support has two phases: at first all feet stand, then those behind are
//! released and swing. Multipliers of all rows are coordinates in both; where a row does not hold, its
//! multiplier has no force. The robot comes to the start without an impulse, `v(0) = S v(T)`: the rates of
//! the feet behind are zero then whatever the motion is, and those in front have to be.

use super::Problem;
use super::error::ProblemError;
use super::gait::{Gait, SoleContact};
use super::gait_error::GaitError;
use super::key::Key;
use super::loop_rows::{Foot, LoopPhase};
use costate::robot::{ConstraintSpec, Robot, RobotError};
use std::sync::Arc;

/// Robots whose feet stand.
pub(super) struct Standing {
    /// With the rows of all phases.
    pub robot: Robot,
    pub phases: Vec<LoopPhase>,
    /// As in [`Walk`](super::loop_rows::Walk).
    pub foot: Robot,
    pub landing: Robot,
    pub feet: Vec<Foot>,
}

impl GaitError {
    /// As an error of a key.
    pub(super) fn at(self, key: Key) -> ProblemError {
        ProblemError::Gait { key, cause: Box::new(self) }
    }
}

/// A frame that cannot stand.
pub(super) fn no_foot(error: RobotError) -> ProblemError {
    GaitError::NoFoot { cause: Arc::new(error) }.at(Key::GAIT_STANCE)
}

impl Problem {
    /// Whether double support takes a part of the step, and soles behind stand as they can.
    ///
    /// # Errors
    /// [`GaitError::OutOfRange`], [`GaitError::NoSolesBehind`].
    pub(super) fn check_double_support(&self, gait: &Gait) -> Result<(), ProblemError> {
        let is_flat = gait.trailing == SoleContact::Flat;
        if is_flat && (gait.sole.is_none() || gait.double_support.is_none()) {
            return Err(GaitError::NoSolesBehind.at(Key::GAIT_TRAILING));
        }
        let Some(value) = gait.double_support else { return Ok(()) };
        let remedy = "the part of the step that all feet stand must be more than 0 and less than 1";
        match value > 0.0 && value < 1.0 {
            true => Ok(()),
            false => Err(GaitError::OutOfRange { value, remedy }.at(Key::GAIT_DOUBLE_SUPPORT)),
        }
    }

    /// The feet of a gait on the ground, x and y of those that stand in `places`.
    ///
    /// # Errors
    /// [`GaitError::NoFoot`].
    pub(super) fn standing(&self, gait: &Gait, places: &[[f64; 2]]) -> Result<Standing, ProblemError> {
        let with = |robot: Robot, row: ConstraintSpec| robot.with_constraint(row).map_err(no_foot);
        let (mut robot, mut foot, mut landing) = (self.robot.clone(), self.robot.clone(), self.robot.clone());
        let mut feet: Vec<Foot> = Vec::new();
        let count = |robot: &Robot| -> usize { robot.constraints().iter().map(|one| one.kind.rows()).sum() };
        let mut add = |name: &String, place: [f64; 2], contact: SoleContact, robot: Robot| {
            let first = count(&robot);
            let robot = gait.held(name, place, contact).into_iter().try_fold(robot, with)?;
            feet.push(Foot { name: name.clone(), rows: first..count(&robot), told: 0..0, contact });
            Ok::<_, ProblemError>(robot)
        };
        for ((stands, swings), place) in gait.stance.iter().zip(&gait.swing).zip(places) {
            robot = add(stands, *place, SoleContact::Flat, robot)?;
            foot = with(foot, gait.told(stands, SoleContact::Flat))?;
            landing = with(landing, gait.at_landing(swings, SoleContact::Flat))?;
        }
        let single = robot.clone();
        if gait.double_support.is_some() {
            for ((stands, swings), [x, y]) in gait.stance.iter().zip(&gait.swing).zip(places) {
                robot = add(swings, [x - gait.length, -y], gait.trailing, robot)?;
                foot = with(foot, gait.told(swings, gait.trailing))?;
                landing = with(landing, gait.at_landing(stands, gait.trailing))?;
            }
        }
        let mut first = 0;
        for (own, told) in feet.iter_mut().zip(foot.constraints()) {
            own.told = first..first + told.kind.rows();
            first = own.told.end;
        }
        let phase = |robot: &Robot| LoopPhase { robot: robot.clone(), rows: count(robot) };
        let phases = match gait.double_support {
            Some(_) => vec![phase(&robot), phase(&single)],
            None => vec![phase(&single)],
        };
        Ok(Standing { robot, phases, foot, landing, feet })
    }
}
