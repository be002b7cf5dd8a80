//! Properties of every scalar.

use super::{Count, Scalar, Tangent};
use nalgebra::Const;
use num_dual::{
    Derivative, Dual, Dual2_64, Dual2SVec64, Dual3_64, Dual64, DualSVec64, HyperDual64, HyperDualSVec64,
    HyperHyperDual64,
};

#[test]
fn tanh_is_accurate_and_free_of_overflow() {
    for x in [1e-300, 1e-12, 1e-3, 0.3, 1.0, 5.0, 19.0, 400.0, 711.0, 1e6, 1e300] {
        for x in [x, -x] {
            let (ours, exact) = (Scalar::tanh(x), f64::tanh(x));
            assert!((ours - exact).abs() <= 4e-16 * exact.abs(), "tanh({x}) = {ours}, not {exact}");
        }
    }
    assert_eq!(Scalar::tanh(0.0), 0.0);
    assert!(Scalar::tanh(f64::NAN).is_nan());
}

#[test]
fn tanh_of_dual_numbers_keeps_its_derivatives() {
    for x in [-800.0, -2.0, 0.0, 0.7, 711.0, 1e8] {
        let t = f64::tanh(x);
        let d1 = 1.0 - t * t;
        let d2 = -2.0 * t * d1;
        let d3 = -2.0 * d1 * (1.0 - 3.0 * t * t);
        let y = Scalar::tanh(Dual3_64::from_re(x).derivative());
        let worst = (y.v1 - d1).abs().max((y.v2 - d2).abs()).max((y.v3 - d3).abs());
        assert!(worst < 2e-15, "derivatives of tanh at {x}: {y}");
        let (_, slope) = Scalar::tanh_and_slope(Dual3_64::from_re(x).derivative());
        let d4 = 8.0 * t * d1 * (2.0 - 3.0 * t * t);
        let worst = (slope.re - d1).abs().max((slope.v1 - d2).abs()).max((slope.v2 - d3).abs());
        assert!(worst.max((slope.v3 - d4).abs()) < 4e-15, "derivatives of the slope at {x}: {slope}");
    }
    assert_eq!(Scalar::tanh(HyperDual64::new(0.0, 0.3, 0.7, 0.0)).eps1eps2, 0.0);
    assert!(num_dual::DualNum::tanh(&Dual64::from_re(711.0)).re.is_nan(), "num-dual's own tanh overflows");
}

#[test]
fn only_the_value_decides_whether_a_number_is_finite() {
    assert!(1e308.is_finite() && !Scalar::is_finite(f64::NAN) && !Scalar::is_finite(f64::NEG_INFINITY));
    assert!(Scalar::is_finite(Dual64::from_re(3.0)) && !Scalar::is_finite(Dual64::from_re(f64::INFINITY)));
}

#[test]
fn select_takes_the_derivatives_along() {
    let a = HyperDual64::new(1.0, 2.0, 3.0, 4.0);
    let b = HyperDual64::new(5.0, 6.0, 7.0, 8.0);
    let smaller = Scalar::select(b.less(a), b, a);
    assert_eq!((smaller.eps1, smaller.eps2, smaller.eps1eps2), (2.0, 3.0, 4.0));
    let x = DualSVec64::<2>::from_re(-3.0).derivative(1);
    assert_eq!(Scalar::abs(x).eps.0.unwrap()[1], -1.0);
}

/// With value 0 and all derivatives 1, the power `ORDER` is the last that is not zero.
#[test]
fn the_order_is_that_of_the_last_power_of_an_infinitesimal() {
    fn is_last<S: Scalar>(x: S, parts: impl Fn(S) -> Vec<f64>) {
        let power = (0..S::ORDER).fold(S::one(), |power, _| power * x);
        assert!(parts(power).iter().any(|part| *part != 0.0), "order {} is too high", S::ORDER);
        assert!(parts(power * x).iter().all(|part| *part == 0.0), "order {} is too low", S::ORDER);
    }
    fn all<const M: usize, const N: usize>(
        part: Derivative<f64, Const<M>, Const<N>>,
    ) -> impl Iterator<Item = f64> {
        part.0.into_iter().flat_map(|entries| entries.iter().copied().collect::<Vec<_>>())
    }
    let ones = || nalgebra::Vector2::repeat(1.0);
    is_last(0.0_f64, |x| vec![x]);
    is_last(0.0_f32, |x| vec![f64::from(x)]);
    is_last(Count::variable(0.0), |x| vec![x.value()]);
    is_last(Tangent::new(0.0, 1.0), |x| vec![x.re, x.eps]);
    #[cfg(feature = "wide")]
    is_last(super::F64x4::zero(), |x| x.as_slice().to_vec());
    is_last(Dual64::new(0.0, 1.0), |x| vec![x.re, x.eps]);
    is_last(Dual2_64::new(0.0, 1.0, 1.0), |x| vec![x.re, x.v1, x.v2]);
    is_last(Dual3_64::new(0.0, 1.0, 1.0, 1.0), |x| vec![x.re, x.v1, x.v2, x.v3]);
    is_last(HyperDual64::new(0.0, 1.0, 1.0, 1.0), |x| vec![x.re, x.eps1, x.eps2, x.eps1eps2]);
    is_last(HyperHyperDual64::new(0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0), |x| {
        vec![x.re, x.eps1, x.eps2, x.eps3, x.eps1eps2, x.eps1eps3, x.eps2eps3, x.eps1eps2eps3]
    });
    is_last(DualSVec64::new(0.0, Derivative::some(ones())), |x| all(x.eps).chain([x.re]).collect());
    let v2 = Derivative::some(nalgebra::Matrix2::repeat(1.0));
    let x = Dual2SVec64::new(0.0, Derivative::some(ones().transpose()), v2);
    is_last(x, |x| all(x.v1).chain(all(x.v2)).chain([x.re]).collect());
    let x = HyperDualSVec64::new(0.0, Derivative::some(ones()), Derivative::some(ones().transpose()), v2);
    is_last(x, |x| all(x.eps1).chain(all(x.eps2)).chain(all(x.eps1eps2)).chain([x.re]).collect());
    let nested = Dual::new(HyperDual64::new(0.0, 1.0, 1.0, 1.0), HyperDual64::new(1.0, 1.0, 1.0, 1.0));
    is_last(nested, |x| {
        [x.re, x.eps].iter().flat_map(|part| [part.re, part.eps1, part.eps2, part.eps1eps2]).collect()
    });
    let nested = Tangent::new(Tangent::new(0.0, 1.0), Tangent::new(1.0, 1.0));
    is_last(nested, |x| vec![x.re.re, x.re.eps, x.eps.re, x.eps.eps]);
}
