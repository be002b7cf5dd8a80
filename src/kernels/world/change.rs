//! The changes of M, P and L_qq along a direction, by scalar products of pairs of joints.

use super::WorldKernel;
use super::composite::{clear_beyond, rate_of_matrix, spread};
use super::group::{Body, Carried, Group, add_force, add_matrix, force_lane, matrix_lane, motion_lane};
use super::group::{motion_along, set_motion};
use super::motion::{across, dot_plus, inward, moved};
use crate::matrix::{Panel, filled};
use crate::robot::{JointKind, Tree};
use crate::scalar::{Scalar, inlined};
use crate::spatial::{Force, Motion, Vec3};

/// What [`WorldKernel::differentiate`] needs beside the kernel.
#[derive(Clone, Debug)]
pub(crate) struct HessianChange<S: Scalar> {
    groups: Vec<Change<S::Pack>>,
    /// The changes of F and G.
    forces: Vec<[Force<S::Pack>; 2]>,
    /// N and the changes of velocities, by place.
    motions: Vec<[Motion<S>; 2]>,
    /// The changes of M, P and L_qq by places, where these are not the joints in their order, and those of P
    /// below the diagonal.
    by_places: Option<Box<[Panel<S>; 3]>>,
    lower: Panel<S>,
}

/// Changes of joints side by side.
#[derive(Clone, Copy, Debug)]
struct Change<P> {
    /// The velocity N that the direction gives the links, and that of the joint axis, `chi = N x S`.
    turning: Motion<P>,
    chi: Motion<P>,
    /// Of the velocity and of psi.
    velocity: Motion<P>,
    psi: Motion<P>,
    /// Of the momentum and of the inertia of the composite body.
    momentum: Force<P>,
    composite: Body<P>,
}

/// The motions of joint i that meet the forces of the joints beyond it, the same in every lane.
struct Meeting<P> {
    axis: Vec3<P>,
    origin: Vec3<P>,
    psi: Motion<P>,
    chi: Motion<P>,
    psi_change: Motion<P>,
    /// The linear parts of `gamma = a_g x S` and of its change, `a_g x chi`.
    gamma: Vec3<P>,
    gamma_change: Vec3<P>,
}

impl<S: Scalar> HessianChange<S> {
    /// Buffers for the tree of a kernel.
    pub fn new(kernel: &WorldKernel<S>) -> Self {
        let (n, groups) = (kernel.places.len(), kernel.groups.len());
        let at_rest = Change {
            turning: Motion::zero(),
            chi: Motion::zero(),
            velocity: Motion::zero(),
            psi: Motion::zero(),
            momentum: Force::zero(),
            composite: Body::zero(),
        };
        let panel = Panel::zeros(n, n);
        let reorders = !kernel.places.are_in_order();
        Self {
            groups: filled(at_rest, groups),
            forces: filled([Force::zero(); 2], groups),
            motions: filled([Motion::zero(); 2], n),
            by_places: reorders.then(|| Box::new([panel.clone(), panel.clone(), panel.clone()])),
            lower: panel,
        }
    }

    /// Velocities N and the changes of those of the links.
    #[inline(always)]
    fn set_motion(&mut self, kernel: &WorldKernel<S>, v: &[S], [dq, dv]: [&[S]; 2]) {
        let lanes = WorldKernel::<S>::LANES;
        // Before the joint: its velocity and the change of that; N that moves its axes, beyond a free joint.
        let mut outer = [Motion::zero(); 3];
        for (k, place) in kernel.places.iter().enumerate() {
            let joint = &kernel.joints[k];
            let (z, arm) = (joint.axes[2], joint.arm);
            let ([mut turning, mut velocity], before) = match place.parent {
                Some(parent) => (
                    self.motions[parent].map(|motion| moved(motion, arm)),
                    moved(kernel.joints[parent].velocity, arm),
                ),
                None => ([Motion::zero(); 2], Motion::zero()),
            };
            outer = if k > place.first {
                outer.map(|motion| moved(motion, arm))
            } else {
                // All axes of a free joint meet at the origin of its first place.
                let parts = (k..=place.last).filter(|_| k < place.last);
                let along = |l: usize| {
                    let place = &kernel.places[l];
                    motion_along(place.kind, kernel.joints[l].axes[2].scaled(place.rate(dq)))
                };
                [before, velocity, parts.fold(turning, |sum, l| sum + along(l))]
            };
            let chi = across(place.kind, outer[2], z);
            let psi = across(place.kind, outer[1], z) + outer[0].cross(chi);
            let [dq, dv, rate] = [dq, dv, v].map(|rates| place.rate(rates));
            match place.kind {
                JointKind::Revolute => {
                    turning.angular = turning.angular.plus_scaled(z, dq);
                    velocity.angular = velocity.angular.plus_scaled(z, dv).plus_scaled(chi.angular, rate);
                }
                JointKind::Prismatic => {
                    turning.linear = turning.linear.plus_scaled(z, dq);
                    velocity.linear = velocity.linear.plus_scaled(z, dv);
                }
            }
            velocity.linear = velocity.linear.plus_scaled(chi.linear, rate);
            self.motions[k] = [turning, velocity];
            let (group, lane) = (&mut self.groups[k / lanes], k % lanes);
            set_motion(&mut group.turning, lane, turning);
            set_motion(&mut group.chi, lane, chi);
            set_motion(&mut group.velocity, lane, velocity);
            set_motion(&mut group.psi, lane, psi);
        }
    }

