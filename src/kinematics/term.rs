//! What contracted derivatives of a twist need of each joint.

use crate::scalar::Scalar;
use crate::spatial::{Force, Motion};

/// What the derivatives need of joint j: `dV/dq_j`, and for the inner one of a pair products with W.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term<S> {
    /// `dV/dq`.
    pub twist: Motion<S>,
    pub weighted: Force<S>,
    pub weighted_rate: Force<S>,
}

impl<S: Scalar> Term<S> {
    pub fn zero() -> Self {
        Self { twist: Motion::zero(), weighted: Force::zero(), weighted_rate: Force::zero() }
    }
}
