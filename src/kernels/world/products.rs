//! Products with the derivatives of inverse dynamics, without a matrix: O(n).

use super::WorldKernel;
use super::contraction::{EntriesOfJoint, TorqueContraction, WeightedAt};
use super::motion::{inward, moved};
use super::torque::Own;
use crate::matrix::filled;
use crate::robot::{Tree, scaled};
use crate::scalar::Scalar;
use crate::spatial::{Force, Motion, Vec3};
use std::ops::Range;

/// Sums over the joints before one, or beyond it, in the axes of the world about its origin.
///
/// A sum of scalar products of pairs is one of sums: what the joints i before j move by, times the forces of
/// j, and the motions of i times the sum of the forces of the joints j beyond it.
#[derive(Clone, Debug)]
pub(crate) struct Sums<S> {
    /// By place, the last of its joint.
    before: Vec<Before<S>>,
    beyond: Vec<Beyond<S>>,
    /// By place.
    own: Vec<Own<S>>,
    weighted: Vec<WeightedAt<S>>,
}

/// Sums of motions.
#[derive(Clone, Copy, Debug)]
struct Before<S> {
    first: Motion<S>,
    second: Motion<S>,
    /// What meets pure moments.
    turning: Vec3<S>,
}

/// Sums of forces.
#[derive(Clone, Copy, Debug)]
struct Beyond<S> {
    first: Force<S>,
    second: Force<S>,
    moment: Vec3<S>,
}

impl<S: Scalar> Before<S> {
    fn none() -> Self {
        Self { first: Motion::zero(), second: Motion::zero(), turning: Vec3::zero() }
    }

    /// The same at the end of an arm.
    fn moved(&self, arm: Vec3<S>) -> Self {
        Self { first: moved(self.first, arm), second: moved(self.second, arm), turning: self.turning }
    }

    fn with(&self, other: &Self) -> Self {
        Self {
            first: self.first + other.first,
            second: self.second + other.second,
            turning: self.turning + other.turning,
        }
    }
}

impl<S: Scalar> Beyond<S> {
    fn none() -> Self {
        Self { first: Force::zero(), second: Force::zero(), moment: Vec3::zero() }
    }

    /// The same where an arm begins.
    fn inward(&self, arm: Vec3<S>) -> Self {
        Self { first: inward(self.first, arm), second: inward(self.second, arm), moment: self.moment }
    }

    fn with(&self, other: &Self) -> Self {
        Self {
            first: self.first + other.first,
            second: self.second + other.second,
            moment: self.moment + other.moment,
        }
    }
}

impl<S: Scalar> Sums<S> {
    /// Buffers for a tree.
    pub fn new(tree: &Tree) -> Self {
        let n = tree.joints().len();
        Self {
            before: filled(Before::none(), n),
            beyond: filled(Beyond::none(), n),
            own: filled(Own::none(), n),
            weighted: filled(WeightedAt::none(), n),
        }
    }
}

impl<S: Scalar> WorldKernel<S> {
    /// Takes the motions and forces of all places, for the sums of products at one state.
    #[inline(never)]
    pub fn take_forces(&self, sums: &mut Sums<S>) {
        sums.own.iter_mut().enumerate().for_each(|(k, own)| *own = self.own(k));
    }

    /// The same of the weights of [`set_weighted_forces`](Self::set_weighted_forces).
    #[inline(never)]
    pub fn take_weighted_forces(&self, work: &TorqueContraction<S>, sums: &mut Sums<S>) {
        sums.weighted.iter_mut().enumerate().for_each(|(k, weighted)| *weighted = work.weighted_at(k));
    }

    /// The places of the joint that ends at place `k`; `None` for another part of it.
    fn joint_ending_at(&self, k: usize) -> Option<Range<usize>> {
        let place = &self.places[k];
        (k == place.last).then(|| place.first..k + 1)
    }

