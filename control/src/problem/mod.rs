//! Optimal-control problems of robots.

pub(crate) mod check;
mod check_vias;
pub(crate) mod continuation_cause;
mod end_error;
pub(crate) mod error;
mod error_text;
#[cfg(feature = "toml")]
pub(crate) mod file;
mod first_guess;
pub(crate) mod free_end;
mod free_error;
mod free_fall;
pub(crate) mod free_joints;
pub(crate) mod gait;
mod gait_checks;
mod gait_error;
mod gait_in_space;
mod gait_legs;
mod gait_symmetry;
mod given_ends;
mod joint_limits;
pub(crate) mod key;
pub(crate) mod least_time;
mod leaving;
pub(crate) mod limits;
mod loop_directions;
mod loop_error;
pub(crate) mod loop_rows;
pub(crate) mod loops;
pub(crate) mod narrow;
pub(crate) mod obstacles;
pub(crate) mod parts;
mod phases;
pub(crate) mod references;
mod robot_limits;
pub(crate) mod rounded;
pub(crate) mod running_cost;
mod soles;
pub(crate) mod source_error;
mod standing;
pub(crate) mod task;
pub(crate) mod task_error;
mod toe_edge;
pub(crate) mod tools;
pub(crate) mod torque_speed_error;
pub(crate) mod urdf_bodies;
mod via;
mod via_error;
mod walking;
pub(crate) mod warning;
pub(crate) mod wrench_cone;

pub use end_error::{EndError, Leads};
pub use free_error::FreeMotionError;
pub use gait::{Gait, SoleContact};
pub use gait_error::GaitError;
pub use limits::MotionLimits;
pub use loop_error::{LoopError, UnfitRates};
pub use obstacles::{BodyPairs, Collision, LinkCapsule, Obstacle, Shape};
pub use parts::{BoundaryState, Bounds, FinalTime, Objective, Penalty};
pub use references::{JointReference, Reference, ToolReference};
pub use task::Task;
pub use task_error::TaskError;
pub use tools::{Keep, Kept, Tool, ToolCost, ToolOrientation, ToolPose};
pub use torque_speed_error::TorqueSpeedError;
pub use urdf_bodies::UrdfBodyError;
pub use via::{Payload, Via};
pub use via_error::ViaError;

use crate::problem::key::Key;
use crate::problem::loop_rows::Loops;
use crate::problem::running_cost::UserTerm;
use costate::robot::Robot;
use std::sync::Arc;

/// Find u(t) that moves a robot from its start to its end and minimises
///
/// $$ J = c_t T + \int_0^T \left( \tfrac12 \sum_i r_i u_i^2 + \text{terms} + \text{penalties} \right) dt,
///    \qquad x' = F(x) + \begin{pmatrix} 0 \\\\ B u \end{pmatrix}, \quad x = (q, p) $$
///
/// With the running cost l and the maximised Hamiltonian $H^\ast(x, y) = \max_u [ y^\top f - l ]$ the costate
/// obeys $y' = -\partial H^\ast / \partial x$, the optimal control is $u_i = r_i^{-1} b_i y_{p,i}$, clipped
/// to its bounds, and $dJ/dT = -H^\ast$, $y(0) = -dJ/dx(0)$.
///
/// ```
/// use costate_control::{Bounds, FinalTime, Objective, Problem};
/// use costate::robot::Robot;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.0, 0.5], 1.0)
///     .with_time(FinalTime::Free { guess: 1.0 })
///     .with_cost(Objective::new(1.0, vec![0.01, 0.01]))
///     .with_bounds(Bounds::symmetric(vec![20.0; 2]));
/// problem.check()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Problem {
    /// The robot.
    pub robot: Robot,
    /// State at the start.
    pub start: BoundaryState,
    /// State at the end.
    pub end: BoundaryState,
    /// Duration of the motion.
    pub time: FinalTime,
    /// Weights of time and effort.
    pub cost: Objective,
    /// Further terms l(q, v) of the running cost, each with factor 1.
    pub terms: Vec<UserTerm>,
    /// Diagonal of B, n entries.
    pub gain: Vec<f64>,
    /// Bounds on u.
    pub bounds: Option<Bounds>,
    /// Penalties on positions and rates.
    pub penalty: Option<Penalty>,
    /// Hard limits, which [`Method::Direct`](crate::Method::Direct) keeps.
    pub limits: MotionLimits,
    /// Tools and obstacles, which [`Method::Direct`](crate::Method::Direct) takes.
    pub task: Task,
    /// Places on the way, in the order in which they are passed, which
    /// [`Method::Direct`](crate::Method::Direct) takes.
    pub vias: Vec<Via>,
    /// Where the end follows the start: q(T) - q(0) (rad, m), n entries. `None`: the ends are independent.
    /// Needs [`Method::Direct`](crate::Method::Direct).
    pub periodic: Option<Vec<f64>>,
    /// The gait of which the motion is one step. Its ends are free; [`start`](Self::start) is a guess. Needs
    /// [`Method::Direct`](crate::Method::Direct).
    pub gait: Option<Gait>,
    /// The constraints whose multipliers are coordinates too; of problems that the solver makes.
    pub(crate) loops: Option<Arc<Loops>>,
}

