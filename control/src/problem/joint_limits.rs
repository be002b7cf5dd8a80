//! Hard limits of a problem together with those of its robot.

use super::Problem;
use super::error::ProblemError;
use super::key::Key;
use super::limits::JointLimits;
use super::torque_speed_error::TorqueSpeedError;
use crate::constants::checks::joint_limits::ROUNDING_OF_ENDS;

/// What exceeds a limit is measured in parts of its range: a limit from here on is none.
const NO_LIMIT: f64 = 1e15;

impl JointLimits {
    /// The same without the limits that no motion comes near.
    fn with_large_ones_infinite(self) -> Self {
        let of = |limit: f64| if limit.abs() < NO_LIMIT { limit } else { limit * f64::INFINITY };
        Self {
            q: self.q.map(of),
            v: of(self.v),
            a: of(self.a),
            torque: self.torque.map(of),
            jerk: of(self.jerk),
            torque_rate: of(self.torque_rate),
            power: of(self.power),
            speeds: self.speeds.map(of),
        }
    }
}

impl Problem {
    /// What the direct method keeps, for each joint in order: the tightest of [`limits`](Self::limits), of
    /// those of the robot if they are [kept](Self::keeps_robot_limits), and of [`bounds`](Self::bounds).
    pub fn joint_limits(&self) -> Vec<JointLimits> {
        let (own, from_robot) = (&self.limits, self.keeps_robot_limits());
        let entry = |list: &Option<Vec<f64>>, i: usize| list.as_ref().map_or(f64::INFINITY, |list| list[i]);
        let of_joints = self.robot.independent_joints().map(|joint| Some(&joint.limits));
        let more = self.coordinates() - self.robot.dof();
        let limits = of_joints.chain(std::iter::repeat_n(None, more)).enumerate().map(|(i, robot)| {
            let mut limits = JointLimits {
                q: [own.q_min.as_ref().map_or(f64::NEG_INFINITY, |list| list[i]), entry(&own.q_max, i)],
                v: entry(&own.v_max, i),
                a: entry(&own.a_max, i),
                torque: [-entry(&own.torque_max, i), entry(&own.torque_max, i)],
                jerk: entry(&own.jerk_max, i),
                torque_rate: entry(&own.torque_rate_max, i),
                power: entry(&own.power_max, i),
                speeds: [entry(&own.corner_speed, i), entry(&own.no_load_speed, i)],
            };
            if self.has_no_motor(i) {
                limits.torque = [0.0, 0.0];
            }
            if let Some(robot) = robot.filter(|_| from_robot) {
                limits.q = intersection(limits.q, [robot.lower, robot.upper]);
                limits.v = limits.v.min(robot.velocity);
                limits.torque = intersection(limits.torque, [-robot.effort, robot.effort]);
            }
            if let Some(bounds) = &self.bounds {
                let ends = [bounds.u_min[i], bounds.u_max[i]].map(|u| self.gain[i] * u);
                limits.torque = intersection(limits.torque, [ends[0].min(ends[1]), ends[0].max(ends[1])]);
            }
            limits.with_large_ones_infinite()
        });
        limits.collect()
    }

    /// Limits are numbers; those of magnitudes are positive, but that of a torque may be zero.
    pub(super) fn check_limit_lists(&self) -> Result<(), ProblemError> {
        for (key, list) in self.limits.lists() {
            let Some(list) = list else { continue };
            self.numbers(key, list)?;
            // A joint without a motor has the torque 0.
            let is_empty = |&limit: &f64| match key {
                Key::LIMIT_Q_MIN | Key::LIMIT_Q_MAX => false,
                Key::LIMIT_TORQUE_MAX => limit < 0.0,
                _ => limit <= 0.0,
            };
            if let Some(j) = list.iter().position(is_empty) {
                return Err(ProblemError::NoRoom { key, joint: Some(self.name(j)), value: list[j] });
            }
        }
        if let Some(value) = self.limits.total_power_max
            && (value <= 0.0 || value.is_nan())
        {
            return Err(ProblemError::NoRoom { key: Key::LIMIT_TOTAL_POWER_MAX, joint: None, value });
        }
        self.check_torque_speed()
    }

