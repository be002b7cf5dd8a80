//! The class `Step`.

use crate::dynamics::Dynamics;
use crate::errors::{CodegenError, argument};
use crate::function::{Engine, Function};
use crate::methods::methods;
use crate::schemes::{Known, SCHEMES, Verb, core, scheme_of};
use crate::xla::registered;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::{Arc, OnceLock};

/// One time step Phi(q, v, tau) under constant torques, with exact first and second derivatives.
///
/// The methods are those of `Dynamics`, with Phi (..., 2n), the next state, in the place of f; the costate y
/// belongs to the next state.
///
/// Parameters
/// ----------
/// dynamics : Dynamics
///     The dynamics, with their coordinates and settings.
/// scheme : {"rk4", "midpoint", "verlet", "semi_implicit_euler"}
///     The classical Runge-Kutta scheme; the implicit midpoint rule; Stoermer-Verlet, for "qp" only; v first,
///     then q with the new v, for "qv" only.
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
    functions: [OnceLock<Arc<Function>>; Verb::ALL.len()],
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
            None => self.prepare(py, verb)?,
        };
        function.call(py, arguments, dynamics.settings())
    }

    #[cold]
    fn prepare(&self, py: Python<'_>, verb: Verb) -> PyResult<&Arc<Function>> {
        let dynamics = self.dynamics.get();
        let (n, space, order) = (dynamics.model().dof(), dynamics.space(), verb.order());
        let engine = match self.engines[order as usize].get() {
            Some(engine) => engine.clone(),
            None => {
                let ((_, build), dt) = (self.scheme, self.dt);
                let steps = py.detach(|| build.steps(dynamics.model(), space));
                let steps = steps.map_err(|error| CodegenError::new_err(error.to_string()))?;
                let engine = Engine::new(move || core(steps(), dt, order, n));
                self.engines[order as usize].get_or_init(|| Arc::new(engine)).clone()
            }
        };
        let robot = dynamics.shared();
        Ok(self.functions[verb as usize].get_or_init(|| Arc::new(Function::new(verb.plan(n), engine, robot))))
    }
}

methods! {
    impl Step {
        #[new]
        fn new(dynamics: &Bound<'_, Dynamics>, scheme: &str, dt: f64) -> PyResult<Self> {
            let known = SCHEMES[scheme_of(dynamics.py(), scheme, dt, dynamics.get().space())?];
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

        /// The number by which XLA calls a method; for `costate.jax`.
        fn _xla(&self, py: Python<'_>, verb: &str) -> PyResult<i64> {
            let found = Verb::ALL.into_iter().find(|known| known.name() == verb);
            let found = found.ok_or_else(|| argument(py, "verb", format!("no method '{verb}'")))?;
            let function = match self.functions[found as usize].get() {
                Some(function) => function,
                None => self.prepare(py, found)?,
            };
            Ok(registered(function, self.dynamics.get().settings()))
        }

        fn __eq__(&self, py: Python<'_>, other: &Self) -> PyResult<bool> {
            let same = self.dynamics.bind(py).eq(&other.dynamics)?;
            Ok(same && self.scheme.0 == other.scheme.0 && self.dt == other.dt)
        }

        fn __hash__(&self) -> u64 {
            (self.dt + 0.0).to_bits() // equal durations: -0 + 0 is 0
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

    /// The next state Phi (..., 2n).
    f(q, v, tau) = call Verb::F;

    /// The Jacobian of Phi in z = (q, v, tau): (..., 2n, 3n).
    jacobian(q, v, tau) = call Verb::Jacobian;

    /// The second derivatives of y'Phi in z (..., 3n, 3n), y (..., 2n) the costate of the next state.
    hessian(q, v, tau, y) = call Verb::Hessian;

    /// What `f` and `jacobian` return, in one pass.
    linearise(q, v, tau) = call Verb::Linearise;

    /// What `f`, `jacobian` and `hessian` return, in one pass.
    contract(q, v, tau, y) = call Verb::Contract;

    /// The product y' dPhi/dz (..., 3n).
    adjoint(q, v, tau, y) = call Verb::Adjoint;

    /// The product of `hessian` and a direction d (..., 3n): (..., 3n).
    hvp(q, v, tau, y, d) = call Verb::Hvp;

    /// The derivative of Phi by the duration dt (..., 2n).
    dt_derivative(q, v, tau) = call Verb::ByTime;
}
