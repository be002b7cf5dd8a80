//! Composite bodies in the axes of the world, and the mass matrix.

use super::WorldKernel;
use super::group::{Body, Carried, add_force, add_matrix, force_lane, matrix_lane};
use super::motion::inward;
use crate::kernels::Factor;
use crate::kernels::coupling::size_of_sum;
use crate::matrix::Matrix;
use crate::robot::{JointKind, Tree};
use crate::scalar::{Pack, Scalar, inlined};
use crate::spatial::{Force, Symmetric3, Vec3};

/// `2 (r.w) 1 - r w' - w r'`: what a first moment 2 w adds to an inertia matrix about an origin that is moved
/// by r.
#[inline(always)]
pub(super) fn spread<S: Scalar>(r: Vec3<S>, w: Vec3<S>) -> Symmetric3<S> {
    inlined!(S, {
        let (x, y, z) = (r.x * w.x, r.y * w.y, r.z * w.z);
        let twice = |a: S| a + a;
        Symmetric3 {
            xx: twice(y + z),
            yy: twice(x + z),
            zz: twice(x + y),
            xy: -r.x.mul_add(w.y, r.y * w.x),
            xz: -r.x.mul_add(w.z, r.z * w.x),
            yz: -r.y.mul_add(w.z, r.z * w.y),
        }
    })
}

impl<S: Scalar> WorldKernel<S> {
    /// Composite bodies, F = IC S and M with armature at the position set last.
    #[inline(never)]
    pub fn compose(&mut self, tree: &Tree) {
        self.compose_bodies(tree);
        self.write_mass_matrix(tree);
    }

    /// The same for [`factor`](Self::factor) alone, if `alone`: [`mass_matrix`](Self::mass_matrix) is not
    /// set.
    #[inline(always)]
    pub fn compose_for_factor(&mut self, tree: &Tree, alone: bool) {
        self.compose_bodies(tree);
        if !alone || !self.factors_panel {
            self.write_mass_matrix(tree);
        }
    }

    /// Factors M, after [`compose_for_factor`](Self::compose_for_factor) and [`set_reach`](Self::set_reach).
    ///
    /// # Errors
    /// See [`Factor::factor`].
    pub fn factor(&self, tree: &Tree, factor: &mut Factor<S>) -> Result<(), usize> {
        let [panel, _] = &self.lower;
        if self.factors_panel {
            factor.factor_panel(panel, |k| self.reach.size(k, panel.get(k, k)))
        } else {
            factor.factor(self.mass_matrix.get(), |k| self.size_of_entry(tree, k))
        }
    }

    /// Composite bodies, F and M by places.
    #[inline(never)]
    fn compose_bodies(&mut self, tree: &Tree) {
        for (group, links) in self.groups.iter_mut().zip(&self.links) {
            group.composite = Body { mass: links.composite_mass, ..group.body };
        }
        for (k, place) in self.places.iter().enumerate().rev() {
            let Some(parent) = place.parent else { continue };
            let (mass, arm) = (tree.joints()[place.joint].lumped_mass, self.joints[k].arm);
            let (group, lane) = (&self.groups[k / Self::LANES], k % Self::LANES);
            let h: Vec3<S> = group.composite.first_moment.lane(lane);
            let mut matrix = matrix_lane(&group.composite.matrix, lane);
            let carried = arm.times(mass);
            matrix += spread(arm, h + carried.times(0.5));
            let (to, lane) = (&mut self.groups[parent / Self::LANES].composite, parent % Self::LANES);
            let sum = to.first_moment.lane(lane) + h + carried;
            to.first_moment.set_lane(lane, sum);
            add_matrix(&mut to.matrix, lane, &matrix);
        }
        for (group, carried) in self.groups.iter().zip(&mut self.carried) {
            carried.inertial = group.composite.apply(group.axis);
        }
        self.fill_mass_matrix();
        if self.factors_panel {
            let [panel, _] = &mut self.lower;
            for &(k, _, value) in tree.armature() {
                let (pack, lane) = (k / Self::LANES, k % Self::LANES);
                let row = panel.row_mut(k);
                row[pack] = row[pack].with_lane(lane, row[pack].lane(lane).plus(value));
            }
        }
    }

    /// M by joints.
    #[inline(never)]
    fn write_mass_matrix(&mut self, tree: &Tree) {
        let [panel, _] = &self.lower;
        let all = &mut self.mass_matrix.all;
        self.places.write(panel, all);
        if self.factors_panel {
            return;
        }
        for &(i, j, value) in tree.armature() {
            let on_one_branch = tree.subtree(j).contains(&i);
            let entry = if on_one_branch { all[(i, j)].plus(value) } else { S::from_f64(value) };
            all[(i, j)] = entry;
            all[(j, i)] = entry;
        }
        self.mass_matrix.sum_symmetric(tree);
    }

    /// Mass matrix M, armature included, n x n.
    pub fn mass_matrix(&self) -> &Matrix<S> {
        self.mass_matrix.get()
    }

