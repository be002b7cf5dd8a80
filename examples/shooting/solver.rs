//! Solves a problem with one kind of second derivatives, and logs the iterations.

use crate::curvature::{Curvature, Nodes};
use crate::problem::{NotEvaluated, Problem};
use crate::program::Program;
use costate::dynamics::Cost;
use costate::step::Step;
use costate_nlp as nlp;
use costate_nlp::StagedProblem;
use nalgebra::DVector;

/// Damping of the first step, where it is asked for, its least and its largest value, and the factors after
/// a shortened step and after others.
const DAMPING: [f64; 3] = [1e-3, 1e-10, 1e2];
const CHANGE: [f64; 2] = [4.0, 0.25];

/// Steps below this length were shortened.
const WHOLE: f64 = 0.3;

/// Tolerance of the conditions of optimality.
const TOLERANCE: f64 = 1e-10;

/// Options of the solver.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    pub curvature: Curvature,
    pub iterations: usize,
    /// The barrier parameter at the start, and the one that the problem is solved for; zero: for the problem
    /// without a barrier.
    pub barrier: [f64; 2],
}

impl Options {
    pub fn new(curvature: Curvature) -> Self {
        Self { curvature, iterations: 300, barrier: [0.1, 0.0] }
    }
}

/// How a solution ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// The optimality conditions hold to the tolerance.
    Solved,
    /// No motion nearby is feasible: the largest defect where the sum of defects and violations of bounds has
    /// a local minimum.
    Infeasible { defect: f64 },
    /// No step makes progress.
    Stalled,
    /// The iteration limit was reached.
    IterationLimit,
    /// The functions or their derivatives could not be evaluated.
    NotEvaluated(NotEvaluated),
}

/// One line of the log: an iterate, and the step that led there.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub cost: f64,
    /// The largest defect, the largest component of the gradient of the Lagrangian, the largest product of a
    /// multiplier and the distance to its bound.
    pub violation: f64,
    pub dual: f64,
    pub complementarity: f64,
    pub mu: f64,
    /// Length of the step that led there; 0 if there was none.
    pub part: f64,
    /// The multiple of the identity that was added to the Hessian.
    pub added: f64,
    /// Whether it is an iterate of the program that minimises the violation.
    pub is_restoration: bool,
}

impl Row {
    fn new(iteration: &nlp::Iteration) -> Self {
        let nlp::Iteration { cost, error, mu, length, regularisation, is_restoration, .. } = *iteration;
        Self {
            cost,
            violation: error.feasibility,
            dual: error.stationarity,
            complementarity: error.complementarity,
            mu,
            part: length,
            added: regularisation,
            is_restoration,
        }
    }

    /// The largest violation of the conditions of optimality; infinite in restoration.
    pub fn error(&self) -> f64 {
        if self.is_restoration {
            return f64::INFINITY;
        }
        self.violation.max(self.dual).max(self.complementarity)
    }
}

#[cfg_attr(not(test), expect(dead_code, reason = "tests alone judge the motions"))]
pub struct Solution {
    pub status: Status,
    pub nodes: Nodes,
    /// Multipliers of the defects.
    pub costates: Nodes,
    /// Those of the bounds, node by node: positive at an upper bound, negative at a lower one.
    pub multipliers: Nodes,
    pub cost: f64,
    pub log: Vec<Row>,
}

impl Solution {
    /// Number of steps.
    pub fn iterations(&self) -> usize {
        self.log.len().saturating_sub(1)
    }
}

/// Solves from a guess of the nodes.
pub fn solve<M: Step<f64>, L: Cost<f64>, F: Cost<f64>>(
    problem: &mut Problem<M, L, F>,
    guess: &[DVector<f64>],
    options: &Options,
) -> Solution {
    let ([damping, ..], [start, least]) = (DAMPING, options.barrier);
    let mut program = Program::new(problem, options.curvature, damping);
    let settings = nlp::Settings {
        tolerance: TOLERANCE,
        feasibility: TOLERANCE,
        iterations: options.iterations,
        barrier: nlp::BarrierSettings { start, least, ..nlp::BarrierSettings::default() },
        ..nlp::Settings::default()
    };
    let mut solver = nlp::Solver::new(program.layout(), settings);
    let mut log = Vec::new();
    let ended = iterate(&mut program, &mut solver, guess, &mut log);
    let found = solver.solution();
    let nodes = program.nodes(found.point);
    let status = match ended {
        Ok(nlp::Status::Solved) => Status::Solved,
        Ok(nlp::Status::LocallyInfeasible) => Status::Infeasible { defect: program.largest_defect(&nodes) },
        Ok(nlp::Status::IterationLimit) => Status::IterationLimit,
        Ok(_) => Status::Stalled,
        Err(error) => {
            Status::NotEvaluated(program.failed.take().unwrap_or_else(|| NotEvaluated::because(error)))
        }
    };
    Solution {
        status,
        nodes,
        costates: program.costates(found.equalities),
        multipliers: program.multipliers(found.ranges),
        cost: found.cost,
        log,
    }
}

fn iterate<M: Step<f64>, L: Cost<f64>, F: Cost<f64>>(
    program: &mut Program<'_, M, L, F>,
    solver: &mut nlp::Solver,
    guess: &[DVector<f64>],
    log: &mut Vec<Row>,
) -> Result<nlp::Status, nlp::SolveError<NotEvaluated>> {
    let start = program.point(guess);
    let mut ended = solver.begin(program, nlp::Start::at(&start))?;
    loop {
        let iteration = solver.iteration();
        log.push(Row::new(&iteration));
        if let Some(status) = ended {
            return Ok(status);
        }
        if iteration.number > 0 && !iteration.is_restoration {
            let [_, least, most] = DAMPING;
            let [up, down] = CHANGE;
            let factor = if iteration.length < WHOLE { up } else { down };
            program.damping = (factor * program.damping).clamp(least, most);
        }
        ended = solver.advance(program)?;
    }
}
