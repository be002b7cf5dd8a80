//! The gains of the optimal feedback and derivatives by limits, in tables over time.

use crate::direct::{Feedback, MotionDerivative, MotionParameter, Resolve, ResolveError, ResolveStatus};
use crate::problem::error::ProblemError;
use crate::problem::{FinalTime, Payload, Problem};
use crate::result::solution::{RobotNames, Solution};
use costate::EvalError;
use serde::{Deserialize, Serialize};

/// Equal intervals, where the mesh of the motion does not do.
const INTERVALS: usize = 60;

/// Most times.
const MOST: f64 = 1e5;

/// Rows of a matrix.
type Rows = Vec<Vec<f64>>;

/// The optimal feedback of a solved motion over time, and how the motion changes with its limits: what
/// `costate optimize --feedback` writes.
///
/// A state that is off by (dq, dv) at the time t is led to the end at the least cost by
/// `tau + gain_q dq + gain_v dv`, as long as the same limits are active ([`Feedback`]).
///
/// ```
/// use costate_control::{Gains, Problem, Solver, SolverOptions};
/// use costate::robot::Robot;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/pendulum.toml")?;
/// let problem = Problem::rest_to_rest(robot, &[0.0], &[3.0], 1.0);
/// let solution = Solver::new(&problem, SolverOptions::default())?.solve();
/// let gains = Gains::new(&problem, &solution, Some(100.0))?;
/// assert_eq!((gains.t.len(), gains.gain_q[0].len()), (101, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Gains {
    /// Version of the format, 1, which stays when keys are added.
    pub format: u32,
    /// Name of the robot.
    pub robot: String,
    /// Names of its joints, in order.
    pub joints: Vec<String>,
    /// T (s).
    pub final_time: f64,
    /// Times of the rows (s).
    pub t: Vec<f64>,
    /// Positions (rad, m).
    pub q: Rows,
    /// Velocities (rad/s, m/s).
    pub v: Rows,
    /// Torques and forces (N m, N).
    pub tau: Rows,
    /// dtau/dq (N m/rad, N/m), n x n at each time.
    pub gain_q: Vec<Rows>,
    /// dtau/dv (N m s/rad, N s/m), n x n at each time.
    pub gain_v: Vec<Rows>,
    /// Derivatives of the cost by the state at the start, (q, v).
    pub cost_by_start: Vec<f64>,
    /// Derivatives of T by the state at the start, the same.
    pub final_time_by_start: Vec<f64>,
    /// How the motion changes with its limits.
    pub derivatives: LimitDerivatives,
}

/// How a motion changes with its limits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct LimitDerivatives {
    /// Times of the rows (s): the points of the motion.
    pub t: Vec<f64>,
    /// One for each limit of each joint, for the power of all, and for each payload.
    pub parameters: Vec<LimitDerivative>,
}

/// How a motion changes with a limit, or with the mass of a payload; rows are at the same part of the time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct LimitDerivative {
    /// The limit as the key of a problem file, such as `limits.torque_max`; `robot.payload.mass` for a
    /// payload.
    pub name: String,
    /// Name of the joint, `all joints` for the power of all; of a payload the frame that carries it.
    pub joint: String,
    /// dJ/dtheta.
    pub cost: f64,
    /// dT/dtheta.
    pub final_time: f64,
    /// Derivatives of positions.
    pub q: Rows,
    /// Derivatives of velocities.
    pub v: Rows,
    /// Derivatives of torques and forces.
    pub tau: Rows,
}

/// Why there are no gains.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GainError {
    /// The solution has no motion.
    #[error("there is no motion to feed back to")]
    NoMotion,
    /// The rate is not a positive number, or asks for too many times.
    #[error("a rate of {rate} Hz; give a positive number of samples in a second, for at most 1e5 of them")]
    Rate {
        /// The rate (Hz).
        rate: f64,
    },
    /// The problem is one that is not solved again.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The dynamics cannot be evaluated along the motion.
    #[error(transparent)]
    Evaluation(#[from] EvalError),
    /// Solving again was not possible.
    #[error(transparent)]
    Resolve(#[from] ResolveError),
    /// Solving again did not come to an end.
    #[error("the motion is not solved on a mesh of its own; try another tolerance or more nodes")]
    NotSolved,
    /// Accelerations are continuous: no gains are computed.
    #[error(
        "there are no gains where accelerations are continuous (jerks, rates of torques or accelerations are \
         limited, cost something or are given); Resolve solves such a motion again"
    )]
    Continuous,
    /// Vias and a free final time: gains of such motions were found to be off by up to a tenth.
    #[error(
        "there are no gains of a motion with vias and a free final time; fix the final time at the one found, or \
         solve the rest of the motion by Resolve"
    )]
    FreeTime,
    /// The matrix of Newton's method is not positive definite.
    #[error("the motion is no strict minimum, so that there is no feedback")]
    NoMinimum,
}

impl Gains {
    /// At this rate (Hz) and at T, or at the points of the motion. The problem, which is the one that was
    /// solved, is solved once more, on the mesh of the motion or on equal intervals.
    ///
    /// # Errors
    /// [`GainError`].
    pub fn new(problem: &Problem, solution: &Solution, rate: Option<f64>) -> Result<Self, GainError> {
        Self::with_payloads(problem, solution, rate, &[])
    }

