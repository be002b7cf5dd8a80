//! The second derivatives of inverse dynamics, contracted with constant weights, as scalar products of pairs
//! of joints.

use super::WorldKernel;
use super::composite::{clear_beyond, rate_of_matrix, spread};
use super::group::{Carried, Group, add_force, add_matrix, force_lane, matrix_lane, motion_lane, set_motion};
use super::motion::{across, dot_plus, inward, moved};
use super::torque::{Meeting, Own, meeting_of};
use crate::matrix::{Panel, filled};
use crate::robot::JointKind;
use crate::scalar::{Scalar, inlined};
use crate::spatial::{Force, Motion, Symmetric3, Vec3};
use std::ops::Range;

/// What [`WorldKernel::contract_torque`] needs beside the kernel.
#[derive(Clone, Debug)]
pub(crate) struct TorqueContraction<S: Scalar> {
    groups: Vec<Virtual<S::Pack>>,
    weighted: Vec<WeightedForces<S::Pack>>,
    /// Virtual velocities, by place.
    velocities: Vec<Motion<S>>,
    /// The blocks by places, where these are not the joints in their order.
    by_places: Option<Box<TorqueHessian<S>>>,
}

/// The blocks of the Hessian of `w.tau` in z = (q, v, a) that are not zero by structure, n x n each.
#[derive(Clone, Debug)]
pub(crate) struct TorqueHessian<S: Scalar> {
    /// (q, q) and (v, v), symmetric.
    pub qq: Panel<S>,
    pub vv: Panel<S>,
    /// Rows v and a, columns q.
    pub vq: Panel<S>,
    pub aq: Panel<S>,
}

/// Joints side by side at the virtual velocity W, the sum of `w_k S_k` on the way to a joint.
#[derive(Clone, Copy, Debug)]
struct Virtual<P> {
    /// `chi = W x S`.
    chi: Motion<P>,
    velocity: Motion<P>,
    /// Momentum of the composite body at W, and the rate that W gives its inertia matrix.
    momentum: Force<P>,
    rate: Symmetric3<P>,
    /// The moment G, of the composite body.
    coriolis_moment: Vec3<P>,
}

/// Forces of the joints, about their origins, see [`WorldKernel::contract_torque`].
#[derive(Clone, Copy, Debug)]
struct WeightedForces<P> {
    /// Q.
    shifted: Force<P>,
    /// The moments R and U; their forces are zero.
    by_position: Vec3<P>,
    by_velocity: Vec3<P>,
}

/// The motion chi of one joint, and its forces, as numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct WeightedAt<S> {
    pub chi: Motion<S>,
    pub shifted: Force<S>,
    pub by_position: Vec3<S>,
    pub by_velocity: Vec3<S>,
}

impl<S: Scalar> WeightedAt<S> {
    pub fn none() -> Self {
        let none = Vec3::zero();
        Self { chi: Motion::zero(), shifted: Force::zero(), by_position: none, by_velocity: none }
    }
}

/// See [`WorldKernel::entries_of_joint`].
pub(super) struct EntriesOfJoint<S> {
    pub qq: S,
    pub vv: S,
    pub vq: S,
    pub aq: S,
}

/// Entries of a pair of joints i <= j, in this order: `qq_ij`, `vv_ij`, `vq_ij`, `vq_ji`, `aq_ij`, `aq_ji`.
type Entries<P> = [P; 6];

impl<S: Scalar> TorqueHessian<S> {
    pub fn zeros(n: usize) -> Self {
        let panel = Panel::zeros(n, n);
        Self { qq: panel.clone(), vv: panel.clone(), vq: panel.clone(), aq: panel }
    }
}

impl<S: Scalar> TorqueContraction<S> {
    /// Buffers for the tree of a kernel.
    #[inline(never)]
    pub fn new(kernel: &WorldKernel<S>) -> Self {
        let (still, slack, none) = (Motion::zero(), Force::zero(), Vec3::zero());
        let at_rest = Virtual {
            chi: still,
            velocity: still,
            momentum: slack,
            rate: Symmetric3::zero(),
            coriolis_moment: none,
        };
        let n = kernel.places.len();
        let reorders = !kernel.places.are_in_order();
        Self {
            groups: filled(at_rest, kernel.groups.len()),
            weighted: filled(
                WeightedForces { shifted: slack, by_position: none, by_velocity: none },
                kernel.groups.len(),
            ),
            velocities: filled(Motion::zero(), n),
            by_places: reorders.then(|| Box::new(TorqueHessian::zeros(n))),
        }
    }

