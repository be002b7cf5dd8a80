//! The same problem solved again and again, as a controller needs it.

use super::feedback::Feedback;
use super::goals::Goals;
use super::recovery::Recovery;
use super::resolved::Shown;
use super::start::Again;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::limits::side::Side;
use crate::direct::motion::mesh::Mesh;
use crate::direct::motion::shape::{PLACES, POINTS};
use crate::direct::outcome::named::{Coordinates, kind, name};
use crate::direct::solve::first::First;
use crate::direct::solve::prepare::{Dynamics, interior, interior_on};
use crate::options::{Method, SolverOptions};
use crate::problem::error::ProblemError;
use crate::problem::limits::JointLimits;
use crate::problem::{BoundaryState, Problem};
use crate::result::trajectory::Trajectory;
use crate::task::build::TaskRows;
use costate::EvalError;
use costate::lagrangian::Lagrangian;
use costate::robot::Robot;
use std::fmt;
use std::time::Duration;

/// Most Newton steps on a finer mesh, which begin at the solution of the one before.
const MOST_STEPS: usize = 100;
/// Tolerance to which it is solved at least. Which limits are active is known where their multipliers, or
/// their distances, are more than about the root of it, both without unit: where these grow from zero to one
/// along an arc that is a hundredth of an interval of a 128th of a phase.
const SHARP: f64 = 1e-8;

/// A problem that is solved again and again on one mesh, with other starts, ends, goals, references and
/// places of obstacles.
///
/// The mesh has `(nodes - 1) / 3` equal intervals of the [options](SolverOptions::nodes), a quarter of the
/// points where accelerations are continuous, shared between the phases; their tolerance is that of each
/// solve. The first solve begins at the guess of [`Solver`](crate::Solver). Every later one
/// begins at the motion that is optimal for the new ends to first order ([`Feedback`]), with the multipliers
/// it has there and the barrier where the last solve ended. After the first solve, and the first
/// [`feedback`](Self::feedback), nothing is allocated.
///
/// A solve that failed ([`NoProgress`](crate::ResolveStatus::NoProgress), an error) is no start: the next one
/// begins at the last motion that was solved, and if that fails too at the first guess. So it does where a
/// solve ended before it was solved and the solved motion is better for what is set now, as after one wrong
/// measurement. After a wrong one for which a motion was solved, [`reset`](Self::reset) begins anew.
///
/// ```
/// use costate::robot::Robot;
/// use costate_control::{Budget, MachineCode, Problem, Resolve, ResolveStatus, SolverOptions};
/// use std::time::Duration;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/ur5.urdf")?;
/// let (from, to) = ([0.0, -1.6, 1.8, -1.8, -1.57, 0.0], [0.5, -1.4, 1.6, -1.6, -1.5, 0.2]);
/// let problem = Problem::rest_to_rest(robot, &from, &to, 1.0);
/// let options = SolverOptions::default().with_tolerance(1e-4).with_machine_code(MachineCode::AtOnce);
/// let mut motion = Resolve::new(&problem, options)?;
/// motion.solve()?;
/// motion.set_start(&[0.01, -1.6, 1.8, -1.79, -1.57, 0.0], &[0.0, 0.1, 0.0, 0.0, 0.0, 0.0])?;
/// let found = motion.solve_again(Budget::steps(12).within(Duration::from_secs(1)))?;
/// assert!(found.status == ResolveStatus::Solved && found.keeps_limits());
/// let mut torques = [0.0; 6];
/// motion.torques_at(0.002, &mut torques)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Resolve {
    pub(super) interior: Interior<Dynamics>,
    pub(super) options: SolverOptions,
    pub(super) limits: Vec<JointLimits>,
    /// In each phase, with what it carries.
    pub(super) robots: Vec<Robot>,
    /// Those of all phases.
    pub(super) models: Vec<Lagrangian<f64>>,
    /// The unknowns at the ends of phases: q, v, with continuous accelerations a.
    pub(super) states: Vec<Vec<f64>>,
    /// q(T) - q(0) of a periodic motion.
    pub(super) shift: Option<Vec<f64>>,
    pub(super) goals: Goals,
    /// With obstacles where they are now.
    pub(super) problem: Problem,
    pub(super) again: Again,
    pub(super) recovery: Recovery,
    feedback: Feedback,
    pub(super) shown: Shown,
    pub(super) z: Vec<f64>,
    /// The damping that steps needed last: where it is needed it is in the next solve too.
    pub(super) damping: f64,
    /// Longest time of a Newton step.
    pub(super) longest: Duration,
    pub(super) started: bool,
    /// Whether the equations are factorised near the iterate.
    pub(super) factorised: bool,
}

