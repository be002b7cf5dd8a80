//! num-dual's numbers of static size, over any scalar that is itself a number of num-dual.
//!
//! Static size only: the dynamic ones allocate on every operation and are not `Copy`. A blanket
//! implementation over num-dual's trait would overlap with that for `f64`, hence one implementation per type.

use super::number::Scalar;
use nalgebra::Const;
use num_dual::{Dual, Dual2, Dual2Vec, Dual3, DualNum, DualVec, HyperDual, HyperDualVec, HyperHyperDual};
use num_traits::{Float, FromPrimitive};

/// A model constant in the base precision of the number type `T`.
#[inline]
fn primitive<T: DualNum>(value: f64) -> T::Primitive {
    T::Primitive::from_f64(value).unwrap_or_else(T::Primitive::nan)
}

/// `t = tanh x` and its first four derivatives: `s = 1 - t^2`, `-2 t s`, `2 s (2 t^2 - s)`,
/// `8 t s (2 s - t^2)`.
#[inline]
fn tanh_derivatives<T: Scalar>(x: T) -> [T; 5] {
    let (t, s) = x.tanh_and_slope();
    let (tt, ts) = (t * t, t * s);
    [t, s, ts.times(-2.0), (s * (tt + tt - s)).times(2.0), (ts * (s + s - tt)).times(8.0)]
}

/// The chain rule: `f(x)` from f and its first three derivatives at the value of x.
trait ChainRule<T> {
    fn chain(self, f: [T; 4]) -> Self;
}

macro_rules! impl_chain_rule {
    ($dual:ident $(, $size:ident)*; |$x:ident, $f1:ident, $f2:ident, $f3:ident| $($part:expr),*) => {
        impl<T: DualNum + Scalar, $(const $size: usize),*> ChainRule<T> for $dual<T, $(Const<$size>),*> {
            #[inline]
            fn chain(self, [f0, $f1, $f2, $f3]: [T; 4]) -> Self {
                let $x = self;
                Self::new(f0, $($part),*)
            }
        }
    };
}

impl_chain_rule!(Dual; |x, f1, _f2, _f3| x.eps * f1);
impl_chain_rule!(Dual2; |x, f1, f2, _f3| x.v1 * f1, x.v2 * f1 + x.v1 * x.v1 * f2);
impl_chain_rule!(Dual3; |x, f1, f2, f3|
    x.v1 * f1,
    x.v2 * f1 + x.v1 * x.v1 * f2,
    x.v3 * f1 + (x.v1 * x.v2 * f2).times(3.0) + x.v1 * x.v1 * x.v1 * f3);
impl_chain_rule!(HyperDual; |x, f1, f2, _f3| x.eps1 * f1, x.eps2 * f1, x.eps1eps2 * f1 + x.eps1 * x.eps2 * f2);
impl_chain_rule!(HyperHyperDual; |x, f1, f2, f3|
    x.eps1 * f1,
    x.eps2 * f1,
    x.eps3 * f1,
    x.eps1eps2 * f1 + x.eps1 * x.eps2 * f2,
    x.eps1eps3 * f1 + x.eps1 * x.eps3 * f2,
    x.eps2eps3 * f1 + x.eps2 * x.eps3 * f2,
    x.eps1eps2eps3 * f1
        + (x.eps1 * x.eps2eps3 + x.eps2 * x.eps1eps3 + x.eps3 * x.eps1eps2) * f2
        + x.eps1 * x.eps2 * x.eps3 * f3);
impl_chain_rule!(DualVec, N; |x, f1, _f2, _f3| x.eps * f1);
impl_chain_rule!(Dual2Vec, N; |x, f1, f2, _f3| x.v1 * f1, x.v2 * f1 + x.v1.tr_mul(&x.v1) * f2);
impl_chain_rule!(HyperDualVec, M, N; |x, f1, f2, _f3|
    x.eps1 * f1, x.eps2 * f1, x.eps1eps2 * f1 + &x.eps1 * &x.eps2 * f2);

/// The largest numbers for which the small functions of the pipeline are inlined (bytes). An operation of
/// larger ones, as of dual numbers of eight-fold dual numbers, is a hundred instructions: inlining multiplies
/// the machine code and saves an eighth of the time of F.
const MOST_INLINED: usize = 128;

