//! Motions at a fixed rate, as controllers take them.

use crate::problem::Problem;
use crate::result::forward::Forward;
use crate::result::free_entries::FreeEntries;
use crate::result::solution::Solution;
use crate::result::trajectory::{Trajectory, TrajectoryPoint};
use costate::EvalError;
use serde::Serialize;

/// Most samples of a motion.
const MOST: usize = 1_000_000;

/// A part of a period that counts as rounding.
const ROUNDING: f64 = 1e-6;

/// A motion at a fixed rate: rows are samples, entries of a row are joints in the order of the robot.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Samples {
    /// Samples in a second (Hz); NaN where the times were given.
    pub rate: f64,
    /// Times (s): `k / rate`, and T, the last one; or those that were given.
    pub t: Vec<f64>,
    /// Positions (rad, m).
    pub q: Vec<Vec<f64>>,
    /// Velocities (rad/s, m/s).
    pub v: Vec<Vec<f64>>,
    /// Accelerations (rad/s^2, m/s^2).
    pub a: Vec<Vec<f64>>,
    /// Torques and forces of the actuators at the joints, after the gain (N m, N).
    pub tau: Vec<Vec<f64>>,
    /// Controls, before the gain (N m, N).
    pub u: Vec<Vec<f64>>,
    /// The phase of each sample, from 1; empty for a motion without vias.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub phase: Vec<usize>,
    /// Names of the entries of q, where floating or spherical joints have more than one: `NAME_x` to
    /// `NAME_qw`. Empty where they are those of the joints.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub positions: Vec<String>,
}

/// Why a motion cannot be sampled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SampleError {
    /// The rate is not a positive number.
    #[error("a rate of {rate} Hz; give a positive number of samples in a second")]
    Rate {
        /// The rate (Hz).
        rate: f64,
    },
    /// The solution has no motion.
    #[error("the solution has no motion; its status says why")]
    NoMotion,
    /// The motion is of another robot.
    #[error("the motion has {found} joints and the robot of the problem {expected}; give its own problem")]
    OtherRobot {
        /// Joints of the motion.
        found: usize,
        /// Joints of the robot.
        expected: usize,
    },
    /// Too many samples.
    #[error("{samples:.0} samples, and at most {MOST} are possible; choose a lower rate")]
    TooMany {
        /// Their number.
        samples: f64,
    },
    /// The dynamics cannot be evaluated at a sample.
    #[error(transparent)]
    Evaluation(#[from] EvalError),
}

impl Samples {
    /// Number of samples of a motion of this duration (s) at a rate (Hz).
    ///
    /// # Errors
    /// [`SampleError::Rate`], [`SampleError::TooMany`].
    pub fn count(duration: f64, rate: f64) -> Result<usize, SampleError> {
        if !(rate > 0.0 && rate.is_finite()) {
            return Err(SampleError::Rate { rate });
        }
        let count = (duration * rate - ROUNDING).ceil().max(if duration > 0.0 { 1.0 } else { 0.0 });
        match count < MOST as f64 {
            true => Ok(count as usize + 1),
            false => Err(SampleError::TooMany { samples: count + 1.0 }),
        }
    }
}

impl Solution {
    /// The motion at a fixed rate (Hz), with torques; `problem` is the one that was solved.
    ///
    /// Samples are at `k / rate`, k = 0, 1, 2, ... before T, and the last one at T exactly: the last period
    /// is shorter unless T is a multiple of the period.
    ///
    /// A motion of the direct method is sampled from its polynomials; its torques are those of inverse
    /// dynamics, cut to the limits of the problem as when the motion is verified. They are exact at the
    /// points of the mesh; where an acceleration jumps within an interval the polynomial overshoots. Those
    /// of robots with constraints, which share their torques with the forces of these, are linear between the
    /// nodes. Of other motions, among them those of robots with floating or spherical joints, q, v and u are
    /// those of [`Trajectory::at`], the torque is u times the gain, and the acceleration that of forward
    /// dynamics.
    ///
    /// # Errors
    /// [`SampleError`].
    pub fn sample(&self, problem: &Problem, rate: f64) -> Result<Samples, SampleError> {
        if !(rate > 0.0 && rate.is_finite()) {
            return Err(SampleError::Rate { rate });
        }
        let (start, end) = self.span(problem)?;
        let count = Samples::count(end - start, rate)? - 1;
        let regular = (0..count).map(|k| start + k as f64 / rate);
        Ok(Samples { rate, ..self.at_times(problem, regular.chain([end]).collect())? })
    }

    /// The motion at given times (s), as [`sample`](Self::sample) gives it at a fixed rate. Times before the
    /// start or after the end count as start and end.
    ///
    /// # Errors
    /// [`SampleError`], but for that of the rate.
    pub fn sample_at(&self, problem: &Problem, times: &[f64]) -> Result<Samples, SampleError> {
        let (start, end) = self.span(problem)?;
        if times.len() > MOST {
            return Err(SampleError::TooMany { samples: times.len() as f64 });
        }
        let times = times.iter().map(|t| t.max(start).min(end)).collect();
        Ok(Samples { rate: f64::NAN, ..self.at_times(problem, times)? })
    }

    /// Start and end of the motion (s).
    fn span(&self, problem: &Problem) -> Result<(f64, f64), SampleError> {
        let trajectory = &self.trajectory;
        let (Some(&start), Some(&last)) = (trajectory.t.first(), trajectory.t.last()) else {
            return Err(SampleError::NoMotion);
        };
        let (found, expected) = (trajectory.dof(), problem.robot.dof());
        if found != expected {
            return Err(SampleError::OtherRobot { found, expected });
        }
        // Times are sums of widths: the last one is T but for rounding.
        let exact = start + self.motion.final_time;
        Ok((start, if (last - exact).abs() <= 1e-12 * exact.abs() { exact } else { last }))
    }

