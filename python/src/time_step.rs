//! The class `Step`.

use crate::cores::{Core, Writer, core_of};
use crate::dynamics::Dynamics;
use crate::errors::{CodegenError, argument};
use crate::function::{Engine, Function};
use crate::plan::{Piece, Plan, PlanBuilder};
use costate::matrix::Block;
use costate::step::{
    ImplicitMidpoint, RungeKutta4, SemiImplicitEuler, Step as Scheme, StepError, StepLinearisation,
    StoermerVerlet,
};
use costate::{Coordinates, EvalError};
use costate_jit::JitModel;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::{Arc, OnceLock};

/// A step of any scheme.
type AnyStep = Box<dyn Scheme<f64, Error = StepError<EvalError>> + Send>;

/// The name of a scheme, how it is built, and the coordinates that it needs.
type Known = (&'static str, fn(JitModel) -> AnyStep, Option<Coordinates>);

const SCHEMES: [Known; 4] = [
    ("rk4", |model| Box::new(RungeKutta4::new(model)), None),
    ("midpoint", |model| Box::new(ImplicitMidpoint::new(model)), None),
    ("verlet", |model| Box::new(StoermerVerlet::new(model)), Some(Coordinates::Hamiltonian)),
    ("semi_implicit_euler", |model| Box::new(SemiImplicitEuler::new(model)), Some(Coordinates::Lagrangian)),
];

/// What a core computes: the next state; its Jacobian and its derivative by dt too; its contracted Hessian too.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Order {
    Value,
    First,
    Second,
}

#[derive(Clone, Copy)]
enum Verb {
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
const VERBS: usize = 8;

impl Verb {
    fn order(self) -> Order {
        match self {
            Self::F => Order::Value,
            Self::Jacobian | Self::Linearise | Self::Adjoint | Self::ByTime => Order::First,
            Self::Hessian | Self::Contract | Self::Hvp => Order::Second,
        }
    }

    /// Arguments and results for n joints; the results of the core are the next state, its derivative by dt, J
    /// and H.
    fn plan(self, rate: &'static str, n: usize) -> Plan {
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

/// A workspace that computes one step.
fn core(build: fn(JitModel) -> AnyStep, model: JitModel, dt: f64, order: Order, n: usize) -> Box<dyn Core> {
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
                put_symmetric(writer.0, [Some(second.xx), second.ux, second.uu], n);
            }
        }
        Ok(())
    })
}

fn put_first(writer: &mut Writer<'_>, first: StepLinearisation<'_, f64>) {
    writer.put(first.next).put(first.phi_h);
    for (in_x, in_u) in first.phi_x.iter_rows().zip(first.phi_u.iter_rows()) {
        writer.put(in_x).put(in_u);
    }
}

/// `[ xx  ux' ; ux  uu ]`, 3n x 3n; ux is zero in the states beyond its columns.
fn put_symmetric(whole: &mut [f64], [xx, ux, uu]: [Option<Block<'_, f64>>; 3], n: usize) {
    whole.fill(0.0);
    for (block, [top, left]) in [(xx, [0, 0]), (ux, [2 * n, 0]), (uu, [2 * n, 2 * n])] {
        for (i, row) in block.iter().flat_map(|block| block.iter_rows()).enumerate() {
            for (j, &entry) in row.iter().enumerate() {
                whole[(top + i) * 3 * n + left + j] = entry;
                if top != left {
                    whole[(left + j) * 3 * n + top + i] = entry;
                }
            }
        }
    }
}

/// One time step Phi(q, v, tau) under constant torques, with exact first and second derivatives.
///
/// The methods are those of `Dynamics`, with Phi (..., 2n), the next state, in the place of f; the costate y belongs
/// to the next state.
///
/// Parameters
/// ----------
/// dynamics : Dynamics
///     The dynamics, with their coordinates and settings.
/// scheme : {"rk4", "midpoint", "verlet", "semi_implicit_euler"}
///     The classical Runge-Kutta scheme; the implicit midpoint rule; Stoermer-Verlet, for "qp" only; v first, then q
///     with the new v, for "qv" only.
/// dt : float
///     Duration (s).
///
/// Examples
/// --------
/// >>> import costate
/// >>> robot = costate.Robot.builder("cart").prismatic("rail", axis=[1, 0, 0], mass=2).build()
/// >>> step = costate.Step(costate.Dynamics(robot), "rk4", 0.5)
/// >>> step.f([0.0], [1.0], [4.0]).round(12).tolist()  # 0.5 s at 2 m/s^2
/// [0.75, 2.0]
#[pyclass(frozen, module = "costate")]
pub struct Step {
    dynamics: Py<Dynamics>,
    scheme: Known,
    dt: f64,
    engines: [OnceLock<Arc<Engine>>; 3],
    functions: [OnceLock<Function>; VERBS],
}

impl Step {
    fn call<'py, const N: usize>(
        &self,
        py: Python<'py>,
        verb: Verb,
        arguments: [&Bound<'py, PyAny>; N],
    ) -> PyResult<Bound<'py, PyAny>> {
        let dynamics = self.dynamics.get();
        let function = match self.functions[verb as usize].get() {
            Some(function) => function,
            None => self.prepare(verb)?,
        };
        function.call(py, arguments, dynamics.settings())
    }

    #[cold]
    fn prepare(&self, verb: Verb) -> PyResult<&Function> {
        let dynamics = self.dynamics.get();
        let (n, space, order) = (dynamics.model().dof(), dynamics.space(), verb.order());
        let engine = match self.engines[order as usize].get() {
            Some(engine) => engine.clone(),
            None => {
                let model = JitModel::new(dynamics.model(), space);
                let model = model.map_err(|error| CodegenError::new_err(error.to_string()))?;
                let ((_, build, _), dt) = (self.scheme, self.dt);
                let engine = Engine::new(move || core(build, model.clone(), dt, order, n));
                self.engines[order as usize].get_or_init(|| Arc::new(engine)).clone()
            }
        };
        let rate = if space == Coordinates::Lagrangian { "v" } else { "p" };
        Ok(self.functions[verb as usize].get_or_init(|| Function::new(verb.plan(rate, n), engine)))
    }
}

