//! The contracted Hessian of inverse dynamics by one dual pass through kernels one and two.

use super::Lagrangian;
use super::inverse::{torque, torque_jacobian};
use crate::error::EvalError;
use crate::kernels::{KernelOne, KernelTwo, TorqueContraction, TorqueHessian};
use crate::matrix::{Matrix, filled};
use crate::robot::Tree;
use crate::scalar::{Scalar, Tangent};

/// How the Hessian of w.tau is computed.
#[derive(Clone, Debug)]
pub(super) enum Pass<S: Scalar> {
    /// As scalar products of pairs of joints, in the axes of the world.
    World(Box<TorqueContraction<S>>),
    Dual(Box<DualPass<S>>),
}

/// The dual pass, for robots without floating and spherical joints.
///
/// For constant w, the power `w.tau` of inverse dynamics consists of directional derivatives of L:
///
/// ```text
/// w.tau(q, v, a) = L''[(v, a), (0, w)] - L'[(w, 0)] - w.D ,
/// ```
///
/// so with `A = D_(0,w) L_qq`, `B = D_(0,w) P` (kernel one by a dual number along (0, w)) and the derivatives
/// `E = D_(0,w) D_(v,a) - D_(w,0)` of M, P and L_qq (kernel two along (v, a), by the same dual number, with
/// the direction's own derivative (-w, 0)), one pass gives its Hessian in (q, v, a):
///
/// $$ (w \cdot \tau)\_{zz} = \begin{pmatrix} E\_{L\_{qq}} & (E\_P + A)^T & B^T \\\\
/// E\_P + A & E\_M + B + B^T - w D\_{vv} & 0 \\\\ B & 0 & 0 \end{pmatrix} $$
///
/// The real parts of the same pass are kernel one at (q, v) and kernel two along (v, a): they give tau and
/// its Jacobian.
#[derive(Clone, Debug)]
pub(super) struct DualPass<S: Scalar> {
    kernel: KernelOne<Tangent<S>>,
    along: KernelTwo<Tangent<S>>,
    q: Vec<Tangent<S>>,
    v: Vec<Tangent<S>>,
    direction_q: Vec<Tangent<S>>,
    direction_v: Vec<Tangent<S>>,
    /// M, its real part.
    pub mass_matrix: Matrix<S>,
}

impl<S: Scalar> DualPass<S> {
    #[inline(never)]
    pub fn new(tree: &Tree) -> Self {
        let (n, zero) = (tree.dof(), Tangent::zero());
        Self {
            kernel: KernelOne::new(tree),
            along: KernelTwo::new(tree),
            q: filled(zero, n),
            v: filled(zero, n),
            direction_q: filled(zero, n),
            direction_v: filled(zero, n),
            mass_matrix: Matrix::zeros(n, n),
        }
    }

    /// The pass at q and (v, a), as `rate`, for the weights w. Fills the Hessian without friction and
    /// wrenches, and the Jacobian of inverse dynamics in `first`.
    #[inline(never)]
    pub fn contract(
        &mut self,
        first: &mut Lagrangian<S>,
        q: &[S],
        w: &[S],
        hessian: &mut TorqueHessian<S>,
    ) -> Result<(), EvalError> {
        let Lagrangian { tree, rate, tau_q, tau_v, .. } = first;
        let (v, a) = rate.split_at(tree.dof());
        for i in 0..v.len() {
            self.q[i] = Tangent::new(q[i], S::zero());
            self.v[i] = Tangent::new(v[i], w[i]);
            self.direction_q[i] = Tangent::new(v[i], -w[i]);
            self.direction_v[i] = Tangent::new(a[i], S::zero());
        }
        self.kernel.set_position(tree, &self.q)?;
        self.kernel.set_velocity(tree, &self.v)?;
        self.kernel.second_order(tree);
        self.along.differentiate(tree, &self.kernel, &self.direction_q, &self.direction_v)?;
        self.fill(hessian);
        torque_jacobian(tree, (&self.kernel, &self.along), |entry| entry.re, v, (tau_q, tau_v));
        first.subtract_wrench_slopes(q);
        first.pack_torque();
        Ok(())
    }

    /// The blocks of the Hessian.
    fn fill(&self, hessian: &mut TorqueHessian<S>) {
        let (n, TorqueHessian { qq, vv, vq, aq }) = (self.q.len(), hessian);
        let (p, l_qq) = (self.kernel.l_vq(), self.kernel.l_qq());
        let (e_m, e_p, e_l_qq) = (self.along.mass_matrix(), self.along.l_vq(), self.along.l_qq());
        for i in 0..n {
            for j in 0..n {
                qq.set(i, j, e_l_qq[(i, j)].eps);
                vv.set(i, j, e_m[(i, j)].eps + (p[(i, j)].eps + p[(j, i)].eps));
                vq.set(i, j, e_p[(i, j)].eps + l_qq[(i, j)].eps);
                aq.set(i, j, p[(i, j)].eps);
            }
        }
    }

    /// Fills tau and M from the real parts of the last pass.
    pub fn take_torque(&mut self, first: &mut Lagrangian<S>, q: &[S]) {
        let all = self.kernel.mass_matrix();
        for i in 0..q.len() {
            let row = self.mass_matrix.row_mut(i).iter_mut().zip(all.row(i));
            row.for_each(|(entry, m)| *entry = m.re);
        }
        let Lagrangian { tree, rate, tau, .. } = first;
        torque(tree, &self.kernel, |entry| entry.re, rate.split_at(q.len()), tau);
        first.subtract_wrenches(q);
    }
}
