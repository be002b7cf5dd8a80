//! Second stage of kernel one: velocities, momenta, and the gradient of the Lagrangian.

use super::KernelOne;
use super::position::along_joint;
use crate::error::{EvalError, check_length};
use crate::robot::{JointKind, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Force, Inertia, Motion, Vec3};

/// `psi = v x S = dS/dt`: its parts have no z component, and a prismatic axis does not turn anything.
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

    /// `I psi`: momentum of a body that moves by psi.
    #[inline(always)]
    pub fn momentum(&self, body: &Inertia<S>) -> Force<S> {
        let (h, i, mass) = (body.first_moment, &body.matrix, body.mass);
        match *self {
            Self::Revolute { angular: [a, b], linear: [c, d] } => Force {
                moment: Vec3::new(
                    i.xx * a + i.xy * b - h.z * d,
                    i.xy * a + i.yy * b + h.z * c,
                    i.xz * a + i.yz * b + h.x * d - h.y * c,
                ),
                force: Vec3::new(c.times(mass) + h.z * b, d.times(mass) - h.z * a, h.y * a - h.x * b),
            },
            Self::Prismatic { linear: [c, d] } => Force {
                moment: Vec3::new(-(h.z * d), h.z * c, h.x * d - h.y * c),
                force: Vec3::new(c.times(mass), d.times(mass), S::zero()),
            },
        }
    }

    /// `psi . f`.
    #[inline(always)]
    pub fn power(&self, f: &Force<S>) -> S {
        match *self {
            Self::Revolute { angular: [a, b], linear: [c, d] } => {
                a * f.moment.x + b * f.moment.y + c * f.force.x + d * f.force.y
            }
            Self::Prismatic { linear: [c, d] } => c * f.force.x + d * f.force.y,
        }
    }
}

/// `a_g . F_j = -V_,j`: what gravity, seen from the body frame, does on the composite body.
#[inline(always)]
fn weight<S: Scalar>(kind: JointKind, composite: &Inertia<S>, gravity: Vec3<S>) -> S {
    match kind {
        JointKind::Revolute => composite.first_moment.x * gravity.y - composite.first_moment.y * gravity.x,
        JointKind::Prismatic => gravity.z.times(composite.mass),
    }
}

impl<S: Scalar> KernelOne<S> {
    /// Computes p = M v and L_q at the position set last and v (rad/s, m/s; length n).
    ///
    /// # Errors
    /// [`EvalError::WrongLength`]. Values are not checked here.
    pub fn set_velocity(&mut self, tree: &Tree, v: &[S]) -> Result<(), EvalError> {
        check_length("v", v, tree.len())?;
        self.v.copy_from_slice(v);
        for (i, joint) in tree.joints().iter().enumerate() {
            let mut velocity = match joint.parent {
                Some(parent) => self.transforms[i].motion_down(self.velocities[parent]),
                None => Motion::zero(),
            };
            match joint.kind {
                JointKind::Revolute => velocity.angular.z += v[i],
                JointKind::Prismatic => velocity.linear.z += v[i],
            }
            self.velocities[i] = velocity;
            self.momenta[i] = joint.lumped.apply(velocity);
        }
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            // That of a joint on the world is only asked for along its axis, see `first_derivatives`.
            if let Some(parent) = joint.parent.filter(|&parent| tree.joints()[parent].parent.is_some()) {
                self.momenta[parent] = self.momenta[parent] + self.transforms[i].force_up(self.momenta[i]);
            }
        }
        self.first_derivatives(tree, v);
        Ok(())
    }

    /// `p_i = S_i . H_i` (+ armature), `L_q,i = H_i . psi_i + F_i . a_g` (- spring force).
    fn first_derivatives(&mut self, tree: &Tree, v: &[S]) {
        for (i, joint) in tree.joints().iter().enumerate() {
            let momentum = &self.momenta[i];
            self.momentum[i] = along_joint(joint.kind, momentum);
            let mut gradient = weight(joint.kind, &self.composites[i], self.gravity[i]);
            if joint.parent.is_some() {
                gradient += AxisRate::new(joint.kind, &self.velocities[i]).power(momentum);
            } else {
                for &child in tree.children(i) {
                    self.momentum[i] += self.momenta[child].dot(self.roots[child].motion);
                }
            }
            if joint.spring.stiffness != 0.0 {
                gradient -= self.q[i].plus(-joint.spring.rest).times(joint.spring.stiffness);
            }
            self.l_q[i] = gradient;
        }
        for &(i, j, value) in tree.armature() {
            self.momentum[i] += v[j].times(value);
            if i != j {
                self.momentum[j] += v[i].times(value);
            }
        }
    }
}
