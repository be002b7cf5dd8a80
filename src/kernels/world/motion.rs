//! Velocities, accelerations and forces in the axes of the world: inverse dynamics.

use super::WorldKernel;
use super::group::{Group, add_force, along_axis, force_lane, motion_lane, set_motion};
use crate::robot::{JointKind, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Force, Motion, Vec3};

impl<S: Scalar> WorldKernel<S> {
    /// Velocities, accelerations with the base accelerated against gravity, and the force on each link,
    /// `I a + v x* I v`, at the position set last; v and a have length n, a is zero where there is none.
    ///
    /// The axes of a joint with several degrees of freedom are fixed to its link: with the velocity v_o of
    /// the link before it, psi_k is `v_o x S_k` for each, and the link accelerates by `a_o + sum (S_k a_k +
    /// psi_k v_k)`.
    #[inline(never)]
    pub fn set_motion(&mut self, tree: &Tree, v: &[S], a: Option<&[S]>) {
        let mut outer = Motion::zero();
        for (k, place) in self.places.iter().enumerate() {
            let joint = &self.joints[k];
            let (z, arm, rate) = (joint.axes[2], joint.arm, place.rate(v));
            let (mut velocity, mut acceleration) = match place.parent.map(|parent| &self.joints[parent]) {
                Some(outer) => (moved(outer.velocity, arm), moved(outer.acceleration, arm)),
                None => (Motion::zero(), against_gravity(tree)),
            };
            outer = if k > place.first { moved(outer, arm) } else { velocity };
            let psi = across(place.kind, outer, z);
            match place.kind {
                JointKind::Revolute => {
                    velocity.angular = velocity.angular.plus_scaled(z, rate);
                    acceleration.angular = acceleration.angular.plus_scaled(psi.angular, rate);
                    if let Some(a) = a {
                        acceleration.angular = acceleration.angular.plus_scaled(z, place.rate(a));
                    }
                }
                JointKind::Prismatic => {
                    velocity.linear = velocity.linear.plus_scaled(z, rate);
                    if let Some(a) = a {
                        acceleration.linear = acceleration.linear.plus_scaled(z, place.rate(a));
                    }
                }
            }
            acceleration.linear = acceleration.linear.plus_scaled(psi.linear, rate);
            let joint = &mut self.joints[k];
            (joint.velocity, joint.acceleration) = (velocity, acceleration);
            let (group, lane) = (&mut self.groups[k / Self::LANES], k % Self::LANES);
            set_motion(&mut group.velocity, lane, velocity);
            set_motion(&mut group.acceleration, lane, acceleration);
            set_motion(&mut group.psi, lane, psi);
        }
        for group in &mut self.groups {
            group.momentum = group.body.apply(group.velocity);
            group.set_force();
        }
    }

    /// Sets other accelerations than those of [`set_motion`](Self::set_motion), called at the same position
    /// and velocity.
    #[inline(never)]
    pub fn set_acceleration(&mut self, tree: &Tree, v: &[S], a: &[S]) {
        for (k, place) in self.places.iter().enumerate() {
            let joint = &self.joints[k];
            let (z, rate) = (joint.axes[2], place.rate(v));
            let psi: Motion<S> = motion_lane(&self.groups[k / Self::LANES].psi, k % Self::LANES);
            let mut acceleration = match place.parent {
                Some(parent) => moved(self.joints[parent].acceleration, joint.arm),
                None => against_gravity(tree),
            };
            acceleration.linear = acceleration.linear.plus_scaled(psi.linear, rate);
            match place.kind {
                JointKind::Revolute => {
                    acceleration.angular =
                        acceleration.angular.plus_scaled(psi.angular, rate).plus_scaled(z, place.rate(a));
                }
                JointKind::Prismatic => {
                    acceleration.linear = acceleration.linear.plus_scaled(z, place.rate(a));
                }
            }
            self.joints[k].acceleration = acceleration;
            set_motion(&mut self.groups[k / Self::LANES].acceleration, k % Self::LANES, acceleration);
        }
        self.groups.iter_mut().for_each(Group::set_force);
    }

    /// `tau = M a + C v + g`, n, without armature, springs and friction, at the motion set last; the forces
    /// of links are added up.
    #[inline(never)]
    pub fn sum_forces(&mut self, tau: &mut [S]) {
        self.places.clear_sums(tau);
        for (k, place) in self.places.iter().enumerate().rev() {
            let (group, lane) = (&self.groups[k / Self::LANES], k % Self::LANES);
            let force: Force<S> = force_lane(&group.force, lane);
            self.places.add(tau, place, along_axis(place.kind, self.joints[k].axes[2], &force));
            if let Some(parent) = place.parent {
                let to = &mut self.groups[parent / Self::LANES].force;
                add_force(to, parent % Self::LANES, inward(force, self.joints[k].arm));
            }
        }
    }
}

impl<P: Scalar> Group<P> {
    /// The force on each link, `I a + v x* I v`.
    #[inline(always)]
    fn set_force(&mut self) {
        let (velocity, momentum) = (self.velocity, self.momentum);
        let Force { moment, force } = self.body.apply(self.acceleration);
        self.force = Force {
            moment: moment
                .plus_product(velocity.angular, momentum.moment)
                .plus_product(velocity.linear, momentum.force),
            force: force.plus_product(velocity.angular, momentum.force),
        };
    }
}

/// The acceleration of the base that stands for weights.
#[inline(always)]
pub(super) fn against_gravity<S: Scalar>(tree: &Tree) -> Motion<S> {
    Motion { angular: Vec3::zero(), linear: -Vec3::constant(tree.gravity()) }
}

/// `v x S` for the axis of a joint.
#[inline(always)]
pub(super) fn across<S: Scalar>(kind: JointKind, velocity: Motion<S>, axis: Vec3<S>) -> Motion<S> {
    match kind {
        JointKind::Revolute => {
            Motion { angular: velocity.angular.cross(axis), linear: velocity.linear.cross(axis) }
        }
        JointKind::Prismatic => Motion { angular: Vec3::zero(), linear: velocity.angular.cross(axis) },
    }
}

/// `motion . force + more`.
#[inline(always)]
pub(super) fn dot_plus<S: Scalar>(motion: &Motion<S>, force: &Force<S>, more: S) -> S {
    motion.angular.dot_plus(force.moment, motion.linear.dot_plus(force.force, more))
}

/// The motion of the origin at the end of an arm.
#[inline(always)]
pub(super) fn moved<S: Scalar>(motion: Motion<S>, arm: Vec3<S>) -> Motion<S> {
    Motion { angular: motion.angular, linear: motion.linear.plus_product(motion.angular, arm) }
}

/// The force about the origin where the arm begins.
#[inline(always)]
pub(super) fn inward<S: Scalar>(force: Force<S>, arm: Vec3<S>) -> Force<S> {
    Force { moment: force.moment.plus_product(arm, force.force), force: force.force }
}
