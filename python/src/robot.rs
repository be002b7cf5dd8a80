//! The class `Robot`.

use crate::configuration::Functions;
use crate::descriptions::triple;
use crate::errors::{self, RobotWarning, argument};
use crate::look::Look;
use crate::notes::note;
use crate::recipe::{Recipe, is_rebuilding, named};
use crate::refusals::refuse_floating_base;
use crate::table;
use crate::words::in_python;
use costate::robot::{self, LoadOptions, RobotFormat, RobotText};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::ffi::CString;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;
use std::sync::Arc;

/// A robot: a tree of revolute, prismatic, floating and spherical joints in the world.
///
/// Constraints between frames close its loops, see `with_constraint` and `ConstrainedDynamics`.
///
/// It never changes: ``lock``, ``with_payload`` and the like return another robot. The entries of q, v and
/// tau belong to ``joint_names``: the joints that mimic no other one, parents before children, as in
/// Pinocchio for most robots.
///
/// A floating or spherical joint has an orientation without singular poses: in q it has x, y, z (m, in the
/// frame that it stands in) and a unit quaternion (x, y, z, w), or the quaternion alone; in v, p, tau and d
/// the linear and angular parts, or the angular part alone, in the axes of the moved frame, as in Pinocchio.
/// So q has ``nq`` entries and all else ``nv`` = n; ``free_joints`` says where. Derivatives by q are those by
/// d in q (+) d, see ``integrate``.
///
/// Examples
/// --------
/// >>> import costate
/// >>> arm = costate.Robot.from_text("name='arm'\n[[joint]]\nname='hinge'\nmass=1.0\ncom=[0.5, 0.0, 0.0]")
/// >>> arm
/// Robot('arm', n=1)
/// >>> arm.with_payload("hinge", 2.0, [1.0, 0, 0]).mass
/// 3.0
#[pyclass(frozen, from_py_object, module = "costate")]
#[derive(Clone)]
pub struct Robot {
    inner: Arc<robot::Robot>,
    recipe: Arc<Recipe>,
    /// Its visual models, if it was read from a URDF; no part of what is compared.
    pub look: Option<Arc<Look>>,
    /// Functions of its configurations.
    pub functions: Arc<Functions>,
}

impl Robot {
    /// The robot of the library.
    pub fn model(&self) -> &robot::Robot {
        &self.inner
    }

    /// The same, to keep.
    pub fn shared(&self) -> Arc<robot::Robot> {
        self.inner.clone()
    }

    /// A robot that was made by these calls; warns of what is unusual about it and was not `known`. What was
    /// done to load it is logged.
    pub fn warned(
        py: Python<'_>,
        robot: robot::Robot,
        recipe: Recipe,
        known: &[robot::Warning],
    ) -> PyResult<Self> {
        let new = |warning: &&robot::Warning| !is_rebuilding() && !known.contains(warning);
        for warning in robot.warnings().iter().filter(new) {
            let text = in_python(&format!("robot '{}': {warning}", robot.name()));
            if warning.is_note() {
                note(py, &text)?;
                continue;
            }
            let text = CString::new(text.replace('\0', " "))?;
            PyErr::warn(py, &py.get_type::<RobotWarning>(), &text, 1)?;
        }
        Ok(Self { inner: Arc::new(robot), recipe: Arc::new(recipe), look: None, functions: Arc::default() })
    }

    /// Refuses a robot with constraints where they would be ignored, saying what it cannot.
    ///
    /// # Errors
    /// `RobotError` with the first constraint.
    pub fn refuse_constraints(&self, py: Python<'_>, what: &'static str) -> PyResult<()> {
        let Some(constraint) = self.inner.constraints().first() else { return Ok(()) };
        let constraint = constraint.name.clone();
        Err(errors::robot(py, &robot::RobotError::Constrained { constraint, what }))
    }

    /// The same with these visual models.
    pub fn looking_like(self, look: Option<Arc<Look>>) -> Self {
        Self { look, ..self }
    }

    /// The robot after a change, which is noted in its recipe.
    pub fn changed(
        &self,
        py: Python<'_>,
        name: &'static str,
        arguments: Bound<'_, PyDict>,
        change: impl FnOnce(&robot::Robot) -> Result<robot::Robot, robot::RobotError>,
    ) -> PyResult<Self> {
        let robot = change(&self.inner).map_err(|error| errors::robot(py, &error))?;
        let recipe = self.recipe.then(py, name, arguments);
        Ok(Self::warned(py, robot, recipe, self.inner.warnings())?.looking_like(self.look.clone()))
    }
}

