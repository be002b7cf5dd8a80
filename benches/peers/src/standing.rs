//! Quantities of a robot that stands on some of its links.

use crate::quantities::{Quantity, State, put};
use crate::workspaces::{Size, Workspaces};
use costate::EvalError;
use costate::constraints::{ConstrainedContraction, ConstrainedLinearisation};
use std::ffi::CStr;

/// F and F_x with the forces of the ground and mu_x.
pub struct Contact;

impl Quantity for Contact {
    type Result<'a> = ConstrainedLinearisation<'a, f64>;
    const NAME: &'static CStr = c"contact:costate";
    fn length(size: Size) -> usize {
        (size.n + size.k) * (size.n + 1)
    }
    #[inline(always)]
    fn evaluate<'a>(w: &'a mut Workspaces, x: &State<'_>) -> Result<Self::Result<'a>, EvalError> {
        w.standing.first().linearise(x.q, x.p, x.u)
    }
    /// a, the forces, and their Jacobians in u, which are those of v and mu in p.
    fn write(linear: Self::Result<'_>, out: &mut Vec<f64>) {
        let n = linear.acceleration().len();
        out.extend_from_slice(linear.acceleration());
        out.extend_from_slice(linear.lambda());
        let (f_x, mu_x) = (linear.matrix(), linear.mu_x());
        let rows = f_x.iter_rows().take(n).chain(mu_x.iter_rows());
        rows.for_each(|row| out.extend_from_slice(&row[n..]));
    }
}

/// The same with y'F_xx.
pub struct ContactHessian;

impl Quantity for ContactHessian {
    type Result<'a> = ConstrainedContraction<'a, f64>;
    const NAME: &'static CStr = c"contact_xx:costate";
    fn length(size: Size) -> usize {
        4 * size.n * size.n
    }
    #[inline(always)]
    fn evaluate<'a>(w: &'a mut Workspaces, x: &State<'_>) -> Result<Self::Result<'a>, EvalError> {
        w.standing.contract(x.q, x.p, x.u, x.y)
    }
    fn write(all: Self::Result<'_>, out: &mut Vec<f64>) {
        put(all.matrix(), out);
    }
}