    /// What was computed for place k.
    pub(super) fn weighted_at(&self, k: usize) -> WeightedAt<S> {
        let (block, lane) = (k / WorldKernel::<S>::LANES, k % WorldKernel::<S>::LANES);
        let weighted = &self.weighted[block];
        WeightedAt {
            chi: motion_lane(&self.groups[block].chi, lane),
            shifted: force_lane(&weighted.shifted, lane),
            by_position: weighted.by_position.lane(lane),
            by_velocity: weighted.by_velocity.lane(lane),
        }
    }

    /// Virtual velocities, momenta and rates of inertia of the links.
    #[inline(always)]
    fn set_motion(&mut self, kernel: &WorldKernel<S>, w: &[S]) {
        let (lanes, mut outer) = (WorldKernel::<S>::LANES, Motion::zero());
        for (k, place) in kernel.places.iter().enumerate() {
            let (joint, rate) = (&kernel.joints[k], place.rate(w));
            let z = joint.axes[2];
            let mut velocity = match place.parent {
                Some(parent) => moved(self.velocities[parent], joint.arm),
                None => Motion::zero(),
            };
            outer = if k > place.first { moved(outer, joint.arm) } else { velocity };
            let chi = across(place.kind, outer, z);
            match place.kind {
                JointKind::Revolute => velocity.angular = velocity.angular.plus_scaled(z, rate),
                JointKind::Prismatic => velocity.linear = velocity.linear.plus_scaled(z, rate),
            }
            self.velocities[k] = velocity;
            let group = &mut self.groups[k / lanes];
            set_motion(&mut group.velocity, k % lanes, velocity);
            set_motion(&mut group.chi, k % lanes, chi);
        }
        for (group, moved) in self.groups.iter_mut().zip(&kernel.groups) {
            let (body, v) = (&moved.body, moved.velocity);
            group.momentum = body.apply(group.velocity);
            group.rate = rate_of_matrix(body, group.velocity.angular, group.velocity.linear);
            // The kernel has the momenta and rates of composite bodies.
            let rate = rate_of_matrix(body, v.angular, v.linear);
            group.coriolis_moment = coriolis_moment(&rate, &body.apply(v), group.velocity);
        }
    }

    /// Momenta and rates of the composite bodies.
    #[inline(always)]
    fn compose(&mut self, kernel: &WorldKernel<S>) {
        let lanes = WorldKernel::<S>::LANES;
        for (k, place) in kernel.places.iter().enumerate().rev() {
            let Some(parent) = place.parent else { continue };
            let (group, lane, arm) = (&self.groups[k / lanes], k % lanes, kernel.joints[k].arm);
            let (momentum, coriolis_moment): (Force<S>, Vec3<S>) =
                (force_lane(&group.momentum, lane), group.coriolis_moment.lane(lane));
            let mut rate = matrix_lane(&group.rate, lane);
            rate += spread(arm, momentum.force);
            let (to, lane) = (&mut self.groups[parent / lanes], parent % lanes);
            add_force(&mut to.momentum, lane, inward(momentum, arm));
            add_matrix(&mut to.rate, lane, &rate);
            let sum = to.coriolis_moment.lane(lane) + coriolis_moment;
            to.coriolis_moment.set_lane(lane, sum);
        }
    }
}

