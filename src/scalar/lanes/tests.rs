use super::{F64x4, F64x8, Lanes, Vector};
use crate::scalar::{Scalar, Tangent};
use num_dual::{Dual, Dual64};
use std::f64::consts::{FRAC_PI_2, PI};

/// Units in the last place of `expected`; infinite if only one of them is NaN.
fn units(found: f64, expected: f64) -> f64 {
    if found == expected || (found.is_nan() && expected.is_nan()) {
        return 0.0;
    }
    let next = f64::from_bits(expected.abs().to_bits() + 1);
    let unit = next - expected.abs();
    if found.is_finite() && unit.is_finite() { (found - expected).abs() / unit } else { f64::INFINITY }
}

/// Angles and exponents of all magnitudes, with special values, NaN and infinities.
fn arguments() -> Vec<f64> {
    let mut all =
        vec![0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 5e-324, -5e-324, 1e-310, f64::MAX];
    for k in -2000..=2000_i32 {
        let quarter = f64::from(k) * FRAC_PI_2;
        all.extend([quarter, quarter * (1.0 + f64::EPSILON), f64::from(k) * 1e3 * PI]);
    }
    let mut random = fastrand::Rng::with_seed(7);
    for _ in 0..60_000 {
        let size = 10.0_f64.powf(random.f64() * 40.0 - 20.0);
        all.extend([
            size,
            -size,
            random.f64() * 2.0 - 1.0,
            random.f64() * 8.0 - 4.0,
            random.f64() * 1500.0 - 750.0,
        ]);
        all.push((random.f64() * 2.0 - 1.0) * 1e6);
    }
    all
}

/// Every lane of a function within so many units of what `f64` gives; different arguments in different lanes.
fn agrees<V: Vector>(name: &str, allowed: f64, lanes: fn(Lanes<V>) -> Lanes<V>, plain: fn(f64) -> f64) {
    for chunk in arguments().chunks(V::LANES) {
        let found = lanes(Lanes::from_lanes(chunk));
        for (k, &x) in chunk.iter().enumerate() {
            let (found, expected) = (found.lane(k), plain(x));
            let off = units(found, expected);
            assert!(
                off <= allowed,
                "{name}({x:e}) is {found:e}, not {expected:e}: {off} units, lane {k} of {chunk:?}"
            );
        }
    }
}

fn functions_agree<V: Vector>() {
    agrees::<V>("sin", 2.0, |x| x.sin_cos().0, f64::sin);
    agrees::<V>("cos", 2.0, |x| x.sin_cos().1, f64::cos);
    agrees::<V>("exp", 2.0, Scalar::exp, f64::exp);
    agrees::<V>("exp_m1", 3.0, Scalar::exp_m1, f64::exp_m1);
    agrees::<V>("tanh", 6.0, Scalar::tanh, Scalar::tanh);
    agrees::<V>("slope of tanh", 8.0, |x| x.tanh_and_slope().1, |x| x.tanh_and_slope().1);
    agrees::<V>("sqrt", 0.0, Scalar::sqrt, f64::sqrt);
    agrees::<V>("recip", 0.0, Scalar::recip, f64::recip);
    agrees::<V>("abs", 0.0, Scalar::abs, f64::abs);
    agrees::<V>("-", 0.0, |x| -x, |x| -x);
}

#[test]
fn functions_of_four_lanes_are_those_of_f64() {
    functions_agree::<wide::f64x4>();
}

#[test]
fn functions_of_eight_lanes_are_those_of_f64() {
    functions_agree::<wide::f64x8>();
}

#[test]
fn the_sign_of_a_zero_is_kept() {
    let zeros = Lanes::<wide::f64x4>::from_lanes(&[0.0, -0.0, 1.0, -0.0]);
    let signs = |x: F64x4| x.as_slice().iter().map(|x| x.is_sign_negative()).collect::<Vec<_>>();
    assert_eq!(signs(zeros.sin_cos().0), [false, true, false, true]);
    assert_eq!(signs(zeros.exp_m1()), [false, true, false, true]);
}

