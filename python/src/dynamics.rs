//! The class `Dynamics`.

use crate::errors::argument;
use crate::function::{Function, Settings};
use crate::kinematics::{BODY_VERBS, BodyVerb, of_robot};
use crate::quantities::Verb;
use crate::robot::Robot;
use crate::shared_engines::{Computed, Known, SharedEngines};
use costate::Coordinates;
use costate::robot;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::sync::{Arc, OnceLock};

/// The dynamics of a robot, with exact first and second derivatives.
///
/// With ``coordinates="qv"`` the state is x = (q, v), with ``"qp"`` it is x = (q, p), p = M v the conjugate
/// momenta, and ``v`` below stands for p; errors call its entries p. Older words for the two are
/// ``"lagrangian"`` and ``"hamiltonian"``. z = (q, v, tau) has 3n entries, f = dx/dt has 2n. All arguments
/// are float64 arrays (or sequences of numbers) with up to eight leading batch axes, which are broadcast;
/// they are not copied. Results are new arrays or, with ``out=``, arrays of the caller: large batches then
/// need no new memory, whose pages the system would clear first. Batches run over lanes of four states, most
/// of them on machine code, and on threads, without the interpreter's lock. Do not write to arguments, or
/// read results, while another thread computes with them. Numbers of equations are those of the reference.
///
/// With floating and spherical joints q has ``robot.nq`` entries, and f = (v, a) or (v, dp/dt) is the rate in
/// the tangent space: derivatives by q, n columns or rows, are those by d at d = 0, q (+) d in the place of q
/// (see ``Robot.integrate``). p is conjugate to v: the momentum of a floating joint is that of all that it
/// carries, about the origin of the moved frame, in its axes. Hessians are symmetric; energy, momenta and
/// frames are those of the same motion.
///
/// Parameters
/// ----------
/// robot : Robot
///     The robot; the order of q, v, tau is that of ``robot.joint_names``.
/// coordinates : {"qv", "qp"}
///     The state.
/// on_error : {"raise", "nan"}
///     What happens at a state of which any number of any argument or result is not finite, or at which the
///     mass matrix is singular: a `StateError` with the batch index (`NonFiniteState`, `NonFiniteResult`,
///     `SingularMassMatrix`), or results that are not-a-number with a `StateWarning`. All other states are
///     computed. A quaternion whose length is not 1 is such a state too (`NonUnitQuaternion`).
/// threads : int, optional
///     Most threads for a batch, from 1 to 4096; as many as the process may use unless given.
///
/// Raises
/// ------
/// ArgumentError
///     For another value of an option.
/// RobotError
///     For a robot with constraints, which has `ConstrainedDynamics`.
///
/// References
/// ----------
/// G. Bessonnet, P. Sardain, Optimal dynamics of actuated kinematic chains. Part 1, European Journal of
/// Mechanics A/Solids 24 (2005) 452-471. It leaves open second derivatives: they follow from the 2n + 1 rule.
///
/// Examples
/// --------
/// >>> import costate, numpy as np
/// >>> builder = costate.Robot.builder("pendulum")
/// >>> robot = builder.revolute("hinge", axis=[0, 1, 0], mass=1, com=[0, 0, -1]).build()
/// >>> dynamics = costate.Dynamics(robot)
/// >>> dynamics.f([0.1], [0.0], [0.0]).round(4).tolist()
/// [0.0, -0.9794]
/// >>> dynamics.jacobian(np.zeros((5, 1)), np.zeros(1), np.zeros(1)).shape
/// (5, 2, 3)
#[pyclass(frozen, module = "costate")]
pub struct Dynamics {
    robot: Robot,
    coordinates: Coordinates,
    settings: Settings,
    engines: SharedEngines,
    functions: [OnceLock<Arc<Function>>; Verb::ALL.len()],
    bodies: [OnceLock<Function>; BODY_VERBS],
}

/// The coordinates of these letters.
pub fn coordinates_of(py: Python<'_>, letters: &str) -> PyResult<Coordinates> {
    letters.parse().map_err(|_| {
        let message = format!("unknown coordinates '{letters}'; give 'qv' or 'qp'");
        argument(py, "coordinates", message)
    })
}

impl Dynamics {
    /// The robot of the library.
    pub fn model(&self) -> &robot::Robot {
        self.robot.model()
    }

    /// The same, to keep.
    pub fn shared(&self) -> Arc<robot::Robot> {
        self.robot.shared()
    }

    /// How batches are evaluated.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// The coordinates of the state.
    pub fn space(&self) -> Coordinates {
        self.coordinates
    }

    /// The engine of a quantity.
    fn engine(&self, py: Python<'_>, of: Computed) -> PyResult<Known> {
        self.engines.get(py, &self.robot, of)
    }

