//! Derivatives of joint friction by its parameters.

use crate::robot::Friction;
use crate::scalar::Scalar;

/// A parameter of the friction of one joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FrictionEntry {
    Viscous,
    Coulomb,
    CoulombVelocity,
}

/// Derivatives of D(v, theta) by a parameter of the law.
#[derive(Clone, Copy, Debug)]
pub(super) struct ByParameter<S> {
    /// `D_theta`.
    pub value: S,
    /// `D_v,theta`.
    pub slope: S,
}

/// Of `D = -b v - c t`, `t = tanh(v / s)`, `t' = 1 - t^2`, by b, c or s:
///
/// ```text
/// D_b = -v              D_c = -t              D_s = c v t' / s^2
/// D_v,b = -1            D_v,c = -t' / s       D_v,s = c t' (1 - 2 t v / s) / s^2
/// ```
pub(super) fn friction_by<S: Scalar>(entry: FrictionEntry, law: &Friction, v: S) -> ByParameter<S> {
    let sharpness = law.coulomb_velocity.recip();
    let (t, slope) = v.times(sharpness).tanh_and_slope();
    match entry {
        FrictionEntry::Viscous => ByParameter { value: -v, slope: -S::one() },
        FrictionEntry::Coulomb => ByParameter { value: -t, slope: slope.times(-sharpness) },
        FrictionEntry::CoulombVelocity => {
            let scaled = slope.times(law.coulomb * sharpness * sharpness);
            let curved = (t * v).times(-2.0 * sharpness).plus(1.0);
            ByParameter { value: scaled * v, slope: scaled * curved }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::HyperDual64;

    #[test]
    fn derivatives_are_those_of_the_law() {
        let law = Friction { viscous: 0.7, coulomb: 3.0, coulomb_velocity: 0.25 };
        let value = |[b, c, s, v]: [HyperDual64; 4]| -(b * v) - c * (v / s).tanh();
        let entries = [FrictionEntry::Viscous, FrictionEntry::Coulomb, FrictionEntry::CoulombVelocity];
        for (k, entry) in entries.into_iter().enumerate() {
            for v in [-3.0, -0.1, 0.0, 1e-9, 0.2, 5.0] {
                let mut arguments =
                    [law.viscous, law.coulomb, law.coulomb_velocity, v].map(HyperDual64::from_re);
                (arguments[k].eps1, arguments[3].eps2) = (1.0, 1.0);
                let (dual, hand) = (value(arguments), friction_by(entry, &law, v));
                assert!((hand.value - dual.eps1).abs() <= 1e-13 * dual.eps1.abs(), "{entry:?} at {v}");
                let size = dual.eps1eps2.abs().max(1e-10);
                assert!((hand.slope - dual.eps1eps2).abs() <= 1e-12 * size, "{entry:?} at {v}");
            }
        }
    }
}
