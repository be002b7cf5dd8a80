//! First guesses where a problem gives none: the position of a start with tools, and a free final time.
//!
//! The position is the one at which the tools of the start are where they shall be that is nearest to the
//! middle of the limits. The time is that of a straight motion through the places of the problem by
//! polynomials of degree five, from rest to rest. On a way D in the time T such a polynomial has the peaks
//!
//! $$ |v| = \tfrac{15}{8} \frac{D}{T}, \qquad |a| = \tfrac{10}{\sqrt 3} \frac{D}{T^2}, \qquad
//!    |j| = 60 \frac{D}{T^3} $$
//!
//! so that the least T that keeps the limits of a joint has a closed form; a torque limit counts as the
//! acceleration `(tau_max - |g_i|) / M_ii` at the beginning of the way. Where a second costs `c_t` and
//! torques cost `r_i u_i^2 / 2`, the effort of a way in the time T is about `C / T^3`, `C = 6 sum r_i (M_ii
//! D_i / b_i)^2`, and `c_t T + C / T^3` is least at `T = (3 C / c_t)^(1/4)`. The larger one of both counts.

use super::{FinalTime, Problem};
use crate::task::build::TaskRows;
use crate::task::functions::PathFunction;
use crate::task::reach::reach_near;
use costate::lagrangian::Lagrangian;

/// Peak of the rate of a way by a polynomial of degree five from rest to rest, in units of D / T.
const PEAK_RATE: f64 = 15.0 / 8.0;

/// That of its acceleration, 10 / sqrt 3 in units of D / T^2.
const PEAK_ACCELERATION: f64 = 5.773_502_691_896_258;

/// That of its jerk, in units of D / T^3.
const PEAK_JERK: f64 = 60.0;

/// The part of a torque limit that moves a joint at least in this estimate, whatever gravity takes.
const FREE_TORQUE: f64 = 0.1;

/// The time (s) where neither limits nor costs say anything: nothing moves, or only free places are given.
const NO_WAY: f64 = 1.0;

impl Problem {
    /// With a start at which the tools of the task are where they shall be: within the limits of the joints,
    /// and nearest to the middle of them. Only positions that are free change. Where none is found the start
    /// is in the middle of the limits, and [`check`](Self::check) says why.
    #[must_use]
    pub fn with_guessed_start(mut self) -> Self {
        if !self.robot.free_joints().is_empty() || self.has_wrong_lists() {
            return self;
        }
        let middle = self.middle_of_limits();
        for &joint in &self.start.q_free {
            if let Some((q, middle)) = self.start.q.get_mut(joint).zip(middle.get(joint)) {
                *q = *middle;
            }
        }
        let q = self.tools_reached(0, &self.start.q);
        self.start.q = q;
        self
    }

    /// With a free final time whose guess is that of a straight motion through the places of the problem
    /// which keeps the limits of each joint, or in which effort and time cost least.
    ///
    /// ```
    /// use costate_control::{FinalTime, MotionLimits, Objective, Problem};
    /// use costate::robot::Robot;
    /// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
    /// let robot = Robot::from_file("robots/two_link.toml")?;
    /// let problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.0, 0.5], 1.0)
    ///     .with_cost(Objective::new(1.0, vec![0.0; 2]))
    ///     .with_limits(MotionLimits::none().with_v_max(vec![0.5, 2.0]).with_torque_max(vec![90.0; 2]))
    ///     .with_guessed_time();
    /// assert_eq!(problem.time, FinalTime::Free { guess: 15.0 / 8.0 * 1.0 / 0.5 });
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_guessed_time(self) -> Self {
        let guess = self.time_of_gait().unwrap_or_else(|| self.time_of_ways());
        let guess = if guess > 0.0 && guess.is_finite() { guess } else { NO_WAY };
        Self { time: FinalTime::Free { guess }, ..self }
    }

    /// The middle of the limits of each joint, those of the robot included even where they are not kept; as
    /// near to 0 as one limit allows, and 0 without any.
    fn middle_of_limits(&self) -> Vec<f64> {
        let robot = self.robot.independent_joints().map(|joint| [joint.limits.lower, joint.limits.upper]);
        let both = self.joint_limits().into_iter().zip(robot);
        let ranges = both.map(|(limits, [lower, upper])| {
            let [low, high] = [limits.q[0].max(lower), limits.q[1].min(upper)];
            if low <= high { [low, high] } else { limits.q }
        });
        ranges
            .map(|[low, high]| match (low.is_finite(), high.is_finite()) {
                (true, true) => 0.5 * (low + high),
                _ => 0.0_f64.max(low).min(high),
            })
            .collect()
    }

