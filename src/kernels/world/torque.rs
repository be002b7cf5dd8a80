//! The derivatives of inverse dynamics as scalar products of pairs of joints.

use super::composite::clear_beyond;
use super::group::{Carried, Group, along_axis, force_lane, motion_along, motion_lane, set_motion};
use super::motion::{across, against_gravity, inward, moved};
use super::{Joint, WorldKernel};
use crate::matrix::{Matrix, Panel};
use crate::robot::{JointKind, Tree};
use crate::scalar::{Scalar, inlined};
use crate::spatial::{Force, Motion, Vec3};
use std::ops::Range;

/// The motions of joint i that meet the forces of the joints beyond it, the same in every lane.
pub(super) struct Meeting<P> {
    pub axis: Vec3<P>,
    pub origin: Vec3<P>,
    pub psi: Motion<P>,
    pub psi_rate: Motion<P>,
    pub drift: Motion<P>,
}

/// The motions of a place, and its forces, as numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Own<S> {
    pub axis: Motion<S>,
    pub psi: Motion<S>,
    pub psi_rate: Motion<S>,
    pub drift: Motion<S>,
    pub inertial: Force<S>,
    pub turning: Vec3<S>,
    pub by_position: Force<S>,
    pub by_velocity: Force<S>,
}

impl<S: Scalar> Own<S> {
    pub fn none() -> Self {
        let (still, slack) = (Motion::zero(), Force::zero());
        Self {
            axis: still,
            psi: still,
            psi_rate: still,
            drift: still,
            inertial: slack,
            turning: Vec3::zero(),
            by_position: slack,
            by_velocity: slack,
        }
    }
}

impl<S: Scalar> WorldKernel<S> {
    /// tau_q and tau_v, n x n, without springs, friction and armature, at the motion set last and the
    /// composite bodies of its position. Entries of joints on different branches are left as they are.
    ///
    /// With J', L and N the rate of the inertia matrix, the linear and the angular momentum of the composite
    /// body of joint j about its origin, f the force on it, w and s angular and linear part of a motion, the
    /// Coriolis operator is `2B m = (J' w - N x w ; -2 L x w)`. For i <= j in tree order
    ///
    /// ```text
    /// F_j = IC_j S_j       C_j = 2B S_j + IC_j d_j            psi_j = v_j x S_j    d_j = 2 psi_j
    /// E_j = (2B)' S_j      A_j = 2B psi_j + IC_j psi'_j + S_j x* f_j     psi'_j = a_j x S_j + v_j x psi_j
    ///
    /// tau_q,ij = S_i . A_j     tau_q,ji = psi_i . E_j + psi'_i . F_j
    /// tau_v,ij = S_i . C_j     tau_v,ji = S_i . E_j + d_i . F_j
    /// ```
    ///
    /// Axes of a joint with several degrees of freedom are fixed to its link, and q is a displacement in the
    /// left-trivialised tangent space: psi and psi' are those of the velocity and the acceleration before the
    /// joint, `d_j = psi_j + v_j x S_j`, and the second form of tau_q holds for all pairs of one joint.
    ///
    /// (S. Singh, R. Russell, P. Wensing, IEEE Robotics and Automation Letters 7 (2022) 1752-1759, in other
    /// terms.) The linear part of E is zero.
    #[inline(never)]
    pub fn torque_derivatives(&mut self, tree: &Tree, tau: &mut [Panel<S>; 2]) {
        self.carry_forces(tree);
        if self.places.are_in_order() {
            return self.meet_all(tau);
        }
        let mut upper = std::mem::replace(&mut self.upper, [Panel::zeros(0, 0), Panel::zeros(0, 0)]);
        self.meet_all(&mut upper);
        self.upper = upper;
        for (tau, upper) in tau.iter_mut().zip(&self.upper) {
            self.places.take_to_coordinates(upper, tau);
        }
    }

    /// The motions and forces of [`torque_derivatives`](Self::torque_derivatives).
    #[inline(always)]
    pub fn carry_forces(&mut self, tree: &Tree) {
        self.compose_motion();
        self.groups.iter_mut().for_each(Group::set_rates);
        self.set_rates_of_free_joints(tree);
        for (group, carried) in self.groups.iter().zip(&mut self.carried) {
            group.carry(carried);
        }
    }

