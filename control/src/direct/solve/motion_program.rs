//! The whole program of a motion on one mesh, for any solver.

use super::first::First;
use super::prepare::{Dynamics, interior_of};
use crate::direct::interior::iterate::Interior;
use crate::direct::motion::spline::Spline;
use crate::direct::outcome::named::{self, Coordinates};
use crate::direct::points::values::Points;
use crate::direct::program::staged::{Program, Work};
use crate::direct::program::structure::{Row, Structure};
use crate::options::{Method, SolverOptions};
use crate::problem::Problem;
use crate::problem::error::ProblemError;
use crate::task::build::TaskRows;
use costate::EvalError;
use costate_nlp::{Blocks, Layout, Scales, StagedProblem, Values, Weights};
use std::fmt;

/// The nonlinear program that the direct method poses for a motion on one mesh, with exact first and second
/// derivatives: [`Problem::nlp`] makes it.
///
/// It is a [`StagedProblem`] for [`costate_nlp::Solver`], and with
/// [`SparseProgram`](costate_nlp::SparseProgram) one of sparse matrices for IPOPT and others. A point has q
/// and its derivatives at the nodes and the heights of the bubbles of the intervals, in the order of the
/// [`Layout`], without what is given at the ends; then the free times (s) and what both ends share. The
/// equations are laws of physics (joints without motors, constraints) and what tools keep; the functions with
/// ranges are limits at the points of the mesh and at nodes. [`equalities`](Self::equalities) and
/// [`ranges`](Self::ranges) name them.
///
/// Solved, it is the motion on this mesh: how far that is from the motion that is meant, and whether limits
/// are kept between the points, is what [`Solver`](crate::Solver) adds, with further meshes.
///
/// ```
/// use costate::robot::Robot;
/// use costate_control::{MotionLimits, Problem, SolverOptions};
/// use costate_nlp::{Certificate, Settings, Solver, StagedProblem, Status};
///
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let limits = MotionLimits::none().with_torque_max(vec![40.0, 12.0]);
/// let problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.5, 1.5], 1.0).with_limits(limits);
/// let mut program = problem.nlp(&SolverOptions::default().with_nodes(61))?;
/// let mut solver = Solver::new(program.layout(), Settings::default());
/// let start = program.start().to_vec();
/// let solution = solver.solve(&mut program, &start)?;
/// assert_eq!(solution.status, Status::Solved);
/// assert_eq!(solver.certify(&mut program)?, Certificate::LocalMinimum);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct MotionProgram {
    interior: Interior<Dynamics>,
    structure: Structure,
    work: Work,
    equalities: Vec<ProgramRow>,
    ranges: Vec<ProgramRow>,
}

/// What an equation or a function with a range of a [`MotionProgram`] is about.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramRow {
    /// What is limited, as in [`LimitUse`](crate::LimitUse): `torque`, `rate`, `task`, ...
    pub kind: &'static str,
    /// The joint, or the row of a task.
    pub name: String,
    /// Its unit in reports. The function itself may be another measure of it: a half of the square of a speed
    /// over its limit, the acceleration of a multiplier for a force.
    pub unit: &'static str,
    /// The place in the motion: 0 at its start, increased by one in each phase.
    pub place: f64,
}

impl fmt::Debug for MotionProgram {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (layout, mesh) = (&self.structure.layout, &self.interior.spline.mesh);
        f.debug_struct("MotionProgram")
            .field("intervals", &mesh.intervals())
            .field("steps", &layout.steps())
            .field("equalities", &layout.equalities())
            .field("ranges", &layout.ranges())
            .finish_non_exhaustive()
    }
}

impl Problem {
    /// The nonlinear program of this motion on the mesh that the [direct method](Method::Direct) begins with:
    /// equal intervals, as many as [`nodes`](SolverOptions::nodes) allows, and nodes at what the problem
    /// names. It takes trees, loops, steps of gaits, and all limits and costs. Constraints have coordinates
    /// of their own after those of the joints, whose accelerations are the multipliers. Of the options
    /// `nodes`, `max_nodes`, `seed` and `machine_code` count; it begins at the straight guess, not at a saved
    /// motion.
    ///
    /// # Errors
    /// [`ProblemError`] as [`Solver::new`](crate::Solver::new); [`ProblemError::FreeJoint`] for floating and
    /// spherical joints.
    pub fn nlp(&self, options: &SolverOptions) -> Result<MotionProgram, ProblemError> {
        self.refuse_free_joints()?;
        self.check_for(Method::Direct)?;
        options.check()?;
        let is_constrained = self.gait.is_some() || !self.robot.constraints().is_empty();
        let with_multipliers = is_constrained.then(|| self.with_multipliers()).transpose()?;
        let problem = with_multipliers.as_ref().unwrap_or(self);
        let rows = TaskRows::new(problem)?;
        let first = First::new(problem, &rows, options, 0, None);
        let mut interior = interior_of(problem, &rows, options, &first);
        // A guess that cannot be evaluated is told by the solver.
        let size = interior.start(None).map_or(1.0, |()| interior.figures.size);
        let of_both = interior.model.tasks.rows_of_both_ends();
        let Interior { spline, barrier, ends, .. } = &mut interior;
        let structure = Structure::new(spline, barrier, ends, (of_both, size));
        let work = Work::new(spline, barrier, ends, &structure);
        let coordinates = Coordinates::of(problem);
        let named = |rows: &[Row]| rows.iter().map(|row| named(&interior, row, &coordinates)).collect();
        let (equalities, ranges) = (named(&structure.equalities), named(&structure.ranges));
        Ok(MotionProgram { interior, structure, work, equalities, ranges })
    }
}