    /// The motion at times within it.
    fn at_times(&self, problem: &Problem, times: Vec<f64>) -> Result<Samples, SampleError> {
        let trajectory = &self.trajectory;
        let mut samples = Samples { t: times, ..Samples::default() };
        if !trajectory.free_joints.is_empty() {
            samples.positions = FreeEntries::names(&trajectory.free_joints, &self.robot.joints);
        }
        if !trajectory.via_times.is_empty() {
            samples.phase = samples.t.iter().map(|&t| 1 + trajectory.phase_at(t)).collect();
        }
        let last = trajectory.t.last().copied().ok_or(SampleError::NoMotion)?;
        let mut actuation = Actuation::new(problem);
        for t in samples.t.iter().map(|t| t.min(last)) {
            let Some(point) = trajectory.at(t) else { return Err(SampleError::NoMotion) };
            let (a, tau) = actuation.at(trajectory, &point)?;
            let is_closed = problem.is_closed();
            let mut u: Vec<f64> = match trajectory.acceleration(t) {
                Some(_) if !is_closed => {
                    tau.iter().zip(&problem.gain).map(|(tau, gain)| tau / gain).collect()
                }
                _ => point.u,
            };
            // Rounding is no reason to exceed a bound.
            if let Some(bounds) = &problem.bounds {
                for (u, (least, most)) in u.iter_mut().zip(bounds.u_min.iter().zip(&bounds.u_max)) {
                    *u = u.clamp(*least, *most);
                }
            }
            let rows = [&mut samples.q, &mut samples.v, &mut samples.a, &mut samples.tau, &mut samples.u];
            for (rows, row) in rows.into_iter().zip([point.q, point.v, a, tau, u]) {
                rows.push(row);
            }
        }
        Ok(samples)
    }
}

impl Solution {
    /// Accelerations (rad/s^2, m/s^2) at the nodes: those of the direct method's polynomials, else by forward
    /// dynamics with the controls there.
    ///
    /// # Errors
    /// [`SampleError`].
    pub fn accelerations(&self, problem: &Problem) -> Result<Vec<Vec<f64>>, SampleError> {
        let trajectory = &self.trajectory;
        if let Some(accelerations) = trajectory.accelerations() {
            return Ok(accelerations.to_vec());
        }
        let (found, expected) = (trajectory.dof(), problem.robot.dof());
        if found != expected && !trajectory.q.is_empty() {
            return Err(SampleError::OtherRobot { found, expected });
        }
        Ok(trajectory.forward_dynamics(problem)?)
    }
}

impl Trajectory {
    /// Accelerations at the nodes by forward dynamics with the controls there.
    fn forward_dynamics(&self, problem: &Problem) -> Result<Vec<Vec<f64>>, EvalError> {
        let mut all = Vec::with_capacity(self.t.len());
        for (robot, nodes) in problem.robots().iter().zip(self.phases()) {
            let mut model = Forward::new(robot);
            for k in nodes {
                let tau: Vec<f64> = self.u[k].iter().zip(&problem.gain).map(|(u, gain)| gain * u).collect();
                all.push(model.accelerations(&self.q[k], &self.v[k], &tau)?);
            }
        }
        Ok(all)
    }

    /// The same trajectory with accelerations, if it has none, from those of its torques; `None` if it has
    /// some, or if they cannot be evaluated.
    pub(crate) fn completed(&self, problem: &Problem) -> Option<Self> {
        let n = problem.robot.dof();
        let fits = self.q.iter().chain(&self.v).chain(&self.u).all(|row| row.len() == n);
        let missing = self.accelerations().is_none() && fits && self.via_times.len() == problem.vias.len();
        let accelerations = if missing { self.forward_dynamics(problem).ok()? } else { return None };
        Some(self.clone().with_accelerations(accelerations))
    }
}

/// What moves a robot along a motion.
struct Actuation<'a> {
    problem: &'a Problem,
    /// Those of the robots of all phases.
    models: Vec<Forward>,
    /// Least and largest torque of each joint.
    limits: Vec<[f64; 2]>,
}

impl<'a> Actuation<'a> {
    fn new(problem: &'a Problem) -> Self {
        let limits = problem.joint_limits().iter().map(|limits| limits.torque).collect();
        // The foot of a step is held by constraints that its robot does not have.
        let made = problem.gait.as_ref().and_then(|_| problem.with_multipliers().ok());
        let robots = match made.and_then(|made| made.loops) {
            Some(loops) => loops.phases.iter().map(|phase| phase.robot.clone()).collect(),
            None => problem.robots(),
        };
        Self { problem, models: robots.iter().map(Forward::new).collect(), limits }
    }

    /// Acceleration and torque.
    fn at(
        &mut self,
        trajectory: &Trajectory,
        point: &TrajectoryPoint,
    ) -> Result<(Vec<f64>, Vec<f64>), EvalError> {
        let TrajectoryPoint { q, v, u, .. } = point;
        let last = self.models.len() - 1;
        let model = &mut self.models[trajectory.phase_at(point.t).min(last)];
        let tau: Vec<f64> = u.iter().zip(&self.problem.gain).map(|(u, gain)| gain * u).collect();
        match (trajectory.acceleration(point.t), model) {
            (Some(a), Forward::Open(open)) => {
                let tau = open.inverse_dynamics(q, v, &a)?.iter().zip(&self.limits);
                let tau = tau.map(|(tau, limit)| tau.clamp(limit[0], limit[1])).collect();
                Ok((a, tau))
            }
            (Some(a), Forward::Closed(_)) => Ok((a, tau)),
            (None, model) => Ok((model.accelerations(q, v, &tau)?, tau)),
        }
    }
}