    /// Joint by joint outward: `of(k)` are the motions of place k, about its origin; `take(k, sums, own)`
    /// gets the sums over the joints before that of k, and those of its own joint, both about its origin.
    fn sum_before(
        &self,
        before: &mut [Before<S>],
        of: impl Fn(usize) -> Before<S>,
        mut take: impl FnMut(usize, &Before<S>, &Before<S>),
    ) {
        for last in 0..self.places.len() {
            let Some(joint) = self.joint_ending_at(last) else { continue };
            let outer = match self.places[joint.start].parent {
                Some(parent) => before[parent].moved(self.joints[joint.start].arm),
                None => Before::none(),
            };
            // About the last origin of the joint.
            let to_end = |k: usize| self.to_end(&joint, k);
            let own = joint.clone().fold(Before::none(), |sum, k| sum.with(&of(k).moved(to_end(k))));
            let outer = outer.moved(to_end(joint.start));
            for k in joint.clone() {
                let back = -to_end(k);
                take(k, &outer.moved(back), &own.moved(back));
            }
            before[last] = outer.with(&own);
        }
    }

    /// Joint by joint inward: `of(k)` are the forces of place k, about its origin; `take(k, sums, own)` gets
    /// the sums over the joints beyond that of k, and those of its own joint, both about its origin.
    fn sum_beyond(
        &self,
        sums: &mut [Beyond<S>],
        of: impl Fn(usize) -> Beyond<S>,
        mut take: impl FnMut(usize, &Beyond<S>, &Beyond<S>),
    ) {
        sums.fill(Beyond::none());
        for last in (0..self.places.len()).rev() {
            let Some(joint) = self.joint_ending_at(last) else { continue };
            let to_end = |k: usize| self.to_end(&joint, k);
            let own = joint.clone().fold(Beyond::none(), |sum, k| sum.with(&of(k).inward(-to_end(k))));
            let beyond = sums[last];
            for k in joint.clone() {
                take(k, &beyond.inward(to_end(k)), &own.inward(to_end(k)));
            }
            if let Some(parent) = self.places[joint.start].parent {
                let arm = self.joints[joint.start].arm + to_end(joint.start);
                sums[parent] = sums[parent].with(&beyond.with(&own).inward(arm));
            }
        }
    }

    /// Adds `tau_q x + tau_v y`, n, to `product`, without springs and friction, at the forces taken last.
    #[inline(never)]
    pub fn add_torque_product(&self, sums: &mut Sums<S>, [x, y]: [&[S]; 2], product: &mut [S]) {
        let (places, Sums { before, beyond, own, weighted: _ }) = (&self.places, sums);
        let rates = |k: usize| [places[k].rate(x), places[k].rate(y)];
        self.sum_before(
            before,
            |k| {
                let ([x, y], own) = (rates(k), &own[k]);
                Before {
                    first: own.psi_rate.scaled(x) + own.drift.scaled(y),
                    second: Motion::zero(),
                    turning: own.psi.angular.scaled(x) + own.axis.angular.scaled(y),
                }
            },
            |k, before, with| {
                let (own, all) = (&own[k], before.with(with));
                let entry = all.turning.dot_plus(own.turning, own.inertial.dot(all.first));
                product[places[k].coordinate] += scaled(places[k].ratio, entry);
            },
        );
        self.sum_beyond(
            beyond,
            |k| {
                let ([x, y], own) = (rates(k), &own[k]);
                Beyond { first: own.by_position.scaled(x) + own.by_velocity.scaled(y), ..Beyond::none() }
            },
            |k, beyond, _| {
                product[places[k].coordinate] += scaled(places[k].ratio, beyond.first.dot(own[k].axis));
            },
        );
    }

    /// Adds `w'tau_q` and `w'tau_v`, n each, to `products`, likewise.
    #[inline(never)]
    pub fn add_torque_adjoint(&self, sums: &mut Sums<S>, w: &[S], [by_q, by_v]: [&mut [S]; 2]) {
        let (places, Sums { before, beyond, own, weighted: _ }) = (&self.places, sums);
        self.sum_before(
            before,
            |k| Before { first: own[k].axis.scaled(places[k].rate(w)), ..Before::none() },
            |k, before, _| {
                let (own, place) = (&own[k], &places[k]);
                by_q[place.coordinate] += scaled(place.ratio, own.by_position.dot(before.first));
                by_v[place.coordinate] += scaled(place.ratio, own.by_velocity.dot(before.first));
            },
        );
        self.sum_beyond(
            beyond,
            |k| {
                let (own, w) = (&own[k], places[k].rate(w));
                Beyond { first: own.inertial.scaled(w), moment: own.turning.scaled(w), ..Beyond::none() }
            },
            |k, beyond, with| {
                let (own, place, all) = (&own[k], &places[k], beyond.with(with));
                let entry = own.psi.angular.dot_plus(all.moment, all.first.dot(own.psi_rate));
                by_q[place.coordinate] += scaled(place.ratio, entry);
                let entry = own.axis.angular.dot_plus(all.moment, all.first.dot(own.drift));
                by_v[place.coordinate] += scaled(place.ratio, entry);
            },
        );
    }

