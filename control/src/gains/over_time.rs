//! The gains of the optimal feedback over time.

use super::derivatives::{LimitDerivatives, Rows, parameters};
use super::error::GainError;
use crate::direct::{OneSided, Resolve};
use crate::problem::{Payload, Problem};
use crate::result::solution::{RobotNames, Solution};
use serde::{Deserialize, Serialize};

/// Most times.
const MOST: f64 = 1e5;
/// Widest interval for gains, as a part of its phase. The error of gains between limits falls with its fourth
/// power, and where a limit becomes active or inactive they are known to an interval.
const WIDEST: f64 = 1.0 / 128.0;
/// By more than this part of the largest entry for q, v or a one-sided derivatives differ: what the stiffness
/// of limits leaves of them.
const ONE_SIDED: f64 = 0.01;

/// The optimal feedback of a solved motion over time, and how the motion changes with its limits: what
/// `costate optimize --feedback` writes.
///
/// A state that is off by (dq, dv) at the time t is led to the end at the least cost by
/// `tau + gain_q dq + gain_v dv`, as long as the same limits are active ([`Feedback`](crate::Feedback)).
/// Where accelerations are continuous the control is the jerk: a state that is off by (dq, dv, da) is led by
/// `jerk + gain_q dq + gain_v dv + gain_a da`.
///
/// [`active`](Self::active) names the limits that are active at each time. Rows of torques (of jerks) at a
/// limit are zero. While a limit of the state is active gains are zero along its gradient and along that of
/// its derivative in time: such deviations have no derivative. A motion that only just touches a limit has
/// two one-sided derivatives, the gain lies between them, and [`undecided`](Self::undecided) names the limit.
/// Towards a given end gains grow without bound; [`held`](Self::held) says from when on they are held.
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
    /// Where accelerations are continuous: djerk/da (1/s), n x n at each time; the two others are djerk/dq
    /// and djerk/dv then. Else empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gain_a: Vec<Rows>,
    /// Names of the limits that are active at each time, such as `rate elbow max`.
    #[serde(default)]
    pub active: Vec<Vec<String>>,
    /// At each time the names of the limits, now or later, that are only touched. Of some the motion does not
    /// show whether they are active, multiplier and distance being both nearly zero; these are named where
    /// the gains with all of them kept and with all of them left out differ by more than 1 % of the largest
    /// gain. Limits of positions, tools and clearances that are kept for longer than an instant, and for less
    /// than four intervals of the mesh, are named too: gains before that are not known.
    #[serde(default)]
    pub undecided: Vec<Vec<String>>,
    /// For each phase the time from which on its gains are held, and its end (s).
    #[serde(default)]
    pub held: Vec<[f64; 2]>,
    /// Derivatives of the cost by the state at the start, (q, v), with continuous accelerations (q, v, a).
    pub cost_by_start: Vec<f64>,
    /// Derivatives of T by the state at the start, the same.
    pub final_time_by_start: Vec<f64>,
    /// How the motion changes with its limits.
    pub derivatives: LimitDerivatives,
}

impl Gains {
    /// At this rate (Hz) and at T, or at the points of the motion. The problem, which is the one that was
    /// solved, is solved once more, on the mesh of the motion or on equal intervals; then with intervals in
    /// halves, no wider than a 128th of a phase, and to a tolerance of at least 1e-8, which shows where
    /// limits become active. Where that is not solved the gains are those of the first mesh or tolerance.
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
        if let Some(joint) = problem.first_free_jerk() {
            return Err(GainError::FreeJerk { joint });
        }
        if !problem.has_gains() {
            return Err(GainError::FreeTime);
        }
        let mut motion = Resolve::solved_near::<GainError>(problem, solution)?.ok_or(GainError::NotSolved)?;
        let mut feedback = motion.feedback()?.cloned().ok_or(GainError::NoMinimum)?;
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
            gain_a: Vec::new(),
            active: Vec::new(),
            undecided: Vec::new(),
            held: Vec::new(),
            cost_by_start: feedback.cost_gradient().to_vec(),
            final_time_by_start: feedback.time_by_start().to_vec(),
            derivatives: LimitDerivatives {
                t: points,
                parameters: parameters(problem, payloads, &mut motion)?,
            },
            t,
        };
        if let Some(finer) = motion.refine(WIDEST)? {
            feedback.clone_from(finer);
        }
        gains.held = feedback.held().collect();
        let mut one_sided = OneSided::of(&mut motion)?;
        let (mut z, mut torques, mut gain) = (vec![0.0; 3 * n], vec![0.0; n], vec![0.0; n * m]);
        for &t in &gains.t {
            motion.state_at(t, &mut z)?;
            motion.torques_at(t, &mut torques)?;
            if !feedback.gain(t, &mut gain) {
                return Err(GainError::NoMinimum);
            }
            gains.active.push(motion.active_at(t));
            let undecided = one_sided.as_mut().map(|sides| sides.names(&motion, t, ONE_SIDED));
            gains.undecided.push(undecided.unwrap_or_default());
            gains.q.push(z[..n].to_vec());
            gains.v.push(z[n..2 * n].to_vec());
            gains.tau.push(torques.clone());
            let part =
                |first: usize| gain.chunks_exact(m).map(|row| row[first..first + n].to_vec()).collect();
            gains.gain_q.push(part(0));
            gains.gain_v.push(part(n));
            if m > 2 * n {
                gains.gain_a.push(part(2 * n));
            }
        }
        Ok(gains)
    }
}
