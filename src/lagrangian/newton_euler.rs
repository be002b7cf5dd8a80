//! Inverse dynamics by one outward and one inward sweep, without a matrix.

use crate::kernels::{Coupled, Spread, along_joint};
use crate::matrix::filled;
use crate::robot::{JointFrame, JointKind, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Force, JointPosition, Motion, Vec3};

/// `tau = M a + C v + g` by the recursive Newton-Euler equations, O(n), in body frames with the joint axis
/// along z.
///
/// With `psi_i = v_i x S_i` and the base accelerated against gravity in place of weights:
///
/// ```text
/// v_i = v_parent + S_i v_i     a_i = a_parent + S_i a_i + psi_i v_i
/// f_i = I_i a_i + v_i x* I_i v_i + sum of f_child     tau_i = S_i . f_i
/// ```
///
/// It shares only the transforms and the link parameters with kernel one, so that the two check each other.
#[derive(Clone, Debug)]
pub(super) struct NewtonEuler<S> {
    positions: Vec<JointPosition<S>>,
    velocities: Vec<Motion<S>>,
    accelerations: Vec<Motion<S>>,
    forces: Vec<Force<S>>,
    /// Positions, velocities and accelerations of all joints.
    all: [Spread<S>; 3],
    /// Actuation without friction (N m, N).
    tau: Coupled<Vec<S>>,
}

impl<S: Scalar> NewtonEuler<S> {
    #[inline(never)]
    pub fn new(tree: &Tree) -> Self {
        let n = tree.joints().len();
        Self {
            positions: tree.joints().iter().map(|joint| joint.position(S::zero())).collect(),
            velocities: filled(Motion::zero(), n),
            accelerations: filled(Motion::zero(), n),
            forces: filled(Force::zero(), n),
            all: [(); 3].map(|()| Spread::new(tree)),
            tau: Coupled::row(tree),
        }
    }

    /// Actuation without friction, n (N m, N).
    pub fn tau(&self) -> &[S] {
        self.tau.get()
    }

    /// Fills tau from links, armature and springs; all arguments have length n.
    #[inline(never)]
    pub fn solve(&mut self, tree: &Tree, q: &[S], v: &[S], a: &[S]) {
        let [all_q, all_v, all_a] = &mut self.all;
        let (q, v, a) = (all_q.positions(tree, q), all_v.rates(tree, v), all_a.rates(tree, a));
        let base = Motion { angular: Vec3::zero(), linear: -Vec3::constant(tree.gravity()) };
        for (i, joint) in tree.joints().iter().enumerate() {
            let to_here = joint.transform(q[i]);
            let (velocity, acceleration) = match joint.parent {
                Some(parent) => (
                    to_here.motion_down(self.velocities[parent]),
                    to_here.motion_down(self.accelerations[parent]),
                ),
                None => (Motion::zero(), to_here.motion_down(base)),
            };
            let (velocity, acceleration) = beyond_joint(joint.kind, velocity, acceleration, v[i], a[i]);
            self.forces[i] = rate_of_momentum(joint, velocity, acceleration);
            self.positions[i] = to_here.joint;
            self.velocities[i] = velocity;
            self.accelerations[i] = acceleration;
        }
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            self.tau.all[i] = along_joint(joint.kind, &self.forces[i]);
            if joint.spring.stiffness != 0.0 {
                self.tau.all[i] += q[i].plus(-joint.spring.rest).times(joint.spring.stiffness);
            }
            if let Some(parent) = joint.parent {
                let moved = joint.transform_at(self.positions[i]).force_up(self.forces[i]);
                self.forces[parent] = self.forces[parent] + moved;
            }
        }
        for &(i, j, value) in tree.armature() {
            self.tau.all[i] += a[j].times(value);
            if i != j {
                self.tau.all[j] += a[i].times(value);
            }
        }
        self.tau.sum(tree);
    }
}

/// `v + S rate`, `a + S acceleration + (v x S) rate`.
#[inline(always)]
fn beyond_joint<S: Scalar>(
    kind: JointKind,
    mut velocity: Motion<S>,
    mut moved: Motion<S>,
    rate: S,
    acceleration: S,
) -> (Motion<S>, Motion<S>) {
    let turning = velocity.angular;
    match kind {
        JointKind::Revolute => {
            moved.angular.x += turning.y * rate;
            moved.angular.y -= turning.x * rate;
            moved.angular.z += acceleration;
            moved.linear.x += velocity.linear.y * rate;
            moved.linear.y -= velocity.linear.x * rate;
            velocity.angular.z += rate;
        }
        JointKind::Prismatic => {
            moved.linear.x += turning.y * rate;
            moved.linear.y -= turning.x * rate;
            moved.linear.z += acceleration;
            velocity.linear.z += rate;
        }
    }
    (velocity, moved)
}

/// `I a + v x* I v` of one link, with regrouped inertial parameters.
#[inline(always)]
fn rate_of_momentum<S: Scalar>(joint: &JointFrame, velocity: Motion<S>, acceleration: Motion<S>) -> Force<S> {
    let momentum: Force<S> = joint.lumped.apply(velocity);
    let (w, v) = (velocity.angular, velocity.linear);
    let gyroscopic =
        Force { moment: w.cross(momentum.moment) + v.cross(momentum.force), force: w.cross(momentum.force) };
    joint.lumped.apply(acceleration) + gyroscopic
}
