//! The schemes of time steps: what their cores compute, and the plans of their arrays.

use crate::cores::{Order, Writer};
use crate::errors::{Failure, argument};
use crate::plan::{Piece, Plan, PlanBuilder};
use costate::codegen::CodegenError;
use costate::robot::Robot;
use costate::scalar::{F64x4, Scalar};
use costate::step::{
    FreeStep, ImplicitMidpoint, RungeKutta4, SemiImplicitEuler, Step as Scheme, StepContraction, StepError,
    StepLinearisation, StoermerVerlet,
};
use costate::{Coordinates, EvalError};
use costate_jit::{JitLanesModel, JitModel, JitVelocityModel};
use pyo3::prelude::*;

/// A step of any scheme, whose states are plain numbers.
pub type Plain<S> = Box<dyn Scheme<S, Error = StepError<EvalError>> + Send>;

/// A step of any scheme, from one state or from four.
pub enum AnyStep<S: Scalar = f64> {
    Plain(Plain<S>),
    /// Of a robot with floating or spherical joints.
    Free(Box<FreeStep<S, Plain<S>>>),
}

type Outcome<T> = Result<T, StepError<EvalError>>;

impl<S: Scalar> AnyStep<S> {
    fn sizes(&self) -> [usize; 2] {
        match self {
            Self::Plain(step) => [step.states(), step.controls()],
            Self::Free(step) => [step.nq() + step.dof(), step.dof()],
        }
    }

    fn evaluate(&mut self, x: &[S], tau: &[S], dt: S) -> Outcome<&[S]> {
        match self {
            Self::Plain(step) => step.evaluate(x, tau, dt),
            Self::Free(step) => step.evaluate(x, tau, dt),
        }
    }

    fn linearise(&mut self, x: &[S], tau: &[S], dt: S) -> Outcome<StepLinearisation<'_, S>> {
        match self {
            Self::Plain(step) => step.linearise(x, tau, dt),
            Self::Free(step) => step.linearise(x, tau, dt),
        }
    }

    fn contract(&mut self, x: &[S], tau: &[S], dt: S, y: &[S]) -> Outcome<StepContraction<'_, S>> {
        match self {
            Self::Plain(step) => step.contract(x, tau, dt, y),
            Self::Free(step) => step.contract(x, tau, dt, y),
        }
    }
}

/// How a scheme is built for one state and for four, by the coordinates that it needs.
#[derive(Clone, Copy)]
pub enum Build {
    Any(fn(JitModel) -> AnyStep, fn(JitLanesModel) -> AnyStep<F64x4>),
    Momenta(fn(JitModel) -> AnyStep, fn(JitLanesModel) -> AnyStep<F64x4>),
    Velocities(fn(JitVelocityModel) -> AnyStep, fn(JitVelocityModel<JitLanesModel>) -> AnyStep<F64x4>),
}