#[pymethods]
impl Robot {
    /// Reads a ``.urdf`` or ``.toml`` file.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The file.
    /// friction : bool
    ///     Load ``<dynamics damping friction>`` of a URDF.
    /// strict : bool
    ///     Warnings that suggest a mistake are errors.
    /// floating_base : bool
    ///     The root link of a URDF moves by a floating joint ``root_joint``; it is the base unless set.
    ///     Refused for robots in TOML, which name the joint of their base themselves.
    /// quaternions : bool
    ///     Joints of type ``floating`` of a URDF are such joints; unless set, each becomes six joints with a
    ///     singular pose. Joints of robots in TOML are what the file says.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     With `RobotWarning` for what is unusual about it.
    ///
    /// Raises
    /// ------
    /// RobotError
    ///     With ``path``, ``line`` and ``culprit``.
    /// ArgumentError
    ///     For ``floating_base`` of a robot in TOML.
    /// OSError
    ///     Where the file cannot be read.
    #[staticmethod]
    #[pyo3(signature = (path, *, friction = false, strict = false, floating_base = false, quaternions = false))]
    pub fn from_file(
        py: Python<'_>,
        path: PathBuf,
        friction: bool,
        strict: bool,
        floating_base: bool,
        quaternions: bool,
    ) -> PyResult<Self> {
        let options = LoadOptions::default().friction(friction).strict(strict);
        let options = options.floating_base(floating_base).quaternions(quaternions);
        // Other threads run meanwhile: a pipe may wait for one of them.
        let file = py.detach(|| RobotText::from_file(&path)).map_err(|error| errors::robot(py, &error))?;
        refuse_floating_base(py, floating_base, file.format())?;
        let read = py.detach(|| file.robot(options)).map_err(|error| errors::robot(py, &error))?;
        // A pickle contains the text: the file need not be where it is read.
        let look = Look::new(file.as_str(), file.format(), Some(&path));
        let (text, format) = (file.as_str(), file.format().name());
        let arguments = named!(py, text, format, friction, strict, floating_base, quaternions);
        let recipe = Recipe::default().then(py, "from_text", arguments);
        Ok(Self::warned(py, read, recipe, &[])?.looking_like(look))
    }

    /// Reads the text of a URDF or of a robot in TOML.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     The description.
    /// format : {"urdf", "toml"}, optional
    ///     Found by the first character unless given.
    /// friction, strict, floating_base, quaternions : bool
    ///     As in `from_file`.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     With `RobotWarning` for what is unusual about it.
    ///
    /// Raises
    /// ------
    /// RobotError
    ///     With ``line`` and ``culprit``.
    /// ArgumentError
    ///     For ``floating_base`` of a robot in TOML, or an unknown format.
    #[staticmethod]
    #[pyo3(signature = (text, format = None, *, friction = false, strict = false, floating_base = false,
        quaternions = false))]
    fn from_text(
        py: Python<'_>,
        text: String,
        format: Option<&str>,
        friction: bool,
        strict: bool,
        floating_base: bool,
        quaternions: bool,
    ) -> PyResult<Self> {
        let kind = match format {
            None => RobotFormat::of_text(&text),
            Some("urdf") => RobotFormat::Urdf,
            Some("toml") => RobotFormat::Toml,
            Some(other) => {
                let message = format!("unknown format '{other}'; give 'urdf' or 'toml'");
                return Err(argument(py, "format", message));
            }
        };
        let options = LoadOptions::default().friction(friction).strict(strict);
        let options = options.floating_base(floating_base).quaternions(quaternions);
        refuse_floating_base(py, floating_base, kind)?;
        let read = robot::Robot::read(text.as_bytes(), kind, options);
        let read = read.map_err(|error| errors::robot(py, &error))?;
        let look = Look::new(&text, kind, None);
        let arguments = named!(py, text, format, friction, strict, floating_base, quaternions);
        let recipe = Recipe::default().then(py, "from_text", arguments);
        Ok(Self::warned(py, read, recipe, &[])?.looking_like(look))
    }

    /// The robot of a problem, with the changes that the problem makes; for pickles.
    #[staticmethod]
    fn _of_problem(problem: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(problem.call_method0("robot")?.extract()?)
    }

    /// Starts a robot without joints.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Name of the robot.
    /// gravity : sequence of float
    ///     In the world (m/s^2).
    ///
    /// Returns
    /// -------
    /// RobotBuilder
    ///     It adds joints and frames.
    #[staticmethod]
    #[pyo3(signature = (name, *, gravity = [0.0, 0.0, -9.81]))]
    fn builder<'py>(
        py: Python<'py>,
        name: &str,
        #[pyo3(from_py_with = triple)] gravity: [f64; 3],
    ) -> PyResult<Bound<'py, PyAny>> {
        let keywords = named!(py, gravity);
        py.import("costate._costate")?.getattr("RobotBuilder")?.call((name,), Some(&keywords))
    }

    /// Order and sign of the joints of a Pinocchio model.
    ///
    /// Parameters
    /// ----------
    /// model : pinocchio.Model
    ///     With one joint for each of ``joint_names``, and no other.
    ///
    /// Returns
    /// -------
    /// JointMap
    ///     It converts q, v and tau.
    ///
    /// Raises
    /// ------
    /// ArgumentError
    ///     Where the joints of the two differ.
    fn map_to<'py>(slf: &Bound<'py, Self>, model: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("costate._pinocchio")?.getattr("JointMap")?.call1((slf, model))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.inner == other.inner
    }

    pub fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.inner.name().hash(&mut hasher);
        self.inner.joints().len().hash(&mut hasher);
        hasher.finish()
    }

    fn __copy__(&self) -> Self {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.clone()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        slf.get().recipe.reduce(slf.get_type())
    }

    fn __repr__(&self) -> String {
        let (name, nq, n) = (robot::printable(self.inner.name()), self.inner.nq(), self.inner.dof());
        let nq = if nq == n { String::new() } else { format!(", nq={nq}") };
        format!("Robot('{name}', n={n}{nq})")
    }

    fn _repr_html_(&self) -> String {
        table::html(&self.inner)
    }
}
