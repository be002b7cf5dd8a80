//! Changes of a robot: each returns another one.

use crate::descriptions::inertia_of;
use crate::errors::argument;
use crate::recipe::named;
use crate::robot::Robot;
use costate::robot::{FrameSpec, Friction, LimitChange, LinkInertia, Placement};
use pyo3::prelude::*;
use pyo3::types::PyDict;

#[pymethods]
impl Robot {
    /// The robot that remains when joints are held: positions (rad, m) by their names.
    fn lock(&self, py: Python<'_>, positions: &Bound<'_, PyDict>) -> PyResult<Self> {
        let positions: Vec<(String, f64)> = positions
            .iter()
            .map(|(joint, q)| Ok((joint.extract()?, q.extract()?)))
            .collect::<PyResult<_>>()?;
        let copy = PyDict::new(py);
        positions.iter().try_for_each(|(joint, q)| copy.set_item(joint, q))?;
        let named = PyDict::new(py);
        named.set_item("positions", copy)?;
        let held: Vec<(&str, f64)> = positions.iter().map(|(joint, q)| (joint.as_str(), *q)).collect();
        self.changed(py, "lock", named, |robot| robot.lock(&held))
    }

    /// The robot of these joints; all others are held at q (n; 0 unless given).
    #[pyo3(signature = (joints, q = None))]
    fn reduced_to(&self, py: Python<'_>, joints: Vec<String>, q: Option<Vec<f64>>) -> PyResult<Self> {
        let arguments = named!(py, joints, q);
        let q = q.unwrap_or_else(|| vec![0.0; self.model().dof()]);
        let joints: Vec<&str> = joints.iter().map(String::as_str).collect();
        self.changed(py, "reduced_to", arguments, |robot| robot.reduced_to(&joints, &q))
    }

    /// The robot with a rigid body on a frame: mass (kg), centre of mass (m) and inertia xx, yy, zz, xy, xz,
    /// yz about it (kg m^2), in the axes of the frame.
    #[pyo3(signature = (frame, mass, com = [0.0; 3], inertia = None))]
    fn with_payload(
        &self,
        py: Python<'_>,
        frame: String,
        mass: f64,
        com: [f64; 3],
        inertia: Option<Vec<f64>>,
    ) -> PyResult<Self> {
        let arguments = named!(py, frame, mass, com, inertia);
        let body = LinkInertia::from_entries(mass, com, inertia_of(py, inertia)?);
        self.changed(py, "with_payload", arguments, |robot| robot.with_payload(&frame, &body))
    }

    /// The robot with one more frame, placed by xyz (m) and rpy (rad) in the frame ``on``.
    #[pyo3(signature = (name, on, xyz = [0.0; 3], rpy = [0.0; 3]))]
    fn add_frame(
        &self,
        py: Python<'_>,
        name: String,
        on: String,
        xyz: [f64; 3],
        rpy: [f64; 3],
    ) -> PyResult<Self> {
        let arguments = named!(py, name, on, xyz, rpy);
        let frame = FrameSpec::new(&name).on(&on).placed(Placement::from_xyz_rpy(xyz, rpy));
        self.changed(py, "add_frame", arguments, |robot| robot.with_frame(frame))
    }

    /// The robot under another gravity (m/s^2), in the world.
    fn with_gravity(&self, py: Python<'_>, gravity: [f64; 3]) -> PyResult<Self> {
        self.changed(py, "with_gravity", named!(py, gravity), |robot| robot.with_gravity(gravity))
    }

    /// The robot with another armature of a joint (kg m^2, kg).
    fn with_armature(&self, py: Python<'_>, joint: String, armature: f64) -> PyResult<Self> {
        let arguments = named!(py, joint, armature);
        self.changed(py, "with_armature", arguments, |robot| robot.with_joint_armature(&joint, armature))
    }

    /// The robot with other friction of a joint: -viscous v - coulomb tanh(v / coulomb_velocity), the last
    /// one 0.01 rad/s or m/s unless given.
    #[pyo3(signature = (joint, viscous = 0.0, coulomb = 0.0, coulomb_velocity = None))]
    fn with_friction(
        &self,
        py: Python<'_>,
        joint: String,
        viscous: f64,
        coulomb: f64,
        coulomb_velocity: Option<f64>,
    ) -> PyResult<Self> {
        let arguments = named!(py, joint, viscous, coulomb, coulomb_velocity);
        let coulomb_velocity = coulomb_velocity.unwrap_or(Friction::DEFAULT_COULOMB_VELOCITY);
        let friction = Friction { viscous, coulomb, coulomb_velocity };
        self.changed(py, "with_friction", arguments, |robot| robot.with_friction(&joint, friction))
    }

    /// The robot with other limits of a joint; those that are not given stay.
    #[pyo3(signature = (joint, *, lower = None, upper = None, velocity = None, effort = None))]
    fn with_limits(
        &self,
        py: Python<'_>,
        joint: String,
        lower: Option<f64>,
        upper: Option<f64>,
        velocity: Option<f64>,
        effort: Option<f64>,
    ) -> PyResult<Self> {
        let arguments = named!(py, joint, lower, upper, velocity, effort);
        let change = LimitChange { lower, upper, velocity, effort };
        if change == LimitChange::default() {
            let message = "no limit is given; give lower, upper, velocity or effort";
            return Err(argument(py, "joint", message.into()));
        }
        self.changed(py, "with_limits", arguments, |robot| {
            let old = robot.joints()[robot.joint_index(&joint)?].limits;
            robot.with_limits(&joint, change.of(old))
        })
    }
}
