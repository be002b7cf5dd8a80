//! Kernel two: the derivative of kernel one along a direction.

use super::KernelOne;
use super::blocks::Blocks;
use super::pass::{Inward, Outward};
use super::position::{across_joint, unit_momentum};
use super::velocity::AxisRate;
use crate::error::{EvalError, check_length};
use crate::matrix::Matrix;
use crate::robot::{JointKind, Tree};
use crate::scalar::{Pack, Scalar};
use crate::spatial::{Force, Inertia, Motion, Symmetric3, Vec3};
use std::ops::Add;

/// Kernel two: the derivatives D M, D P and D L_qq of kernel one along a direction (dq, dv).
///
/// In body frames `dS = 0`, only the transforms X move: `dX = -(S dq) x X`. By the product rule, X' for the way up,
///
/// ```text
/// dv_i = X dv_parent + S_i dv_i + psi_i dq_i      dpsi_i = dv_i x S_i      dgamma_i = da_g x S_i
/// d(X' f) = X' (df + S dq x* f)                   likewise dIC, dH from the tips inward
/// dF_j = dIC_j S_j        dG_j = dIC_j psi_j + IC_j dpsi_j + S_j x* dH_j
/// D M_ij = S_i . dF_j     D P_ij = S_i . dG_j     D P_ji = dpsi_i . F_j + psi_i . dF_j
/// D L_qq,ij = dpsi_i . G_j + psi_i . dG_j + dgamma_i . F_j + gamma_i . dF_j
/// ```
///
/// for i <= j in tree order: n d scalar products again, and no derivative of a factorisation anywhere. Along (dq, dv) =
/// (v, a) these are the rates of M, P and L_qq in a motion, from which all first derivatives of inverse dynamics follow.
#[derive(Clone, Debug)]
pub struct KernelTwo<S: Scalar> {
    pub(super) dq: Vec<S>,
    pub(super) velocities: Vec<Motion<S>>,
    pub(super) gravity: Vec<Vec3<S>>,
    pub(super) momenta: Vec<Force<S>>,
    pub(super) composites: Vec<Inertia<S>>,
    /// dF_j seen from frame i, in the blocks of kernel one.
    pub(super) forces: Vec<Force<S::Pack>>,
    /// dG_j, likewise.
    pub(super) rates: Vec<Force<S::Pack>>,
    pub(super) mass_matrix: Matrix<S>,
    pub(super) l_vq: Matrix<S>,
    pub(super) l_qq: Matrix<S>,
}

/// `f + (S dq) x* g`.
#[inline(always)]
pub(super) fn moved<S: Scalar>(kind: JointKind, f: Force<S>, g: &Force<S>, dq: S) -> Force<S> {
    let Force { moment: n, force: p } = across_joint(kind, g);
    let mut sum = f;
    sum.moment.x = n.x.mul_add(dq, f.moment.x);
    sum.moment.y = n.y.mul_add(dq, f.moment.y);
    if kind == JointKind::Revolute {
        sum.force.x = p.x.mul_add(dq, f.force.x);
        sum.force.y = p.y.mul_add(dq, f.force.y);
    }
    sum
}

/// `D + S dq x* I - I S dq x`: the change of an inertia whose frame moves back by S dq.
#[inline(always)]
fn moved_inertia<S: Scalar>(kind: JointKind, change: &Inertia<S>, body: &Inertia<S>, dq: S) -> Inertia<S> {
    let (h, j) = (&body.first_moment, &body.matrix);
    let Inertia { mass, first_moment: dh, matrix: d } = *change;
    let double = |a: S| a + a;
    match kind {
        JointKind::Revolute => {
            let twist = double(j.xy * dq);
            Inertia {
                mass,
                first_moment: Vec3::new(h.y.mul_add(-dq, dh.x), h.x.mul_add(dq, dh.y), dh.z),
                matrix: Symmetric3 {
                    xx: d.xx - twist,
                    yy: d.yy + twist,
                    xy: (j.xx - j.yy).mul_add(dq, d.xy),
                    xz: j.yz.mul_add(-dq, d.xz),
                    yz: j.xz.mul_add(dq, d.yz),
                    ..d
                },
            }
        }
        JointKind::Prismatic => {
            let spread = double(h.z * dq);
            Inertia {
                mass,
                first_moment: Vec3::new(dh.x, dh.y, dh.z + dq.times(body.mass)),
                matrix: Symmetric3 {
                    xx: d.xx + spread,
                    yy: d.yy + spread,
                    xz: h.x.mul_add(-dq, d.xz),
                    yz: h.y.mul_add(-dq, d.yz),
                    ..d
                },
            }
        }
    }
}

