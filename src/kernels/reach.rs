//! How large the rounding errors of the diagonal of M are, joint by joint.

use crate::robot::{JointKind, Tree};
use crate::scalar::Scalar;

/// The reach of each joint, see [`JointFrame::reach`](crate::robot::JointFrame::reach): most of them are
/// constant.
#[derive(Clone, Debug)]
pub(crate) struct Reach<S> {
    /// `None` for prismatic joints, and for all where nothing is checked.
    reach: Vec<Option<S>>,
    /// Joints that are not prismatic, with prismatic ones beyond them.
    changing: Vec<usize>,
}

impl<S: Scalar> Reach<S> {
    pub fn new(tree: &Tree) -> Self {
        // Without checks nobody reads it, and these constants are no labels of parameters.
        let turns = |k: usize| S::CHECKED && tree.joints()[k].kind == JointKind::Revolute;
        let at_rest = |k| turns(k).then(|| S::from_f64(tree.joints()[k].reach));
        let all = 0..tree.joints().len();
        Self {
            reach: all.clone().map(at_rest).collect(),
            changing: all.filter(|&k| turns(k) && tree.joints()[k].carries_slides).collect(),
        }
    }

    /// At these positions of all joints.
    pub fn set_position(&mut self, tree: &Tree, q: &[S]) {
        for &k in &self.changing {
            self.reach[k] = Some(reach_of_joint(tree, k, q));
        }
    }

    /// For the entry `M_kk`.
    #[inline(always)]
    pub fn size(&self, k: usize, entry: S) -> S {
        self.reach[k].map_or(entry, |reach| entry + (reach * reach).times(2.0))
    }
}

/// The reach of a joint that is not prismatic, see [`JointFrame::reach`](crate::robot::JointFrame::reach), at
/// these positions of all joints.
#[inline]
pub(super) fn reach_of_joint<S: Scalar>(tree: &Tree, k: usize, q: &[S]) -> S {
    let joints = tree.joints();
    let mut reach = S::from_f64(joints[k].reach);
    if joints[k].carries_slides {
        for &i in tree.slides_in_subtree(k) {
            reach += q[i].plus(joints[i].offset).abs().times(joints[i].subtree_mass.sqrt());
        }
    }
    reach
}
