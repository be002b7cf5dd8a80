//! Motions of robots with floating and spherical joints: what they take.

use super::error::ProblemError;
use super::free_error::FreeMotionError;
use super::key::Key;
use super::{BoundaryState, Problem};
use crate::constants::free_motions::UNIT;
use costate::robot::{FreeJoint, Robot};
use nalgebra::{Quaternion, UnitQuaternion};

/// q with quaternions of length 1.
pub(crate) fn normalised(robot: &Robot, q: &[f64]) -> Vec<f64> {
    let mut q = q.to_vec();
    for at in robot.free_joints().iter().map(FreeJoint::quaternion) {
        let length = length(&q[at..at + 4]);
        q[at..at + 4].iter_mut().for_each(|entry| *entry /= length);
    }
    q
}

/// R of its frame, from its quaternion.
pub(crate) fn orientation(free: &FreeJoint, q: &[f64]) -> UnitQuaternion<f64> {
    let at = free.quaternion();
    UnitQuaternion::from_quaternion(Quaternion::new(q[at + 3], q[at], q[at + 1], q[at + 2]))
}

pub(crate) fn length(entries: &[f64]) -> f64 {
    entries.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}

impl Problem {
    /// The floating or spherical joint that a coordinate belongs to.
    pub(crate) fn free_joint_of(&self, coordinate: usize) -> Option<&FreeJoint> {
        let is_of =
            |free: &&FreeJoint| (free.coordinate..free.coordinate + free.kind.dof()).contains(&coordinate);
        self.robot.free_joints().iter().find(is_of)
    }

    /// Whether nothing drives a coordinate: its torque is limited to 0, or it belongs to a floating or
    /// spherical joint and nothing is said about torques.
    pub(crate) fn has_no_motor(&self, coordinate: usize) -> bool {
        let is_unsaid = self.bounds.is_none() && self.limits.torque_max.is_none();
        self.limits.has_no_motor(coordinate) || (is_unsaid && self.free_joint_of(coordinate).is_some())
    }

    /// The first floating or spherical joint is named where none is taken.
    ///
    /// # Errors
    /// [`ProblemError::FreeJoint`].
    pub(crate) fn refuse_free_joints(&self) -> Result<(), ProblemError> {
        self.robot.free_joints().first().map_or(Ok(()), |free| {
            let (joint, kind) = (free.name.clone(), free.kind.name());
            Err(ProblemError::FreeJoint { joint, kind })
        })
    }

    /// One finite number for each entry of q.
    pub(super) fn finite_positions(&self, key: Key, q: &[f64]) -> Result<(), ProblemError> {
        let (expected, found) = (self.robot.nq(), q.len());
        if found != expected {
            return match self.robot.free_joints().is_empty() {
                true => Err(ProblemError::WrongLength { key, expected, found }),
                false => Err(ProblemError::WrongPositions { key, expected, found }),
            };
        }
        match q.iter().position(|value| !value.is_finite()) {
            Some(entry) => Err(ProblemError::NotFinite { key, joint: self.name_of_position(entry) }),
            None => Ok(()),
        }
    }

    /// The joint of an entry of q.
    fn name_of_position(&self, entry: usize) -> String {
        self.robot.joint_of_position(entry).unwrap_or_default().to_owned()
    }