    /// The motions and forces of place k.
    pub(super) fn own(&self, k: usize) -> Own<S> {
        let (block, lane) = (k / Self::LANES, k % Self::LANES);
        let (group, carried) = (&self.groups[block], &self.carried[block]);
        Own {
            axis: motion_along(self.places[k].kind, self.joints[k].axes[2]),
            psi: motion_lane(&group.psi, lane),
            psi_rate: motion_lane(&group.psi_rate, lane),
            drift: motion_lane(&group.drift, lane),
            inertial: force_lane(&carried.inertial, lane),
            turning: carried.turning.lane(lane),
            by_position: force_lane(&carried.by_position, lane),
            by_velocity: force_lane(&carried.by_velocity, lane),
        }
    }

    /// psi' and d of joints with several degrees of freedom.
    fn set_rates_of_free_joints(&mut self, tree: &Tree) {
        for chain in &self.free {
            let (mut velocity, mut acceleration) = match self.places[chain.start].parent {
                Some(parent) => (self.joints[parent].velocity, self.joints[parent].acceleration),
                None => (Motion::zero(), against_gravity(tree)),
            };
            let whole = self.joints[chain.end - 1].velocity;
            for k in chain.clone() {
                let (kind, joint) = (self.places[k].kind, &self.joints[k]);
                let axis = motion_along(kind, joint.axes[2]);
                (velocity, acceleration) = (moved(velocity, joint.arm), moved(acceleration, joint.arm));
                let psi = across(kind, velocity, joint.axes[2]);
                let own = across(kind, moved(whole, -self.to_end(chain, k)), joint.axes[2]);
                let psi_rate = acceleration.cross(axis);
                let (group, lane) = (&mut self.groups[k / Self::LANES], k % Self::LANES);
                set_motion(&mut group.drift, lane, psi + own);
                set_motion(&mut group.psi_rate, lane, psi_rate + velocity.cross(psi));
            }
        }
    }

    /// From the origin of place `k` of a free joint to that of its last one: the way there.
    #[inline(always)]
    pub(super) fn to_end(&self, chain: &Range<usize>, k: usize) -> Vec3<S> {
        self.joints[k + 1..chain.end].iter().fold(Vec3::zero(), |sum, joint| sum + joint.arm)
    }

    /// A motion at place `k` of a free joint, at the last origin of the joint.
    #[inline(always)]
    pub(super) fn at_end(&self, chain: &Range<usize>, k: usize, motion: Motion<S>) -> Motion<S> {
        moved(motion, self.to_end(chain, k))
    }

    /// The same for a force.
    #[inline(always)]
    pub(super) fn force_at_end(&self, chain: &Range<usize>, k: usize, force: Force<S>) -> Force<S> {
        inward(force, -self.to_end(chain, k))
    }

    /// All entries, by places.
    fn meet_all(&mut self, to: &mut [Panel<S>; 2]) {
        let ([q_upper, v_upper], [q_lower, v_lower]) = (to, &mut self.lower);
        for (k, place) in self.places.iter().enumerate() {
            let meeting = meeting_of(&self.joints[k], &self.groups[k / Self::LANES], k % Self::LANES);
            let mut rows = [q_upper.row_mut(k), q_lower.row_mut(k), v_upper.row_mut(k), v_lower.row_mut(k)];
            let groups = place.groups(Self::LANES);
            match place.kind {
                JointKind::Revolute => fill(&mut rows, &self.carried, groups, &meeting, revolute),
                JointKind::Prismatic => fill(&mut rows, &self.carried, groups, &meeting, prismatic),
            }
            rows.into_iter().for_each(|row| clear_beyond::<S>(row, place.end));
        }
        self.places.complete(q_upper, q_lower);
        self.places.mirror(v_upper, Some(&*v_lower));
    }

    /// Writes the entries of joints on one branch of an n x n panel by joints to a matrix; others are left as
    /// they are.
    pub fn write_pairs(&self, from: &Panel<S>, to: &mut Matrix<S>) {
        if self.places.are_in_order() { self.places.write(from, to) } else { from.write(to) }
    }

    /// `tau = M a + C v + g`, n, without armature, springs and friction, at the motion set last, after
    /// [`torque_derivatives`](Self::torque_derivatives).
    pub fn torques(&self, tau: &mut [S]) {
        self.places.clear_sums(tau);
        for (k, place) in self.places.iter().enumerate() {
            let force = force_lane(&self.groups[k / Self::LANES].force, k % Self::LANES);
            self.places.add(tau, place, along_axis(place.kind, self.joints[k].axes[2], &force));
        }
    }
}