/// A NumPy array, or a tuple of arrays.
type Arrays<'py> = PyResult<Bound<'py, PyAny>>;
/// An argument: an array or a sequence of numbers.
type Given<'a, 'py> = &'a Bound<'py, PyAny>;

#[pymethods]
impl Step {
    #[new]
    fn new(dynamics: &Bound<'_, Dynamics>, scheme: &str, dt: f64) -> PyResult<Self> {
        let py = dynamics.py();
        let known = SCHEMES.into_iter().find(|(name, ..)| *name == scheme).ok_or_else(|| {
            let names = SCHEMES.map(|(name, ..)| format!("'{name}'")).join(", ");
            argument(py, "scheme", format!("unknown scheme '{scheme}'; give one of {names}"))
        })?;
        let letters = dynamics.get().space();
        if let (name, _, Some(needed)) = known
            && needed != letters
        {
            let needed = if needed == Coordinates::Lagrangian { "qv" } else { "qp" };
            let message = format!("the scheme '{name}' needs Dynamics(robot, \"{needed}\")");
            return Err(argument(py, "scheme", message));
        }
        if !dt.is_finite() {
            return Err(argument(py, "dt", format!("dt is {dt}; it must be finite")));
        }
        Ok(Self {
            dynamics: dynamics.clone().unbind(),
            scheme: known,
            dt,
            engines: Default::default(),
            functions: Default::default(),
        })
    }

    /// The dynamics.
    #[getter]
    fn dynamics(&self, py: Python<'_>) -> Py<Dynamics> {
        self.dynamics.clone_ref(py)
    }

    /// The name of the scheme.
    #[getter]
    fn scheme(&self) -> &str {
        self.scheme.0
    }

    /// Duration (s).
    #[getter]
    fn dt(&self) -> f64 {
        self.dt
    }

    /// The next state Phi (..., 2n).
    fn f<'py>(
        &self,
        py: Python<'py>,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        tau: Given<'_, 'py>,
    ) -> Arrays<'py> {
        self.call(py, Verb::F, [q, v, tau])
    }

    /// The Jacobian of Phi in z = (q, v, tau): (..., 2n, 3n).
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        tau: Given<'_, 'py>,
    ) -> Arrays<'py> {
        self.call(py, Verb::Jacobian, [q, v, tau])
    }

    /// The second derivatives of y'Phi in z (..., 3n, 3n), y (..., 2n) the costate of the next state.
    fn hessian<'py>(
        &self,
        py: Python<'py>,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        tau: Given<'_, 'py>,
        y: Given<'_, 'py>,
    ) -> Arrays<'py> {
        self.call(py, Verb::Hessian, [q, v, tau, y])
    }

    /// What `f` and `jacobian` return, in one pass.
    fn linearise<'py>(
        &self,
        py: Python<'py>,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        tau: Given<'_, 'py>,
    ) -> Arrays<'py> {
        self.call(py, Verb::Linearise, [q, v, tau])
    }

    /// What `f`, `jacobian` and `hessian` return, in one pass.
    fn contract<'py>(
        &self,
        py: Python<'py>,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        tau: Given<'_, 'py>,
        y: Given<'_, 'py>,
    ) -> Arrays<'py> {
        self.call(py, Verb::Contract, [q, v, tau, y])
    }

    /// The product y' dPhi/dz (..., 3n).
    fn adjoint<'py>(
        &self,
        py: Python<'py>,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        tau: Given<'_, 'py>,
        y: Given<'_, 'py>,
    ) -> Arrays<'py> {
        self.call(py, Verb::Adjoint, [q, v, tau, y])
    }

    /// The product of `hessian` and a direction d (..., 3n): (..., 3n).
    fn hvp<'py>(
        &self,
        py: Python<'py>,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        tau: Given<'_, 'py>,
        y: Given<'_, 'py>,
        d: Given<'_, 'py>,
    ) -> Arrays<'py> {
        self.call(py, Verb::Hvp, [q, v, tau, y, d])
    }

    /// The derivative of Phi by the duration dt (..., 2n).
    fn dt_derivative<'py>(
        &self,
        py: Python<'py>,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        tau: Given<'_, 'py>,
    ) -> Arrays<'py> {
        self.call(py, Verb::ByTime, [q, v, tau])
    }

    fn __eq__(&self, py: Python<'_>, other: &Self) -> PyResult<bool> {
        let same = self.dynamics.bind(py).eq(&other.dynamics)?;
        Ok(same && self.scheme.0 == other.scheme.0 && self.dt == other.dt)
    }

    fn __hash__(&self) -> u64 {
        self.dt.to_bits()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let (py, this) = (slf.py(), slf.get());
        let arguments = (this.dynamics.clone_ref(py), this.scheme.0, this.dt);
        Ok((slf.get_type().into_any(), arguments.into_pyobject(py)?))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let dynamics = self.dynamics.bind(py).repr()?;
        Ok(format!("Step({dynamics}, {:?}, dt={})", self.scheme.0, self.dt))
    }
}