impl Resolve {
    /// Prepares a problem, whatever [`method`](SolverOptions::method) the options say: always the direct one.
    /// The limits of the robot are kept as [`Solver`](crate::Solver) keeps them
    /// ([`Problem::keeps_robot_limits`]).
    ///
    /// # Errors
    /// [`ProblemError`] as [`Solver::new`](crate::Solver::new).
    pub fn new(problem: &Problem, options: SolverOptions) -> Result<Self, ProblemError> {
        Self::begin(problem, options, None)
    }

    /// The same near a motion that was solved, on its mesh: at its nodes, whatever
    /// [`nodes`](SolverOptions::nodes) the options say. The first solve begins at this motion, with the
    /// limits that [`Solver`](crate::Solver) keeps.
    ///
    /// # Errors
    /// As [`new`](Self::new); a motion that begins and ends at one time, or of another robot, counts as none.
    pub fn near(
        problem: &Problem,
        options: SolverOptions,
        motion: &Trajectory,
    ) -> Result<Self, ProblemError> {
        let n = problem.robot.dof();
        let fits = motion.q.iter().all(|q| q.len() == n) && motion.q.len() > 2;
        let near = motion.mesh_nodes().filter(|_| fits).map(|nodes| (motion, nodes));
        Self::begin(problem, options, near)
    }

    fn begin(
        problem: &Problem,
        options: SolverOptions,
        near: Option<(&Trajectory, Vec<f64>)>,
    ) -> Result<Self, ProblemError> {
        let limits = problem.limits.clone().with_from_robot(problem.keeps_robot_limits());
        let problem = &problem.clone().with_limits(limits);
        problem.refuse_free_joints()?;
        let rows = TaskRows::new(problem)?;
        problem.refuse_constraints()?;
        problem.check_for(Method::Direct)?;
        options.check()?;
        let n = problem.robot.dof();
        let interior = match near {
            Some((motion, nodes)) => interior_on(
                problem,
                &rows,
                &options,
                &First::new(problem, &rows, &options, 0, Some(motion)),
                &nodes,
            ),
            None => interior(problem, &rows, &options, 0, None),
        };
        let state = |state: BoundaryState| {
            let mut unknowns = [state.q, state.v, state.a.unwrap_or_else(|| vec![0.0; n])].concat();
            unknowns.truncate(interior.spline.node());
            unknowns
        };
        let states: Vec<Vec<f64>> = problem.ends().into_iter().map(state).collect();
        Ok(Self {
            recovery: Recovery::new(&interior.spline, &states),
            interior,
            limits: problem.joint_limits(),
            robots: problem.robots(),
            models: problem.robots().iter().map(Lagrangian::new).collect(),
            shift: problem.periodic.clone(),
            goals: Goals::of(&problem.task),
            problem: problem.clone(),
            again: Again::new(n, &states),
            states,
            feedback: Feedback::default(),
            shown: Shown::default(),
            z: vec![0.0; 3 * n],
            damping: 0.0,
            longest: Duration::ZERO,
            started: false,
            factorised: false,
            options,
        })
    }

    /// The name of a joint, or its index from 0 if there is no such joint.
    pub(super) fn joint_name(&self, joint: usize) -> String {
        let found = self.robots.first().and_then(|robot| robot.independent_joints().nth(joint));
        found.map_or_else(|| joint.to_string(), |joint| joint.name.clone())
    }

    /// Number of joints, n.
    pub fn dof(&self) -> usize {
        self.limits.len()
    }

