//! Changes of a robot: each returns another one.

use crate::descriptions::{inertia_entries, inertia_of, triple};
use crate::errors::argument;
use crate::recipe::named;
use crate::robot::Robot;
use costate::robot::{FrameSpec, Friction, LimitChange, LinkInertia, Placement};
use pyo3::prelude::*;
use pyo3::types::PyDict;

#[pymethods]
impl Robot {
    /// The robot that remains when joints are held.
    ///
    /// Parameters
    /// ----------
    /// positions : dict
    ///     Positions (rad, m) by names of joints.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     Another robot; this one does not change.
    ///
    /// Raises
    /// ------
    /// RobotError
    ///     For an unknown joint, one that mimics another one, or a position that is not finite.
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

    /// The robot of these joints; all others are held.
    ///
    /// Parameters
    /// ----------
    /// joints : list of str
    ///     The joints that remain.
    /// q : array_like (nq), optional
    ///     Positions (rad, m) at which others are held; 0 unless given.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     Another robot; this one does not change.
    ///
    /// Raises
    /// ------
    /// RobotError
    ///     For an unknown joint, a wrong number of positions, or a floating or spherical joint that does not
    ///     remain.
    #[pyo3(signature = (joints, q = None))]
    fn reduced_to(&self, py: Python<'_>, joints: Vec<String>, q: Option<Vec<f64>>) -> PyResult<Self> {
        let arguments = named!(py, joints, q);
        let q = q.unwrap_or_else(|| vec![0.0; self.model().nq()]);
        let joints: Vec<&str> = joints.iter().map(String::as_str).collect();
        self.changed(py, "reduced_to", arguments, |robot| robot.reduced_to(&joints, &q))
    }

    /// The robot with a rigid body on a frame.
    ///
    /// Parameters
    /// ----------
    /// frame : str
    ///     One of ``frame_names``.
    /// mass : float
    ///     In kg.
    /// com : sequence of float
    ///     Centre of mass (m) in the frame.
    /// inertia : sequence of float, optional
    ///     xx, yy, zz, xy, xz, yz, or a 3 x 3 matrix, about the centre of mass (kg m^2) in axes of the frame;
    ///     0 unless given.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     Another robot; this one does not change.
    ///
    /// Raises
    /// ------
    /// RobotError
    ///     For an unknown frame, or a body that cannot be.
    #[pyo3(signature = (frame, mass, com = [0.0; 3], inertia = None))]
    fn with_payload(
        &self,
        py: Python<'_>,
        frame: String,
        mass: f64,
        #[pyo3(from_py_with = triple)] com: [f64; 3],
        #[pyo3(from_py_with = inertia_entries)] inertia: Option<Vec<f64>>,
    ) -> PyResult<Self> {
        let arguments = named!(py, frame, mass, com, inertia);
        let body = LinkInertia::from_entries(mass, com, inertia_of(py, inertia)?);
        self.changed(py, "with_payload", arguments, |robot| robot.with_payload(&frame, &body))
    }

    /// The robot with one more frame.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Its name.
    /// on : str
    ///     The joint or frame that carries it.
    /// xyz, rpy : sequence of float
    ///     Its placement there (m; rad, fixed axes).
    ///
    /// Returns
    /// -------
    /// Robot
    ///     Another robot; this one does not change.
    ///
    /// Raises
    /// ------
    /// RobotError
    ///     For a name that is taken, or an unknown frame.
    #[pyo3(signature = (name, on, xyz = [0.0; 3], rpy = [0.0; 3]))]
    fn add_frame(
        &self,
        py: Python<'_>,
        name: String,
        on: String,
        #[pyo3(from_py_with = triple)] xyz: [f64; 3],
        #[pyo3(from_py_with = triple)] rpy: [f64; 3],
    ) -> PyResult<Self> {
        let arguments = named!(py, name, on, xyz, rpy);
        let frame = FrameSpec::new(&name).on(&on).placed(Placement::from_xyz_rpy(xyz, rpy));
        self.changed(py, "add_frame", arguments, |robot| robot.with_frame(frame))
    }

    /// The robot under another gravity.
    ///
    /// Parameters
    /// ----------
    /// gravity : sequence of float
    ///     In the world (m/s^2).
    ///
    /// Returns
    /// -------
    /// Robot
    ///     Another robot; this one does not change.
    ///
    /// Raises
    /// ------
    /// RobotError
    ///     For a number that is not finite.
    fn with_gravity(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = triple)] gravity: [f64; 3],
    ) -> PyResult<Self> {
        self.changed(py, "with_gravity", named!(py, gravity), |robot| robot.with_gravity(gravity))
    }

    /// The robot with another armature of a joint.
    ///
    /// Parameters
    /// ----------
    /// joint : str
    ///     The joint.
    /// armature : float
    ///     Rotor inertia at the joint (kg m^2, kg).
    ///
    /// Returns
    /// -------
    /// Robot
    ///     Another robot; this one does not change.
    ///
    /// Raises
    /// ------
    /// RobotError
    ///     For an unknown joint, or a negative armature.
    fn with_armature(&self, py: Python<'_>, joint: String, armature: f64) -> PyResult<Self> {
        let arguments = named!(py, joint, armature);
        self.changed(py, "with_armature", arguments, |robot| robot.with_joint_armature(&joint, armature))
    }

    /// The robot with other friction of a joint: -viscous v - coulomb tanh(v / coulomb_velocity).
    ///
    /// Parameters
    /// ----------
    /// joint : str
    ///     The joint.
    /// viscous : float
    ///     In N m s/rad, N s/m.
    /// coulomb : float
    ///     In N m, N.
    /// coulomb_velocity : float, optional
    ///     In rad/s, m/s; 0.01 unless given.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     Another robot; this one does not change.
    ///
    /// Raises
    /// ------
    /// RobotError
    ///     For an unknown joint, or a number that cannot be.
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
    ///
    /// Parameters
    /// ----------
    /// joint : str
    ///     The joint.
    /// lower, upper : float, optional
    ///     Positions (rad, m).
    /// velocity : float, optional
    ///     Largest speed (rad/s, m/s).
    /// effort : float, optional
    ///     Largest torque or force (N m, N).
    ///
    /// Returns
    /// -------
    /// Robot
    ///     Another robot; this one does not change.
    ///
    /// Raises
    /// ------
    /// RobotError
    ///     For an unknown joint, or limits that cannot be.
    /// ArgumentError
    ///     Where no limit is given.
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
