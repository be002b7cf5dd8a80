//! Kernel two: the derivative of kernel one along a direction.

use super::KernelOne;
use super::blocks::Blocks;
use super::coupling::{Coupled, Spread};
use super::pass::{Inward, Outward};
use super::position::{across_joint, unit_momentum};
use super::velocity::AxisRate;
use crate::error::{EvalError, check_length};
use crate::matrix::{Matrix, filled};
use crate::robot::{JointKind, Tree};
use crate::scalar::{Pack, Scalar, inlined};
use crate::spatial::{Force, Inertia, Motion, Symmetric3, Vec3};
use std::ops::Add;

/// Kernel two: the derivatives D M, D P and D L_qq of kernel one along a direction (dq, dv).
///
/// In body frames `dS = 0`, only the transforms X move: `dX = -(S dq) x X`. By the product rule, X' for the
/// way up,
///
/// ```text
/// dv_i = X dv_parent + S_i dv_i + psi_i dq_i      dpsi_i = dv_i x S_i      dgamma_i = da_g x S_i
/// d(X' f) = X' (df + S dq x* f)                   likewise dIC, dH from the tips inward
/// dF_j = dIC_j S_j        dG_j = dIC_j psi_j + IC_j dpsi_j + S_j x* dH_j
/// D M_ij = S_i . dF_j     D P_ij = S_i . dG_j     D P_ji = dpsi_i . F_j + psi_i . dF_j
/// D L_qq,ij = dpsi_i . G_j + psi_i . dG_j + dgamma_i . F_j + gamma_i . dF_j
/// ```
///
/// for i <= j in tree order: n d scalar products again; no factorisation is differentiated. Along (dq, dv) =
/// (v, a) these are the rates of M, P and L_qq in a motion, from which all first derivatives of inverse
/// dynamics follow.
#[derive(Clone, Debug)]
pub struct KernelTwo<S: Scalar> {
    pub(super) bodies: Vec<Change<S>>,
    /// dF_j in frame i, in the blocks of kernel one.
    pub(super) forces: Vec<Force<S::Pack>>,
    /// dG_j, likewise.
    pub(super) rates: Vec<Force<S::Pack>>,
    pub(super) mass_matrix: Coupled<Matrix<S>>,
    pub(super) l_vq: Coupled<Matrix<S>>,
    pub(super) l_qq: Coupled<Matrix<S>>,
    /// dq and dv of all joints.
    along: [Spread<S>; 2],
}

/// Changes of the quantities in a [`Body`](super::Body), in the frame of the joint, which moves by S dq.
#[derive(Clone, Copy, Debug)]
pub(super) struct Change<S> {
    pub dq: S,
    pub velocity: Motion<S>,
    pub gravity: Vec3<S>,
    pub momentum: Force<S>,
    pub composite: Inertia<S>,
}

/// `f + (S dq) x* g`.
#[inline(always)]
pub(super) fn moved<S: Scalar>(kind: JointKind, f: Force<S>, g: &Force<S>, dq: S) -> Force<S> {
    inlined!(S, {
        let Force { moment: n, force: p } = across_joint(kind, g);
        let mut sum = f;
        sum.moment.x = n.x.mul_add(dq, f.moment.x);
        sum.moment.y = n.y.mul_add(dq, f.moment.y);
        if kind == JointKind::Revolute {
            sum.force.x = p.x.mul_add(dq, f.force.x);
            sum.force.y = p.y.mul_add(dq, f.force.y);
        }
        sum
    })
}

/// `D + S dq x* I - I S dq x`: the change of an inertia whose frame moves by -S dq.
#[inline(always)]
fn moved_inertia<S: Scalar>(kind: JointKind, change: &Inertia<S>, body: &Inertia<S>, dq: S) -> Inertia<S> {
    inlined!(S, {
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
    })
}

impl<S: Scalar> KernelTwo<S> {
    /// Buffers for a tree.
    #[inline(never)]
    pub fn new(tree: &Tree) -> Self {
        let (n, zero) = (tree.joints().len(), Vec3::zero());
        let blocks = Blocks::new(tree, <S::Pack as Pack<S>>::LANES).len();
        let still = Change {
            dq: S::zero(),
            velocity: Motion::zero(),
            gravity: zero,
            momentum: Force::zero(),
            composite: Inertia { mass: 0.0, first_moment: zero, matrix: Symmetric3::zero() },
        };
        Self {
            bodies: filled(still, n),
            forces: filled(Force::zero(), blocks),
            rates: filled(Force::zero(), blocks),
            mass_matrix: Coupled::square(tree),
            l_vq: Coupled::square(tree),
            l_qq: Coupled::square(tree),
            along: [Spread::new(tree), Spread::new(tree)],
        }
    }