    /// What [`size_of_entry`](Self::size_of_entry) needs of the configuration set last, which is q (nq).
    pub fn set_reach(&mut self, tree: &Tree, q: &[S]) {
        let coordinates = if tree.free().is_empty() { q } else { &self.chart };
        self.reach.set_position(tree, self.all.positions(tree, coordinates));
    }

    /// The scale of the rounding error of `M_kk`, see
    /// [`KernelOne::size_of_entry`](crate::kernels::KernelOne::size_of_entry).
    ///
    /// After [`set_reach`](Self::set_reach).
    pub fn size_of_entry(&self, tree: &Tree, k: usize) -> S {
        size_of_sum(tree, k, |i| self.reach.size(i, self.mass_matrix.all[(i, i)]))
    }

    /// Exchanges the matrix of M for another of the same size, which [`compose`](Self::compose) fills next.
    ///
    /// Entries of joints on different branches are never set: they must be zero there too.
    pub fn swap_mass_matrix(&mut self, other: &mut Matrix<S>) {
        std::mem::swap(&mut self.mass_matrix.all, other);
    }

    /// Momenta, forces and rates of inertia of the composite bodies, at the motion set last.
    #[inline(never)]
    pub(super) fn compose_motion(&mut self) {
        for group in &mut self.groups {
            group.rate = rate_of_matrix(&group.body, group.velocity.angular, group.velocity.linear);
        }
        for (k, place) in self.places.iter().enumerate().rev() {
            let Some(parent) = place.parent else { continue };
            let (group, lane, arm) = (&self.groups[k / Self::LANES], k % Self::LANES, self.joints[k].arm);
            let momentum: Force<S> = force_lane(&group.momentum, lane);
            let force: Force<S> = force_lane(&group.force, lane);
            let mut rate = matrix_lane(&group.rate, lane);
            // The rate of the first moment is the linear momentum.
            rate += spread(arm, momentum.force);
            let (to, lane) = (&mut self.groups[parent / Self::LANES], parent % Self::LANES);
            add_force(&mut to.momentum, lane, inward(momentum, arm));
            add_force(&mut to.force, lane, inward(force, arm));
            add_matrix(&mut to.rate, lane, &rate);
        }
    }

    /// M without armature by places, n x n, at the composite bodies.
    #[inline(never)]
    fn fill_mass_matrix(&mut self) {
        let (places, [entries, _]) = (&self.places, &mut self.lower);
        for (k, place) in places.iter().enumerate() {
            let axis: Vec3<S::Pack> = self.joints[k].axes[2].splat();
            let origin: Vec3<S::Pack> = self.joints[k].origin.splat();
            let about = |force: &Force<S::Pack>, end: Vec3<S::Pack>| inward(*force, end - origin).moment;
            let (first, row) = (k / Self::LANES, entries.row_mut(k));
            let forces = self.carried[first..place.end.div_ceil(Self::LANES)].iter();
            let entries = forces.zip(&mut row[first..]);
            match place.kind {
                JointKind::Revolute => entries.for_each(|(Carried { origin: end, inertial, .. }, entry)| {
                    *entry = axis.dot(about(inertial, *end));
                }),
                JointKind::Prismatic => entries.for_each(|(carried, entry)| {
                    *entry = axis.dot(carried.inertial.force);
                }),
            }
            clear_beyond::<S>(row, place.end);
        }
        places.mirror(entries, None);
    }
}

/// Zeros in the lanes of a row after a subtree that ends before place `end`, in its last pack.
#[inline(always)]
pub(super) fn clear_beyond<S: Scalar>(row: &mut [S::Pack], end: usize) {
    let last = (end - 1) / <S::Pack as Pack<S>>::LANES;
    row[last] = row[last].before(end - last * <S::Pack as Pack<S>>::LANES, S::Pack::zero());
}

/// The rate of the inertia matrix of a body about a fixed point: `w x J + (w x J)' + 2 (v.h) 1 - v h' - h
/// v'`.
#[inline(always)]
pub(super) fn rate_of_matrix<P: Scalar>(body: &Body<P>, w: Vec3<P>, v: Vec3<P>) -> Symmetric3<P> {
    inlined!(P, {
        let (h, j) = (body.first_moment, &body.matrix);
        let mut rate = spread(v, h);
        let twice = |a: P| a + a;
        rate.xx += twice(w.y.mul_add(j.xz, -(w.z * j.xy)));
        rate.yy += twice(w.z.mul_add(j.xy, -(w.x * j.yz)));
        rate.zz += twice(w.x.mul_add(j.yz, -(w.y * j.xz)));
        rate.xy += w.y.mul_add(j.yz, w.z.mul_add(j.xx - j.yy, -(w.x * j.xz)));
        rate.xz += w.z.mul_add(-j.yz, w.y.mul_add(j.zz - j.xx, w.x * j.xy));
        rate.yz += w.z.mul_add(j.xz, w.x.mul_add(j.yy - j.zz, -(w.y * j.xy)));
        rate
    })
}
