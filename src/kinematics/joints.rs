//! Axes of joints and frames, for constraints between them.

use super::Kinematics;
use super::body::Body;
use super::columns::axis_of;
use super::frame::Placed;
use crate::robot::{JointKind, TreeFrame};
use crate::scalar::Scalar;
use crate::spatial::{Motion, Vec3};

/// A frame from which others are seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seat<S> {
    axes: Body<S>,
    origin: Vec3<S>,
}

impl<S: Scalar> Seat<S> {
    /// A direction of the world in the axes of this frame.
    pub fn direction(&self, world: Vec3<S>) -> Vec3<S> {
        self.axes.in_frame(world)
    }

    /// A point of the world in this frame.
    pub fn point(&self, world: Vec3<S>) -> Vec3<S> {
        self.direction(world - self.origin)
    }

    /// Origin and rotation, by rows, of another frame in this one.
    pub fn pose(&self, other: &Self) -> (Vec3<S>, [Vec3<S>; 3]) {
        let column = |k: usize| {
            let [x, y, z] = other.axes.rows.map(|row| row.to_array()[k]);
            self.direction(Vec3::new(x, y, z)).to_array()
        };
        let [x, y, z] = [column(0), column(1), column(2)];
        (self.point(other.origin), [0, 1, 2].map(|row| Vec3::new(x[row], y[row], z[row])))
    }
}

impl<S: Scalar> Kinematics<S> {
    /// A frame of the tree.
    pub(crate) fn seat(&self, frame: &TreeFrame) -> Seat<S> {
        let Placed { frame, point } = self.locate(frame);
        Seat { axes: frame, origin: point.position }
    }

    /// What a joint does to a point at unit rate, seen from a frame: `(w ; w x (at - o))` or `(0 ; z)`; and
    /// the square of the size that its rounding errors are in proportion to.
    pub(crate) fn column_seen(&self, joint: usize, from: &Seat<S>, at: Vec3<S>) -> (Motion<S>, S) {
        let body = &self.bodies[joint];
        let [axis, _] = axis_of(&self.tree, &self.bodies, joint).map(|axis| from.direction(axis));
        match self.tree.joints()[joint].kind {
            JointKind::Revolute => {
                let origin = from.point(body.position);
                let motion = Motion { angular: axis, linear: axis.cross(at - origin) };
                (motion, at.dot(at) + origin.dot(origin))
            }
            JointKind::Prismatic => (Motion { angular: Vec3::zero(), linear: axis }, S::one()),
        }
    }
}
