//! What the second derivatives of the momentum need of each joint.

use crate::scalar::Scalar;
use crate::spatial::{Force, Motion, Vec3};

/// What the second derivatives need of joint j, about the centre of mass, in axes of the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct MomentumTerm<S> {
    /// `s = (w ; c)`: the motion at unit rate.
    pub unit: Motion<S>,
    /// `psi = V_j x s`.
    pub rate: Motion<S>,
    /// `n = m x s` with the weights m as a motion.
    pub weighted: Motion<S>,
    /// `F = I s`: momentum of all that the joint carries, at unit rate.
    pub momentum: Force<S>,
    /// `g = s x* h + I psi`: the derivative of the momentum by q_j; first h alone.
    pub slope: Force<S>,
    /// `r = I n + s x* (I m)`.
    pub pull: Force<S>,
    /// `c_,j` and the derivative of the linear momentum by q_j.
    pub centre: Vec3<S>,
    pub linear_slope: Vec3<S>,
}

impl<S: Scalar> MomentumTerm<S> {
    pub fn zero() -> Self {
        let (still, none, zero) = (Motion::zero(), Force::zero(), Vec3::zero());
        Self {
            unit: still,
            rate: still,
            weighted: still,
            momentum: none,
            slope: none,
            pull: none,
            centre: zero,
            linear_slope: zero,
        }
    }
}