    /// Calls a method.
    #[inline]
    pub fn call<'py, const N: usize>(
        &self,
        py: Python<'py>,
        verb: Verb,
        arguments: [&Bound<'py, PyAny>; N],
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.function(py, verb)?.call(py, arguments, out, self.settings)
    }

    /// The function of arrays of a method.
    #[inline]
    pub fn function(&self, py: Python<'_>, verb: Verb) -> PyResult<&Arc<Function>> {
        match self.functions[verb as usize].get() {
            Some(function) => Ok(function),
            None => self.prepare(py, verb),
        }
    }

    #[cold]
    fn prepare(&self, py: Python<'_>, verb: Verb) -> PyResult<&Arc<Function>> {
        let Known { engine, .. } = self.engine(py, verb.quantity(self.coordinates))?;
        let plan = verb.plan(self.coordinates, [self.model().nq(), self.model().dof()]);
        Ok(self.functions[verb as usize].get_or_init(|| Arc::new(Function::new(plan, engine, self.shared()))))
    }

    /// Calls a method for the robot as a whole.
    pub fn of_robot<'py, const N: usize>(
        &self,
        py: Python<'py>,
        verb: BodyVerb,
        arguments: [&Bound<'py, PyAny>; N],
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let function = self.bodies[verb as usize].get_or_init(|| of_robot(self.shared(), verb));
        function.call(py, arguments, out, self.settings)
    }
}

#[pymethods]
impl Dynamics {
    #[new]
    #[pyo3(signature = (robot, coordinates = "qv", *, on_error = "raise", threads = None))]
    fn new(
        py: Python<'_>,
        robot: Robot,
        coordinates: &str,
        on_error: &str,
        threads: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        robot.refuse_constraints(py, "have Dynamics, only ConstrainedDynamics")?;
        Ok(Self {
            coordinates: coordinates_of(py, coordinates)?,
            robot,
            settings: Settings::of(py, on_error, threads)?,
            engines: SharedEngines::default(),
            functions: Default::default(),
            bodies: Default::default(),
        })
    }

    /// The robot.
    #[getter]
    fn robot(&self) -> Robot {
        self.robot.clone()
    }

    /// Number of joints that move by themselves: the length of v and tau.
    #[getter]
    fn n(&self) -> usize {
        self.model().dof()
    }

    /// ``"qv"`` or ``"qp"``.
    #[getter]
    fn coordinates(&self) -> &str {
        match self.coordinates {
            Coordinates::Lagrangian => "qv",
            Coordinates::Hamiltonian => "qp",
        }
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

    /// A frame of the robot.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     One of ``robot.frame_names``.
    /// axes : {"local", "world", "local_world_aligned"}
    ///     Axes and point of six-vectors, see `Frame`.
    ///
    /// Returns
    /// -------
    /// Frame
    ///     ``Frame(self, name, axes)``.
    ///
    /// Raises
    /// ------
    /// RobotError
    ///     For a frame that the robot has not.
    #[pyo3(signature = (name, axes = "local_world_aligned"))]
    fn frame<'py>(slf: &Bound<'py, Self>, name: &str, axes: &str) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("costate._costate")?.getattr("Frame")?.call1((slf, name, axes))
    }

    /// How a method computes one state.
    ///
    /// Parameters
    /// ----------
    /// verb : str
    ///     Name of a method, such as ``"hessian"``.
    ///
    /// Returns
    /// -------
    /// str
    ///     Machine code with its length, or the generic code and why.
    ///
    /// Raises
    /// ------
    /// ArgumentError
    ///     For another name.
    fn backend(&self, py: Python<'_>, verb: &str) -> PyResult<String> {
        let found = Verb::of_name(py, verb)?;
        Ok(self.engine(py, found.quantity(self.coordinates))?.backend)
    }

    fn __eq__(&self, other: &Self) -> bool {
        let same = self.coordinates == other.coordinates && self.settings == other.settings;
        same && self.model() == other.model()
    }

    fn __hash__(&self) -> u64 {
        self.robot.__hash__() ^ u64::from(self.coordinates == Coordinates::Lagrangian)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let (py, this) = (slf.py(), slf.get());
        let keywords = PyDict::new(py);
        keywords.set_item("on_error", this.on_error())?;
        keywords.set_item("threads", this.threads())?;
        let partial = py.import("functools")?.getattr("partial")?;
        let class = partial.call((slf.get_type(),), Some(&keywords))?;
        Ok((class, (this.robot.clone(), this.coordinates()).into_pyobject(py)?))
    }

    fn __repr__(&self) -> String {
        format!("Dynamics({:?}, coordinates={:?}, n={})", self.model().name(), self.coordinates(), self.n())
    }
}
