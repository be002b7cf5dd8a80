//! The hyperbolic tangent and its slope.

use super::number::Scalar;

/// [`Scalar::tanh_and_slope`] from the exponential functions, for numbers without derivatives.
#[inline]
pub(crate) fn real_tanh_and_slope<S: Scalar>(x: S) -> (S, S) {
    let twice = x.abs().times(-2.0);
    let (m, e) = (twice.exp_m1(), twice.exp());
    let t = -m / m.plus(2.0);
    let root = e.plus(1.0).recip();
    (S::select(x.less(S::zero()), -t, t), (e * root * root).times(4.0))
}
