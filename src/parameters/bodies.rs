//! Derivatives of L(q, v) by the inertial parameters of bodies that are fixed to links.

use super::unit::{across_joint, plus_joint};
use crate::kernels::Spread;
use crate::robot::{JointKind, Row, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Inertia, JointPosition, Motion, Symmetric3, Transform, Vec3};

/// Velocities, gravity and joint axes in the frame of each link; their changes along a direction (dq, dv).
///
/// L is linear in the ten parameters of a body: it is the sum of those of ten unit bodies. With `m . I n` of
/// one of them, J_i the axis of joint i seen from the frame of the body and `psi_i = v_i x J_i`,
///
/// ```text
/// p_i = J_i . I v     L_q,i = psi_i . I v + J_i . I a_g
/// D L = dv . I v + xi . I a_g     xi = sum of J_i dq_i
/// tau_i = J_i . I (a - a_g) - (v x J_i) . I v
/// ```
///
/// The parameters are those of the links themselves: the regrouped inertias of the tree are not used.
#[derive(Clone, Debug)]
pub(super) struct UnitBodies<S> {
    pub links: Vec<Link<S>>,
    /// Where the pairs of each joint start; one more at the end.
    pub starts: Vec<usize>,
    /// The joint i of each pair (i, k), i on the way from the base to k, k included.
    pub ancestors: Vec<Ancestor>,
    /// For each pair.
    pub axes: Vec<Seen<S>>,
    /// Positions and rates of all joints.
    spread: [Spread<S>; 2],
}

/// The first joint i of a pair (i, k).
#[derive(Clone, Copy, Debug)]
pub(super) struct Ancestor {
    /// Its coordinate, and its rate over that of the coordinate.
    pub coordinate: usize,
    pub ratio: f64,
    /// Whether no ancestor of k before it has this coordinate.
    pub is_first: bool,
}

/// Quantities of one link, in the frame of its joint in the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link<S> {
    pub position: JointPosition<S>,
    pub velocity: Motion<S>,
    pub gravity: Motion<S>,
    /// Changes along the direction.
    pub velocity_change: Motion<S>,
    pub gravity_change: Motion<S>,
    /// The sum of `S_i dq_i` over the joints before it.
    pub displacement: Motion<S>,
    /// Gravity times the position of the origin in the world.
    pub height: S,
}

/// Axis of a joint and its rate, seen from a frame beyond it, and their changes along the direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<S> {
    pub axis: Motion<S>,
    pub rate: Motion<S>,
    pub axis_change: Motion<S>,
    pub rate_change: Motion<S>,
}

impl<S: Scalar> UnitBodies<S> {
    pub fn new(tree: &Tree) -> Self {
        let (mut starts, mut ancestors) = (vec![0], Vec::new());
        let rows = tree.rows();
        for (k, joint) in tree.joints().iter().enumerate() {
            if let Some(parent) = joint.parent {
                ancestors.extend_from_within(starts[parent]..starts[parent + 1]);
            }
            let Row { coordinate, ratio, .. } = rows[k];
            let outer = &ancestors[starts[k]..];
            let is_first = outer.iter().all(|other: &Ancestor| other.coordinate != coordinate);
            ancestors.push(Ancestor { coordinate, ratio, is_first });
            starts.push(ancestors.len());
        }
        let still = |position| Link {
            position,
            velocity: Motion::zero(),
            gravity: Motion::zero(),
            velocity_change: Motion::zero(),
            gravity_change: Motion::zero(),
            displacement: Motion::zero(),
            height: S::zero(),
        };
        let none = Motion::zero();
        Self {
            links: tree.joints().iter().map(|joint| still(joint.position(S::zero()))).collect(),
            axes: vec![
                Seen { axis: none, rate: none, axis_change: none, rate_change: none };
                ancestors.len()
            ],
            starts,
            ancestors,
            spread: [Spread::new(tree), Spread::new(tree)],
        }
    }

    /// Velocities and gravity at (q, v).
    #[inline(never)]
    pub fn set_state(&mut self, tree: &Tree, q: &[S], v: &[S]) {
        let [positions, rates] = &mut self.spread;
        let (q, v) = (positions.positions(tree, q), rates.rates(tree, v));
        for (i, joint) in tree.joints().iter().enumerate() {
            let to_here = joint.transform(q[i]);
            let (velocity, gravity) = match joint.parent {
                Some(parent) => (self.links[parent].velocity, self.links[parent].gravity),
                None => (Motion::zero(), translation(Vec3::constant(tree.gravity()))),
            };
            let link = &mut self.links[i];
            link.velocity = plus_joint(joint.kind, to_here.motion_down(velocity), v[i]);
            link.gravity = translation(to_here.vector_down(gravity.linear));
            link.position = to_here.joint;
        }
    }

    /// Heights of the origins, after [`set_state`](Self::set_state).
    pub fn set_heights(&mut self, tree: &Tree) {
        for (i, joint) in tree.joints().iter().enumerate() {
            let arm = origin(&joint.transform_at(self.links[i].position));
            let (height, gravity) = match joint.parent {
                Some(parent) => (self.links[parent].height, self.links[parent].gravity.linear),
                None => (S::zero(), Vec3::constant(tree.gravity())),
            };
            self.links[i].height = height + gravity.dot(arm);
        }
    }