/// The motions of a joint in this lane of its group.
#[inline(always)]
pub(super) fn meeting_of<S: Scalar>(
    joint: &Joint<S>,
    group: &Group<S::Pack>,
    lane: usize,
) -> Meeting<S::Pack> {
    let motion = |motion: &Motion<S::Pack>| motion_lane::<S, _>(motion, lane).splat();
    Meeting {
        axis: joint.axes[2].splat(),
        origin: joint.origin.splat(),
        psi: motion(&group.psi),
        psi_rate: motion(&group.psi_rate),
        drift: motion(&group.drift),
    }
}

/// Entries ij, ji of tau_q and of tau_v for joint i and the joints of these groups.
#[inline(always)]
fn fill<P: Scalar>(
    rows: &mut [&mut [P]; 4],
    carried: &[Carried<P>],
    groups: Range<usize>,
    meeting: &Meeting<P>,
    entries: impl Fn(&Meeting<P>, &Carried<P>) -> [P; 4],
) {
    let [a, b, c, d] = rows.each_mut().map(|row| row[groups.clone()].iter_mut());
    for ((((carried, a), b), c), d) in carried[groups].iter().zip(a).zip(b).zip(c).zip(d) {
        [*a, *b, *c, *d] = entries(meeting, carried);
    }
}

impl<P: Scalar> Group<P> {
    /// psi' and d of joints of one degree of freedom: there the motions before the joint and after it give
    /// the same.
    #[inline(always)]
    fn set_rates(&mut self) {
        let (axis, psi, a, v) = (self.axis, self.psi, self.acceleration, self.velocity);
        self.drift = psi + psi;
        self.psi_rate = Motion {
            angular: a.angular.cross(axis.angular).plus_product(v.angular, psi.angular),
            linear: a
                .linear
                .cross(axis.angular)
                .plus_product(a.angular, axis.linear)
                .plus_product(v.linear, psi.angular)
                .plus_product(v.angular, psi.linear),
        };
    }

    /// The forces of all joints of the group, see [`WorldKernel::torque_derivatives`]; F is there.
    #[inline(always)]
    fn carry(&self, carried: &mut Carried<P>) {
        let (axis, psi, psi_rate) = (self.axis, self.psi, self.psi_rate);
        let Force { moment: angular, force: linear } = self.momentum;
        // J' w and N x w of S and psi.
        let (turned, crossed) = (self.rate.apply(axis.angular), angular.cross(axis.angular));
        let twice = |a: Vec3<P>| a + a;
        let shifted = self.composite.apply(self.drift);
        let pushed = self.composite.apply(psi_rate);
        let swept = linear.cross(psi.angular);
        let f = self.force;
        *carried = Carried {
            origin: carried.origin,
            inertial: carried.inertial,
            turning: twice(linear.cross(axis.linear)) + turned + crossed,
            by_velocity: Force {
                moment: shifted.moment + turned - crossed,
                force: shifted.force - twice(linear.cross(axis.angular)),
            },
            by_position: Force {
                moment: (pushed.moment + self.rate.apply(psi.angular) - angular.cross(psi.angular))
                    .plus_product(axis.angular, f.moment)
                    .plus_product(axis.linear, f.force),
                force: (pushed.force - twice(swept)).plus_product(axis.angular, f.force),
            },
        };
    }
}

/// tau_q and tau_v for joint i, revolute, and each joint of a group: ij, ji of both.
#[inline(always)]
fn revolute<P: Scalar>(i: &Meeting<P>, group: &Carried<P>) -> [P; 4] {
    inlined!(P, {
        let Carried { origin, inertial, turning, by_position, by_velocity } = group;
        let distance = *origin - i.origin;
        let moment = |force: &Force<P>| inward(*force, distance).moment;
        let (moved, force) = (moment(inertial), inertial.force);
        let along = i.drift.angular.dot_plus(moved, i.drift.linear.dot(force));
        let rate = i.psi_rate.angular.dot_plus(moved, i.psi_rate.linear.dot(force));
        [
            i.axis.dot(moment(by_position)),
            i.psi.angular.dot_plus(*turning, rate),
            i.axis.dot(moment(by_velocity)),
            i.axis.dot_plus(*turning, along),
        ]
    })
}

/// The same for joint i prismatic: its motions have no angular parts.
#[inline(always)]
fn prismatic<P: Scalar>(i: &Meeting<P>, carried: &Carried<P>) -> [P; 4] {
    inlined!(P, {
        [
            i.axis.dot(carried.by_position.force),
            i.psi_rate.linear.dot(carried.inertial.force),
            i.axis.dot(carried.by_velocity.force),
            i.drift.linear.dot(carried.inertial.force),
        ]
    })
}
