//! The schemes of time steps: what their cores compute, and the plans of their arrays.

use crate::cores::{Core, Order, Writer, core_of};
use crate::errors::argument;
use crate::plan::{Piece, Plan, PlanBuilder};
use costate::step::{
    ImplicitMidpoint, RungeKutta4, SemiImplicitEuler, Step as Scheme, StepError, StepLinearisation,
    StoermerVerlet,
};
use costate::{Coordinates, EvalError};
use costate_jit::JitModel;
use pyo3::prelude::*;

/// A step of any scheme.
pub type AnyStep = Box<dyn Scheme<f64, Error = StepError<EvalError>> + Send>;

/// The name of a scheme, how it is built, and the coordinates that it needs.
pub type Known = (&'static str, fn(JitModel) -> AnyStep, Option<Coordinates>);

/// All schemes.
pub const SCHEMES: [Known; 4] = [
    ("rk4", |model| Box::new(RungeKutta4::new(model)), None),
    ("midpoint", |model| Box::new(ImplicitMidpoint::new(model)), None),
    ("verlet", |model| Box::new(StoermerVerlet::new(model)), Some(Coordinates::Hamiltonian)),
    ("semi_implicit_euler", |model| Box::new(SemiImplicitEuler::new(model)), Some(Coordinates::Lagrangian)),
];

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
    if let (name, _, Some(needed)) = SCHEMES[found]
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

/// Number of verbs.
pub const VERBS: usize = 8;

impl Verb {
    /// What its core computes.
    pub fn order(self) -> Order {
        match self {
            Self::F => Order::Value,
            Self::Jacobian | Self::Linearise | Self::Adjoint | Self::ByTime => Order::First,
            Self::Hessian | Self::Contract | Self::Hvp => Order::Second,
        }
    }

    /// Arguments and results for n joints; the results of the core are the next state, its derivative by dt,
    /// J and H.
    pub fn plan(self, rate: &'static str, n: usize) -> Plan {
        let mut plan = PlanBuilder::new(5 * n);
        plan.core("q", n);
        plan.core(rate, n);
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
            Order::Value => 2 * n,
            Order::First => 4 * n + jacobian,
            Order::Second => 4 * n + jacobian + hessian,
        });
        let next = plan.core_outputs.start;
        let (by_time, j, h) = (next + 2 * n, next + 4 * n, next + 4 * n + jacobian);
        let value = |plan: Plan| plan.output(&[2 * n], vec![Piece::copy(0, next, 2 * n)]);
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

/// A workspace that computes one step: the next state; with its derivative by dt and its Jacobian; with its
/// contracted Hessian too.
pub fn core(
    build: fn(JitModel) -> AnyStep,
    model: JitModel,
    dt: f64,
    order: Order,
    n: usize,
) -> Box<dyn Core> {
    core_of(build(model), move |step, inputs, outputs| {
        let (x, rest) = inputs.split_at(2 * n);
        let (tau, y) = rest.split_at(n);
        let writer = &mut Writer(outputs);
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
    })
}

fn put_first(writer: &mut Writer<'_>, first: StepLinearisation<'_, f64>) {
    writer.put(first.next).put(first.phi_h);
    let (jacobian, rest) = std::mem::take(&mut writer.0)
        .split_at_mut(first.next.len() * (first.phi_x.columns() + first.phi_u.columns()));
    first.jacobian(jacobian);
    writer.0 = rest;
}