impl<S: Scalar> WorldKernel<S> {
    /// The Hessian of `w.tau` in (q, v, a) for constant weights w (n), without friction and what depends on q
    /// alone, at the motion of [`torque_derivatives`](Self::torque_derivatives), called before. Entries of
    /// joints on different branches are left as they are.
    ///
    /// With W the velocity that w gives the links, P its momentum and 2B_w its Coriolis operator, G the sum
    /// of `(2B)' W` over the links of the composite body, all others as in
    /// [`torque_derivatives`](Self::torque_derivatives), `w.tau` is the sum of `W . f` over the links. Let
    /// joint i move, and all beyond it with it: there W changes by chi_i, the velocity by psi_i, and the
    /// acceleration by `psi_i x v + psi'_i`. A change of v_i changes the velocity by S_i, the acceleration by
    /// `S_i x v + d_i`. So for i <= j in tree order
    ///
    /// ```text
    /// chi_j = W_j x S_j              Q_j = IC_j chi_j + S_j x* P_j
    /// U_j = -(2B_w)' S_j             R_j = (2B)' chi_j - (2B_w)' psi_j + S_j x* G_j
    ///
    /// qq_ij = chi_i . A_j + psi'_i . Q_j + psi_i . R_j         vv_ij = S_i . U_j
    /// vq_ij = d_i . Q_j + S_i . R_j                            aq_ij = S_i . Q_j
    /// vq_ji = chi_i . C_j + psi_i . U_j                        aq_ji = chi_i . F_j
    /// ```
    ///
    /// Of joints with several degrees of freedom (see [`torque_derivatives`](Self::torque_derivatives)), the
    /// forms with chi_i of vq and aq hold for all pairs of one joint, and qq and vv are the symmetric parts.
    ///
    /// (S. Singh, R. Russell, P. Wensing, On Second-Order Derivatives of Rigid-Body Dynamics (2023), contract
    /// the same derivatives, in other terms.) Forces of R and U are zero.
    #[inline(never)]
    pub fn contract_torque(&mut self, work: &mut TorqueContraction<S>, w: &[S], to: &mut TorqueHessian<S>) {
        self.set_weighted_forces(work, w);
        let Some(mut by_places) = work.by_places.take() else { return self.meet_weighted(work, to) };
        self.meet_weighted(work, &mut by_places);
        let TorqueHessian { qq, vv, vq, aq } = &*by_places;
        self.places.take_to_coordinates(qq, &mut to.qq);
        self.places.take_to_coordinates(vv, &mut to.vv);
        self.places.take_to_coordinates(vq, &mut to.vq);
        self.places.take_to_coordinates(aq, &mut to.aq);
        work.by_places = Some(by_places);
    }

    /// The forces of [`contract_torque`](Self::contract_torque), for the weights w (n).
    #[inline(always)]
    pub fn set_weighted_forces(&self, work: &mut TorqueContraction<S>, w: &[S]) {
        work.set_motion(self, w);
        work.compose(self);
        for ((group, moved), weighted) in self.groups.iter().zip(&work.groups).zip(&mut work.weighted) {
            *weighted = weighted_forces(group, moved);
        }
    }

    /// All entries, by places.
    #[inline(never)]
    fn meet_weighted(&mut self, work: &TorqueContraction<S>, to: &mut TorqueHessian<S>) {
        let TorqueHessian { qq, vv, vq, aq } = to;
        let [vq_lower, aq_lower] = &mut self.lower;
        for (k, place) in self.places.iter().enumerate() {
            let (block, lane) = (k / Self::LANES, k % Self::LANES);
            let meeting = meeting_of(&self.joints[k], &self.groups[block], lane);
            let chi = motion_lane::<S, _>(&work.groups[block].chi, lane).splat();
            let groups = place.groups(Self::LANES);
            let mut rows = [
                qq.row_mut(k),
                vv.row_mut(k),
                vq.row_mut(k),
                vq_lower.row_mut(k),
                aq.row_mut(k),
                aq_lower.row_mut(k),
            ];
            let [a, b, c, d, e, f] = rows.each_mut().map(|row| row[groups.clone()].iter_mut());
            let forces = self.carried[groups.clone()].iter().zip(&work.weighted[groups]);
            let entries = forces.zip(a.zip(b)).zip(c.zip(d)).zip(e.zip(f));
            match place.kind {
                JointKind::Revolute => {
                    entries.for_each(|((((carried, weighted), (a, b)), (c, d)), (e, f))| {
                        [*a, *b, *c, *d, *e, *f] = revolute(&meeting, &chi, carried, weighted);
                    })
                }
                JointKind::Prismatic => {
                    entries.for_each(|((((carried, weighted), (a, b)), (c, d)), (e, f))| {
                        [*a, *b, *c, *d, *e, *f] = prismatic(&meeting, &chi, carried, weighted);
                    })
                }
            }
            rows.into_iter().for_each(|row| clear_beyond::<S>(row, place.end));
        }
        [qq, vv].into_iter().for_each(|entries| self.places.symmetrise(entries));
        self.places.complete(vq, vq_lower);
        self.places.complete(aq, aq_lower);
    }