    /// Changes of momenta and inertias of the composite bodies, then of F and G.
    #[inline(always)]
    fn compose(&mut self, kernel: &WorldKernel<S>) {
        let lanes = WorldKernel::<S>::LANES;
        for (change, group) in self.groups.iter_mut().zip(&kernel.groups) {
            change.set_link(group);
        }
        for (k, place) in kernel.places.iter().enumerate().rev() {
            let Some(parent) = place.parent else { continue };
            let (change, lane, arm) = (&self.groups[k / lanes], k % lanes, kernel.joints[k].arm);
            let momentum: Force<S> = force_lane(&change.momentum, lane);
            let first_moment: Vec3<S> = change.composite.first_moment.lane(lane);
            let mut matrix = matrix_lane(&change.composite.matrix, lane);
            matrix += spread(arm, first_moment);
            let (to, lane) = (&mut self.groups[parent / lanes], parent % lanes);
            add_force(&mut to.momentum, lane, inward(momentum, arm));
            let sum = to.composite.first_moment.lane(lane) + first_moment;
            to.composite.first_moment.set_lane(lane, sum);
            add_matrix(&mut to.composite.matrix, lane, &matrix);
        }
        for ((forces, change), group) in self.forces.iter_mut().zip(&self.groups).zip(&kernel.groups) {
            *forces = change.forces(group);
        }
    }
}

impl<P: Scalar> Change<P> {
    /// Of the links. An inertia that moves with the velocity N has the rate `N x* I - I N x`: that of its
    /// first moment is the linear momentum, that of its mass zero.
    #[inline(always)]
    fn set_link(&mut self, group: &Group<P>) {
        let (body, n) = (&group.body, self.turning);
        self.composite = Body {
            mass: P::zero(),
            first_moment: body.apply(n).force,
            matrix: rate_of_matrix(body, n.angular, n.linear),
        };
        self.momentum = self.composite.apply(group.velocity) + body.apply(self.velocity);
    }

    /// The changes of F and G.
    #[inline(always)]
    fn forces(&self, group: &Group<P>) -> [Force<P>; 2] {
        inlined!(P, {
            let (axis, chi) = (group.axis, self.chi);
            let inertial = self.composite.apply(axis) + group.composite.apply(chi);
            let rate = self.composite.apply(group.psi) + group.composite.apply(self.psi);
            let pulled = |sum: Force<P>, motion: Motion<P>, force: &Force<P>| Force {
                moment: sum
                    .moment
                    .plus_product(motion.angular, force.moment)
                    .plus_product(motion.linear, force.force),
                force: sum.force.plus_product(motion.angular, force.force),
            };
            [inertial, pulled(pulled(rate, chi, &group.momentum), axis, &self.momentum)]
        })
    }
}

impl<S: Scalar> WorldKernel<S> {
    /// The changes of M, P and L_qq, n x n, along (dq, dv), n each, at the velocity v and after
    /// [`hessian`](Self::hessian). Entries of joints on different branches are left as they are.
    ///
    /// With N the velocity that dq gives the links, spatial vectors of a link change by `N x`, inertias by `N
    /// x* I - I N x`. With `chi_i = N_i x S_i`, D for changes, all others as in [`hessian`](Self::hessian)
    ///
    /// ```text
    /// D v_i = sum (S_k dv_k + chi_k v_k)     D psi_i = D v_i x S_i + v_i x chi_i     D gamma_i = a_g x chi_i
    /// D F_j = (D IC_j) S_j + IC_j chi_j
    /// D G_j = (D IC_j) psi_j + IC_j D psi_j + chi_j x* H_j + S_j x* D H_j
    ///
    /// D M_ij = chi_i . F_j + S_i . D F_j     D P_ij = chi_i . G_j + S_i . D G_j     (i <= j)
    /// D P_ji = D psi_i . F_j + psi_i . D F_j
    /// D L_qq,ij = D psi_i . G_j + psi_i . D G_j + D gamma_i . F_j + gamma_i . D F_j
    /// ```
    ///
    /// Axes of a floating or spherical joint move with its link: N_i of chi_i is that beyond the joint, v_i
    /// and D v_i of D psi_i are those before it. [`KernelTwo`](crate::kernels::KernelTwo) computes the same
    /// in body frames, for robots without such joints.
    #[inline(never)]
    pub fn differentiate(
        &mut self,
        tree: &Tree,
        work: &mut HessianChange<S>,
        (v, direction): (&[S], [&[S]; 2]),
        to: &mut [Panel<S>; 3],
    ) {
        work.set_motion(self, v, direction);
        work.compose(self);
        let Some(mut by_places) = work.by_places.take() else { return self.meet_change(tree, work, to) };
        self.meet_change(tree, work, &mut by_places);
        for (from, to) in by_places.iter().zip(to) {
            self.places.take_to_coordinates(from, to);
        }
        work.by_places = Some(by_places);
    }