impl<S: Scalar> KernelTwo<S> {
    /// Buffers for this tree.
    pub fn new(tree: &Tree) -> Self {
        let n = tree.len();
        let (square, zero) = (Matrix::zeros(n, n), Vec3::zero());
        let blocks = Blocks::new(tree, <S::Pack as Pack<S>>::LANES).len();
        let none = Inertia { mass: 0.0, first_moment: zero, matrix: Symmetric3::zero() };
        Self {
            dq: vec![S::zero(); n],
            velocities: vec![Motion::zero(); n],
            gravity: vec![zero; n],
            momenta: vec![Force::zero(); n],
            composites: vec![none; n],
            forces: vec![Force::zero(); blocks],
            rates: vec![Force::zero(); blocks],
            mass_matrix: square.clone(),
            l_vq: square.clone(),
            l_qq: square,
        }
    }

    /// Derivatives at the position and velocity that `kernel` was set to, all three stages, along (dq, dv), n each.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`]. Values are not checked here.
    pub fn differentiate(
        &mut self,
        tree: &Tree,
        kernel: &KernelOne<S>,
        dq: &[S],
        dv: &[S],
    ) -> Result<(), EvalError> {
        check_length("dq", dq, tree.len())?;
        check_length("dv", dv, tree.len())?;
        self.dq.copy_from_slice(dq);
        self.outward(tree, kernel, dv);
        self.inward(tree, kernel);
        self.pairs(tree, kernel);
        Ok(())
    }

    /// `D M`, n x n, symmetric: along (v, a) the rate of the mass matrix.
    pub fn mass_matrix(&self) -> &Matrix<S> {
        &self.mass_matrix
    }

    /// `D P = D L_vq`, n x n.
    pub fn l_vq(&self) -> &Matrix<S> {
        &self.l_vq
    }

    /// `D L_qq`, n x n, symmetric.
    pub fn l_qq(&self) -> &Matrix<S> {
        &self.l_qq
    }

    /// Changes of velocities and gravity, from the world outward.
    fn outward(&mut self, tree: &Tree, kernel: &KernelOne<S>, dv: &[S]) {
        let mut before = Outward::new();
        for (i, joint) in tree.joints().iter().enumerate() {
            let (transform, dq, gravity) = (kernel.transform(tree, i), self.dq[i], kernel.gravity[i]);
            let (mut velocity, mut down) = match joint.parent {
                Some(parent) => {
                    let (velocity, down) = before.of_pair(parent, (&self.velocities, &self.gravity));
                    (transform.motion_down(velocity), transform.vector_down(down))
                }
                None => (Motion::zero(), Vec3::zero()),
            };
            match AxisRate::new(joint.kind, &kernel.velocities[i]) {
                AxisRate::Revolute { angular: [a, b], linear: [c, d] } => {
                    velocity.angular = velocity.angular + Vec3::new(a * dq, b * dq, dv[i]);
                    velocity.linear.x += c * dq;
                    velocity.linear.y += d * dq;
                    down.x += gravity.y * dq;
                    down.y -= gravity.x * dq;
                }
                AxisRate::Prismatic { linear: [c, d] } => {
                    velocity.linear = velocity.linear + Vec3::new(c * dq, d * dq, dv[i]);
                }
            }
            before.leave(i, (velocity, down));
            self.velocities[i] = velocity;
            self.gravity[i] = down;
        }
    }

    /// Changes of momenta and composite inertias, from the tips inward; those of joints on the world where they are read.
    fn inward(&mut self, tree: &Tree, kernel: &KernelOne<S>) {
        for (i, joint) in tree.joints().iter().enumerate() {
            self.momenta[i] = joint.lumped.apply(self.velocities[i]);
            self.composites[i] =
                Inertia { mass: 0.0, first_moment: Vec3::zero(), matrix: Symmetric3::zero() };
        }
        let (mut momenta, mut composites) = (Inward::new(), Inward::new());
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            let momentum = momenta.total(i, &mut self.momenta, Force::add);
            let composite = composites.total(i, &mut self.composites, Inertia::with_moments);
            (self.momenta[i], self.composites[i]) = (momentum, composite);
            let Some(parent) = joint.parent else { continue };
            let (transform, dq) = (kernel.transform(tree, i), self.dq[i]);
            if tree.joints()[parent].parent.is_some() {
                momenta.hand(parent, transform.force_up(moved(joint.kind, momentum, &kernel.momenta[i], dq)));
            }
            let change = moved_inertia(joint.kind, &composite, &kernel.composites[i], dq);
            composites.hand(parent, transform.inertia_up(&change));
        }
    }

    /// `dF_i` and `dG_i` in the frame of joint i.
    #[inline(always)]
    pub(super) fn own(&self, tree: &Tree, kernel: &KernelOne<S>, i: usize) -> [Force<S>; 2] {
        let kind = tree.joints()[i].kind;
        let psi = AxisRate::new(kind, &kernel.velocities[i]);
        let dpsi = AxisRate::new(kind, &self.velocities[i]);
        let rate = psi.momentum(&self.composites[i]) + dpsi.momentum(&kernel.composites[i]);
        [unit_momentum(kind, &self.composites[i]), rate + across_joint(kind, &self.momenta[i])]
    }
}
