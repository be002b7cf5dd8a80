//! Gradient and Hessian of the Lagrangian, by scalar products of pairs of joints.

use super::WorldKernel;
use super::composite::clear_beyond;
use super::group::{Carried, add_force, force_lane, motion_lane, set_motion};
use super::motion::{across, inward, moved};
use crate::matrix::Panel;
use crate::robot::{JointKind, Tree};
use crate::scalar::{Pack, Scalar, inlined};
use crate::spatial::{Force, Motion, Vec3};

/// The motions of joint i that meet the forces of the joints beyond it, the same in every lane.
struct Meeting<P> {
    axis: Vec3<P>,
    origin: Vec3<P>,
    psi: Motion<P>,
    /// The linear part of `gamma = a_g x S`; its angular part is zero.
    gamma: Vec3<P>,
}

impl<S: Scalar> WorldKernel<S> {
    /// Velocities, and momenta of the composite bodies, at the position set last; v has length n.
    #[inline(never)]
    pub fn set_velocity(&mut self, v: &[S]) {
        let mut outer = Motion::zero();
        for (k, place) in self.places.iter().enumerate() {
            let joint = &self.joints[k];
            let (z, rate) = (joint.axes[2], place.rate(v));
            let mut velocity = match place.parent {
                Some(parent) => moved(self.joints[parent].velocity, joint.arm),
                None => Motion::zero(),
            };
            outer = if k > place.first { moved(outer, joint.arm) } else { velocity };
            let psi = across(place.kind, outer, z);
            match place.kind {
                JointKind::Revolute => velocity.angular = velocity.angular.plus_scaled(z, rate),
                JointKind::Prismatic => velocity.linear = velocity.linear.plus_scaled(z, rate),
            }
            self.joints[k].velocity = velocity;
            let (group, lane) = (&mut self.groups[k / Self::LANES], k % Self::LANES);
            set_motion(&mut group.velocity, lane, velocity);
            set_motion(&mut group.psi, lane, psi);
        }
        for group in &mut self.groups {
            group.momentum = group.body.apply(group.velocity);
        }
        for (k, place) in self.places.iter().enumerate().rev() {
            let Some(parent) = place.parent else { continue };
            let momentum: Force<S> = force_lane(&self.groups[k / Self::LANES].momentum, k % Self::LANES);
            let to = &mut self.groups[parent / Self::LANES].momentum;
            add_force(to, parent % Self::LANES, inward(momentum, self.joints[k].arm));
        }
    }

    /// `L_q,i = H_i . psi_i + F_i . a_g`, n, without springs, at the velocity set last.
    #[inline(never)]
    pub fn gradient(&self, tree: &Tree, l_q: &mut [S]) {
        let gravity = Vec3::<S::Pack>::constant(tree.gravity());
        let groups = self.groups.iter().zip(&self.carried);
        self.places.clear_sums(l_q);
        for (some, (group, carried)) in self.places.chunks(Self::LANES).zip(groups) {
            let entries = group.momentum.dot(group.psi) + carried.inertial.force.dot(gravity);
            for (lane, place) in some.iter().enumerate() {
                self.places.add(l_q, place, entries.lane(lane));
            }
        }
    }

