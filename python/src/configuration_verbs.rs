//! The methods of `Robot` that are functions of configurations.

use crate::configuration::Verb;
use crate::function::Settings;
use crate::methods::verbs;
use crate::robot::Robot;
use costate::configuration::ConfigurationSpace;
use numpy::PyArray1;
use pyo3::prelude::*;

impl Robot {
    fn configure<'py, const N: usize>(
        &self,
        py: Python<'py>,
        verb: Verb,
        arguments: [&Bound<'py, PyAny>; N],
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.functions.of(&self.shared(), verb).call(py, arguments, out, Settings::default())
    }
}

#[pymethods]
impl Robot {
    /// The configuration at zero: all positions 0, all rotations the identity.
    ///
    /// Returns
    /// -------
    /// ndarray (nq)
    ///     In rad, m; quaternions (0, 0, 0, 1).
    fn neutral<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, ConfigurationSpace::new(self.model()).neutral())
    }
}

verbs! {
    impl Robot with plain;

    /// The configuration q (+) d: q moved by d, and the sum q + d where no joint is floating or spherical.
    ///
    /// Such a joint moves by the exponential of d in the axes of the moved frame, as in Pinocchio: a body
    /// with velocity v is at q (+) v dt after the time dt.
    integrate(q: q, d: step) -> one
        "ndarray (..., nq)\n    In rad, m; quaternions of length 1."
        = configure Verb::Integrate;

    /// The smallest direction d with q_1 = q_0 (+) d.
    difference(q_0: from, q_1: to) -> one
        "ndarray (..., n)\n    In rad, m; angular parts of at most pi."
        = configure Verb::Difference;

    /// The Jacobians of q (+) d in tangent spaces; they do not depend on q.
    integrate_jacobians(d: step) -> several
        "by_q : ndarray (..., n, n)\n    By q, in its tangent space.\nby_d : ndarray (..., n, n)\n    By d."
        = configure Verb::IntegrateJacobians;

    /// The Jacobians of the difference of q_0 and q_1 in their tangent spaces.
    difference_jacobians(q_0: from, q_1: to) -> several
        "by_q_0 : ndarray (..., n, n)\n    By q_0.\nby_q_1 : ndarray (..., n, n)\n    By q_1."
        = configure Verb::DifferenceJacobians;

    /// The configuration with quaternions of length 1: each is divided by its length.
    normalize(q: raw) -> one
        "ndarray (..., nq)\n    Positions (rad, m) unchanged."
        = configure Verb::Normalize;
}