    /// The position at an end of a phase at which its tools are where they shall be, near this one; the same
    /// one where there are no tools, or none is found.
    fn tools_reached(&self, end: usize, near: &[f64]) -> Vec<f64> {
        let ends = self.ends();
        let is_plain = near.len() == self.robot.dof() && self.joint_limits().len() >= near.len();
        let Some(rows) = TaskRows::new(self).ok().filter(|_| is_plain) else { return near.to_vec() };
        let Some(mut functions) = rows.at_ends().nth(end).filter(|rows| rows.rows() > 0).cloned() else {
            return near.to_vec();
        };
        let free: Vec<usize> = ends[end].q_free.iter().copied().filter(|&i| i < near.len()).collect();
        let limits: Vec<[f64; 2]> = self.joint_limits().iter().map(|limits| limits.q).collect();
        let found = reach_near(&mut functions, near, &free, &limits, 0);
        if found.is_there() { found.q } else { near.to_vec() }
    }

    /// The time of the ways between all places that are known, one after the other.
    fn time_of_ways(&self) -> f64 {
        let ends = self.ends();
        let last = ends.len() - 1;
        let is_short = |q: &[f64]| q.len() < self.robot.dof();
        if ends.iter().any(|end| is_short(&end.q)) || self.has_wrong_lists() {
            return NO_WAY;
        }
        let mut from = self.tools_reached(0, &ends[0].q);
        let mut time = 0.0;
        for (number, end) in ends.iter().enumerate().skip(1) {
            let is_given = number == last || self.vias[number - 1].q.is_some();
            let has_tools = self.tools_at_ends().nth(number).is_some_and(|tools| !tools.is_empty());
            if !is_given && !has_tools {
                continue;
            }
            let near = |i: usize| if has_tools && end.q_free.contains(&i) { from[i] } else { end.q[i] };
            let near: Vec<f64> = (0..from.len()).map(near).collect();
            let to = self.tools_reached(number, &near);
            time += self.time_of_way(&from, &to);
            from = to;
        }
        time
    }

    /// Whether a list that counts here has too few entries, which the check of the problem refuses.
    fn has_wrong_lists(&self) -> bool {
        let n = self.robot.dof();
        let bounds = self.bounds.iter().flat_map(|bounds| [&bounds.u_min, &bounds.u_max]);
        let limits = self.limits.lists();
        let mut lists = limits.into_iter().filter_map(|(_, list)| list.as_ref()).chain(bounds);
        lists.any(|list| list.len() != n) || self.gain.len() != n || self.cost.effort.len() != n
    }

    /// The time of one way.
    fn time_of_way(&self, from: &[f64], to: &[f64]) -> f64 {
        let (n, limits) = (self.robot.dof(), self.joint_limits());
        let still = vec![0.0; n];
        let mut model = Lagrangian::<f64>::new(&self.robot);
        // Robots with quaternions have none; then torques say nothing.
        let dynamics = model.linearise_inverse_dynamics(&from[..from.len().min(n)], &still, &still).ok();
        let dynamics = dynamics.filter(|_| self.robot.free_joints().is_empty());
        let (mut time, mut effort) = (0.0_f64, 0.0);
        for (entry, i) in self.robot.plain_entries() {
            let way = (to[entry] - from[entry]).abs();
            let mut acceleration = limits[i].a;
            if let Some(found) = &dynamics {
                let (mass, weight) = (found.tau_a[(i, i)], found.tau[i].abs());
                let torque = limits[i].torque[1].min(-limits[i].torque[0]);
                if torque > 0.0 && mass > 0.0 {
                    acceleration = acceleration.min((torque - weight).max(FREE_TORQUE * torque) / mass);
                }
                if self.gain[i] != 0.0 {
                    effort += 6.0 * self.cost.effort[i] * (mass * way / self.gain[i]).powi(2);
                }
            }
            let by_rate = PEAK_RATE * way / limits[i].v;
            let by_acceleration = (PEAK_ACCELERATION * way / acceleration).sqrt();
            let by_jerk = (PEAK_JERK * way / limits[i].jerk).cbrt();
            time = time.max(by_rate).max(by_acceleration).max(by_jerk);
        }
        if self.cost.time > 0.0 {
            time = time.max((3.0 * effort / self.cost.time).sqrt().sqrt());
        }
        time
    }
}