    /// Begins the warm start later by `dt` (s), the time since the last solve: the part of the motion that is
    /// over is left out. With a fixed final time the motion goes on beyond its end at the rates there; with a
    /// free one its rest remains. Less than half an interval makes no difference: the new start and end
    /// take the motion along.
    ///
    /// Vias stay where they are on the clock: the first phase becomes shorter by `dt`, and so do the times
    /// that are given for vias and for the end. The first phase keeps half of its time at least: make a
    /// `Resolve` without a via that is passed. A periodic motion stays.
    pub fn advance(&mut self, dt: f64) {
        if self.started && dt > 0.0 && dt.is_finite() {
            self.interior.shift(dt, &mut self.again);
            self.recovery.advance(dt);
        }
    }

    /// The derivatives of the motion by its ends. The equations of its last Newton step are factorised anew
    /// at the motion: one evaluation at the points.
    ///
    /// `None` where the matrix is not positive definite: before a solution is near, or at one that is no
    /// strict minimum.
    ///
    /// # Errors
    /// [`EvalError`] where the motion cannot be evaluated.
    pub fn feedback(&mut self) -> Result<Option<&Feedback>, EvalError> {
        if !self.started {
            return Ok(None);
        }
        self.factorised = self.interior.linearise()?;
        if !self.factorised {
            return Ok(None);
        }
        self.interior.fill_feedback(&mut self.feedback);
        Ok(Some(&self.feedback))
    }

    /// The feedback of the motion on a finer mesh, whose intervals are halves of those that it has, none
    /// wider than this part of a phase, and solved there to a sharp tolerance where that succeeds. `None`
    /// where it is not solved there at all, and the motion is what it was, or where it is no strict minimum.
    /// Else it stays on the finer mesh, for nothing but its values and its feedback.
    ///
    /// # Errors
    /// [`EvalError`] where the motion cannot be evaluated.
    pub(crate) fn refine(&mut self, widest: f64) -> Result<Option<&Feedback>, EvalError> {
        let (coarse, tolerance) = (self.interior.spline.mesh.nodes.clone(), self.options.tolerance);
        let mut mesh = self.interior.spline.mesh.clone();
        while (0..mesh.intervals()).any(|k| mesh.width(k) > widest) {
            mesh = Mesh::new(mesh.halved(widest), mesh.shape);
        }
        if mesh.nodes.len() > coarse.len() || tolerance > SHARP {
            self.recovery.other.take(&self.interior);
            self.interior.move_to(mesh.nodes.clone())?;
            if self.interior.iterate(tolerance, MOST_STEPS, |_, _| None)? != End::Solved {
                self.interior.move_to(coarse)?;
                return self.put_back().map(|()| None);
            }
            if tolerance > SHARP {
                self.recovery.other.take(&self.interior);
                if self.interior.iterate(SHARP, MOST_STEPS, |_, _| None)? != End::Solved {
                    self.put_back()?;
                }
            }
            self.shown.take(&self.interior);
        }
        self.interior.take_touches();
        self.feedback()
    }

    /// Makes the motion that was put aside, on this mesh, the iterate.
    fn put_back(&mut self) -> Result<(), EvalError> {
        self.recovery.other.put(&mut self.interior);
        self.interior.evaluate()
    }

    /// Names of the limits that are active at a time of the last motion: what, of which joint or row, and the
    /// side, such as `rate elbow max`.
    pub(crate) fn active_at(&self, t: f64) -> Vec<String> {
        let spline = &self.interior.spline;
        let (k, x) = spline.mesh.place(spline.place_of(t));
        let off = |j: &usize| (PLACES[*j] - x).abs();
        let near = (0..POINTS).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
        let coordinates = Coordinates::of(&self.problem);
        let sides = self.interior.active_sides(k, near).filter(|side| !side.is_law());
        sides.map(|side| named(&self.interior, side, &coordinates)).collect()
    }
}

/// A side in words.
pub(super) fn named(interior: &Interior<Dynamics>, side: &Side, coordinates: &Coordinates) -> String {
    let own = name(interior, side, None, coordinates);
    let end = match (side.is_equation, side.sign > 0.0) {
        (true, _) => "",
        (false, true) => " min",
        (false, false) => " max",
    };
    format!("{} {own}{end}", kind(interior, side, None, coordinates))
}

impl fmt::Debug for Resolve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Resolve")
            .field("options", &self.options)
            .field("states", &self.states)
            .field("started", &self.started)
            .finish_non_exhaustive()
    }
}