impl Problem {
    /// From rest to rest in the time T (s), with cost $\frac12 |u|^2$ per second and no bounds. `from` and
    /// `to` are positions (rad, m), one per joint.
    pub fn rest_to_rest(robot: Robot, from: &[f64], to: &[f64], time: f64) -> Self {
        let n = robot.dof();
        Self {
            robot,
            start: BoundaryState::fixed(from, &vec![0.0; n]),
            end: BoundaryState::fixed(to, &vec![0.0; n]),
            time: FinalTime::Fixed(time),
            cost: Objective::new(0.0, vec![1.0; n]),
            terms: Vec::new(),
            gain: vec![1.0; n],
            bounds: None,
            penalty: None,
            limits: MotionLimits::unsaid(),
            task: Task::default(),
            vias: Vec::new(),
            periodic: None,
            gait: None,
            loops: None,
        }
    }

    /// With this start.
    #[must_use]
    pub fn with_start(self, start: BoundaryState) -> Self {
        Self { start, ..self }
    }

    /// With this end.
    #[must_use]
    pub fn with_end(self, end: BoundaryState) -> Self {
        Self { end, ..self }
    }

    /// With this final time.
    #[must_use]
    pub fn with_time(self, time: FinalTime) -> Self {
        Self { time, ..self }
    }

    /// With these weights of time and effort.
    #[must_use]
    pub fn with_cost(self, cost: Objective) -> Self {
        Self { cost, ..self }
    }

    /// With one more term of the running cost.
    #[must_use]
    pub fn with_term(mut self, term: UserTerm) -> Self {
        self.terms.push(term);
        self
    }

    /// With this diagonal of B, n entries.
    #[must_use]
    pub fn with_gain(self, gain: Vec<f64>) -> Self {
        Self { gain, ..self }
    }

    /// With these bounds on u.
    #[must_use]
    pub fn with_bounds(self, bounds: Bounds) -> Self {
        Self { bounds: Some(bounds), ..self }
    }

    /// With these penalties.
    #[must_use]
    pub fn with_penalty(self, penalty: Penalty) -> Self {
        Self { penalty: Some(penalty), ..self }
    }

    /// With these hard limits.
    #[must_use]
    pub fn with_limits(self, limits: MotionLimits) -> Self {
        Self { limits, ..self }
    }

    /// With these tools and obstacles.
    #[must_use]
    pub fn with_task(self, task: Task) -> Self {
        Self { task, ..self }
    }

    /// The names of the ends, "start" and "end", at rest where accelerations jump: those of the motion are
    /// continuous there, but they are not given, so the motion need not begin or end with those of a robot at
    /// rest.
    pub fn jumps_at_rest(&self) -> Vec<&'static str> {
        if self.first_of_rates().is_none() || self.periodic.is_some() || self.gait.is_some() {
            return Vec::new();
        }
        let rests = |end: &BoundaryState| end.v_free.is_empty() && end.v.iter().all(|&v| v == 0.0);
        let jumps = |end: &BoundaryState| end.a.is_none() && rests(end);
        let ends = [("start", &self.start), ("end", &self.end)];
        ends.into_iter().filter(|(_, end)| jumps(end)).map(|(name, _)| name).collect()
    }

    /// What makes accelerations continuous, if anything does: a limit or a cost of jerks or of rates of
    /// torques, or accelerations that are given at an end.
    pub(crate) fn first_of_rates(&self) -> Option<Key> {
        let given = |end: &BoundaryState, key| end.a.as_ref().map(|_| key);
        let of_limits = self.limits.first_of_rates().or_else(|| self.cost.first_of_rates());
        of_limits.or(given(&self.start, Key::START_A)).or(given(&self.end, Key::END_A))
    }

    /// Whether an optimal motion of this problem that is a strict minimum has gains
    /// ([`Gains`](crate::Gains)). Where accelerations are continuous only if the jerk, or the rate of the
    /// torque, of each joint costs something, and the final time and those of all vias are given.
    pub fn has_gains(&self) -> bool {
        let times_are_given = || self.times_at_ends().iter().all(Option::is_some);
        self.first_of_rates().is_none() || (self.first_free_jerk().is_none() && times_are_given())
    }

    /// Where accelerations are continuous: the name of the first joint whose jerk, and whose rate of the
    /// torque, cost nothing.
    pub(crate) fn first_free_jerk(&self) -> Option<String> {
        self.first_of_rates()?;
        let costs = |list: &Option<Vec<f64>>, i: usize| list.as_ref().is_some_and(|list| list[i] > 0.0);
        let mut joints = self.robot.independent_joints().enumerate();
        let free = joints.find(|&(i, _)| !costs(&self.cost.jerk, i) && !costs(&self.cost.torque_rate, i));
        free.map(|(_, joint)| joint.name.clone())
    }

    /// Whether a relaxed problem may weaken the user terms. Not where they are the only cost of time.
    pub(crate) fn terms_may_be_weaker(&self) -> bool {
        !self.terms.is_empty() && (self.cost.time > 0.0 || matches!(self.time, FinalTime::Fixed(_)))
    }
}