    /// Corner speeds and no-load speeds are given together, the latter larger.
    fn check_torque_speed(&self) -> Result<(), ProblemError> {
        let refuse = |key, cause| Err(ProblemError::TorqueSpeed { key, cause });
        let (corner, no_load) = match (&self.limits.corner_speed, &self.limits.no_load_speed) {
            (Some(corner), Some(no_load)) => (corner, no_load),
            (None, None) => return Ok(()),
            (Some(_), None) => return refuse(Key::LIMIT_CORNER_SPEED, TorqueSpeedError::Alone),
            (None, Some(_)) => return refuse(Key::LIMIT_NO_LOAD_SPEED, TorqueSpeedError::Alone),
        };
        let mut pairs = corner.iter().zip(no_load);
        match pairs.position(|(corner, no_load)| corner >= no_load && no_load.is_finite()) {
            Some(j) => {
                let (joint, corner, no_load) = (self.name(j), corner[j], no_load[j]);
                let cause = TorqueSpeedError::NotBelow { joint, corner, no_load };
                refuse(Key::LIMIT_CORNER_SPEED, cause)
            }
            None => Ok(()),
        }
    }

    /// The keys of positions, rates and accelerations at the end of a phase.
    pub(super) fn keys_of_end(&self, end: usize) -> [Key; 3] {
        match end {
            0 => [Key::START_Q, Key::START_V, Key::START_A],
            via if via < self.phases() => ["q", "v", "a"].map(|name| Key::via(name, via - 1)),
            // That of a periodic motion comes from the start.
            _ if self.periodic.is_some() => [Key::PERIODIC_SHIFT, Key::START_V, Key::START_A],
            _ => [Key::END_Q, Key::END_V, Key::END_A],
        }
    }

    /// Whether there is something between the limits, those of the robot included, and the given ends lie
    /// there.
    ///
    /// # Errors
    /// [`ProblemError::EmptyLimits`], [`ProblemError::OutsideLimits`], [`ProblemError::TorqueSpeed`], with
    /// the joint.
    pub(super) fn check_limits(&self) -> Result<(), ProblemError> {
        for (j, limits) in self.joint_limits().iter().enumerate() {
            let rates = [-limits.v, limits.v];
            // The one that is given.
            let upper = self.limits.q_min.is_none() && self.limits.q_max.is_some();
            let key_q = if upper { Key::LIMIT_Q_MAX } else { Key::LIMIT_Q_MIN };
            let ranges = [
                (key_q, limits.q, false),
                (Key::LIMIT_V_MAX, rates, false),
                (Key::LIMIT_TORQUE_MAX, limits.torque, self.has_no_motor(j)),
            ];
            self.refuse_empty(j, &ranges)?;
            if limits.speeds[1].is_finite() && !limits.torque.iter().all(|torque| torque.is_finite()) {
                let cause = TorqueSpeedError::NoTorqueLimit { joint: self.name(j) };
                return Err(ProblemError::TorqueSpeed { key: Key::LIMIT_CORNER_SPEED, cause });
            }
            for (number, end) in self.ends().iter().enumerate() {
                let [key_q, key_v, key_a] = self.keys_of_end(number);
                let values = [
                    (key_q, end.q[j], limits.q, end.q_free.contains(&j)),
                    (key_v, end.v[j], [-limits.v, limits.v], end.v_free.contains(&j)),
                ];
                let accelerations = end.a.as_ref().map(|a| (key_a, a[j], [-limits.a, limits.a], false));
                for (key, value, range, free) in values.into_iter().chain(accelerations) {
                    if !free {
                        self.refuse_outside(j, key, value, range)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// There is something between limits, of which some may be equal.
    pub(super) fn refuse_empty(
        &self,
        j: usize,
        ranges: &[(Key, [f64; 2], bool)],
    ) -> Result<(), ProblemError> {
        for &(key, [low, high], may_be_equal) in ranges {
            if low > high || (low == high && !may_be_equal) {
                return Err(ProblemError::EmptyLimits { key, joint: self.name(j), low, high });
            }
        }
        Ok(())
    }

    /// A given value lies between limits, up to rounding.
    pub(super) fn refuse_outside(
        &self,
        j: usize,
        key: Key,
        value: f64,
        [low, high]: [f64; 2],
    ) -> Result<(), ProblemError> {
        let rounding = |limit: f64| ROUNDING_OF_ENDS * limit.abs().max(1.0);
        match (low - rounding(low)..=high + rounding(high)).contains(&value) {
            true => Ok(()),
            false => Err(ProblemError::OutsideLimits { key, joint: self.name(j), value, low, high }),
        }
    }
}

fn intersection(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].max(b[0]), a[1].min(b[1])]
}