    /// Adds the product of the Hessian of `w.tau` with `(x, y, z)`, n each, to `products`, without friction,
    /// at the forces of w taken last.
    #[inline(never)]
    pub fn add_contraction_product(
        &self,
        sums: &mut Sums<S>,
        [x, y, z]: [&[S]; 3],
        [by_q, by_v, by_a]: [&mut [S]; 3],
    ) {
        let (places, Sums { before, beyond, own, weighted }) = (&self.places, sums);
        let rates = |k: usize| [places[k].rate(x), places[k].rate(y), places[k].rate(z)];
        let mut add = |k: usize, entries: [S; 3]| {
            let (i, ratio) = (places[k].coordinate, places[k].ratio);
            by_q[i] += scaled(ratio, entries[0]);
            by_v[i] += scaled(ratio, entries[1]);
            by_a[i] += scaled(ratio, entries[2]);
        };
        self.sum_before(
            before,
            |k| {
                let ([x, y, z], own, weighted) = (rates(k), &own[k], &weighted[k]);
                Before {
                    first: weighted.chi.scaled(x),
                    second: own.psi_rate.scaled(x) + own.drift.scaled(y) + own.axis.scaled(z),
                    turning: own.psi.angular.scaled(x) + own.axis.angular.scaled(y),
                }
            },
            |k, before, _| {
                let (own, weighted, Before { first, second, turning }) = (&own[k], &weighted[k], *before);
                let by_shift = own.by_position.dot(first) + weighted.shifted.dot(second);
                add(
                    k,
                    [
                        turning.dot_plus(weighted.by_position, by_shift),
                        turning.dot_plus(weighted.by_velocity, own.by_velocity.dot(first)),
                        own.inertial.dot(first),
                    ],
                );
            },
        );
        self.sum_beyond(
            beyond,
            |k| {
                let ([x, y, z], own, weighted) = (rates(k), &own[k], &weighted[k]);
                Beyond {
                    first: own.by_position.scaled(x) + own.by_velocity.scaled(y) + own.inertial.scaled(z),
                    second: weighted.shifted.scaled(x),
                    moment: weighted.by_position.scaled(x) + weighted.by_velocity.scaled(y),
                }
            },
            |k, beyond, _| {
                let (own, weighted, Beyond { first, second, moment }) = (&own[k], &weighted[k], *beyond);
                let by_shift = first.dot(weighted.chi) + second.dot(own.psi_rate);
                add(
                    k,
                    [
                        own.psi.angular.dot_plus(moment, by_shift),
                        own.axis.angular.dot_plus(moment, second.dot(own.drift)),
                        second.dot(own.axis),
                    ],
                );
            },
        );
        // Pairs of one joint.
        for last in 0..places.len() {
            let Some(joint) = self.joint_ending_at(last) else { continue };
            let entries = |i: usize, j: usize| {
                self.entries_of_joint(&joint, (i, j), [&own[i], &own[j]], [&weighted[i], &weighted[j]])
            };
            let mut add_pair = |i: usize, j: usize, [ij, ji]: [&EntriesOfJoint<S>; 2]| {
                let [x, y, z] = rates(j);
                let [qq, vv] = [ij.qq + ji.qq, ij.vv + ji.vv].map(|sum| sum.times(0.5));
                let in_q = qq.mul_add(x, ij.vq.mul_add(y, ij.aq * z));
                add(i, [in_q, ji.vq.mul_add(x, vv * y), ji.aq * x]);
            };
            for i in joint.clone() {
                let own = entries(i, i);
                add_pair(i, i, [&own, &own]);
                for j in i + 1..joint.end {
                    let (ij, ji) = (entries(i, j), entries(j, i));
                    add_pair(i, j, [&ij, &ji]);
                    add_pair(j, i, [&ji, &ij]);
                }
            }
        }
    }
}
