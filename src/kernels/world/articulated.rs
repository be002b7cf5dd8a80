//! Forward dynamics by articulated bodies.

use super::WorldKernel;
use super::articulated_inertia::Articulated;
use super::group::{Body, along_axis, force_lane, matrix_lane};
use super::motion::{inward, moved};
use crate::matrix::filled;
use crate::robot::{JointKind, Tree};
use crate::scalar::{Pack, Scalar};
use crate::spatial::{Force, Motion};

/// Articulated bodies of a tree: `a = M^-1 (u - C v - g)` in O(n), for armature that couples no joints.
///
/// With p the force on the articulated body of joint k at the accelerations of the motion set last, from the
/// tips inward
///
/// ```text
/// U_k = IA_k S_k     D_k = S_k . U_k + armature     x_k = (u_k - S_k . p_k) / D_k
/// IA_parent += IA_k - U_k U_k' / D_k                p_parent += p_k + U_k x_k
/// ```
///
/// then outward `a_k = x_k - U_k . m_parent / D_k`, `m_k = m_parent + S_k a_k` (R. Featherstone, Rigid Body
/// Dynamics Algorithms (2008), section 7.3). D_k are the pivots of `M = L' D L`.
#[derive(Clone, Debug)]
pub(crate) struct ArticulatedBodies<S> {
    /// Diagonal of the armature, by joint; all others by place.
    armature: Vec<f64>,
    inertias: Vec<Articulated<S>>,
    forces: Vec<Force<S>>,
    gains: Vec<Gain<S>>,
    motions: Vec<Motion<S>>,
    /// D, and the scales of their rounding errors, by place.
    pivots: Vec<S>,
    sizes: Vec<S>,
    /// What the joints beyond add to the scale of a revolute joint.
    scales: Vec<S>,
}

/// `U / D` and x.
#[derive(Clone, Copy, Debug)]
struct Gain<S> {
    force: Force<S>,
    rate: S,
}

/// Pivots above this part of their scales are regular: several must lose five digits each before the error of
/// one is as large as itself. Otherwise the errors are propagated.
const SETTLED: f64 = 1e-5;

impl<S: Scalar> ArticulatedBodies<S> {
    /// Whether articulated bodies hold the dynamics of the tree: armature couples no joints.
    pub fn suit(tree: &Tree) -> bool {
        tree.armature().iter().all(|&(i, j, _)| i == j)
    }

    /// Buffers for a tree.
    #[inline(never)]
    pub fn new(tree: &Tree) -> Self {
        let n = tree.dof();
        let mut armature = vec![0.0; n];
        tree.armature().iter().filter(|(i, j, _)| i == j).for_each(|&(i, _, value)| armature[i] = value);
        let slack = Force::zero();
        Self {
            armature,
            inertias: filled(Articulated::zero(), n),
            forces: filled(slack, n),
            gains: filled(Gain { force: slack, rate: S::zero() }, n),
            motions: filled(Motion::zero(), n),
            pivots: filled(S::zero(), n),
            sizes: filled(S::zero(), n),
            scales: filled(S::zero(), n),
        }
    }

    /// `a <- M^-1 (a - tau)`, n, for the inverse dynamics tau at the motion set last in `kernel`, without
    /// springs and friction.
    ///
    /// # Errors
    /// The index of a joint whose pivot is not above its rounding error, as
    /// [`Factor::factor`](crate::kernels::Factor::factor).
    #[inline(never)]
    pub fn solve(&mut self, tree: &Tree, kernel: &WorldKernel<S>, a: &mut [S]) -> Result<(), usize> {
        self.take_links(kernel);
        self.scales.fill(S::zero());
        for (k, place) in kernel.places.iter().enumerate().rev() {
            let (joint, kind, axis) = (place.joint, place.kind, kernel.joints[k].axes[2]);
            let (inertia, force) = (&self.inertias[k], self.forces[k]);
            let u = inertia.along(kind, axis);
            let pivot = along_axis(kind, axis, &u).plus(self.armature[joint]);
            let inverse = pivot.recip();
            let gain = Force { moment: u.moment.scaled(inverse), force: u.force.scaled(inverse) };
            let rest = a[joint] - along_axis(kind, axis, &force);
            self.pivots[k] = pivot;
            let scale = if S::CHECKED { self.scales[k] + inertia.turning_scale() } else { S::zero() };
            if S::CHECKED {
                self.sizes[k] = match kind {
                    JointKind::Revolute => scale.plus(self.armature[joint]),
                    JointKind::Prismatic => {
                        S::from_f64(tree.joints()[joint].subtree_mass + self.armature[joint])
                    }
                };
            }
            self.gains[k] = Gain { force: gain, rate: rest * inverse };
            if let Some(parent) = place.parent {
                let arm = kernel.joints[k].arm;
                if S::CHECKED {
                    self.scales[parent] += inertia.pulling_scale().mul_add(arm.dot(arm), scale);
                }
                let moved = inertia.less(&u, &gain).shifted(arm);
                self.inertias[parent].add(&moved);
                let force = Force {
                    moment: force.moment.plus_scaled(gain.moment, rest),
                    force: force.force.plus_scaled(gain.force, rest),
                };
                self.forces[parent] = self.forces[parent] + inward(force, arm);
            }
        }
        self.accelerate(kernel, a);
        if S::CHECKED { self.check_pivots(kernel) } else { Ok(()) }
    }

