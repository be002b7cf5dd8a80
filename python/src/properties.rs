//! What a robot says about itself.

use crate::robot::Robot;
use crate::words::in_python;
use costate::robot::{Joint, Limits};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

impl Robot {
    /// One number for each joint of q.
    fn of_joints<'py>(&self, py: Python<'py>, of: impl Fn(&Joint) -> f64) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.model().independent_joints().map(of))
    }
}

#[pymethods]
impl Robot {
    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        self.model().name()
    }

    /// Number of joints that mimic no other one: the length of v and tau, and of q without quaternions.
    #[getter]
    fn n(&self) -> usize {
        self.model().dof()
    }

    /// Number of entries of q: n, and one more for each quaternion.
    #[getter]
    fn nq(&self) -> usize {
        self.model().nq()
    }

    /// Number of entries of v, p, tau and of directions of q; the same as ``n``.
    #[getter]
    fn nv(&self) -> usize {
        self.model().dof()
    }

    /// The floating and spherical joints: name, ``"floating"`` or ``"spherical"``, and the indices of its
    /// first entries of q and of v.
    #[getter]
    fn free_joints(&self) -> Vec<(&str, &str, usize, usize)> {
        let all = self.model().free_joints().iter();
        all.map(|free| (free.name.as_str(), free.kind.name(), free.position, free.coordinate)).collect()
    }

    /// The joints of v and tau, in their order, and of q where it has no quaternions.
    ///
    /// A floating joint NAME stands here as ``NAME_x``, ``NAME_y``, ``NAME_z``, ``NAME_rx``, ``NAME_ry``,
    /// ``NAME``, a spherical one as the last three.
    #[getter]
    fn joint_names(&self) -> Vec<&str> {
        self.model().independent_joints().map(|joint| joint.name.as_str()).collect()
    }

    /// All joints, with those that mimic others.
    #[getter]
    fn all_joint_names(&self) -> Vec<&str> {
        self.model().joints().iter().map(|joint| joint.name.as_str()).collect()
    }

    /// For each of ``all_joint_names`` the joint before it in the tree; None for one on the base.
    #[getter]
    fn parents(&self) -> Vec<Option<&str>> {
        let joints = self.model().joints();
        joints.iter().map(|joint| joint.parent.map(|parent| joints[parent].name.as_str())).collect()
    }

    /// ``"revolute"`` or ``"prismatic"``, for each of ``joint_names``; for parts of free joints too.
    #[getter]
    fn joint_kinds(&self) -> Vec<&str> {
        self.model().independent_joints().map(|joint| joint.kind.name()).collect()
    }

    /// The frames: the world, then those of joints, of links, and added ones.
    ///
    /// A name that several frames have stands here for each of them, such as ``"world"`` of a robot whose
    /// base link has this name. It means the added one, else that of the link, else that of the joint;
    /// ``"link:NAME"`` and ``"joint:NAME"`` say which.
    #[getter]
    fn frame_names(&self) -> Vec<&str> {
        self.model().frames().iter().map(|frame| frame.name.as_str()).collect()
    }

    /// Gravity in the world (3) in m/s^2.
    #[getter]
    fn gravity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.model().gravity().as_slice())
    }

    /// Mass of all links that move (kg).
    #[getter]
    fn mass(&self) -> f64 {
        self.model().joints().iter().map(|joint| joint.inertia.mass).sum()
    }

    /// The armature matrix: a row for each of ``all_joint_names`` (kg m^2, kg).
    #[getter]
    fn armature<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let matrix = self.model().armature_matrix();
        let rows: Vec<Vec<f64>> = matrix.row_iter().map(|row| row.iter().copied().collect()).collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }

    /// Smallest and largest q (2, n) in rad, m, for each of ``joint_names``; infinite where there is no
    /// limit, as for free joints.
    #[getter]
    fn position_limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let of = |side: fn(&Limits) -> f64| -> Vec<f64> {
            self.model().independent_joints().map(|joint| side(&joint.limits)).collect()
        };
        Ok(PyArray2::from_vec2(py, &[of(|limits| limits.lower), of(|limits| limits.upper)])?)
    }

    /// Largest speeds (n) in rad/s, m/s.
    #[getter]
    fn velocity_limits<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.of_joints(py, |joint| joint.limits.velocity)
    }

    /// Largest torques (n) in N m, N.
    #[getter]
    fn effort_limits<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.of_joints(py, |joint| joint.limits.effort)
    }

    /// What is unusual about it.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.model().warnings().iter().map(|warning| in_python(&warning.to_string())).collect()
    }
}
