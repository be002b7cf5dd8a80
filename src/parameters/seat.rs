//! Joints and the coordinates that move them.

use crate::robot::{Tree, scaled};
use crate::scalar::Scalar;

/// The coordinate of a joint: `q_joint = ratio q_coordinate + offset`, ratio 1 and offset 0 unless it mimics
/// another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seat {
    pub coordinate: usize,
    pub ratio: f64,
    offset: f64,
}

impl Seat {
    /// Those of all joints.
    pub fn all(tree: &Tree) -> Vec<Self> {
        match tree.joint_map() {
            None => {
                let own = |coordinate| Self { coordinate, ratio: 1.0, offset: 0.0 };
                (0..tree.joints().len()).map(own).collect()
            }
            Some(map) => {
                let rows = map.rows().iter();
                rows.map(|row| Self { coordinate: row.coordinate, ratio: row.ratio, offset: row.offset })
                    .collect()
            }
        }
    }

    /// Position of the joint.
    #[inline(always)]
    pub fn position<S: Scalar>(&self, q: &[S]) -> S {
        let turned = scaled(self.ratio, q[self.coordinate]);
        if self.offset == 0.0 { turned } else { turned.plus(self.offset) }
    }

    /// Velocity of the joint, or its change.
    #[inline(always)]
    pub fn rate<S: Scalar>(&self, v: &[S]) -> S {
        scaled(self.ratio, v[self.coordinate])
    }
}