    /// Links and the forces on them.
    #[inline(always)]
    fn take_links(&mut self, kernel: &WorldKernel<S>) {
        let lanes = WorldKernel::<S>::LANES;
        let bodies = self.inertias.chunks_mut(lanes).zip(self.forces.chunks_mut(lanes));
        for (group, (inertias, forces)) in kernel.groups.iter().zip(bodies) {
            for (lane, (inertia, force)) in inertias.iter_mut().zip(forces).enumerate() {
                let Body { mass, first_moment, matrix } = &group.body;
                *inertia =
                    Articulated::rigid(matrix_lane(matrix, lane), first_moment.lane(lane), mass.lane(lane));
                *force = force_lane(&group.force, lane);
            }
        }
    }

    /// Accelerations from the base outward.
    #[inline(always)]
    fn accelerate(&mut self, kernel: &WorldKernel<S>, a: &mut [S]) {
        for (k, place) in kernel.places.iter().enumerate() {
            let (axis, gain) = (kernel.joints[k].axes[2], &self.gains[k]);
            let mut motion = match place.parent {
                Some(parent) => moved(self.motions[parent], kernel.joints[k].arm),
                None => Motion::zero(),
            };
            let rate = gain.rate - gain.force.dot(motion);
            match place.kind {
                JointKind::Revolute => motion.angular = motion.angular.plus_scaled(axis, rate),
                JointKind::Prismatic => motion.linear = motion.linear.plus_scaled(axis, rate),
            }
            (self.motions[k], a[place.joint]) = (motion, rate);
        }
    }

    /// Compares each pivot with its possible rounding error, as the factorisation does: `eps sum_k U_ki^2
    /// size_k`, which is the derivative of pivot D_i when the entries of armature grow by `eps size_k`.
    ///
    /// The sizes are those of what was added up: inertias of articulated bodies, which are smaller than those
    /// of the composite bodies in M.
    fn check_pivots(&mut self, kernel: &WorldKernel<S>) -> Result<(), usize> {
        let mut both = self.pivots.iter().zip(&self.sizes);
        let settled = both.all(|(pivot, size)| S::all(size.times(SETTLED).less(*pivot)));
        if settled { Ok(()) } else { self.check_changes(kernel) }
    }

    /// Derivatives of the pivots, from the tips inward.
    #[inline(never)]
    fn check_changes(&mut self, kernel: &WorldKernel<S>) -> Result<(), usize> {
        let unit = 128.0 * S::EPSILON;
        let mut first = Ok(());
        self.inertias.fill(Articulated::zero());
        for (k, place) in kernel.places.iter().enumerate().rev() {
            let (axis, gain) = (kernel.joints[k].axes[2], &self.gains[k].force);
            let change = &self.inertias[k];
            let u = change.along(place.kind, axis);
            let pivot = along_axis(place.kind, axis, &u) + self.sizes[k];
            if first.is_ok() && !S::all(pivot.times(unit).less(self.pivots[k])) {
                first = Err(place.joint);
            }
            if let Some(parent) = place.parent {
                let half = pivot.times(-0.5);
                let rest = Force {
                    moment: u.moment.plus_scaled(gain.moment, half),
                    force: u.force.plus_scaled(gain.force, half),
                };
                let moved = change.less(&rest, gain).less(gain, &rest);
                self.inertias[parent].add(&moved.shifted(kernel.joints[k].arm));
            }
        }
        first
    }
}
