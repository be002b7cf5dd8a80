//! Spatial motion and force vectors.

use super::vector::Vec3;
use crate::scalar::{Pack, Scalar, inlined};
use std::ops::{Add, Sub};

/// A spatial motion vector: velocity of a rigid body, in a frame fixed to the body.
#[derive(Clone, Copy, Debug)]
pub struct Motion<S> {
    /// Angular velocity (rad/s).
    pub angular: Vec3<S>,
    /// Velocity of the body point at the origin of the frame (m/s).
    pub linear: Vec3<S>,
}

impl<S: Scalar> Motion<S> {
    /// No motion.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { angular: Vec3::zero(), linear: Vec3::zero() }
    }

    /// The same in every lane.
    #[inline(always)]
    pub fn splat<P: Pack<S>>(self) -> Motion<P> {
        Motion { angular: self.angular.splat(), linear: self.linear.splat() }
    }

    /// `factor self`.
    #[inline(always)]
    pub fn scaled(self, factor: S) -> Self {
        Self { angular: self.angular.scaled(factor), linear: self.linear.scaled(factor) }
    }

    /// `self x other = (w x w' ; w x v' + v x w')`: the rate of `other` if it is fixed to a body that moves
    /// by `self`.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        inlined!(
            S,
            Self {
                angular: self.angular.cross(other.angular),
                linear: self.angular.cross(other.linear) + self.linear.cross(other.angular),
            }
        )
    }
}

impl<S: Scalar> Add for Motion<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { angular: self.angular + other.angular, linear: self.linear + other.linear }
    }
}

impl<S: Scalar> Sub for Motion<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { angular: self.angular - other.angular, linear: self.linear - other.linear }
    }
}

/// A spatial force vector: momentum or force on a rigid body, about the origin of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Force<S> {
    /// Angular momentum or moment about the origin of the frame.
    pub moment: Vec3<S>,
    /// Linear momentum or force.
    pub force: Vec3<S>,
}

impl<S: Scalar> Force<S> {
    /// `factor self`.
    #[inline(always)]
    pub fn scaled(self, factor: S) -> Self {
        Self { moment: self.moment.scaled(factor), force: self.force.scaled(factor) }
    }

    /// No force.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { moment: Vec3::zero(), force: Vec3::zero() }
    }

    /// Power of the force in the motion: the scalar product of the two kinds of vectors.
    #[inline(always)]
    pub fn dot(self, motion: Motion<S>) -> S {
        inlined!(S, self.moment.dot(motion.angular) + self.force.dot(motion.linear))
    }

    /// The force g with `g . b = self . (motion x b)` for every motion b.
    #[inline(always)]
    pub fn before(self, motion: Motion<S>) -> Self {
        inlined!(
            S,
            Self {
                moment: self.moment.cross(motion.angular) + self.force.cross(motion.linear),
                force: self.force.cross(motion.angular),
            }
        )
    }
}

impl<S: Scalar> Add for Force<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { moment: self.moment + other.moment, force: self.force + other.force }
    }
}

#[cfg(test)]
mod tests {
    use super::{Force, Motion, Vec3};

    #[test]
    fn a_force_before_a_motion_is_the_transpose_of_its_product() {
        let vector = |k: f64| Vec3::<f64>::constant([k, 1.0 - k * k, 0.3 * k - 2.0]);
        let motion = |k: f64| Motion { angular: vector(k), linear: vector(k + 0.7) };
        let force = Force { moment: vector(-0.4), force: vector(1.9) };
        let (a, b) = (motion(0.3), motion(-1.1));
        assert!((force.before(a).dot(b) - force.dot(a.cross(b))).abs() < 1e-14);
        assert!((force.dot(a.cross(b)) + force.dot(b.cross(a))).abs() < 1e-14, "a x b = - b x a");
    }
}
