//! num-dual's numbers of static size, over any scalar that is itself a number of num-dual.
//!
//! Static size only: the dynamic ones allocate on every operation and are not `Copy`. A blanket implementation
//! over num-dual's trait would overlap with that for `f64`, hence one implementation a type.

use super::Scalar;
use nalgebra::Const;
use num_dual::{Dual, Dual2, Dual2Vec, Dual3, DualNum, DualVec, HyperDual, HyperDualVec, HyperHyperDual};
use num_traits::{Float, FromPrimitive};

/// A model constant in the precision that lies at the bottom of the number type `T`.
#[inline]
fn primitive<T: DualNum>(value: f64) -> T::Primitive {
    T::Primitive::from_f64(value).unwrap_or_else(T::Primitive::nan)
}

macro_rules! forward_to_num_dual {
    () => {
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
        fn less(self, other: Self) -> Self::Mask {
            self.re.less(other.re)
        }
        #[inline]
        fn all(mask: Self::Mask) -> bool {
            T::all(mask)
        }
    };
}

/// Numbers whose parts are plain scalars: `select` goes part by part, for any mask.
macro_rules! impl_scalar_by_parts {
    ($dual:ident, $($part:ident),*) => {
        impl<T: DualNum + Scalar> Scalar for $dual<T> {
            type Mask = T::Mask;
            forward_to_num_dual!();
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

impl_scalar_by_parts!(Dual, eps);
impl_scalar_by_parts!(Dual2, v1, v2);
impl_scalar_by_parts!(Dual3, v1, v2, v3);
impl_scalar_by_parts!(HyperDual, eps1, eps2, eps1eps2);
impl_scalar_by_parts!(HyperHyperDual, eps1, eps2, eps3, eps1eps2, eps1eps3, eps2eps3, eps1eps2eps3);

/// Numbers with a vector of derivatives: `select` takes one of the two as a whole.
macro_rules! impl_scalar_as_a_whole {
    ($dual:ident, $($size:ident),*) => {
        impl<T: DualNum + Scalar<Mask = bool>, $(const $size: usize),*> Scalar for $dual<T, $(Const<$size>),*> {
            type Mask = bool;
            forward_to_num_dual!();
            #[inline]
            fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
                if mask { if_true } else { if_false }
            }
        }
    };
}

impl_scalar_as_a_whole!(DualVec, N);
impl_scalar_as_a_whole!(Dual2Vec, N);
impl_scalar_as_a_whole!(HyperDualVec, M, N);
