//! One time step as a program.

use crate::Coordinates;
use crate::codegen::error::CodegenError;
use crate::codegen::names::name_from;
use crate::codegen::program::Program;
use crate::codegen::program_ends::RecordedResult;
use crate::codegen::record::Expr;
use crate::codegen::robot::ProgramOptions;
use crate::error::EvalError;
use crate::hamiltonian::HamiltonianSecondOrder;
use crate::lagrangian::LagrangianSecondOrder;
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;
use crate::step::{RungeKutta4, SemiImplicitEuler, Step, StepError};

/// An explicit time step of a duration, and the coordinates of its state.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum StepSpec {
    /// The classical Runge-Kutta scheme.
    RungeKutta4 {
        /// Duration (s).
        dt: f64,
        /// The state.
        coordinates: Coordinates,
    },
    /// Velocities first, then positions with the new velocities; x = (q, v).
    SemiImplicitEuler {
        /// Duration (s).
        dt: f64,
    },
}

/// What is computed of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepOrder {
    /// The next state.
    Value,
    /// Its Jacobian in (x, u) too.
    First,
    /// Its Hessian in (x, u), contracted with y, too.
    Second,
}

impl StepOrder {
    fn name(self) -> &'static str {
        match self {
            Self::Value => "step",
            Self::First => "step_z",
            Self::Second => "y_step_zz",
        }
    }
}

/// The results of a step, row by row; those above its order are empty.
#[derive(Default)]
pub(super) struct RecordedStep {
    pub next: Vec<Expr>,
    /// 2n x 3n.
    pub jacobian: Vec<Expr>,
    /// 3n x 3n.
    pub hessian: Vec<Expr>,
}

/// Evaluates a step at (x, u), with weights y for the second order.
pub(super) fn record_step(
    robot: &Robot,
    step: StepSpec,
    order: StepOrder,
    arguments: [&[Expr]; 3],
) -> Result<RecordedStep, CodegenError> {
    let tree = Tree::from(robot);
    let recorded = match step {
        StepSpec::RungeKutta4 { dt, coordinates: Coordinates::Lagrangian } => {
            evaluate(RungeKutta4::new(LagrangianSecondOrder::from_tree(tree)), dt, order, arguments)
        }
        StepSpec::RungeKutta4 { dt, coordinates: Coordinates::Hamiltonian } => {
            evaluate(RungeKutta4::new(HamiltonianSecondOrder::from_tree(tree)), dt, order, arguments)
        }
        StepSpec::SemiImplicitEuler { dt } => {
            evaluate(SemiImplicitEuler::new(LagrangianSecondOrder::from_tree(tree)), dt, order, arguments)
        }
    };
    recorded.map_err(|error| match error {
        StepError::Dynamics(error) => error.into(),
        other => EvalError::Model { reason: other.to_string() }.into(),
    })
}

fn evaluate(
    mut step: impl Step<Expr, Error = StepError<EvalError>>,
    dt: f64,
    order: StepOrder,
    [x, u, y]: [&[Expr]; 3],
) -> Result<RecordedStep, StepError<EvalError>> {
    let (dt, all, n) = (Expr::from_f64(dt), [x.len(), u.len()], x.len() + u.len());
    let mut recorded = RecordedStep::default();
    match order {
        StepOrder::Value => recorded.next.extend(step.evaluate(x, u, dt)?),
        StepOrder::First => {
            let first = step.linearise(x, u, dt)?;
            recorded.next.extend(first.next);
            recorded.jacobian.resize(all[0] * n, Expr::zero());
            first.jacobian(&mut recorded.jacobian);
        }
        StepOrder::Second => {
            let second = step.contract(x, u, dt, y)?;
            recorded.next.extend(second.first.next);
            recorded.jacobian.resize(all[0] * n, Expr::zero());
            second.first.jacobian(&mut recorded.jacobian);
            recorded.hessian.resize(n * n, Expr::zero());
            second.hessian(&mut recorded.hessian);
        }
    }
    Ok(recorded)
}

/// Records one time step `x_next = Phi(x, u)`: arguments x (2n), u (n) and for the second order y (2n),
/// results `next` (2n), `next_z` (2n x 3n) and `y_next_zz` (3n x 3n), z = (x, u); only the last of them with
/// [`ProgramOptions::only`].
///
/// # Errors
/// [`CodegenError::LongRecording`] and [`CodegenError::TooLarge`] where the program has more steps than
/// [`ProgramOptions::limit`].
pub fn step_program(
    robot: &Robot,
    step: StepSpec,
    order: StepOrder,
    options: &ProgramOptions,
) -> Result<Program, CodegenError> {
    let n = robot.dof();
    let (scheme, dt, coordinates) = match step {
        StepSpec::RungeKutta4 { dt, coordinates } => ("the classical Runge-Kutta scheme", dt, coordinates),
        StepSpec::SemiImplicitEuler { dt } => ("semi-implicit Euler", dt, Coordinates::Lagrangian),
    };
    let name = name_from(&format!("{} {} {}", robot.name(), coordinates.name(), order.name()));
    let sizes = [("x", 2 * n), ("u", n), ("y", 2 * n)];
    let sizes = if order == StepOrder::Second { &sizes[..] } else { &sizes[..2] };
    let program = Program::try_record_within(&name, sizes, options.limit, |given| {
        let y = given.get(2).map_or(&[][..], Vec::as_slice);
        let all = record_step(robot, step, order, [&given[0], &given[1], y])?;
        let mut results = vec![RecordedResult::vector("next", all.next)];
        if order != StepOrder::Value {
            results.push(RecordedResult::matrix("next_z", 2 * n, 3 * n, all.jacobian));
        }
        if order == StepOrder::Second {
            results.push(RecordedResult::matrix("y_next_zz", 3 * n, 3 * n, all.hessian));
        }
        if options.only {
            results.drain(..results.len() - 1);
        }
        Ok(results)
    })?;
    let notes = vec![
        format!("{}: a step of {dt} s by {scheme}, in {} coordinates.", robot.name(), coordinates.name()),
        "The mass matrix must be regular: results are not finite otherwise, and nothing is checked.".into(),
    ];
    Ok(program.with_notes(notes).with_meanings(&[
        ("x", "state"),
        ("u", "actuation (N m, N), constant during the step"),
        ("y", "costate of the next state"),
        ("next", "state after the step"),
        ("next_z", "its derivative, columns in the order z = (x, u)"),
        ("y_next_zz", "sum over k of y_k d2next_k/dz dz, symmetric"),
    ]))
}
