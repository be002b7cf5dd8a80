//! What solving a problem of a robot gives.

use crate::options::{Method, SolverOptions};
use crate::problem::Problem;
use crate::result::constraint_forces::ConstraintForces;
use crate::result::free_entries::FreeEntries;
use crate::result::gait::GaitReport;
use crate::result::limit_use::LimitReport;
use crate::result::motion::Motion;
use crate::result::polish_report::PolishReport;
use crate::result::stage_times::StageTimes;
use crate::result::start::StartResult;
use crate::result::trajectory::Trajectory;
use crate::result::trajectory_error::TrajectoryError;
use crate::result::verification::Verification;
use crate::status::Status;
use costate::robot::Robot;

/// What solving a [`Problem`](crate::Problem) gave; unless [`Status::is_solved`] the best iterate.
///
/// Written and read as JSON by serde; [`Trajectory`] by itself is what a warm start needs.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Solution {
    /// Status, cost and all other figures of the motion.
    pub motion: Motion,
    /// Largest miss of a position or velocity that is fixed at the end, when the motion is integrated again
    /// with the control that was found (rad, m, rad/s, m/s); infinite where that was not possible.
    pub end_defect: f64,
    /// Newton steps of the direct method and on extremals, over all meshes and starts.
    pub newton_iterations: usize,
    /// How the motion uses its hard limits; empty without the direct method.
    pub limits: LimitReport,
    /// The forces of the constraints of the robot at the nodes, and how far the motion drifts from them.
    pub constraints: Vec<ConstraintForces>,
    /// Of a gait, whose foot on the ground is the only one of `constraints`.
    pub gait: Option<GaitReport>,
    /// Whether the motion is that of the direct method or its polished form, and why; `None` where that was
    /// not asked.
    pub polish: Option<PolishReport>,
    /// What a verification found that does not use the points of the solver; `None` without it
    /// ([`Verify::Full`](crate::Verify::Full)), and where there was nothing to verify.
    pub verified: Option<Verification>,
    /// Where the time of the direct method went; `None` unless
    /// [asked for](crate::Solver::with_stage_times). Not saved.
    pub stage_times: Option<StageTimes>,
    /// The motion over time.
    pub trajectory: Trajectory,
    /// Each start in its order; the best of them is this solution.
    pub starts: Vec<StartResult>,
    /// The options it was solved with.
    pub options: SolverOptions,
    /// The robot that moves.
    pub robot: RobotNames,
}

/// A robot by its name and the names of its joints: what tells the solutions of two robots apart.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RobotNames {
    /// Name of the robot.
    pub robot: String,
    /// Names of its joints, in order.
    pub joints: Vec<String>,
}

impl RobotNames {
    /// The names of a robot.
    pub fn of(robot: &Robot) -> Self {
        let joints = robot.independent_joints().map(|joint| joint.name.clone()).collect();
        Self { robot: robot.name().into(), joints }
    }
}

/// The costates at the start of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CostateStart<'a> {
    /// `-dJ/dq(0)` at constant p, one entry for each joint.
    pub y_q: &'a [f64],
    /// `-dJ/dp(0)`, one entry for each joint.
    pub y_p: &'a [f64],
}

impl Solution {
    /// Cost and penalties together: what was minimised.
    pub fn total(&self) -> f64 {
        self.motion.total()
    }

    /// Number of rows of the trajectory, `nodes` in JSON. Of extremals these are the nodes of the mesh, a
    /// switch two. Of the direct method they are points and nodes, where torques may jump five for each
    /// interval (both ends and three points), with continuous accelerations four for each and one more.
    pub fn nodes(&self) -> usize {
        self.trajectory.t.len()
    }

    /// Number of intervals of the last mesh; 0 without a motion.
    pub fn intervals(&self) -> usize {
        self.trajectory.mesh_nodes().map_or(0, |nodes| nodes.len() - 1)
    }

    /// Nodes of the last mesh as [`SolverOptions::nodes`] and `max_nodes` count them: of extremals one more
    /// than intervals, of the direct method 3k + 1 for k intervals, 4k + 1 where accelerations are
    /// continuous.
    pub fn mesh_nodes(&self) -> usize {
        let stride = match self.motion.is_direct() {
            true if self.trajectory.has_continuous_accelerations() => 4,
            true => 3,
            false => 1,
        };
        stride * self.intervals() + 1
    }

    /// Estimated error of the cost of a motion of the direct method, relative to it. `None` of extremals,
    /// whose [`errors`](Motion::errors) are those of components, and where there is no estimate.
    pub fn cost_error(&self) -> Option<f64> {
        let is_polished = self.polish.as_ref().is_some_and(|report| report.outcome.is_polished());
        let error = self.motion.errors.first().filter(|error| error.is_finite());
        error.copied().filter(|_| self.options.method == Method::Direct && !is_polished)
    }

    /// The costates at the start: `y(0) = -dJ/dx(0)`. Empty for a solution without a motion.
    pub fn costate_start(&self) -> CostateStart<'_> {
        CostateStart {
            y_q: self.trajectory.y_q.first().map_or(&[], Vec::as_slice),
            y_p: self.trajectory.y_p.first().map_or(&[], Vec::as_slice),
        }
    }

    /// Whether this is a solution of a problem of this robot: its joints have these names and, if there is a
    /// motion, as many entries of q, with quaternions of the same joints.
    ///
    /// # Errors
    /// [`TrajectoryError::OtherRobot`], [`TrajectoryError::OtherFreeJoints`], or the errors of
    /// [`Trajectory::check`].
    pub fn check_robot(&self, robot: &Robot) -> Result<(), TrajectoryError> {
        let RobotNames { robot: found, joints: found_joints } = &self.robot;
        let RobotNames { joints, .. } = RobotNames::of(robot);
        if *found_joints != joints {
            let (found, found_joints) = (found.clone(), found_joints.clone());
            return Err(TrajectoryError::OtherRobot { found, found_joints, joints });
        }
        if self.trajectory.t.is_empty() {
            return Ok(());
        }
        FreeEntries::check_robot(&self.trajectory.free_joints, found, robot)?;
        self.trajectory.check(robot)
    }

    /// Whether there is a motion near which an extremal may be.
    pub(crate) fn is_motion(&self) -> bool {
        let status = &self.motion.status;
        let hopeless = status.exceeds_limits() || matches!(status, Status::EvaluationFailed(_));
        !hopeless && self.trajectory.t.len() > 1 && self.total().is_finite()
    }

    /// A solution of a problem without a motion.
    pub(crate) fn without_motion(problem: &Problem, status: Status) -> Self {
        Self::missing(&problem.robot, status, problem.time.value())
    }

    /// The same, of a robot and a time.
    pub(crate) fn missing(robot: &Robot, status: Status, final_time: f64) -> Self {
        Self {
            motion: Motion::missing(status, final_time),
            end_defect: f64::INFINITY,
            newton_iterations: 0,
            limits: LimitReport::default(),
            constraints: Vec::new(),
            gait: None,
            polish: None,
            verified: None,
            stage_times: None,
            trajectory: Trajectory::default(),
            starts: Vec::new(),
            options: SolverOptions::default(),
            robot: RobotNames::of(robot),
        }
    }
}