/// The choice in one lane does not depend on the others, and comparisons with NaN are false, as for `f64`.
fn masks_are_exact<V: Vector>() {
    let values = [1.0, f64::NAN, -3.0, f64::INFINITY, -0.0, 0.0, f64::NEG_INFINITY, 5e-324];
    for shift in 0..8 {
        for other in 0..8 {
            let pick = |from: usize| -> Vec<f64> {
                (0..V::LANES).map(|k| values[(k * from + k + from) % 8]).collect()
            };
            let (a, b) = (pick(shift), pick(other));
            let (x, y) = (Lanes::<V>::from_lanes(&a), Lanes::<V>::from_lanes(&b));
            let mask = x.less(y);
            let chosen = Lanes::select(mask, x.plus(2.0), y.times(3.0));
            for k in 0..V::LANES {
                assert_eq!(mask.lane(k), a[k] < b[k], "{} < {}", a[k], b[k]);
                let expected = if a[k] < b[k] { a[k] + 2.0 } else { b[k] * 3.0 };
                assert_eq!(units(chosen.lane(k), expected), 0.0);
            }
            assert_eq!(Lanes::<V>::all(mask), a.iter().zip(&b).all(|(a, b)| a < b));
            assert_eq!(Scalar::is_finite(x), a.iter().all(|a| a.is_finite()));
        }
    }
}

#[test]
fn masks_hold_lane_by_lane() {
    masks_are_exact::<wide::f64x4>();
    masks_are_exact::<wide::f64x8>();
}

/// Every operation of a scalar, in one expression.
fn everything<S: Scalar>(x: S) -> S {
    let (sin, cos) = (x * x).sin_cos();
    let mut sum = sin / cos + x.recip() - x.sqrt() + (-x).exp() * x.exp_m1() + x.times(3.0).plus(1.0);
    let (t, slope) = x.tanh_and_slope();
    sum += t;
    sum -= slope.times(0.3);
    sum *= x.tanh().mul_add(x, S::one());
    S::select(x.less(S::one()), sum, sum.abs())
}

#[test]
fn dual_numbers_over_lanes_differentiate_every_lane() {
    let x = [0.3, 0.9, 1.7, 30.0, 0.01, 2.0, 0.5, 1.0];
    let dual = everything(Dual::new(F64x8::from_lanes(&x), F64x8::from_f64(0.7)));
    let tangent = everything(Tangent::new(F64x8::from_lanes(&x), F64x8::from_f64(0.7)));
    for (k, &x) in x.iter().enumerate() {
        let expected = everything(Dual64::new(x, 0.7));
        for (re, eps) in [(dual.re, dual.eps), (tangent.re, tangent.eps)] {
            assert!(
                (re.lane(k) - expected.re).abs() <= 1e-14 * expected.re.abs().max(1.0),
                "{x}: {re} {expected}"
            );
            assert!(
                (eps.lane(k) - expected.eps).abs() <= 1e-13 * expected.eps.abs().max(1.0),
                "{x}: {eps} {expected}"
            );
        }
    }
}

#[test]
fn num_dual_sees_what_all_lanes_share() {
    use num_dual::{DualNum, DualStruct};
    let (same, mixed) = (F64x4::from(2.0), F64x4::from_lanes(&[1.0, 2.0, 3.0, 4.0]));
    assert!(DualStruct::re(&same) == 2.0 && DualStruct::re(&mixed).is_nan());
    assert!(same == 2.0 && mixed > 0.5 && mixed != same && mixed.partial_cmp(&2.5).is_none());
    let lanes = [
        mixed.atan2(same),
        mixed % same,
        DualNum::ln(&mixed),
        mixed.powd(same),
        mixed.powi(3),
        DualNum::tan(&mixed),
    ];
    for (k, x) in [1.0_f64, 2.0, 3.0, 4.0].into_iter().enumerate() {
        let expected = [x.atan2(2.0), x % 2.0, x.ln(), x.powf(2.0), x.powi(3), x.tan()];
        lanes
            .iter()
            .zip(expected)
            .for_each(|(found, expected)| assert!(units(found.lane(k), expected) <= 4.0));
    }
}
