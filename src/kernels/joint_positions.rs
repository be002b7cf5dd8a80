//! Where joints are: turns and displacements from coordinates.

use crate::robot::Tree;
use crate::scalar::{Pack, Scalar};
use crate::spatial::{JointPosition, Turn};

/// Sines and cosines of the angles, a pack at a time, and displacements, joint by joint in any order.
#[inline(always)]
pub(super) fn joint_positions<S: Scalar>(tree: &Tree, q: &[S], mut set: impl FnMut(usize, JointPosition<S>)) {
    let lanes = <S::Pack as Pack<S>>::LANES;
    let mut angles = S::Pack::zero();
    for some in tree.revolute().chunks(lanes) {
        for (lane, &i) in some.iter().enumerate() {
            angles = angles.with_lane(lane, tree.joints()[i].shifted(q[i]));
        }
        let (sin, cos) = angles.sin_cos();
        for (lane, &i) in some.iter().enumerate() {
            let turn = Turn::from_sin_cos(sin.lane(lane), cos.lane(lane));
            set(i, JointPosition::Rotated(turn));
        }
    }
    for &i in tree.prismatic() {
        set(i, JointPosition::Translated(tree.joints()[i].shifted(q[i])));
    }
}
