//! The class `RobotBuilder`.

use crate::descriptions::{inertia_entries, inertia_of, mimicked, triple};
use crate::errors;
use crate::recipe::{Recipe, named};
use crate::robot::Robot;
use costate::robot::{
    FrameSpec, Friction, JointSpec, LimitChange, Limits, LinkInertia, Placement, RobotBuilder as Builder,
    Spring,
};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::{Mutex, PoisonError};

/// Builds a robot joint by joint; made by `Robot.builder`.
///
/// Each method changes the builder and returns it, also where the result is not used; ``copy.copy`` makes
/// another one. Joint frames: ``xyz`` (m) and ``rpy`` (rad, fixed axes, as in a URDF)
/// place the frame of the joint in the frame of the joint ``on`` (in the world without one); ``axis``,
/// ``com`` and ``inertia`` are in the frame of the joint. Builders with equal calls are equal; a copy is a
/// builder of its own.
///
/// Parameters
/// ----------
/// name : str
///     Name of the robot.
/// gravity : sequence of float
///     In the world (m/s^2).
///
/// Examples
/// --------
/// >>> import costate
/// >>> builder = costate.Robot.builder("arm")
/// >>> builder = builder.revolute("shoulder", axis=[0, 0, 1], mass=1.0, com=[0.5, 0, 0])
/// >>> builder = builder.revolute("elbow", on="shoulder", xyz=[1, 0, 0], mass=1.0, com=[0.5, 0, 0])
/// >>> builder.frame("tip", "elbow", xyz=[1, 0, 0]).build().joint_names
/// ['shoulder', 'elbow']
#[pyclass(frozen, module = "costate")]
pub struct RobotBuilder {
    state: Mutex<(Builder, Recipe)>,
}

type Shared<'py> = Bound<'py, RobotBuilder>;

impl RobotBuilder {
    /// Adds to the builder, and notes the call.
    fn add<'py>(
        slf: Shared<'py>,
        name: &'static str,
        arguments: Bound<'py, pyo3::types::PyDict>,
        change: impl FnOnce(Builder) -> Builder,
    ) -> Shared<'py> {
        {
            let mut state = slf.get().state.lock().unwrap_or_else(PoisonError::into_inner);
            state.0 = change(state.0.clone());
            state.1.push(name, arguments);
        }
        slf
    }
}

/// The methods for the two kinds of joints of one degree of freedom, which differ by their name.
macro_rules! joint_methods {
    ($($kind:ident: $text:literal),*) => {
        #[pymethods]
        impl RobotBuilder {
            $(
            #[doc = $text]
            ///
            /// Parameters
            /// ----------
            /// name : str
            ///     Its name; that of its link too.
            /// on : str, optional
            ///     The joint that carries it; the world unless given.
            /// xyz, rpy, axis : sequence of float
            ///     Placement of its frame, and the direction of its axis.
            /// mass, com, inertia : float, sequence of float
            ///     Of its link: kg, m, and xx, yy, zz, xy, xz, yz or a 3 x 3 matrix about the
            ///     centre of mass (kg m^2).
            /// armature : float
            ///     Rotor inertia (kg m^2, kg).
            /// stiffness, rest : float
            ///     Of a spring: N m/rad or N/m, rad or m.
            /// viscous, coulomb : float
            ///     Friction: N m s/rad or N s/m, N m or N.
            /// lower, upper, velocity, effort : float, optional
            ///     Limits: rad or m, rad/s or m/s, N m or N.
            /// mimic : (str, float, float), optional
            ///     The joint that it follows, ratio and offset.
            ///
            /// Returns
            /// -------
            /// RobotBuilder
            ///     This one.
            #[pyo3(signature = (name, *, on = None, xyz = [0.0; 3], rpy = [0.0; 3], axis = [0.0, 0.0, 1.0],
                mass = 0.0, com = [0.0; 3], inertia = None, armature = 0.0, stiffness = 0.0, rest = 0.0,
                viscous = 0.0, coulomb = 0.0, lower = None, upper = None, velocity = None, effort = None,
                mimic = None))]
            #[expect(clippy::too_many_arguments, reason = "all by name")]
            fn $kind<'py>(
                slf: Shared<'py>,
                name: String,
                on: Option<String>,
                #[pyo3(from_py_with = triple)] xyz: [f64; 3],
                #[pyo3(from_py_with = triple)] rpy: [f64; 3],
                #[pyo3(from_py_with = triple)] axis: [f64; 3],
                mass: f64,
                #[pyo3(from_py_with = triple)] com: [f64; 3],
                #[pyo3(from_py_with = inertia_entries)] inertia: Option<Vec<f64>>,
                armature: f64,
                stiffness: f64,
                rest: f64,
                viscous: f64,
                coulomb: f64,
                lower: Option<f64>,
                upper: Option<f64>,
                velocity: Option<f64>,
                effort: Option<f64>,
                #[pyo3(from_py_with = mimicked)] mimic: Option<(String, f64, f64)>,
            ) -> PyResult<Shared<'py>> {
                let py = slf.py();
                let arguments = named!(
                    py, name, on, xyz, rpy, axis, mass, com, inertia, armature, stiffness, rest, viscous,
                    coulomb, lower, upper, velocity, effort, mimic
                );
                let limits = LimitChange { lower, upper, velocity, effort }.of(Limits::default());
                let mut joint = JointSpec::$kind(&name)
                    .placed(Placement::from_xyz_rpy(xyz, rpy))
                    .axis(axis)
                    .carrying(LinkInertia::from_entries(mass, com, inertia_of(py, inertia)?))
                    .armature(armature)
                    .spring(Spring { stiffness, rest })
                    .friction(Friction { viscous, coulomb, ..Friction::none() })
                    .limits(limits);
                if let Some(on) = &on {
                    joint = joint.on(on);
                }
                if let Some((other, ratio, offset)) = &mimic {
                    joint = joint.mimicking(other, *ratio, *offset);
                }
                Ok(Self::add(slf, stringify!($kind), arguments, |builder| builder.joint(joint)))
            }
            )*

            #[new]
            #[pyo3(signature = (name, *, gravity = [0.0, 0.0, -9.81]))]
            fn new(py: Python<'_>, name: &str, #[pyo3(from_py_with = triple)] gravity: [f64; 3]) -> PyResult<Self> {
                let recipe = Recipe::default().then(py, "builder", named!(py, name, gravity));
                Ok(Self { state: Mutex::new((costate::robot::Robot::builder(name).gravity(gravity), recipe)) })
            }

            /// Adds a frame that is fixed to the link of a joint, or to another frame.
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
            /// RobotBuilder
            ///     This one.
            #[pyo3(signature = (name, on, *, xyz = [0.0; 3], rpy = [0.0; 3]))]
            fn frame<'py>(
                slf: Shared<'py>,
                name: String,
                on: String,
                #[pyo3(from_py_with = triple)] xyz: [f64; 3],
                #[pyo3(from_py_with = triple)] rpy: [f64; 3],
            ) -> PyResult<Shared<'py>> {
                let arguments = named!(slf.py(), name, on, xyz, rpy);
                let frame = FrameSpec::new(&name).on(&on).placed(Placement::from_xyz_rpy(xyz, rpy));
                Ok(Self::add(slf, "frame", arguments, |builder| builder.frame(frame)))
            }

            /// The robot, checked.
            ///
            /// Returns
            /// -------
            /// Robot
            ///     Another one each time; the builder can go on.
            ///
            /// Raises
            /// ------
            /// RobotError
            ///     For joints that form no tree, names given twice, and numbers that cannot be.
            fn build(&self, py: Python<'_>) -> PyResult<Robot> {
                let (robot, recipe) = {
                    let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
                    (state.0.clone().build(), state.1.then(py, "build", named!(py,)))
                };
                Robot::warned(py, robot.map_err(|error| errors::robot(py, &error))?, recipe, &[])
            }
        }
    };
}
joint_methods!(
    revolute: "Adds a revolute joint with its link.",
    prismatic: "Adds a prismatic joint with its link."
);