    /// Whether the direct method takes a problem of a robot with floating or spherical joints whose lists
    /// were checked.
    ///
    /// # Errors
    /// [`ProblemError::Free`]; [`ProblemError::EmptyLimits`], [`ProblemError::OutsideLimits`].
    pub(super) fn check_free_motion(&self) -> Result<(), ProblemError> {
        let Some(first) = self.robot.free_joints().first() else { return Ok(()) };
        let joint = || first.name.clone();
        if self.gait.is_some() {
            return Err(FreeMotionError::Gait { joint: joint() }.into());
        }
        if let Some(one) = self.robot.constraints().first() {
            let constraint = one.name.clone();
            return Err(FreeMotionError::Constraint { constraint, joint: joint() }.into());
        }
        if let Some(key) = self.first_not_taken() {
            return Err(FreeMotionError::NotTaken { key, joint: joint() }.into());
        }
        if !self.robot.wrenches().is_empty() {
            return Err(FreeMotionError::Wrench { joint: joint() }.into());
        }
        self.check_free_limits()?;
        if (0..self.robot.dof()).all(|i| self.has_no_motor(i)) {
            return Err(FreeMotionError::NoMotor { joint: joint() }.into());
        }
        for (key, q) in [(Key::START_Q, &self.start.q), (Key::END_Q, &self.end.q)] {
            for free in self.robot.free_joints() {
                let entry = free.quaternion();
                let length = length(&q[entry..entry + 4]);
                let is_unit = (length * length - 1.0).abs() <= UNIT;
                if !is_unit {
                    let joint = free.name.clone();
                    return Err(FreeMotionError::NotUnit { key, joint, entry, length }.into());
                }
            }
        }
        self.free_start()?;
        self.free_end().map(drop)
    }

    /// What such motions do not take.
    fn first_not_taken(&self) -> Option<Key> {
        let finite = |list: &Option<Vec<f64>>| {
            list.as_ref().is_some_and(|list| list.iter().any(|limit| limit.is_finite()))
        };
        let limits = &self.limits;
        let lists = [
            (Key::LIMIT_V_MAX, finite(&limits.v_max)),
            (Key::LIMIT_A_MAX, finite(&limits.a_max)),
            (Key::LIMIT_POWER_MAX, finite(&limits.power_max)),
            (Key::LIMIT_TOTAL_POWER_MAX, limits.total_power_max.is_some_and(f64::is_finite)),
            (Key::LIMIT_CORNER_SPEED, finite(&limits.corner_speed)),
            (Key::LIMIT_NO_LOAD_SPEED, finite(&limits.no_load_speed)),
            (Key::TERMS, !self.terms.is_empty()),
            (Key::PENALTY_WEIGHT, self.penalty.as_ref().is_some_and(|penalty| penalty.weight > 0.0)),
            (Key::ENERGY, self.cost.has_energy()),
            (Key::START_Q_FREE, !self.start.q_free.is_empty()),
            (Key::START_V_FREE, !self.start.v_free.is_empty()),
        ];
        let first = self.task.first_key().or_else(|| self.first_of_rates());
        let first = first.or_else(|| self.first_of_phases());
        first.or_else(|| lists.into_iter().find(|(_, given)| *given).map(|(key, _)| key))
    }

    /// There is room between limits of positions and torques, and the given ends lie there.
    fn check_free_limits(&self) -> Result<(), ProblemError> {
        let all = self.joint_limits();
        for (i, limits) in all.iter().enumerate() {
            let is_lower = limits.q[0].is_finite();
            if self.free_joint_of(i).is_some() && (is_lower || limits.q[1].is_finite()) {
                let key = if is_lower { Key::LIMIT_Q_MIN } else { Key::LIMIT_Q_MAX };
                return Err(FreeMotionError::PositionLimit { key, joint: self.name(i) }.into());
            }
            if limits.v.is_finite() {
                return Err(FreeMotionError::RobotRate { joint: self.name(i) }.into());
            }
            let ranges = [
                (Key::LIMIT_Q_MIN, limits.q, false),
                (Key::LIMIT_TORQUE_MAX, limits.torque, self.has_no_motor(i)),
            ];
            self.refuse_empty(i, &ranges)?;
        }
        for (entry, i) in self.robot.plain_entries() {
            for (key, BoundaryState { q, q_free, .. }) in
                [(Key::START_Q, &self.start), (Key::END_Q, &self.end)]
            {
                if !q_free.contains(&i) {
                    self.refuse_outside(i, key, q[entry], all[i].q)?;
                }
            }
        }
        Ok(())
    }
}