    /// The same with the derivatives by the masses of these payloads, which the robot carries already: their
    /// centres and shapes stay. Those that no joint moves and those without mass are left out.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_payloads(
        problem: &Problem,
        solution: &Solution,
        rate: Option<f64>,
        payloads: &[Payload],
    ) -> Result<Self, GainError> {
        if solution.trajectory.t.len() < 2 {
            return Err(GainError::NoMotion);
        }
        if problem.first_of_rates().is_some() {
            return Err(GainError::Continuous);
        }
        if !problem.vias.is_empty() && matches!(problem.time, FinalTime::Free { .. }) {
            return Err(GainError::FreeTime);
        }
        let mut motion = solved(problem, solution)?;
        let feedback = motion.feedback()?.cloned().ok_or(GainError::NoMinimum)?;
        let (n, m) = (feedback.dof(), feedback.state());
        let time = motion.final_time().unwrap_or(0.0);
        let points: Vec<f64> = (0..feedback.points()).map(|p| feedback.time(p)).collect();
        let t = match rate {
            Some(rate) if !(rate > 0.0 && time * rate < MOST) => return Err(GainError::Rate { rate }),
            Some(rate) => {
                let count = (time * rate * (1.0 - 1e-12)).floor() as usize;
                (0..=count).map(|k| k as f64 / rate).chain([time]).collect()
            }
            None => points.clone(),
        };
        let RobotNames { robot, joints, .. } = solution.robot.clone();
        let mut gains = Self {
            format: 1,
            robot,
            joints,
            final_time: time,
            q: Vec::new(),
            v: Vec::new(),
            tau: Vec::new(),
            gain_q: Vec::new(),
            gain_v: Vec::new(),
            cost_by_start: feedback.cost_gradient().to_vec(),
            final_time_by_start: feedback.time_by_start().to_vec(),
            derivatives: LimitDerivatives {
                t: points,
                parameters: parameters(problem, payloads, &mut motion)?,
            },
            t,
        };
        let (mut z, mut torques, mut gain) = (vec![0.0; 3 * n], vec![0.0; n], vec![0.0; n * m]);
        for &t in &gains.t {
            motion.state_at(t, &mut z)?;
            motion.torques_at(t, &mut torques)?;
            if !gain_at(&feedback, t, &mut gain) {
                return Err(GainError::NoMinimum);
            }
            gains.q.push(z[..n].to_vec());
            gains.v.push(z[n..2 * n].to_vec());
            gains.tau.push(torques.clone());
            let part =
                |first: usize| gain.chunks_exact(m).map(|row| row[first..first + n].to_vec()).collect();
            gains.gain_q.push(part(0));
            gains.gain_v.push(part(n));
        }
        Ok(gains)
    }
}

/// The motion solved again on its mesh; where that has no end on equal intervals.
fn solved(problem: &Problem, solution: &Solution) -> Result<Resolve, GainError> {
    let options = solution.options.clone();
    let mut near = Resolve::near(problem, options.clone(), &solution.trajectory)?;
    if near.solve()?.status == ResolveStatus::Solved {
        return Ok(near);
    }
    let limits = problem.limits.clone().with_from_robot(problem.keeps_robot_limits());
    let nodes = options.nodes.max(3 * INTERVALS + 1);
    let mut even = Resolve::new(&problem.clone().with_limits(limits), options.with_nodes(nodes))?;
    match even.solve()?.status {
        ResolveStatus::Solved => Ok(even),
        _ => Err(GainError::NotSolved),
    }
}

/// K(t); false where there is none.
fn gain_at(feedback: &Feedback, t: f64, gain: &mut [f64]) -> bool {
    feedback.gain(t, gain) && gain.iter().all(|entry| entry.is_finite())
}

/// Derivatives by all limits that the joints have, by the power of all, and by masses.
fn parameters(
    problem: &Problem,
    payloads: &[Payload],
    motion: &mut Resolve,
) -> Result<Vec<LimitDerivative>, GainError> {
    type Limit = (&'static str, fn(usize) -> MotionParameter);
    const LIMITS: [Limit; 8] = [
        ("limits.q_min", MotionParameter::PositionMin),
        ("limits.q_max", MotionParameter::PositionMax),
        ("limits.v_max", MotionParameter::VelocityMax),
        ("limits.a_max", MotionParameter::AccelerationMax),
        ("limits.torque_max", MotionParameter::TorqueMax),
        ("limits.power_max", MotionParameter::PowerMax),
        ("limits.jerk_max", MotionParameter::JerkMax),
        ("limits.torque_rate_max", MotionParameter::TorqueRateMax),
    ];
    let mut asked: Vec<(&'static str, String, MotionParameter)> = Vec::new();
    for (index, joint) in problem.robot.independent_joints().enumerate() {
        asked.extend(LIMITS.map(|(name, parameter)| (name, joint.name.clone(), parameter(index))));
    }
    asked.push(("limits.total_power_max", "all joints".into(), MotionParameter::TotalPowerMax));
    let mass =
        |of: &Payload| ("robot.payload.mass", of.frame.clone(), MotionParameter::PayloadMass(of.clone()));
    asked.extend(payloads.iter().map(mass));
    let mut all = Vec::new();
    for (name, joint, parameter) in asked {
        let MotionDerivative { cost, final_time, states, torques, .. } = match motion
            .derivative_by(&parameter)
        {
            Ok(Some(found)) => found,
            // Nor where no joint moves a payload, or where it has no mass.
            Ok(None)
            | Err(ResolveError::NoLimit { .. } | ResolveError::Payload(_) | ResolveError::NoMass) => continue,
            Err(error) => return Err(error.into()),
        };
        let n = motion.dof();
        let m = n * states.len() / torques.len();
        let rows = |first: usize| states.chunks_exact(m).map(|x| x[first..first + n].to_vec()).collect();
        all.push(LimitDerivative {
            name: name.into(),
            joint,
            cost,
            final_time,
            q: rows(0),
            v: rows(n),
            tau: torques.chunks_exact(n).map(<[f64]>::to_vec).collect(),
        });
    }
    Ok(all)
}
