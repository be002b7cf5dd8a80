//! The class `ConstrainedDynamics`.

use crate::constraints::{VERBS, Verb, of_constrained};
use crate::descriptions::names;
use crate::errors::argument;
use crate::function::{Function, Settings};
use crate::methods::described;
use crate::robot::Robot;
use costate::constraints::Constraints;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::sync::OnceLock;

/// The dynamics of a robot whose loops are closed by constraints, with exact first and second derivatives.
///
/// The state is x = (q, p), all n coordinates of the open tree: g(q), k rows, stays what it is, by the
/// constrained Legendre transform p = M v - J'mu, J v = 0, with J = dg/dq and the impulses mu of the
/// constraints. Start a motion at rest with p = 0, or with p = ``momentum(q, v)`` where J v = 0. z = (q, p,
/// tau) has 3n entries, f = dx/dt has 2n. Compare v and ``multipliers`` of two motions, not p: p + J'kappa is
/// the same motion for every kappa. A robot without constraints has k = 0. With floating and spherical joints
/// q and derivatives by q are as in `Dynamics`; what does not take them raises `StateError`.
///
/// Arguments and results are those of `Dynamics`: float64 arrays with any leading batch axes. Batches run on
/// threads, without the interpreter's lock, by the generic code.
///
/// Parameters
/// ----------
/// robot : Robot
///     The robot; its constraints are ``robot.constraint_names``.
/// on_error : {"raise", "nan"}
///     As in `Dynamics`.
/// threads : int, optional
///     As in `Dynamics`.
///
/// Raises
/// ------
/// ArgumentError
///     For another value of an option.
///
/// References
/// ----------
/// J. H. Maddocks, R. L. Pego, An unconstrained Hamiltonian formulation for incompressible fluid flow,
/// Communications in Mathematical Physics 170 (1995) 207-217, for the transform.
///
/// Examples
/// --------
/// >>> import costate
/// >>> builder = costate.Robot.builder("slider", gravity=[0, -9.81, 0])
/// >>> builder = builder.revolute("crank", axis=[0, 0, 1], mass=1, com=[0.1, 0, 0])
/// >>> rod = {"on": "crank", "xyz": [0.2, 0, 0], "axis": [0, 0, 1], "mass": 1, "com": [0.3, 0, 0]}
/// >>> robot = builder.revolute("rod", **rod).frame("end", "rod", xyz=[0.6, 0, 0]).build()
/// >>> robot = robot.with_constraint("rail", "end", rows=["y"])
/// >>> dynamics = costate.ConstrainedDynamics(robot)
/// >>> q = dynamics.close([0.5, -0.5], held=["crank"])
/// >>> bool(abs(dynamics.constraint(q)).max() < 1e-12)
/// True
/// >>> force, moment = dynamics.forces(q, [0, 0], [0, 0])
/// >>> force.shape, int((force != 0).sum())
/// ((1, 3), 1)
#[pyclass(frozen, module = "costate")]
pub struct ConstrainedDynamics {
    robot: Robot,
    settings: Settings,
    rows: Vec<String>,
    functions: [OnceLock<Function>; VERBS],
}

impl ConstrainedDynamics {
    /// Calls a method.
    pub fn call<'py, const N: usize>(
        &self,
        py: Python<'py>,
        verb: Verb,
        arguments: [&Bound<'py, PyAny>; N],
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let new = || of_constrained(self.robot.shared(), verb, self.rows.len());
        self.functions[verb as usize].get_or_init(new).call(py, arguments, out, self.settings)
    }
}

#[pymethods]
impl ConstrainedDynamics {
    #[new]
    #[pyo3(signature = (robot, *, on_error = "raise", threads = None))]
    fn new(
        py: Python<'_>,
        robot: Robot,
        on_error: &str,
        threads: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let rows = Constraints::<f64>::new(robot.model());
        let rows = (0..rows.count()).map(|i| rows.name(i).to_owned()).collect();
        let settings = Settings::of(py, on_error, threads)?;
        Ok(Self { robot, settings, rows, functions: std::array::from_fn(|_| OnceLock::new()) })
    }

    /// The robot.
    #[getter]
    fn robot(&self) -> Robot {
        self.robot.clone()
    }

    /// Number of coordinates of the open tree.
    #[getter]
    fn n(&self) -> usize {
        self.robot.model().dof()
    }

    /// Number of rows of g.
    #[getter]
    fn k(&self) -> usize {
        self.rows.len()
    }

    /// For each row of g the name of its constraint.
    #[getter]
    fn row_names(&self) -> Vec<&str> {
        self.rows.iter().map(String::as_str).collect()
    }

    /// ``"raise"`` or ``"nan"``.
    #[getter]
    fn on_error(&self) -> &str {
        self.settings.on_error()
    }

    /// Most threads for a batch; None: as many as the process may use.
    #[getter]
    fn threads(&self) -> Option<usize> {
        self.settings.threads()
    }

    /// The nearest position that was found with g(q) = 0, some joints held as they are.
    ///
    /// Newton's method with the smallest steps, weighted by the diagonal of M.
    ///
    /// Parameters
    /// ----------
    #[doc = described!(q)]
    /// held : list of str, optional
    ///     Names of joints that do not move.
    #[doc = described!(one)]
    ///
    /// Returns
    /// -------
    /// ndarray (..., nq)
    ///     In rad, m; quaternions of length 1.
    ///
    /// Raises
    /// ------
    /// ConstraintError
    ///     With ``constraint`` and ``miss``: a loop that cannot be closed, or not from there, and a
    ///     constraint that contradicts those before it; unless ``on_error="nan"``.
    /// ArgumentError
    ///     For a name of no joint, and as other methods.
    /// Interrupted
    ///     As other methods.
    #[pyo3(signature = (q, held = None, *, out = None))]
    fn close<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = names)] held: Option<Vec<String>>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut mask = vec![0.0; self.n()];
        for name in held.unwrap_or_default() {
            if let Some(free) = self.robot.model().free_joints().iter().find(|free| free.name == name) {
                mask[free.coordinate..free.coordinate + free.kind.dof()].fill(1.0);
                continue;
            }
            let joints = || self.robot.model().independent_joints();
            let Some(index) = joints().position(|joint| joint.name == name) else {
                let all: Vec<&str> = joints().map(|joint| joint.name.as_str()).collect();
                let name = costate::robot::printable(&name);
                let message =
                    format!("there is no joint '{name}' to hold; the joints are {}", all.join(", "));
                return Err(argument(py, "held", message));
            };
            mask[index] = 1.0;
        }
        self.call(py, Verb::Close, [q, PyArray1::from_vec(py, mask).as_any()], out)
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.settings == other.settings && self.robot.model() == other.robot.model()
    }

    fn __hash__(&self) -> u64 {
        self.robot.__hash__().wrapping_add(1)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let (py, this) = (slf.py(), slf.get());
        let keywords = PyDict::new(py);
        keywords.set_item("on_error", this.on_error())?;
        keywords.set_item("threads", this.threads())?;
        let class = py.import("functools")?.getattr("partial")?.call((slf.get_type(),), Some(&keywords))?;
        Ok((class, (this.robot.clone(),).into_pyobject(py)?))
    }

    fn __repr__(&self) -> String {
        format!("ConstrainedDynamics({:?}, n={}, k={})", self.robot.model().name(), self.n(), self.k())
    }
}
