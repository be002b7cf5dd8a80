//! Constraints of a robot: those it has, one more, none.

use crate::descriptions::triple;
use crate::errors::argument;
use crate::recipe::named;
use crate::robot::Robot;
use costate::robot::{ConstraintRow, ConstraintSpec, Placement};
use pyo3::prelude::*;
use pyo3::types::PyDict;

#[pymethods]
impl Robot {
    /// The constraints that close its loops, in their order.
    #[getter]
    fn constraint_names(&self) -> Vec<&str> {
        self.model().constraints().iter().map(|one| one.name.as_str()).collect()
    }

    /// The open tree: the robot without its constraints.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     Another robot; this one does not change.
    fn without_constraints(&self, py: Python<'_>) -> PyResult<Self> {
        self.changed(py, "without_constraints", PyDict::new(py), |robot| Ok(robot.without_constraints()))
    }

    /// The robot with one more constraint: some functions g(q) stay what they are.
    ///
    /// r is the origin of the first frame in the axes of the second, psi twice the vector of the quaternion
    /// of its orientation there, an angle where it is small. Rows choose what a joint of the loop leaves
    /// free: ``["x", "y"]`` closes a planar loop, ``["x", "y", "z", "turn_x", "turn_y"]`` is a revolute joint
    /// about z.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Its name.
    /// frame, to : str, optional
    ///     The first frame, and the second one, which is the world unless given.
    /// kind : {"rows", "pinned", "rigid", "distance", "coupling"}
    ///     Entries of r (m) and psi (rad) that ``rows`` names; r; r and psi; (r.r - length^2) / (2 length)
    ///     (m); the sum of factor q_joint, less a constant.
    /// rows : list of str, optional
    ///     Some of ``"x"``, ``"y"``, ``"z"``, ``"turn_x"``, ``"turn_y"``, ``"turn_z"``.
    /// length : float, optional
    ///     Of a distance (m).
    /// joints : dict, optional
    ///     Of a coupling: factors by names of joints.
    /// constant : float
    ///     Of a coupling (rad, m).
    /// xyz, rpy : sequence of float
    ///     Displaces the first frame (m; rad, fixed axes).
    /// to_xyz, to_rpy : sequence of float
    ///     Displaces the second frame.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     Another robot, for `ConstrainedDynamics`; this one does not change.
    ///
    /// Raises
    /// ------
    /// ArgumentError
    ///     For another kind or row, and for what a kind needs or does not have.
    /// RobotError
    ///     For an unknown frame or joint, and for what cannot be held.
    #[pyo3(signature = (name, frame = None, to = None, *, kind = "rows", rows = None, length = None,
        joints = None, constant = 0.0, xyz = [0.0; 3], rpy = [0.0; 3], to_xyz = [0.0; 3], to_rpy = [0.0; 3]))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn with_constraint(
        &self,
        py: Python<'_>,
        name: String,
        frame: Option<String>,
        to: Option<String>,
        kind: &str,
        rows: Option<Vec<String>>,
        length: Option<f64>,
        joints: Option<&Bound<'_, PyDict>>,
        constant: f64,
        #[pyo3(from_py_with = triple)] xyz: [f64; 3],
        #[pyo3(from_py_with = triple)] rpy: [f64; 3],
        #[pyo3(from_py_with = triple)] to_xyz: [f64; 3],
        #[pyo3(from_py_with = triple)] to_rpy: [f64; 3],
    ) -> PyResult<Self> {
        let joints = joints.map(|joints| joints.copy()).transpose()?;
        let arguments =
            named!(py, name, frame, to, kind, rows, length, joints, constant, xyz, rpy, to_xyz, to_rpy);
        let given = [
            ("frame", frame.is_some() || to.is_some()),
            ("rows", rows.is_some()),
            ("length", length.is_some()),
            ("joints", joints.is_some()),
        ];
        let takes: &[&str] = match kind {
            "rows" => &["frame", "rows"],
            "pinned" | "rigid" => &["frame"],
            "distance" => &["frame", "length"],
            "coupling" => &["joints"],
            _ => {
                let message = format!(
                    "unknown kind '{kind}'; give 'rows', 'pinned', 'rigid', 'distance' or 'coupling'"
                );
                return Err(argument(py, "kind", message));
            }
        };
        for (what, is_given) in given {
            if takes.contains(&what) != is_given {
                let verb = if is_given { "has no" } else { "needs" };
                return Err(argument(py, what, format!("a constraint of the kind '{kind}' {verb} {what}")));
            }
        }
        let displaced = [xyz, rpy, to_xyz, to_rpy] != [[0.0; 3]; 4];
        let odd = match kind {
            "coupling" if displaced => Some(("xyz", "has no frames to displace")),
            "coupling" => None,
            _ if constant != 0.0 => Some(("constant", "has no constant")),
            _ if frame.is_none() => Some(("frame", "needs its first frame")),
            _ => None,
        };
        if let Some((what, words)) = odd {
            return Err(argument(py, what, format!("a constraint of the kind '{kind}' {words}")));
        }
        let (first, second) = (frame.unwrap_or_default(), to.unwrap_or_else(|| "world".into()));
        let spec = match kind {
            "rows" => ConstraintSpec::rows(name, &first, &second, &rows_of(py, rows.unwrap_or_default())?),
            "pinned" => ConstraintSpec::pinned(name, &first, &second),
            "rigid" => ConstraintSpec::rigid(name, &first, &second),
            "distance" => ConstraintSpec::distance(name, &first, &second, length.unwrap_or_default()),
            _ => {
                let terms: Vec<(String, f64)> = match joints {
                    Some(joints) => {
                        joints.iter().map(|(joint, factor)| Ok((joint.extract()?, factor.extract()?)))
                    }
                    None => return Err(argument(py, "joints", "a coupling needs joints".into())),
                }
                .collect::<PyResult<_>>()?;
                let terms: Vec<(&str, f64)> =
                    terms.iter().map(|(joint, factor)| (joint.as_str(), *factor)).collect();
                ConstraintSpec::coupling(name, &terms, constant)
            }
        };
        let spec =
            spec.placed(Placement::from_xyz_rpy(xyz, rpy)).to_placed(Placement::from_xyz_rpy(to_xyz, to_rpy));
        self.changed(py, "with_constraint", arguments, |robot| robot.with_constraint(spec))
    }
}

fn rows_of(py: Python<'_>, names: Vec<String>) -> PyResult<Vec<ConstraintRow>> {
    let row = |name: String| {
        ConstraintRow::ALL.into_iter().find(|row| row.name() == name).ok_or_else(|| {
            let all = ConstraintRow::ALL.map(ConstraintRow::name).join(", ");
            let name = costate::robot::printable(&name).to_string();
            argument(py, "rows", format!("there is no row '{name}'; the rows are {all}"))
        })
    };
    names.into_iter().map(row).collect()
}
