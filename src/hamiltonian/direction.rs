//! The direction along which a costate contracts the derivatives of H.

use crate::kernels::friction_of;
use crate::matrix::filled;
use crate::robot::Tree;
use crate::scalar::Scalar;

/// `w = (-y_p, y_q + D_v y_p)`, for which `y'F_x = Hess H w`, and the change V w of the velocity along it.
///
/// Without friction F is J grad H, `y'F = w . grad H`. Friction D(v), v = H_p, adds y_p.D, whose gradient
/// `V' D_v y_p` is Hess H times the shift of w.
#[derive(Clone, Debug)]
pub(super) struct Direction<S> {
    /// w_q, n.
    pub q: Vec<S>,
    /// w_p, n.
    pub p: Vec<S>,
    /// `V w = M^-1 (w_p - P w_q)`, n.
    pub v: Vec<S>,
}

impl<S: Scalar> Direction<S> {
    /// Buffers for n joints.
    pub fn new(n: usize) -> Self {
        let zeros = filled(S::zero(), n);
        Self { q: zeros.clone(), p: zeros.clone(), v: zeros }
    }

    /// Sets the direction of the costate y, 2n.
    pub fn set_costate(&mut self, tree: &Tree, velocity: &[S], y: &[S]) {
        let (y_q, y_p) = y.split_at(tree.dof());
        self.q.iter_mut().zip(y_p).for_each(|(q, &y_p)| *q = -y_p);
        self.p.copy_from_slice(y_q);
        for &i in tree.with_friction() {
            self.p[i] += friction_of(tree, i, velocity[i]).first * y_p[i];
        }
    }
}