    /// Derivatives along (dq, dv), n each, at the state of `kernel`, which must have passed all three stages.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`]. Values are not checked here.
    #[inline(never)]
    pub fn differentiate(
        &mut self,
        tree: &Tree,
        kernel: &KernelOne<S>,
        dq: &[S],
        dv: &[S],
    ) -> Result<(), EvalError> {
        check_length("dq", dq, tree.dof())?;
        check_length("dv", dv, tree.dof())?;
        self.outward(tree, kernel, dq, dv);
        self.inward(tree, kernel);
        self.pairs(tree, kernel);
        self.mass_matrix.sum_symmetric(tree);
        self.l_vq.sum(tree);
        self.l_qq.sum_symmetric(tree);
        Ok(())
    }

    /// `D M`, n x n, symmetric: along (v, a) the rate of the mass matrix.
    pub fn mass_matrix(&self) -> &Matrix<S> {
        self.mass_matrix.get()
    }

    /// `D P = D L_vq`, n x n.
    pub fn l_vq(&self) -> &Matrix<S> {
        self.l_vq.get()
    }

    /// `D L_qq`, n x n, symmetric.
    pub fn l_qq(&self) -> &Matrix<S> {
        self.l_qq.get()
    }

    /// Changes of velocities and gravity, from the base outward.
    fn outward(&mut self, tree: &Tree, kernel: &KernelOne<S>, dq: &[S], dv: &[S]) {
        let [along_q, along_v] = &mut self.along;
        let (dq, dv) = (along_q.rates(tree, dq), along_v.rates(tree, dv));
        let bodies = &mut self.bodies[..tree.joints().len()];
        let mut before = Outward::new();
        for (i, ((joint, body), (&dq, &dv))) in
            tree.joints().iter().zip(&kernel.bodies).zip(dq.iter().zip(dv)).enumerate()
        {
            let (mut velocity, mut down) = match joint.parent {
                Some(parent) => {
                    let (velocity, down) =
                        before.of(parent, bodies, |change: &Change<S>| (change.velocity, change.gravity));
                    let transform = joint.transform_at(body.position);
                    (transform.motion_down(velocity), transform.vector_down(down))
                }
                None => (Motion::zero(), Vec3::zero()),
            };
            match AxisRate::new(joint.kind, &body.velocity) {
                AxisRate::Revolute { angular: [a, b], linear: [c, d] } => {
                    velocity.angular = velocity.angular + Vec3::new(a * dq, b * dq, dv);
                    velocity.linear.x += c * dq;
                    velocity.linear.y += d * dq;
                    down.x += body.gravity.y * dq;
                    down.y -= body.gravity.x * dq;
                }
                AxisRate::Prismatic { linear: [c, d] } => {
                    velocity.linear = velocity.linear + Vec3::new(c * dq, d * dq, dv);
                }
            }
            before.leave(i, (velocity, down));
            bodies[i] = Change {
                dq,
                velocity,
                gravity: down,
                momentum: joint.lumped.apply(velocity),
                composite: Inertia { mass: 0.0, first_moment: Vec3::zero(), matrix: Symmetric3::zero() },
            };
        }
    }

    /// Changes of momenta and composite inertias, from the tips inward; for joints on the fixed base where
    /// they are needed.
    fn inward(&mut self, tree: &Tree, kernel: &KernelOne<S>) {
        let bodies = &mut self.bodies[..tree.joints().len()];
        let (mut momenta, mut composites) = (Inward::new(), Inward::new());
        for (i, (joint, body)) in tree.joints().iter().zip(&kernel.bodies).enumerate().rev() {
            let momentum = momenta.total(i, bodies, |change| &mut change.momentum, Force::add);
            let composite =
                composites.total(i, bodies, |change| &mut change.composite, Inertia::with_moments);
            (bodies[i].momentum, bodies[i].composite) = (momentum, composite);
            let Some(parent) = joint.parent else { continue };
            let (transform, dq) = (joint.transform_at(body.position), bodies[i].dq);
            if tree.joints()[parent].parent.is_some() {
                momenta.hand(parent, transform.force_up(moved(joint.kind, momentum, &body.momentum, dq)));
            }
            let change = moved_inertia(joint.kind, &composite, &body.composite, dq);
            composites.hand(parent, transform.inertia_up(&change));
        }
    }

    /// `dF_i` and `dG_i` in the frame of joint i.
    #[inline(always)]
    pub(super) fn own(&self, tree: &Tree, kernel: &KernelOne<S>, i: usize) -> [Force<S>; 2] {
        let kind = tree.joints()[i].kind;
        let (body, change) = (&kernel.bodies[i], &self.bodies[i]);
        let psi = AxisRate::new(kind, &body.velocity);
        let dpsi = AxisRate::new(kind, &change.velocity);
        let rate = psi.momentum(&change.composite) + dpsi.momentum(&body.composite);
        [unit_momentum(kind, &change.composite), rate + across_joint(kind, &change.momentum)]
    }
}
