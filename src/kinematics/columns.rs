//! Columns of Jacobians.

use super::body::Body;
use crate::robot::{JointKind, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Motion, Vec3};

/// A point of the robot: position, velocity and acceleration, in axes of the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point<S> {
    pub position: Vec3<S>,
    pub velocity: Vec3<S>,
    pub acceleration: Vec3<S>,
}

impl<S: Scalar> Point<S> {
    /// The origin of the world.
    pub fn origin() -> Self {
        Self { position: Vec3::zero(), velocity: Vec3::zero(), acceleration: Vec3::zero() }
    }

    /// A point that is fixed to the link of this body, at `arm` from its origin.
    pub fn on(body: &Body<S>, arm: Vec3<S>) -> Self {
        let carried = body.angular.cross(arm);
        Self {
            position: body.position + arm,
            velocity: body.linear + carried,
            acceleration: body.linear_rate + body.angular_rate.cross(arm) + body.angular.cross(carried),
        }
    }
}

/// What one joint does to a point, in axes of the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Column<S> {
    /// `(w ; c)`: the motion at unit rate.
    pub motion: Motion<S>,
    /// Its derivative in time.
    pub rate: Motion<S>,
}

impl<S: Scalar> Column<S> {
    pub fn zero() -> Self {
        Self { motion: Motion::zero(), rate: Motion::zero() }
    }

    /// For a revolute joint `(z ; z x r)`, `r = x - o`, with the rate `(z' ; z' x r + z x r')`; for a
    /// prismatic one `(0 ; z)`, `(0 ; z')`. `z' = w x z` with the angular velocity w of the link.
    ///
    /// Axes of floating and spherical joints are those of the moved frame.
    pub fn new(tree: &Tree, bodies: &[Body<S>], j: usize, point: &Point<S>) -> Self {
        let [axis, turned] = axis_of(tree, bodies, j);
        match tree.joints()[j].kind {
            JointKind::Revolute => {
                let body = &bodies[j];
                let (arm, moved) = (point.position - body.position, point.velocity - body.linear);
                Self {
                    motion: Motion { angular: axis, linear: axis.cross(arm) },
                    rate: Motion { angular: turned, linear: turned.cross(arm) + axis.cross(moved) },
                }
            }
            JointKind::Prismatic => Self {
                motion: Motion { angular: Vec3::zero(), linear: axis },
                rate: Motion { angular: Vec3::zero(), linear: turned },
            },
        }
    }
}

/// The axis of joint j in the tangent space, and its derivative in time.
pub(super) fn axis_of<S: Scalar>(tree: &Tree, bodies: &[Body<S>], j: usize) -> [Vec3<S>; 2] {
    let [axis, link] = tree.axis_of(j).map(|joint| &bodies[joint]);
    [axis.axis(), link.angular.cross(axis.axis())]
}
