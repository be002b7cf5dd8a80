//! The class `Step`.

use crate::cores::{core_of, lanes_of};
use crate::dynamics::Dynamics;
use crate::engine::Engine;
use crate::errors::{CodegenError, argument};
use crate::free_steps::FreeScheme;
use crate::function::Function;
use crate::methods::verbs;
use crate::schemes::{Known, NewStep, SCHEMES, Verb, evaluate, scheme_of};
use crate::words::in_python;
use crate::xla::registered;
use costate::scalar::F64x4;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::{Arc, OnceLock};

/// One time step Phi(q, v, tau) under constant torques, with exact first and second derivatives.
///
/// The methods are those of `Dynamics`, with Phi (..., 2n), the next state, in the place of f; the costate y
/// belongs to the next state.
///
/// With floating and spherical joints Phi has nq + n entries, its quaternions of length 1. Derivatives are
/// those in the tangent spaces at both ends: J, 2n rows, is that of the difference from Phi
/// (``Robot.difference``) by (d, dv, dtau), q (+) d in the place of q, and y has 2n entries. The scheme steps
/// the quaternions as plain numbers, for "qp" with the momenta conjugate to them, and divides them by their
/// lengths; it is any but "semi_implicit_euler". For "qp" "midpoint" and "verlet" keep the linear and angular
/// momentum of a body in space to rounding and its energy without drift; all else keeps them to its order.
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
/// Raises
/// ------
/// ArgumentError
///     For another scheme, or one that needs other coordinates or takes no floating and spherical joints; for
///     a duration that is not finite.
///
/// References
/// ----------
/// E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, 2006: sections I.1, II.1 and VI.3.
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
    /// The same for a robot with floating or spherical joints.
    free: Option<FreeScheme>,
    dt: f64,
    engines: [OnceLock<Arc<Engine>>; 3],
    /// Makes steps from four states, once a batch has asked for it.
    fours: Arc<OnceLock<Option<NewStep<F64x4>>>>,
    functions: [OnceLock<Arc<Function>>; Verb::ALL.len()],
}

impl Step {
    fn call<'py, const N: usize>(
        &self,
        py: Python<'py>,
        verb: Verb,
        arguments: [&Bound<'py, PyAny>; N],
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let dynamics = self.dynamics.get();
        let function = match self.functions[verb as usize].get() {
            Some(function) => function,
            None => self.prepare(py, verb)?,
        };
        function.call(py, arguments, out, dynamics.settings())
    }

    #[cold]
    fn prepare(&self, py: Python<'_>, verb: Verb) -> PyResult<&Arc<Function>> {
        let dynamics = self.dynamics.get();
        let (space, order) = (dynamics.space(), verb.order());
        let engine = match self.engines[order as usize].get() {
            Some(engine) => engine.clone(),
            None => {
                let dt = self.dt;
                let steps = py.detach(|| self.steps(dynamics))?;
                let core = move || {
                    core_of(steps(), move |step, inputs, outputs| evaluate(step, dt, order, inputs, outputs))
                };
                let (robot, fours) = (dynamics.shared(), self.fours.clone());
                let ((_, build), free) = (self.scheme, self.free);
                let lanes = move || {
                    let new = fours.get_or_init(|| match free {
                        Some(scheme) => {
                            let robot = robot.clone();
                            Some(Box::new(move || scheme.step(&robot, space)))
                        }
                        None => build.lanes(&robot, space),
                    });
                    Some(lanes_of(new.as_ref()?(), move |step, inputs, outputs| {
                        evaluate(step, dt, order, inputs, outputs)
                    }))
                };
                let engine = Engine::new(core).with_lanes(lanes);
                self.engines[order as usize].get_or_init(|| Arc::new(engine)).clone()
            }
        };
        let sizes = [dynamics.model().nq(), dynamics.model().dof()];
        let robot = dynamics.shared();
        Ok(self.functions[verb as usize]
            .get_or_init(|| Arc::new(Function::new(verb.plan(sizes, space), engine, robot))))
    }

    /// What makes workspaces for one state.
    fn steps(&self, dynamics: &Dynamics) -> PyResult<NewStep> {
        let (robot, space) = (dynamics.shared(), dynamics.space());
        if let Some(scheme) = self.free {
            return Ok(Box::new(move || scheme.step(&robot, space)));
        }
        let steps = self.scheme.1.steps(&robot, space);
        steps.map_err(|error| CodegenError::new_err(in_python(&error.to_string())))
    }
}

#[pymethods]
impl Step {
    #[new]
    fn new(dynamics: &Bound<'_, Dynamics>, scheme: &str, dt: f64) -> PyResult<Self> {
        let py = dynamics.py();
        let known = SCHEMES[scheme_of(py, scheme, dt, dynamics.get().space())?];
        let is_free = !dynamics.get().model().free_joints().is_empty();
        let free = is_free.then(|| FreeScheme::of_name(py, scheme)).transpose()?;
        Ok(Self {
            dynamics: dynamics.clone().unbind(),
            scheme: known,
            free,
            dt,
            engines: Default::default(),
            fours: Arc::default(),
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

verbs! {
    impl Step;

    /// The next state Phi.
    f(q: q, v: state, tau: tau) -> one
        "ndarray (..., nq + n)\n    q and v after ``dt``; with ``\"qp\"`` q and p."
        = call Verb::F;

    /// The Jacobian of Phi by z = (q, v, tau).
    jacobian(q: q, v: state, tau: tau) -> one
        "ndarray (..., 2n, 3n)\n    Rows are entries of the next state."
        = call Verb::Jacobian;

    /// The second derivatives of y'Phi by z = (q, v, tau).
    hessian(q: q, v: state, tau: tau, y: next) -> one
        "ndarray (..., 3n, 3n)\n    Symmetric."
        = call Verb::Hessian;

    /// Phi and its Jacobian in one pass.
    linearise(q: q, v: state, tau: tau) -> several
        "next : ndarray (..., nq + n)\n    As `f`.\nJ : ndarray (..., 2n, 3n)\n    As `jacobian`."
        = call Verb::Linearise;

    /// Phi, its Jacobian and the second derivatives of y'Phi in one pass.
    contract(q: q, v: state, tau: tau, y: next) -> several
        "next : ndarray (..., nq + n)\n    As `f`.\nJ : ndarray (..., 2n, 3n)\n    As `jacobian`.\n\
         H : ndarray (..., 3n, 3n)\n    As `hessian`."
        = call Verb::Contract;

    /// The product y' dPhi/dz.
    adjoint(q: q, v: state, tau: tau, y: next) -> one
        "ndarray (..., 3n)\n    The derivatives of y'Phi by q, v and tau."
        = call Verb::Adjoint;

    /// The product of the second derivatives of y'Phi and a direction.
    hvp(q: q, v: state, tau: tau, y: next, d: d) -> one
        "ndarray (..., 3n)\n    ``hessian(q, v, tau, y) @ d``."
        = call Verb::Hvp;

    /// The derivative of Phi by the duration, in the tangent space at Phi.
    dt_derivative(q: q, v: state, tau: tau) -> one
        "ndarray (..., 2n)\n    dPhi/d(dt)."
        = call Verb::ByTime;
}
