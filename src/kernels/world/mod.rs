//! The dynamics in the axes of the world, each joint about its own origin, several joints side by side.
//!
//! Nothing is turned from joint to joint here: a force moves to another origin by one product with the
//! distance. What depends on one joint only is computed for as many joints at once as a pack has lanes.
//! Zeros and ones of a model save nothing, so that code generated for one robot takes fewer operations in
//! body frames on short branches, while packs take less time at every size (`docs/frames.md`).

mod articulated;
mod articulated_inertia;
mod change;
mod composite;
mod contraction;
mod group;
mod hessian;
mod motion;
mod places;
mod products;
mod torque;

use super::coupling::{Coupled, Spread};
use super::reach::Reach;
use crate::matrix::{Matrix, Panel, filled};
use crate::robot::{FreeJoint, FreeKind, JointKind, Tree};
use crate::scalar::{Pack, Scalar};
use crate::spatial::{Force, JointPosition, Motion, Vec3};
pub(crate) use articulated::ArticulatedBodies;
pub(crate) use change::HessianChange;
pub(crate) use contraction::{TorqueContraction, TorqueHessian};
use group::{Carried, Group, Links, motion_along, set_motion};
use places::Places;
pub(crate) use products::Sums;
use std::ops::Range;

/// The joints of a tree in the axes of the world: positions, motions, forces, M, and the derivatives of
/// inverse dynamics.
///
/// A subtree is a range of places: the order is depth first.
#[derive(Clone, Debug)]
pub(crate) struct WorldKernel<S: Scalar> {
    places: Places,
    turns: Vec<JointPosition<S>>,
    reach: Reach<S>,
    /// Coordinates of the chains of floating and spherical joints; empty where there are none.
    chart: Vec<S>,
    /// Positions of all joints.
    all: Spread<S>,
    /// Places of the chains of floating and spherical joints.
    free: Vec<Range<usize>>,
    links: Vec<Links<S::Pack>>,
    groups: Vec<Group<S::Pack>>,
    joints: Vec<Joint<S>>,
    carried: Vec<Carried<S::Pack>>,
    /// G, likewise.
    rates: Vec<Force<S::Pack>>,
    /// Rows i of entries (i, j), and of (j, i), j beyond i: those of tau_q, then those of tau_v.
    upper: [Panel<S>; 2],
    lower: [Panel<S>; 2],
    mass_matrix: Coupled<Matrix<S>>,
    /// Whether M by places, with armature, is M and factored by blocks: the order is that of the joints, and
    /// armature couples none.
    factors_panel: bool,
}

/// What the next joint needs of a joint.
#[derive(Clone, Copy, Debug)]
struct Joint<S> {
    axes: [Vec3<S>; 3],
    /// Origin seen from that of the parent, and from that of the first revolute joint of the branch.
    arm: Vec3<S>,
    origin: Vec3<S>,
    velocity: Motion<S>,
    acceleration: Motion<S>,
}

impl<S: Scalar> WorldKernel<S> {
    /// Joints in a group.
    const LANES: usize = <S::Pack as Pack<S>>::LANES;

    /// Buffers for a tree.
    #[inline(never)]
    pub fn new(tree: &Tree) -> Self {
        let n = tree.joints().len();
        let places = Places::new(tree, Self::LANES);
        let chunks = places.chunks(Self::LANES);
        let links = chunks.map(|some| {
            let joints: Vec<_> = some.iter().map(|place| &tree.joints()[place.joint]).collect();
            Links::new(&joints)
        });
        let (none, still) = (Vec3::zero(), Motion::zero());
        let at_rest =
            Joint { axes: [none; 3], arm: none, origin: none, velocity: still, acceleration: still };
        let groups = n.div_ceil(Self::LANES);
        let panel = Panel::zeros(n, n);
        let chain = |free: &FreeJoint| {
            let first = places.iter().position(|place| place.joint + free.kind.slides() == free.turned);
            first.map(|first| first..first + free.kind.dof())
        };
        Self {
            free: tree.free().iter().filter_map(|free| chain(&free.joint)).collect(),
            reach: Reach::new(tree),
            turns: filled(JointPosition::Translated(S::zero()), n),
            chart: filled(S::zero(), if tree.free().is_empty() { 0 } else { tree.dof() }),
            all: Spread::new(tree),
            links: links.collect(),
            groups: filled(Group::zero(), groups),
            carried: filled(Carried::zero(), groups),
            rates: filled(Force::zero(), groups),
            joints: filled(at_rest, n),
            upper: [panel.clone(), panel.clone()],
            lower: [panel.clone(), panel],
            mass_matrix: Coupled::square(tree),
            factors_panel: Panel::<S>::in_blocks(n)
                && places.are_in_order()
                && tree.armature().iter().all(|&(i, j, _)| i == j),
            places,
        }
    }