    /// `P = L_vq` and L_qq, n x n, without springs, at the velocity set last. Entries of joints on different
    /// branches are left as they are.
    ///
    /// ```text
    /// P_ij = S_i . G_j    P_ji = psi_i . F_j    L_qq,ij = psi_i . G_j + gamma_i . F_j    (i <= j)
    /// ```
    ///
    /// with `G_j = IC_j psi_j + S_j x* H_j`, as in [`KernelOne`](crate::kernels::KernelOne).
    ///
    /// For a floating or spherical joint q is a displacement in the left-trivialised tangent space, psi that
    /// of the velocity before the joint. Its pairs have P_ji for both orders, and the symmetric part of L_qq.
    #[inline(never)]
    pub fn hessian(&mut self, tree: &Tree, to: [&mut Panel<S>; 2]) {
        for (group, rate) in self.groups.iter().zip(&mut self.rates) {
            let Force { moment, force } = group.composite.apply(group.psi);
            let (axis, h) = (group.axis, group.momentum);
            *rate = Force {
                moment: moment.plus_product(axis.angular, h.moment).plus_product(axis.linear, h.force),
                force: force.plus_product(axis.angular, h.force),
            };
        }
        if self.places.are_in_order() {
            return self.meet_for_hessian(tree, to);
        }
        let mut upper = std::mem::replace(&mut self.upper, [Panel::zeros(0, 0), Panel::zeros(0, 0)]);
        let [p, l_qq] = &mut upper;
        self.meet_for_hessian(tree, [p, l_qq]);
        self.upper = upper;
        for (to, upper) in to.into_iter().zip(&self.upper) {
            self.places.take_to_coordinates(upper, to);
        }
    }

    /// All entries, by places.
    fn meet_for_hessian(&mut self, tree: &Tree, [p, l_qq]: [&mut Panel<S>; 2]) {
        let [lower, _] = &mut self.lower;
        let gravity = Vec3::<S>::constant(tree.gravity());
        for (k, place) in self.places.iter().enumerate() {
            let (joint, axis) = (&self.joints[k], self.joints[k].axes[2]);
            let psi: Motion<S> = motion_lane(&self.groups[k / Self::LANES].psi, k % Self::LANES);
            let meeting: Meeting<S::Pack> = Meeting {
                axis: axis.splat(),
                origin: joint.origin.splat(),
                psi: psi.splat(),
                gamma: gravity.cross(axis).splat(),
            };
            let mut rows = [p.row_mut(k), lower.row_mut(k), l_qq.row_mut(k)];
            let groups = place.groups(Self::LANES);
            let [a, b, c] = rows.each_mut().map(|row| row[groups.clone()].iter_mut());
            let forces = self.carried[groups.clone()].iter().zip(&self.rates[groups]);
            let entries = forces.zip(a).zip(b).zip(c);
            match place.kind {
                JointKind::Revolute => entries.for_each(|((((carried, rate), a), b), c)| {
                    [*a, *b, *c] = revolute(&meeting, carried, rate);
                }),
                JointKind::Prismatic => entries.for_each(|((((carried, rate), a), b), c)| {
                    [*a, *b, *c] = prismatic(&meeting, carried, rate);
                }),
            }
            rows.into_iter().for_each(|row| clear_beyond::<S>(row, place.end));
        }
        self.places.complete(p, lower);
        self.places.symmetrise(l_qq);
    }
}

/// P_ij, P_ji and L_qq,ij for joint i, revolute, and each joint of a group.
#[inline(always)]
fn revolute<P: Scalar>(i: &Meeting<P>, group: &Carried<P>, rate: &Force<P>) -> [P; 3] {
    inlined!(P, {
        let Carried { origin, inertial, .. } = group;
        let distance = *origin - i.origin;
        let (inertial, rate) = (inward(*inertial, distance), inward(*rate, distance));
        let Motion { angular, linear } = i.psi;
        [
            i.axis.dot(rate.moment),
            angular.dot_plus(inertial.moment, linear.dot(inertial.force)),
            angular.dot_plus(rate.moment, i.gamma.dot_plus(inertial.force, linear.dot(rate.force))),
        ]
    })
}

/// The same for joint i prismatic: psi has no angular part, and gravity none in L_qq.
#[inline(always)]
fn prismatic<P: Scalar>(i: &Meeting<P>, carried: &Carried<P>, rate: &Force<P>) -> [P; 3] {
    inlined!(P, {
        let psi = i.psi.linear;
        [i.axis.dot(rate.force), psi.dot(carried.inertial.force), psi.dot(rate.force)]
    })
}