/// The methods for joints whose orientation is a quaternion.
macro_rules! free_joint_methods {
    ($($kind:ident: $text:literal),*) => {
        #[pymethods]
        impl RobotBuilder {
            $(
            #[doc = $text]
            ///
            /// Its orientation is a unit quaternion, see `Robot`.
            ///
            /// Parameters
            /// ----------
            /// name : str
            ///     Its name; that of its link too.
            /// on : str, optional
            ///     The joint that carries it; the world unless given.
            /// xyz, rpy : sequence of float
            ///     Placement of its frame.
            /// mass, com, inertia : float, sequence of float
            ///     Of its link: kg, m, and xx, yy, zz, xy, xz, yz or a 3 x 3 matrix about the
            ///     centre of mass (kg m^2).
            ///
            /// Returns
            /// -------
            /// RobotBuilder
            ///     This one.
            #[pyo3(signature = (name, *, on = None, xyz = [0.0; 3], rpy = [0.0; 3], mass = 0.0, com = [0.0; 3],
                inertia = None))]
            fn $kind<'py>(
                slf: Shared<'py>,
                name: String,
                on: Option<String>,
                #[pyo3(from_py_with = triple)] xyz: [f64; 3],
                #[pyo3(from_py_with = triple)] rpy: [f64; 3],
                mass: f64,
                #[pyo3(from_py_with = triple)] com: [f64; 3],
                #[pyo3(from_py_with = inertia_entries)] inertia: Option<Vec<f64>>,
            ) -> PyResult<Shared<'py>> {
                let py = slf.py();
                let arguments = named!(py, name, on, xyz, rpy, mass, com, inertia);
                let mut joint = JointSpec::$kind(&name)
                    .placed(Placement::from_xyz_rpy(xyz, rpy))
                    .carrying(LinkInertia::from_entries(mass, com, inertia_of(py, inertia)?));
                if let Some(on) = &on {
                    joint = joint.on(on);
                }
                Ok(Self::add(slf, stringify!($kind), arguments, |builder| builder.joint(joint)))
            }
            )*
        }
    };
}
free_joint_methods!(
    floating: "Adds a floating joint, which moves without restriction, with its link.",
    spherical: "Adds a spherical joint, which turns without restriction, with its link."
);

#[pymethods]
impl RobotBuilder {
    fn __eq__(&self, py: Python<'_>, other: &Self) -> PyResult<bool> {
        // One lock at a time: a builder is compared with itself too.
        let calls = |of: &Self| of.state.lock().unwrap_or_else(PoisonError::into_inner).1.copy(py);
        let (ours, theirs) = (calls(self), calls(other));
        ours.equals(py, &theirs)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let calls = self.state.lock().unwrap_or_else(PoisonError::into_inner).1.copy(py);
        let names = |of: &[&str]| calls.names(py, of);
        let kinds = ["revolute", "prismatic", "floating", "spherical"];
        let (all, frames) = (names(&kinds)?, names(&["frame"])?);
        let name = names(&["builder"])?.concat();
        Ok(format!("RobotBuilder({name}, joints=[{}], frames=[{}])", all.join(", "), frames.join(", ")))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let py = slf.py();
        let calls = slf.get().state.lock().unwrap_or_else(PoisonError::into_inner).1.copy(py);
        calls.reduce(py.get_type::<Robot>())
    }
}