    /// The entries of places i and j of one joint from the motions of i and the forces of j: `vq_ji`,
    /// `aq_ji`, and those whose symmetric parts are qq and vv.
    pub(super) fn entries_of_joint(
        &self,
        joint: &Range<usize>,
        (i, j): (usize, usize),
        [of_i, of_j]: [&Own<S>; 2],
        [moved, weighted]: [&WeightedAt<S>; 2],
    ) -> EntriesOfJoint<S> {
        let motion = |motion: Motion<S>| self.at_end(joint, i, motion);
        let force = |force: Force<S>| self.force_at_end(joint, j, force);
        let (psi, axis, chi) = (of_i.psi.angular, of_i.axis.angular, motion(moved.chi));
        let by_shift = force(weighted.shifted).dot(motion(of_i.psi_rate));
        EntriesOfJoint {
            qq: psi.dot_plus(weighted.by_position, force(of_j.by_position).dot(chi) + by_shift),
            vv: axis.dot(weighted.by_velocity),
            vq: psi.dot_plus(weighted.by_velocity, force(of_j.by_velocity).dot(chi)),
            aq: force(of_j.inertial).dot(chi),
        }
    }
}

/// The transpose of a Coriolis operator times a motion, `(2B)' m`: a moment.
#[inline(always)]
fn coriolis_moment<P: Scalar>(rate: &Symmetric3<P>, momentum: &Force<P>, motion: Motion<P>) -> Vec3<P> {
    inlined!(P, {
        let pulled = momentum.force.cross(motion.linear);
        rate.apply(motion.angular).plus_product(momentum.moment, motion.angular) + pulled + pulled
    })
}

/// The forces of a group.
#[inline(always)]
fn weighted_forces<P: Scalar>(group: &Group<P>, moved: &Virtual<P>) -> WeightedForces<P> {
    inlined!(P, {
        let (axis, psi, chi, momentum) = (group.axis, group.psi, moved.chi, group.momentum);
        let Force { moment: angular, force: linear } = moved.momentum;
        let Force { moment, force } = group.composite.apply(chi);
        WeightedForces {
            shifted: Force {
                moment: moment.plus_product(axis.angular, angular).plus_product(axis.linear, linear),
                force: force.plus_product(axis.angular, linear),
            },
            by_position: (coriolis_moment(&group.rate, &momentum, chi)
                - coriolis_moment(&moved.rate, &moved.momentum, psi))
            .plus_product(axis.angular, moved.coriolis_moment),
            by_velocity: -coriolis_moment(&moved.rate, &moved.momentum, axis),
        }
    })
}

/// The entries for joint i, revolute, and each joint of a group.
#[inline(always)]
fn revolute<P: Scalar>(
    i: &Meeting<P>,
    chi: &Motion<P>,
    carried: &Carried<P>,
    weighted: &WeightedForces<P>,
) -> Entries<P> {
    inlined!(P, {
        let distance = carried.origin - i.origin;
        let about = |force: &Force<P>| inward(*force, distance);
        let (a, c, f) = (about(&carried.by_position), about(&carried.by_velocity), about(&carried.inertial));
        let q = about(&weighted.shifted);
        let (r, u) = (weighted.by_position, weighted.by_velocity);
        [
            dot_plus(chi, &a, dot_plus(&i.psi_rate, &q, i.psi.angular.dot(r))),
            i.axis.dot(u),
            i.axis.dot_plus(r, dot_plus(&i.drift, &q, P::zero())),
            dot_plus(chi, &c, i.psi.angular.dot(u)),
            i.axis.dot(q.moment),
            dot_plus(chi, &f, P::zero()),
        ]
    })
}

/// The same for joint i prismatic: its motions have no angular parts.
#[inline(always)]
fn prismatic<P: Scalar>(
    i: &Meeting<P>,
    chi: &Motion<P>,
    carried: &Carried<P>,
    weighted: &WeightedForces<P>,
) -> Entries<P> {
    inlined!(P, {
        let (chi, q) = (chi.linear, weighted.shifted.force);
        [
            chi.dot_plus(carried.by_position.force, i.psi_rate.linear.dot(q)),
            P::zero(),
            i.drift.linear.dot(q),
            chi.dot(carried.by_velocity.force),
            i.axis.dot(q),
            chi.dot(carried.inertial.force),
        ]
    })
}
