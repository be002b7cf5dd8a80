//! A robot in the frames that the kernels use.
//!
//! Each joint frame is rotated so that its z axis is the joint axis, then about z so that the placement in
//! the parent's frame becomes `Rz(gamma) (r + Rx(alpha) .)`. The frame of a revolute parent (or of the world)
//! absorbs the gamma of its first child, as in the modified Denavit-Hartenberg convention; q then has a
//! constant offset. Each origin is moved along its axis to where most of the translations vanish, and
//! inertial parameters are regrouped. Only constants change: q, v, p, M and every derivative are those of the
//! original frames.

mod build;
mod constraint;
mod free;

pub(crate) use constraint::TreeConstraintKind;

use super::branches::{Branches, Marked};
use super::free_frame::FreeFrame;
use super::joint::Friction;
use super::joint_frame::JointFrame;
use super::joint_map::{JointMap, Row};
use super::tree_frame::TreeFrame;
use super::wrench::AppliedWrench;
use crate::error::EvalError;
use constraint::TreeConstraint;
use nalgebra::Matrix3;

/// The model that the kernels run on; built from a [`Robot`](super::Robot) once.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    names: Vec<String>,
    joints: Vec<JointFrame>,
    gravity: [f64; 3],
    fixed_potential: f64,
    armature: Vec<(usize, usize, f64)>,
    branches: Branches,
    revolute: Vec<usize>,
    prismatic: Vec<usize>,
    slides: Marked,
    with_spring: Vec<usize>,
    with_friction: Vec<usize>,
    joint_map: Option<JointMap>,
    frames: Vec<TreeFrame>,
    wrenches: Vec<AppliedWrench>,
    constraints: Vec<TreeConstraint>,
    free: Vec<FreeFrame>,
    world: Matrix3<f64>,
}

impl Tree {
    /// Number of degrees of freedom, n.
    pub fn dof(&self) -> usize {
        self.names.len()
    }

    /// All joints, parents before children, with those that mimic others.
    pub fn joints(&self) -> &[JointFrame] {
        &self.joints
    }

    /// Name of the independent joint of coordinate `i`.
    pub fn name(&self, i: usize) -> &str {
        &self.names[i]
    }

    /// The positions of all joints from the coordinates; `None` if every joint is independent.
    pub(crate) fn joint_map(&self) -> Option<&JointMap> {
        self.joint_map.as_ref()
    }

    /// The coordinate of joint `i`.
    pub(crate) fn row_of(&self, i: usize) -> Row {
        self.joint_map.as_ref().map_or_else(|| Row::independent(i), |map| map.rows()[i])
    }

    /// The coordinate of each joint.
    pub(crate) fn rows(&self) -> Vec<Row> {
        match &self.joint_map {
            None => (0..self.joints.len()).map(Row::independent).collect(),
            Some(map) => map.rows().to_vec(),
        }
    }

    /// The frames of [`Robot::frames`](super::Robot::frames), in its order, placed in the aligned frames.
    pub fn frames(&self) -> &[TreeFrame] {
        &self.frames
    }

    /// The wrenches from outside, as in [`Robot::wrenches`](super::Robot::wrenches).
    pub fn wrenches(&self) -> &[AppliedWrench] {
        &self.wrenches
    }

    /// The constraints, as in [`Robot::constraints`](super::Robot::constraints).
    pub(crate) fn constraints(&self) -> &[TreeConstraint] {
        &self.constraints
    }

    /// [`EvalError::Constrained`] if there are any.
    pub(crate) fn refuse_constraints(&self) -> Result<(), EvalError> {
        match self.constraints.first() {
            None => Ok(()),
            Some(constraint) => Err(EvalError::Constrained { constraint: constraint.name.clone() }),
        }
    }

    /// The joints that move joint `i`, itself first, then its parent, to the base; none for `None`.
    pub fn path(&self, i: Option<usize>) -> impl Iterator<Item = usize> {
        std::iter::successors(i, |&i| self.joints[i].parent)
    }

    /// The rotation from the world of the robot to the aligned world: `x_aligned = R x`. Both have one
    /// origin.
    pub fn world_rotation(&self) -> &Matrix3<f64> {
        &self.world
    }

    /// Gravity acceleration in the aligned world frame (m/s^2).
    pub fn gravity(&self) -> [f64; 3] {
        self.gravity
    }

    /// V (J) of the mass that no joint moves after regrouping.
    pub(crate) fn fixed_potential(&self) -> f64 {
        self.fixed_potential
    }

    /// Entries `(i, j, A_ij)`, i >= j, of the armature matrix that are not zero.
    pub fn armature(&self) -> &[(usize, usize, f64)] {
        &self.armature
    }

    /// The joints attached to the link of joint `i`.
    pub fn children(&self, i: usize) -> &[usize] {
        self.branches.children(i)
    }

    /// Joint `i` and all joints beyond it: i, then the subtree of each child, one after the other.
    pub fn subtree(&self, i: usize) -> &[usize] {
        self.branches.subtree(i)
    }

    /// The prismatic joints of [`subtree`](Self::subtree).
    pub(crate) fn slides_in_subtree(&self, i: usize) -> &[usize] {
        self.branches.marked_in_subtree(&self.slides, i)
    }

    /// The revolute joints.
    pub(crate) fn revolute(&self) -> &[usize] {
        &self.revolute
    }

    /// The prismatic joints.
    pub(crate) fn prismatic(&self) -> &[usize] {
        &self.prismatic
    }

    /// The joints with a spring.
    pub(crate) fn with_spring(&self) -> &[usize] {
        &self.with_spring
    }

    /// The coordinates with friction.
    pub(crate) fn with_friction(&self) -> &[usize] {
        &self.with_friction
    }

    /// Whether a joint of coordinate `i` has Coulomb friction.
    pub(crate) fn has_coulomb_friction(&self, i: usize) -> bool {
        let has = |joint: usize| self.joints[joint].friction.coulomb != 0.0;
        self.joint_map.as_ref().map_or_else(|| has(i), |map| map.joints_of(i).iter().any(|&joint| has(joint)))
    }

    /// Number of pairs `i <= j` of joints in tree order.
    pub fn pairs(&self) -> usize {
        self.branches.pairs()
    }

    /// Whether no joint has friction.
    pub fn is_conservative(&self) -> bool {
        self.joints.iter().all(|joint| joint.friction.is_none())
    }

    /// The same model with D = 0.
    pub fn without_friction(&self) -> Self {
        let mut tree = self.clone();
        tree.joints.iter_mut().for_each(|joint| joint.friction = Friction::none());
        tree.with_friction.clear();
        tree
    }
}
