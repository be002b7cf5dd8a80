//! The class `Frame`.

use crate::dynamics::Dynamics;
use crate::errors::argument;
use crate::function::Function;
use crate::kinematics::{FRAME_VERBS, FrameVerb, of_frame};
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

/// A frame of a robot: its pose, motion and derivatives. Made by `Dynamics.frame`.
///
/// Six-vectors are (angular, linear), in the axes and for the point that ``axes`` names: ``"local"``: the origin
/// and the axes of the frame; ``"world"``: the point of the link at the origin of the world, axes of the world;
/// ``"local_world_aligned"``: the origin of the frame, axes of the world. Pinocchio has the linear part first.
///
/// Examples
/// --------
/// >>> import costate, numpy as np
/// >>> robot = costate.Robot.builder("pendulum").revolute("hinge", axis=[0, 1, 0], mass=1, com=[1, 0, 0]).build()
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
    /// The frame of this name.
    pub fn of(dynamics: &Bound<'_, Dynamics>, name: &str, axes: &str) -> PyResult<Self> {
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

    fn call<'py, const N: usize>(
        &self,
        py: Python<'py>,
        verb: FrameVerb,
        arguments: [&Bound<'py, PyAny>; N],
    ) -> PyResult<Bound<'py, PyAny>> {
        let dynamics = self.dynamics.get();
        let new = || of_frame(dynamics.model(), verb, self.frame, self.axes.1);
        self.functions[verb as usize].get_or_init(new).call(py, arguments, dynamics.settings())
    }
}

#[pymethods]
impl Frame {
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

    /// Orientation R (..., 3, 3), whose columns are the axes of the frame, and position (..., 3) in m, both in
    /// the world.
    fn pose<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.call(py, FrameVerb::Pose, [q])
    }

    /// The Jacobian J (..., 6, n): twist = J v.
    fn jacobian<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.call(py, FrameVerb::Jacobian, [q])
    }

    /// The derivative of J in time (..., 6, n).
    fn jacobian_rate<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.call(py, FrameVerb::JacobianRate, [q, v])
    }

    /// Angular and linear velocity (..., 6) in rad/s and m/s.
    fn twist<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.call(py, FrameVerb::Twist, [q, v])
    }

    /// The derivative of the twist in time (..., 6): J a + dJ/dt v.
    fn acceleration<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        a: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.call(py, FrameVerb::Acceleration, [q, v, a])
    }

    /// The second derivatives of w'x (..., n, n), x the position in the world and w (..., 3) weights.
    fn position_hessian<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        w: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.call(py, FrameVerb::PositionHessian, [q, w])
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let of = self.dynamics.bind(py).getattr("frame")?;
        Ok((of, (&self.name, self.axes.0).into_pyobject(py)?))
    }

    fn __repr__(&self) -> String {
        let robot = self.dynamics.get().model().name();
        format!("Frame({:?} of {robot:?}, axes={:?})", self.name, self.axes.0)
    }
}
