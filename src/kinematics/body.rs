//! Motion of a link, and of points on it.

use crate::scalar::Scalar;
use crate::spatial::{JointPosition, Vec3};

/// One link: the aligned frame of its joint, and its motion, in axes of the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body<S> {
    /// The joint.
    pub joint: JointPosition<S>,
    /// The axes of the world, seen from the frame: the rows of its rotation R.
    pub rows: [Vec3<S>; 3],
    /// Origin.
    pub position: Vec3<S>,
    /// Angular velocity.
    pub angular: Vec3<S>,
    /// Velocity of the origin.
    pub linear: Vec3<S>,
    /// Angular acceleration.
    pub angular_rate: Vec3<S>,
    /// Acceleration of the origin.
    pub linear_rate: Vec3<S>,
}

impl<S: Scalar> Body<S> {
    /// At the origin and at rest, for the world and for buffers.
    pub fn still() -> Self {
        let zero = Vec3::zero();
        let rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec3::constant);
        Self {
            joint: JointPosition::Translated(S::zero()),
            rows,
            position: zero,
            angular: zero,
            linear: zero,
            angular_rate: zero,
            linear_rate: zero,
        }
    }

    /// The joint axis in the world.
    pub fn axis(&self) -> Vec3<S> {
        Vec3::new(self.rows[0].z, self.rows[1].z, self.rows[2].z)
    }

    /// `R a`: a vector of the frame in axes of the world.
    pub fn in_world(&self, a: Vec3<S>) -> Vec3<S> {
        Vec3::new(self.rows[0].dot(a), self.rows[1].dot(a), self.rows[2].dot(a))
    }

    /// `R a` for a constant.
    pub fn constant_in_world(&self, a: [f64; 3]) -> Vec3<S> {
        let [x, y, z] = self.rows;
        Vec3::new(x.dot_constant(a), y.dot_constant(a), z.dot_constant(a))
    }

    /// `R'a`.
    pub fn in_frame(&self, a: Vec3<S>) -> Vec3<S> {
        let [x, y, z] = self.rows;
        x.scaled(a.x) + y.scaled(a.y) + z.scaled(a.z)
    }
}
