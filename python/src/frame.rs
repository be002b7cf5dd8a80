//! The class `Frame`.

use crate::dynamics::Dynamics;
use crate::errors::argument;
use crate::function::Function;
use crate::kinematics::{FRAME_VERBS, FrameVerb, of_frame};
use crate::methods::verbs;
use costate::kinematics::ReferenceFrame;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::OnceLock;

/// The names of the conventions, as in Pinocchio.
const AXES: [(&str, ReferenceFrame); 3] = [
    ("local", ReferenceFrame::Local),
    ("world", ReferenceFrame::World),
    ("local_world_aligned", ReferenceFrame::LocalWorldAligned),
];

/// A frame of a robot: its pose, motion and derivatives; `Dynamics.frame` makes it too.
///
/// Six-vectors are (angular, linear), in the axes and for the point that ``axes`` names: ``"local"``: the
/// origin and the axes of the frame; ``"world"``: the point of the link at the origin of the world, axes of
/// the world; ``"local_world_aligned"``: the origin of the frame, axes of the world. Pinocchio has the linear
/// part first.
///
/// Parameters
/// ----------
/// dynamics : Dynamics
///     The robot, with its settings for errors and threads.
/// name : str
///     One of ``robot.frame_names``.
/// axes : {"local", "world", "local_world_aligned"}
///     Axes and point of six-vectors.
///
/// Raises
/// ------
/// RobotError
///     For a frame that the robot has not.
///
/// Examples
/// --------
/// >>> import costate, numpy as np
/// >>> builder = costate.Robot.builder("pendulum")
/// >>> robot = builder.revolute("hinge", axis=[0, 1, 0], mass=1, com=[1, 0, 0]).build()
/// >>> bob = costate.Dynamics(robot.add_frame("bob", "hinge", [1, 0, 0])).frame("bob")
/// >>> R, x = bob.pose([0.0])
/// >>> x.tolist()
/// [1.0, 0.0, 0.0]
/// >>> bob.jacobian([0.0])[:, 0].tolist()
/// [0.0, 1.0, 0.0, 0.0, 0.0, -1.0]
#[pyclass(frozen, module = "costate")]
pub struct Frame {
    dynamics: Py<Dynamics>,
    name: String,
    frame: usize,
    axes: (&'static str, ReferenceFrame),
    functions: [OnceLock<Function>; FRAME_VERBS],
}

impl Frame {
    fn call<'py, const N: usize>(
        &self,
        py: Python<'py>,
        verb: FrameVerb,
        arguments: [&Bound<'py, PyAny>; N],
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let dynamics = self.dynamics.get();
        let new = || of_frame(dynamics.shared(), verb, self.frame, self.axes.1);
        self.functions[verb as usize].get_or_init(new).call(py, arguments, out, dynamics.settings())
    }
}

#[pymethods]
impl Frame {
    #[new]
    #[pyo3(signature = (dynamics, name, axes = "local_world_aligned"))]
    fn new(dynamics: &Bound<'_, Dynamics>, name: &str, axes: &str) -> PyResult<Self> {
        let py = dynamics.py();
        let found = AXES.into_iter().find(|(known, _)| *known == axes).ok_or_else(|| {
            let names = AXES.map(|(name, _)| format!("'{name}'")).join(", ");
            argument(py, "axes", format!("unknown axes '{axes}'; give one of {names}"))
        })?;
        let robot = dynamics.get().model();
        let frame = robot.frame_index(name).map_err(|error| crate::errors::robot(py, &error))?;
        Ok(Self {
            dynamics: dynamics.clone().unbind(),
            name: name.to_owned(),
            frame,
            axes: found,
            functions: Default::default(),
        })
    }

    /// Name of the frame.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// The axes of six-vectors: ``"local"``, ``"world"`` or ``"local_world_aligned"``.
    #[getter]
    fn axes(&self) -> &str {
        self.axes.0
    }

    /// The dynamics that made it.
    #[getter]
    fn dynamics(&self, py: Python<'_>) -> Py<Dynamics> {
        self.dynamics.clone_ref(py)
    }

    fn __eq__(&self, py: Python<'_>, other: &Self) -> PyResult<bool> {
        let same = self.dynamics.bind(py).eq(&other.dynamics)?;
        Ok(same && self.frame == other.frame && self.axes.0 == other.axes.0)
    }

    fn __hash__(&self) -> usize {
        self.frame
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let (py, this) = (slf.py(), slf.get());
        let arguments = (this.dynamics.clone_ref(py), &this.name, this.axes.0);
        Ok((slf.get_type().into_any(), arguments.into_pyobject(py)?))
    }

    fn __repr__(&self) -> String {
        let robot = self.dynamics.get().model().name();
        format!("Frame({:?} of {robot:?}, axes={:?})", self.name, self.axes.0)
    }
}

verbs! {
    impl Frame;

    /// Orientation and position of the frame in the world.
    pose(q: q) -> several
        "R : ndarray (..., 3, 3)\n    Its columns are the axes of the frame.\nx : ndarray (..., 3)\n    Its \
         origin (m)."
        = call FrameVerb::Pose;

    /// The Jacobian J: twist = J v.
    jacobian(q: q) -> one
        "ndarray (..., 6, n)\n    Rows of the angular velocity, then of the linear one, in ``axes``."
        = call FrameVerb::Jacobian;

    /// The derivative of J in time.
    jacobian_rate(q: q, v: v) -> one
        "ndarray (..., 6, n)\n    dJ/dt, in ``axes``."
        = call FrameVerb::JacobianRate;

    /// Angular and linear velocity.
    twist(q: q, v: v) -> one
        "ndarray (..., 6)\n    In rad/s and m/s, in ``axes``."
        = call FrameVerb::Twist;

    /// The derivative of the twist in time, J a + dJ/dt v.
    ///
    /// Only with the axes ``"local_world_aligned"`` its linear part is the acceleration of the origin of the
    /// frame; otherwise it is a spatial acceleration.
    acceleration(q: q, v: v, a: a) -> one
        "ndarray (..., 6)\n    In rad/s^2 and m/s^2, in ``axes``."
        = call FrameVerb::Acceleration;

    /// The second derivatives of w'x by q, x the position of the frame in the world.
    position_hessian(q: q, w: weights) -> one
        "ndarray (..., n, n)\n    Symmetric."
        = call FrameVerb::PositionHessian;
}