    /// Changes of velocities and gravity along (dq, dv).
    #[inline(never)]
    pub fn set_direction(&mut self, tree: &Tree, dq: &[S], dv: &[S]) {
        let [first, second] = &mut self.spread;
        let (dq, dv) = (first.rates(tree, dq), second.rates(tree, dv));
        for (i, joint) in tree.joints().iter().enumerate() {
            let to_here = joint.transform_at(self.links[i].position);
            let (velocity, gravity, displacement) = match joint.parent {
                Some(parent) => {
                    let outer = &self.links[parent];
                    (outer.velocity_change, outer.gravity_change, outer.displacement)
                }
                None => (Motion::zero(), Motion::zero(), Motion::zero()),
            };
            let link = &mut self.links[i];
            let moved = to_here.motion_down(velocity) + across_joint(joint.kind, link.velocity, dq[i]);
            link.velocity_change = plus_joint(joint.kind, moved, dv[i]);
            let turned = translation(to_here.vector_down(gravity.linear));
            link.gravity_change = turned + across_joint(joint.kind, link.gravity, dq[i]);
            link.displacement = plus_joint(joint.kind, to_here.motion_down(displacement), dq[i]);
        }
    }

    /// Axes of joints in all frames beyond them, after [`set_state`](Self::set_state).
    #[inline(never)]
    pub fn carry_axes(&mut self, tree: &Tree) {
        carry(tree, (&self.links, &self.starts), &mut self.axes, |to_here, _, _, from, to| {
            to.axis = to_here.motion_down(from.axis)
        });
    }

    /// Rates of the axes likewise, after [`carry_axes`](Self::carry_axes).
    #[inline(never)]
    pub fn carry_rates(&mut self, tree: &Tree) {
        carry(tree, (&self.links, &self.starts), &mut self.axes, |to_here, _, _, from, to| {
            to.rate = to_here.motion_down(from.rate)
        });
    }

    /// Changes of axes and rates along the direction, after [`carry_rates`](Self::carry_rates) and
    /// [`set_direction`](Self::set_direction).
    #[inline(never)]
    pub fn carry_changes(&mut self, tree: &Tree, dq: &[S]) {
        let Self { links, starts, axes, spread: [spread, _], .. } = self;
        let dq = spread.rates(tree, dq);
        carry(tree, (links, starts), axes, |to_here, k, kind, from, to| {
            let left_behind = |change, m| to_here.motion_down(change) + across_joint(kind, m, dq[k]);
            to.axis_change = left_behind(from.axis_change, to.axis);
            to.rate_change = left_behind(from.rate_change, to.rate);
        });
    }

    /// The motion of each link with joint rates w.
    pub fn motions(&mut self, tree: &Tree, w: &[S], motions: &mut [Motion<S>]) {
        let w = self.spread[0].rates(tree, w);
        for (i, joint) in tree.joints().iter().enumerate() {
            let outer = joint.parent.map_or(Motion::zero(), |parent| motions[parent]);
            let to_here = joint.transform_at(self.links[i].position);
            motions[i] = plus_joint(joint.kind, to_here.motion_down(outer), w[i]);
        }
    }
}

/// The motion of a body that only translates.
#[inline(always)]
fn translation<S: Scalar>(linear: Vec3<S>) -> Motion<S> {
    Motion { angular: Vec3::zero(), linear }
}

/// The origin of a frame in that of its parent: the first moment there of a unit mass.
fn origin<S: Scalar>(transform: &Transform<'_, S>) -> Vec3<S> {
    let point = Inertia { mass: 1.0, first_moment: Vec3::zero(), matrix: Symmetric3::zero() };
    transform.inertia_up(&point).first_moment
}

/// From joint to joint: each axis at its own joint, then `pass` from the frame before to that of joint k.
#[inline(always)]
fn carry<S: Scalar>(
    tree: &Tree,
    (links, starts): (&[Link<S>], &[usize]),
    axes: &mut [Seen<S>],
    pass: impl Fn(&Transform<'_, S>, usize, JointKind, &Seen<S>, &mut Seen<S>),
) {
    for (k, joint) in tree.joints().iter().enumerate() {
        let link = &links[k];
        let to_here = joint.transform_at(link.position);
        let (before, from_here) = axes.split_at_mut(starts[k]);
        if let Some(parent) = joint.parent {
            let outer = &before[starts[parent]..starts[parent + 1]];
            for (from, to) in outer.iter().zip(from_here.iter_mut()) {
                pass(&to_here, k, joint.kind, from, to);
            }
        }
        let own = &mut from_here[starts[k + 1] - starts[k] - 1];
        *own = Seen {
            axis: plus_joint(joint.kind, Motion::zero(), S::one()),
            rate: across_joint(joint.kind, link.velocity, S::one()),
            axis_change: Motion::zero(),
            rate_change: across_joint(joint.kind, link.velocity_change, S::one()),
        };
    }
}