/// The name of a scheme, and how it is built.
pub type Known = (&'static str, Build);

/// A scheme by its name, the kind of its model and its type.
macro_rules! scheme {
    ($name:literal, $kind:ident, $scheme:ident) => {
        (
            $name,
            Build::$kind(
                |model| AnyStep::Plain(Box::new($scheme::new(model))),
                |model| AnyStep::Plain(Box::new($scheme::new(model))),
            ),
        )
    };
}

/// All schemes.
pub const SCHEMES: [Known; 4] = [
    scheme!("rk4", Any, RungeKutta4),
    scheme!("midpoint", Any, ImplicitMidpoint),
    scheme!("verlet", Momenta, StoermerVerlet),
    scheme!("semi_implicit_euler", Velocities, SemiImplicitEuler),
];

/// Makes steps for another thread.
pub type NewStep<S = f64> = Box<dyn Fn() -> AnyStep<S> + Send + Sync>;

impl Build {
    /// The coordinates that it needs.
    pub fn needs(self) -> Option<Coordinates> {
        match self {
            Self::Any(..) => None,
            Self::Momenta(..) => Some(Coordinates::Hamiltonian),
            Self::Velocities(..) => Some(Coordinates::Lagrangian),
        }
    }

    /// Compiles the model; the workspaces that compute steps of it are made by what is returned.
    ///
    /// # Errors
    /// As [`JitModel::new`].
    pub fn steps(self, robot: &Robot, coordinates: Coordinates) -> Result<NewStep, CodegenError> {
        Ok(match self {
            Self::Any(build, _) | Self::Momenta(build, _) => {
                let model = JitModel::new(robot, coordinates)?;
                Box::new(move || build(model.clone()))
            }
            Self::Velocities(build, _) => {
                let model = JitVelocityModel::new(robot)?;
                Box::new(move || build(model.clone()))
            }
        })
    }

    /// The same for four states at once; none where there is no machine code for four.
    pub fn lanes(self, robot: &Robot, coordinates: Coordinates) -> Option<NewStep<F64x4>> {
        Some(match self {
            Self::Any(_, build) | Self::Momenta(_, build) => {
                let model = JitModel::over_lanes(robot, coordinates).ok()?.ok()?;
                Box::new(move || build(model.clone()))
            }
            Self::Velocities(_, build) => {
                let model = JitVelocityModel::over_lanes(robot).ok()?.ok()?;
                Box::new(move || build(model.clone()))
            }
        })
    }
}

/// The number of a scheme in [`SCHEMES`], for steps of this duration in these coordinates.
///
/// # Errors
/// `ArgumentError` for an unknown scheme, one that needs other coordinates, and a duration that is not
/// finite.
pub fn scheme_of(py: Python<'_>, scheme: &str, dt: f64, coordinates: Coordinates) -> PyResult<usize> {
    let found = SCHEMES.iter().position(|(name, ..)| *name == scheme).ok_or_else(|| {
        let names = SCHEMES.map(|(name, ..)| format!("'{name}'")).join(", ");
        argument(py, "scheme", format!("unknown scheme '{scheme}'; give one of {names}"))
    })?;
    let (name, build) = SCHEMES[found];
    if let Some(needed) = build.needs()
        && needed != coordinates
    {
        let needed = if needed == Coordinates::Lagrangian { "qv" } else { "qp" };
        let message = format!("the scheme '{name}' needs Dynamics(robot, \"{needed}\")");
        return Err(argument(py, "scheme", message));
    }
    if !dt.is_finite() {
        return Err(argument(py, "dt", format!("dt is {dt}; it must be finite")));
    }
    Ok(found)
}

/// The methods of `Step`.
#[derive(Clone, Copy)]
pub enum Verb {
    F,
    Jacobian,
    Hessian,
    Linearise,
    Contract,
    Adjoint,
    Hvp,
    ByTime,
}

impl Verb {
    pub const ALL: [Self; 8] = [
        Self::F,
        Self::Jacobian,
        Self::Hessian,
        Self::Linearise,
        Self::Contract,
        Self::Adjoint,
        Self::Hvp,
        Self::ByTime,
    ];

    /// The name of the method.
    pub fn name(self) -> &'static str {
        match self {
            Self::F => "f",
            Self::Jacobian => "jacobian",
            Self::Hessian => "hessian",
            Self::Linearise => "linearise",
            Self::Contract => "contract",
            Self::Adjoint => "adjoint",
            Self::Hvp => "hvp",
            Self::ByTime => "dt_derivative",
        }
    }

    /// What its core computes.
    pub fn order(self) -> Order {
        match self {
            Self::F => Order::Value,
            Self::Jacobian | Self::Linearise | Self::Adjoint | Self::ByTime => Order::First,
            Self::Hessian | Self::Contract | Self::Hvp => Order::Second,
        }
    }

    /// Arguments and results for nq positions and n coordinates; the results of the core are the next state,
    /// its derivative by dt, J and H.
    pub fn plan(self, [nq, n]: [usize; 2], coordinates: Coordinates) -> Plan {
        let mut plan = PlanBuilder::new(5 * n);
        plan.positions([nq, n]);
        plan.core(if coordinates == Coordinates::Hamiltonian { "p" } else { "v" }, n);
        plan.core("tau", n);
        let (jacobian, hessian) = (6 * n * n, 9 * n * n);
        let mut y = 0;
        if self.order() == Order::Second {
            y = plan.core("y", 2 * n);
        }
        if let Self::Adjoint = self {
            [y] = plan.split("y", [(2 * n, false)]);
        }
        let d = if let Self::Hvp = self { plan.split("d", [(3 * n, false)])[0] } else { 0 };
        let plan = plan.results(match self.order() {
            Order::Value => nq + n,
            Order::First => nq + 3 * n + jacobian,
            Order::Second => nq + 3 * n + jacobian + hessian,
        });
        let next = plan.core_outputs.start;
        let by_time = next + nq + n;
        let (j, h) = (by_time + 2 * n, by_time + 2 * n + jacobian);
        let value = |plan: Plan| plan.output(&[nq + n], vec![Piece::copy(0, next, nq + n)]);
        let first = |plan: Plan| plan.output(&[2 * n, 3 * n], vec![Piece::copy(0, j, jacobian)]);
        let second = |plan: Plan| plan.output(&[3 * n, 3 * n], vec![Piece::copy(0, h, hessian)]);
        match self {
            Self::F => value(plan),
            Self::Jacobian => first(plan),
            Self::Hessian => second(plan),
            Self::Linearise => first(value(plan)),
            Self::Contract => second(first(value(plan))),
            Self::ByTime => plan.output(&[2 * n], vec![Piece::copy(0, by_time, 2 * n)]),
            Self::Adjoint => {
                let of = |k| Piece::Product { to: k, a: (y, 1), b: (j + k, 3 * n), length: 2 * n };
                plan.output(&[3 * n], (0..3 * n).map(of).collect())
            }
            Self::Hvp => {
                let of = |k| Piece::Product { to: k, a: (h + 3 * n * k, 1), b: (d, 1), length: 3 * n };
                plan.output(&[3 * n], (0..3 * n).map(of).collect())
            }
        }
    }
}

/// What a step computes: the next state, its derivative by dt, J and H, as far as the order says.
pub fn evaluate<S: Scalar>(
    step: &mut AnyStep<S>,
    dt: f64,
    order: Order,
    inputs: &[S],
    outputs: &mut [S],
) -> Result<(), Failure> {
    let [states, controls] = step.sizes();
    let (x, rest) = inputs.split_at(states);
    let (tau, y) = rest.split_at(controls);
    let (writer, dt) = (&mut Writer(outputs), S::from_f64(dt));
    match order {
        Order::Value => {
            writer.put(step.evaluate(x, tau, dt)?);
        }
        Order::First => put_first(writer, step.linearise(x, tau, dt)?),
        Order::Second => {
            let second = step.contract(x, tau, dt, y)?;
            put_first(writer, second.first);
            second.hessian(writer.0);
        }
    }
    Ok(())
}

fn put_first<S: Scalar>(writer: &mut Writer<'_, S>, first: StepLinearisation<'_, S>) {
    writer.put(first.next).put(first.phi_h);
    let (jacobian, rest) = std::mem::take(&mut writer.0)
        .split_at_mut(first.phi_x.rows() * (first.phi_x.columns() + first.phi_u.columns()));
    first.jacobian(jacobian);
    writer.0 = rest;
}