    /// All entries, by places.
    #[inline(never)]
    fn meet_change(&self, tree: &Tree, work: &mut HessianChange<S>, [m, p, l_qq]: &mut [Panel<S>; 3]) {
        let (gravity, lower) = (Vec3::<S>::constant(tree.gravity()), &mut work.lower);
        for (k, place) in self.places.iter().enumerate() {
            let (block, lane) = (k / Self::LANES, k % Self::LANES);
            let (joint, change) = (&self.joints[k], &work.groups[block]);
            let motion = |motion: &Motion<S::Pack>| motion_lane::<S, _>(motion, lane);
            let (axis, chi) = (joint.axes[2], motion(&change.chi));
            let meeting = Meeting {
                axis: axis.splat(),
                origin: joint.origin.splat(),
                psi: motion(&self.groups[block].psi).splat(),
                chi: chi.splat(),
                psi_change: motion(&change.psi).splat(),
                gamma: gravity.cross(motion_along(place.kind, axis).angular).splat(),
                gamma_change: gravity.cross(chi.angular).splat(),
            };
            let groups = place.groups(Self::LANES);
            let mut rows = [m.row_mut(k), p.row_mut(k), lower.row_mut(k), l_qq.row_mut(k)];
            let [a, b, c, d] = rows.each_mut().map(|row| row[groups.clone()].iter_mut());
            let forces = self.carried[groups.clone()].iter().zip(&self.rates[groups.clone()]);
            let entries = forces.zip(&work.forces[groups]).zip(a.zip(b)).zip(c.zip(d));
            match place.kind {
                JointKind::Revolute => entries.for_each(|(((force, change), (a, b)), (c, d))| {
                    [*a, *b, *c, *d] = revolute(&meeting, force, change);
                }),
                JointKind::Prismatic => entries.for_each(|(((force, change), (a, b)), (c, d))| {
                    [*a, *b, *c, *d] = prismatic(&meeting, force, change);
                }),
            }
            rows.into_iter().for_each(|row| clear_beyond::<S>(row, place.end));
        }
        self.places.mirror(m, None);
        self.places.complete(p, lower);
        self.places.symmetrise(l_qq);
    }
}

/// The changes of M_ij, P_ij, P_ji and L_qq,ij for joint i, revolute, and each joint of a group.
#[inline(always)]
fn revolute<P: Scalar>(
    i: &Meeting<P>,
    (group, rate): (&Carried<P>, &Force<P>),
    [inertial_change, rate_change]: &[Force<P>; 2],
) -> [P; 4] {
    inlined!(P, {
        let distance = group.origin - i.origin;
        let about = |force: &Force<P>| inward(*force, distance);
        let [f, g, df, dg] = [&group.inertial, rate, inertial_change, rate_change].map(about);
        let weights = i.gamma_change.dot_plus(f.force, i.gamma.dot(df.force));
        [
            dot_plus(&i.chi, &f, i.axis.dot(df.moment)),
            dot_plus(&i.chi, &g, i.axis.dot(dg.moment)),
            dot_plus(&i.psi_change, &f, dot_plus(&i.psi, &df, P::zero())),
            dot_plus(&i.psi_change, &g, dot_plus(&i.psi, &dg, weights)),
        ]
    })
}

/// The same for joint i prismatic: its motions have no angular parts, and gravity none in L_qq.
#[inline(always)]
fn prismatic<P: Scalar>(
    i: &Meeting<P>,
    (group, rate): (&Carried<P>, &Force<P>),
    [inertial_change, rate_change]: &[Force<P>; 2],
) -> [P; 4] {
    inlined!(P, {
        let [f, g] = [group.inertial.force, rate.force];
        let [df, dg] = [inertial_change.force, rate_change.force];
        let (chi, psi, psi_change) = (i.chi.linear, i.psi.linear, i.psi_change.linear);
        [
            chi.dot_plus(f, i.axis.dot(df)),
            chi.dot_plus(g, i.axis.dot(dg)),
            psi_change.dot_plus(f, psi.dot(df)),
            psi_change.dot_plus(g, psi.dot(dg)),
        ]
    })
}