macro_rules! forward_to_num_dual {
    ($order:literal) => {
        const EPSILON: f64 = T::EPSILON;
        const ORDER: usize = T::ORDER + $order;
        const CHECKED: bool = T::CHECKED;
        const FOLDED: bool = T::FOLDED;
        const INLINED: bool = T::INLINED && size_of::<Self>() <= MOST_INLINED;
        #[inline]
        fn from_f64(value: f64) -> Self {
            Self::from_re(<T as Scalar>::from_f64(value))
        }
        #[inline]
        fn times(self, factor: f64) -> Self {
            self * primitive::<T>(factor)
        }
        #[inline]
        fn plus(self, term: f64) -> Self {
            self + primitive::<T>(term)
        }
        #[inline]
        fn recip(self) -> Self {
            DualNum::recip(&self)
        }
        #[inline]
        fn sqrt(self) -> Self {
            DualNum::sqrt(&self)
        }
        #[inline]
        fn sin_cos(self) -> (Self, Self) {
            DualNum::sin_cos(&self)
        }
        #[inline]
        fn exp(self) -> Self {
            DualNum::exp(&self)
        }
        #[inline]
        fn exp_m1(self) -> Self {
            DualNum::exp_m1(&self)
        }
        #[inline]
        fn tanh_and_slope(self) -> (Self, Self) {
            let [f0, f1, f2, f3, f4] = tanh_derivatives(self.re);
            (self.chain([f0, f1, f2, f3]), self.chain([f1, f2, f3, f4]))
        }
        #[inline]
        fn less(self, other: Self) -> Self::Mask {
            self.re.less(other.re)
        }
        #[inline]
        fn all(mask: Self::Mask) -> bool {
            T::all(mask)
        }
    };
}

/// Numbers with scalar components: `select` works component by component, for any mask.
macro_rules! impl_scalar_by_parts {
    ($dual:ident, $order:literal, $($part:ident),*) => {
        impl<T: DualNum + Scalar> Scalar for $dual<T> {
            type Mask = T::Mask;
            type Pack = Self;
            forward_to_num_dual!($order);
            #[inline]
            fn select(mask: T::Mask, if_true: Self, if_false: Self) -> Self {
                Self {
                    re: T::select(mask, if_true.re, if_false.re),
                    $($part: T::select(mask, if_true.$part, if_false.$part)),*
                }
            }
        }
    };
}

impl_scalar_by_parts!(Dual, 1, eps);
impl_scalar_by_parts!(Dual2, 2, v1, v2);
impl_scalar_by_parts!(Dual3, 3, v1, v2, v3);
impl_scalar_by_parts!(HyperDual, 2, eps1, eps2, eps1eps2);
impl_scalar_by_parts!(HyperHyperDual, 3, eps1, eps2, eps3, eps1eps2, eps1eps3, eps2eps3, eps1eps2eps3);

/// Numbers with a vector of derivatives: `select` chooses one of the two as a whole.
macro_rules! impl_scalar_as_a_whole {
    ($dual:ident, $order:literal, $($size:ident),*) => {
        impl<T: DualNum + Scalar<Mask = bool>, $(const $size: usize),*> Scalar for $dual<T, $(Const<$size>),*> {
            type Mask = bool;
            type Pack = Self;
            forward_to_num_dual!($order);
            #[inline]
            fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
                if mask { if_true } else { if_false }
            }
        }
    };
}

impl_scalar_as_a_whole!(DualVec, 1, N);
impl_scalar_as_a_whole!(Dual2Vec, 2, N);
impl_scalar_as_a_whole!(HyperDualVec, 2, M, N);

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::{Derivative, Dual2SVec64, HyperDualSVec64, HyperHyperDual64};

    /// Checks the chain rules against num-dual's tanh where that does not overflow.
    #[test]
    fn chain_rules_agree_with_num_dual() {
        let x = HyperHyperDual64::new(0.6, 0.3, -0.7, 1.1, 0.2, -0.4, 0.9, 1.3);
        let (ours, theirs) = (Scalar::tanh(x), DualNum::tanh(&x));
        assert!(
            (ours.eps1eps2eps3 - theirs.eps1eps2eps3).abs() < 1e-14
                && (ours.eps2eps3 - theirs.eps2eps3).abs() < 1e-14
        );
        let mut x = Dual2SVec64::<2>::from_re(0.6);
        x.v1 = Derivative::some(nalgebra::RowVector2::new(0.3, -0.7));
        x.v2 = Derivative::some(nalgebra::Matrix2::new(0.1, 0.2, 0.2, -0.5));
        let (ours, theirs) = (Scalar::tanh(x), DualNum::tanh(&x));
        assert!((ours.v2.0.unwrap() - theirs.v2.0.unwrap()).amax() < 1e-14);
        let mut x = HyperDualSVec64::<2, 3>::from_re(-0.4);
        x.eps1 = Derivative::some(nalgebra::Vector2::new(0.3, -0.7));
        x.eps2 = Derivative::some(nalgebra::RowVector3::new(0.1, 0.2, -0.5));
        let (ours, theirs) = (Scalar::tanh(x), DualNum::tanh(&x));
        assert!((ours.eps1eps2.0.unwrap() - theirs.eps1eps2.0.unwrap()).amax() < 1e-14);
        assert!((ours.eps2.0.unwrap() - theirs.eps2.0.unwrap()).amax() < 1e-14);
    }
}