/// What a row is about.
fn named(interior: &Interior<Dynamics>, row: &Row, coordinates: &Coordinates) -> ProgramRow {
    let barrier = &interior.barrier;
    let side = barrier.side(row.entry);
    let end = barrier.side_index(row.entry).is_none().then(|| barrier.end_of(row.entry));
    ProgramRow {
        kind: named::kind(interior, side, end, coordinates),
        name: named::name(interior, side, end, coordinates).to_owned(),
        unit: named::unit(interior, side, end, coordinates),
        place: barrier.place(row.entry, &interior.spline),
    }
}

impl MotionProgram {
    /// The guess.
    pub fn start(&self) -> &[f64] {
        &self.work.origin
    }

    /// What the equations are about, in their order.
    pub fn equalities(&self) -> &[ProgramRow] {
        &self.equalities
    }

    /// What the functions with ranges are about, in their order.
    pub fn ranges(&self) -> &[ProgramRow] {
        &self.ranges
    }

    /// The motion of a point of the program, at the points of its mesh.
    ///
    /// # Errors
    /// [`EvalError::Model`] where a time is not positive, or inverse dynamics has no value.
    pub fn sample(&mut self, point: &[f64]) -> Result<Vec<ProgramSample>, EvalError> {
        let mut program = self.program();
        if !program.place(point) {
            let reason = "the point is no motion: a time is not positive, or forces are not finite".into();
            return Err(EvalError::Model { reason });
        }
        let Interior { spline, points, .. } = &self.interior;
        Ok((0..points.count()).map(|p| sample(spline, points, p)).collect())
    }

    fn program(&mut self) -> Program<'_, Dynamics> {
        let Self { interior, structure, work, .. } = self;
        let Interior { spline, points, barrier, running, model, system, ends, .. } = interior;
        Program { spline, points, barrier, running, model, system, ends, structure, work }
    }
}

/// A motion at one point of the mesh of a [`MotionProgram`].
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramSample {
    /// Time (s).
    pub t: f64,
    /// Positions (rad, m).
    pub q: Vec<f64>,
    /// Velocities (rad/s, m/s).
    pub v: Vec<f64>,
    /// Accelerations (rad/s^2, m/s^2).
    pub a: Vec<f64>,
    /// Generalised forces of inverse dynamics (N m, N): gains times controls, and zero without a motor.
    pub tau: Vec<f64>,
}

fn sample(spline: &Spline, points: &Points, p: usize) -> ProgramSample {
    let [q, v, a] = [0, 1, 2].map(|part| points.z(p)[points.dof * part..][..points.dof].to_vec());
    ProgramSample { t: spline.time_of(p), q, v, a, tau: points.tau(p).to_vec() }
}

impl StagedProblem for MotionProgram {
    type Error = EvalError;

    fn layout(&self) -> &Layout {
        &self.structure.layout
    }

    fn bounds(&self) -> [&[f64]; 2] {
        self.structure.bounds.each_ref().map(Vec::as_slice)
    }

    fn scales(&self) -> Option<&Scales> {
        Some(&self.structure.scales)
    }

    fn evaluate(&mut self, point: &[f64], values: &mut Values) -> Result<(), EvalError> {
        self.program().evaluate(point, values)
    }

    fn linearise(
        &mut self,
        point: &[f64],
        weights: Weights<'_>,
        blocks: &mut Blocks,
    ) -> Result<(), EvalError> {
        self.program().linearise(point, weights, blocks)
    }

    fn convexify(
        &mut self,
        point: &[f64],
        weights: Weights<'_>,
        blocks: &mut Blocks,
    ) -> Result<bool, EvalError> {
        self.program().convexify(point, weights, blocks)
    }

    fn add_metric(&mut self, point: &[f64], factor: f64, blocks: &mut Blocks) -> Result<(), EvalError> {
        self.program().add_metric(point, factor, blocks)
    }
}
