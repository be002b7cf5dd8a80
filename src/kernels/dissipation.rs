//! Joint friction and its derivatives.

use crate::robot::Friction;
use crate::scalar::Scalar;

/// Friction of one joint and its first two derivatives in v.
#[derive(Clone, Copy, Debug)]
pub struct FrictionDerivatives<S> {
    /// D(v) (N m or N).
    pub value: S,
    /// dD/dv.
    pub first: S,
    /// d2D/dv2.
    pub second: S,
}

/// `D = -b v - c t`, `dD/dv = -b - c (1 - t^2) / s`, `d2D/dv2 = 2 c t (1 - t^2) / s^2` with
/// `t = tanh(v / s)`, viscous coefficient b, Coulomb limit c, transition velocity s.
#[inline]
pub fn friction<S: Scalar>(law: &Friction, v: S) -> FrictionDerivatives<S> {
    let mut d = FrictionDerivatives {
        value: v.times(-law.viscous),
        first: S::from_f64(-law.viscous),
        second: S::zero(),
    };
    if law.coulomb != 0.0 {
        let (limit, sharpness) = (law.coulomb, law.coulomb_velocity.recip());
        let (t, slope) = v.times(sharpness).tanh_and_slope();
        d.value -= t.times(limit);
        d.first -= slope.times(limit * sharpness);
        d.second = (t * slope).times(2.0 * limit * sharpness * sharpness);
    }
    d
}

#[cfg(test)]
mod tests {
    use super::friction;
    use crate::robot::Friction;
    use num_dual::Dual2_64;

    #[test]
    fn derivatives_are_those_of_the_law() {
        let law = Friction { viscous: 0.7, coulomb: 3.0, coulomb_velocity: 0.25 };
        for v in [-1e6, -3.0, -0.1, 0.0, 1e-9, 0.2, 5.0] {
            let hand = friction(&law, v);
            let dual = friction(&law, Dual2_64::from_re(v).derivative()).value;
            for (hand, dual) in [(hand.value, dual.re), (hand.first, dual.v1), (hand.second, dual.v2)] {
                assert!((hand - dual).abs() <= 1e-14 * dual.abs(), "at {v}: {hand} is not {dual}");
            }
            assert!(hand.value * v <= 0.0, "friction never drives");
        }
    }
}
