//! Second stage of kernel one: velocities, momenta, and the gradient of the Lagrangian.

use super::KernelOne;
use super::coupling::rates;
use super::pass::{Inward, Outward};
use super::position::along_joint;
use crate::error::{EvalError, check_length};
use crate::robot::{JointKind, Tree};
use crate::scalar::{Pack, Scalar, inlined};
use crate::spatial::{Force, Inertia, Motion, Vec3};
use std::ops::Add;

/// `psi = v x S = dS/dt`: it has no z components, and no angular part for a prismatic joint.
#[derive(Clone, Copy, Debug)]
pub(super) enum AxisRate<S> {
    /// `(w x e_z; v x e_z)`.
    Revolute { angular: [S; 2], linear: [S; 2] },
    /// `(0; w x e_z)`.
    Prismatic { linear: [S; 2] },
}

impl<S: Scalar> AxisRate<S> {
    #[inline(always)]
    pub fn new(kind: JointKind, velocity: &Motion<S>) -> Self {
        let across = |a: Vec3<S>| [a.y, -a.x];
        match kind {
            JointKind::Revolute => {
                Self::Revolute { angular: across(velocity.angular), linear: across(velocity.linear) }
            }
            JointKind::Prismatic => Self::Prismatic { linear: across(velocity.angular) },
        }
    }

    /// The same value in every lane.
    #[inline(always)]
    pub fn splat<P: Pack<S>>(&self) -> AxisRate<P> {
        match *self {
            Self::Revolute { angular, linear } => {
                AxisRate::Revolute { angular: angular.map(P::splat), linear: linear.map(P::splat) }
            }
            Self::Prismatic { linear } => AxisRate::Prismatic { linear: linear.map(P::splat) },
        }
    }

    /// `I psi`: momentum of a body with velocity psi.
    #[inline(always)]
    pub fn momentum(&self, body: &Inertia<S>) -> Force<S> {
        inlined!(S, {
            let (h, i, mass) = (body.first_moment, &body.matrix, body.mass);
            match *self {
                Self::Revolute { angular: [a, b], linear: [c, d] } => Force {
                    moment: Vec3::new(
                        i.xx.mul_add(a, i.xy.mul_add(b, -(h.z * d))),
                        i.xy.mul_add(a, i.yy.mul_add(b, h.z * c)),
                        i.xz.mul_add(a, i.yz * b) + h.x.mul_add(d, -(h.y * c)),
                    ),
                    force: Vec3::new(
                        h.z.mul_add(b, c.times(mass)),
                        (-h.z).mul_add(a, d.times(mass)),
                        h.y.mul_add(a, -(h.x * b)),
                    ),
                },
                Self::Prismatic { linear: [c, d] } => Force {
                    moment: Vec3::new(-(h.z * d), h.z * c, h.x.mul_add(d, -(h.y * c))),
                    force: Vec3::new(c.times(mass), d.times(mass), S::zero()),
                },
            }
        })
    }

    /// `psi . f`.
    #[inline(always)]
    pub fn power(&self, f: &Force<S>) -> S {
        inlined!(
            S,
            match *self {
                Self::Revolute { angular: [a, b], linear: [c, d] } => {
                    a.mul_add(f.moment.x, b * f.moment.y) + c.mul_add(f.force.x, d * f.force.y)
                }
                Self::Prismatic { linear: [c, d] } => c.mul_add(f.force.x, d * f.force.y),
            }
        )
    }
}

/// `a_g . F_j = -V_,j`: power of gravity, in the body frame, on the composite body.
#[inline(always)]
fn weight<S: Scalar>(kind: JointKind, composite: &Inertia<S>, gravity: Vec3<S>) -> S {
    match kind {
        JointKind::Revolute => {
            let h = composite.first_moment;
            h.x.mul_add(gravity.y, -(h.y * gravity.x))
        }
        JointKind::Prismatic => gravity.z.times(composite.mass),
    }
}

impl<S: Scalar> KernelOne<S> {
    /// Computes p = M v and L_q at the position set last and v (rad/s, m/s; length n).
    ///
    /// # Errors
    /// [`EvalError::WrongLength`]. Values are not checked here.
    #[inline(never)]
    pub fn set_velocity(&mut self, tree: &Tree, v: &[S]) -> Result<(), EvalError> {
        check_length("v", v, tree.dof())?;
        rates(tree, v, &mut self.v);
        let bodies = &mut self.bodies[..tree.joints().len()];
        let mut before = Outward::new();
        for (i, (joint, &v)) in tree.joints().iter().zip(&self.v).enumerate() {
            let mut velocity = match joint.parent {
                Some(parent) => {
                    let outer = before.of(parent, bodies, |body| body.velocity);
                    joint.transform_at(bodies[i].position).motion_down(outer)
                }
                None => Motion::zero(),
            };
            match joint.kind {
                JointKind::Revolute => velocity.angular.z += v,
                JointKind::Prismatic => velocity.linear.z += v,
            }
            before.leave(i, velocity);
            bodies[i].velocity = velocity;
            bodies[i].momentum = joint.lumped.apply(velocity);
        }
        let mut inward = Inward::new();
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            let total = inward.total(i, bodies, |body| &mut body.momentum, Force::add);
            bodies[i].momentum = total;
            // For a joint on the fixed base only the component along its axis is needed, see
            // `first_derivatives`.
            if let Some(parent) = joint.parent.filter(|&parent| tree.joints()[parent].parent.is_some()) {
                inward.hand(parent, joint.transform_at(bodies[i].position).force_up(total));
            }
        }
        self.first_derivatives(tree);
        self.momentum.sum(tree);
        self.l_q.sum(tree);
        Ok(())
    }

    /// `p_i = S_i . H_i` (+ armature), `L_q,i = H_i . psi_i + F_i . a_g` (- spring force).
    fn first_derivatives(&mut self, tree: &Tree) {
        for (i, (joint, body)) in tree.joints().iter().zip(&self.bodies).enumerate() {
            self.momentum.all[i] = along_joint(joint.kind, &body.momentum);
            let mut gradient = weight(joint.kind, &body.composite, body.gravity);
            if joint.parent.is_some() {
                gradient += AxisRate::new(joint.kind, &body.velocity).power(&body.momentum);
            } else {
                for body in tree.children(i).iter().map(|&child| &self.bodies[child]) {
                    self.momentum.all[i] += body.momentum.dot(body.root.motion);
                }
            }
            self.l_q.all[i] = gradient;
        }
        for &i in tree.with_spring() {
            let spring = tree.joints()[i].spring;
            self.l_q.all[i] -= self.q[i].plus(-spring.rest).times(spring.stiffness);
        }
        for &(i, j, value) in tree.armature() {
            self.momentum.all[i] += self.v[j].times(value);
            if i != j {
                self.momentum.all[j] += self.v[i].times(value);
            }
        }
    }
}