    /// Axes and origins at q (rad, m; length nq), and the links there. Rates of floating and spherical joints
    /// are those of the twist of the moved frame in its axes.
    #[inline(never)]
    pub fn set_position(&mut self, tree: &Tree, q: &[S]) {
        if !tree.free().is_empty() {
            tree.chart_coordinates(q, &mut self.chart);
        }
        let coordinates = if tree.free().is_empty() { q } else { &self.chart };
        let all = self.all.positions(tree, coordinates);
        super::joint_positions::joint_positions(tree, all, |i, position| self.turns[i] = position);
        for free in tree.free() {
            self.turns[free.joint.turned] = JointPosition::Oriented(free.orientation(q));
        }
        for (k, place) in self.places.iter().enumerate() {
            let fixed = &tree.joints()[place.joint].screw;
            let [mut x, mut y, mut z] = match place.parent {
                Some(parent) => self.joints[parent].axes,
                None => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec3::constant),
            };
            if let Some(gamma) = &fixed.gamma {
                [x, y] = turned([x, y], |pair| gamma.undo(pair));
            }
            let mut arm = Vec3::zero();
            if place.parent.is_some() {
                let [a, b, c] = fixed.translation;
                arm = Vec3::new(
                    x.x.times(a).plus_times(y.x, b).plus_times(z.x, c),
                    x.y.times(a).plus_times(y.y, b).plus_times(z.y, c),
                    x.z.times(a).plus_times(y.z, b).plus_times(z.z, c),
                );
            }
            [y, z] = turned([y, z], |pair| fixed.alpha.undo(pair));
            match &self.turns[place.joint] {
                JointPosition::Rotated(turn) => {
                    arm = arm.plus_scaled(z, S::from_f64(fixed.rise));
                    [x, y] = turned([x, y], |pair| turn.undo(pair));
                }
                &JointPosition::Translated(distance) => arm = arm.plus_scaled(z, distance),
                JointPosition::Oriented(orientation) => {
                    let [a, b, c] = orientation.rotation().rows;
                    let column = |i: fn(Vec3<S>) -> S| x.scaled(i(a)) + y.scaled(i(b)) + z.scaled(i(c));
                    [x, y, z] = [column(|row| row.x), column(|row| row.y), column(|row| row.z)];
                }
            }
            let joint = &mut self.joints[k];
            (joint.axes, joint.arm) = ([x, y, z], arm);
            let origin = match place.parent {
                Some(parent) if place.turns => self.joints[parent].origin + arm,
                _ => Vec3::zero(),
            };
            self.joints[k].origin = origin;
            let (group, lane) = (&mut self.groups[k / Self::LANES], k % Self::LANES);
            group.axes.iter_mut().zip([x, y, z]).for_each(|(to, axis)| to.set_lane(lane, axis));
            set_motion(&mut group.axis, lane, motion_along(place.kind, z));
            self.carried[k / Self::LANES].origin.set_lane(lane, origin);
        }
        for (group, links) in self.groups.iter_mut().zip(&self.links) {
            group.turn_links(links);
        }
        self.turn_displacements();
    }

    /// Turns the displacements of floating joints from the axes of the parent to those of the moved frame:
    /// the axes of their angles.
    fn turn_displacements(&mut self) {
        for chain in self.free.iter().filter(|chain| chain.len() == FreeKind::Floating.dof()) {
            // The whole displacement stands before the first slide: nothing is moved out of it and back.
            let (first, slides) = (chain.start, chain.start..chain.start + 3);
            let whole = slides.clone().fold(Vec3::zero(), |sum, k| sum + self.joints[k].arm);
            let end = self.joints[first + 2].origin;
            for k in slides {
                self.joints[k].arm = if k == first { whole } else { Vec3::zero() };
                self.joints[k].origin = end;
                self.carried[k / Self::LANES].origin.set_lane(k % Self::LANES, end);
                let axis = self.joints[k + 3].axes[2];
                self.joints[k].axes[2] = axis;
                let lane = k % Self::LANES;
                set_motion(
                    &mut self.groups[k / Self::LANES].axis,
                    lane,
                    motion_along(JointKind::Prismatic, axis),
                );
            }
        }
    }
}

/// A pair of vectors turned in their plane, component by component.
#[inline(always)]
fn turned<S: Scalar>([a, b]: [Vec3<S>; 2], turn: impl Fn([S; 2]) -> [S; 2]) -> [Vec3<S>; 2] {
    let [ax, bx] = turn([a.x, b.x]);
    let [ay, by] = turn([a.y, b.y]);
    let [az, bz] = turn([a.z, b.z]);
    [Vec3::new(ax, ay, az), Vec3::new(bx, by, bz)]
}
