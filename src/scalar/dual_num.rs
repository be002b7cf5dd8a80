//! Implements num-dual's number traits, so that dual and hyper-dual numbers can have components of this
//! library's types.
//!
//! Methods that [`Scalar`](super::Scalar) has are forwarded to it; functions that no formula here needs use
//! those of `f64` through `map` and `combine` of the type. This does not compile with num-dual's feature
//! `ndarray`, which requires one more trait.

/// `DualNum` and its supertraits. The type has `real_part(&self) -> f64`, `map(self, f64 -> f64)` and
/// `combine(self, Self, (f64, f64) -> f64)`.
macro_rules! dual_num {
    ($type:ty $(, $parameter:ident: $bound:path)?) => {
        impl$(<$parameter: $bound>)? num_dual::DualStruct for $type {
            type Real = f64;
            type Inner = f64;
            fn re(&self) -> f64 {
                self.real_part()
            }
            fn from_inner(inner: &f64) -> Self {
                Scalar::from_f64(*inner)
            }
        }

        impl$(<$parameter: $bound>)? num_dual::Mappable<Self> for $type {
            type Output<O> = O;
            fn map_dual<M: Fn(Self) -> O, O>(self, f: M) -> O {
                f(self)
            }
        }

        impl$(<$parameter: $bound>)? num_dual::DualNum for $type {
            type Primitive = f64;
            const NDERIV: usize = 0;
            type InnerDual = f64;

            fn from_re(re: f64) -> Self {
                Scalar::from_f64(re)
            }
            fn scale(self, factor: &f64) -> Self {
                self.times(*factor)
            }
            #[inline(always)]
            fn recip(&self) -> Self {
                Scalar::recip(*self)
            }
            #[inline(always)]
            fn sqrt(&self) -> Self {
                Scalar::sqrt(*self)
            }
            fn exp(&self) -> Self {
                Scalar::exp(*self)
            }
            fn exp_m1(&self) -> Self {
                Scalar::exp_m1(*self)
            }
            #[inline]
            fn sin_cos(&self) -> (Self, Self) {
                Scalar::sin_cos(*self)
            }
            fn sin(&self) -> Self {
                Scalar::sin_cos(*self).0
            }
            fn cos(&self) -> Self {
                Scalar::sin_cos(*self).1
            }
            fn tan(&self) -> Self {
                let (sin, cos) = Scalar::sin_cos(*self);
                sin / cos
            }
            fn tanh(&self) -> Self {
                Scalar::tanh(*self)
            }
            fn powi(&self, n: i32) -> Self {
                self.map(|x| x.powi(n))
            }
            fn powf(&self, n: f64) -> Self {
                self.map(|x| x.powf(n))
            }
            fn powd(&self, exponent: Self) -> Self {
                self.combine(exponent, f64::powf)
            }
            fn log(&self, base: f64) -> Self {
                self.map(|x| x.log(base))
            }
            fn atan2(&self, other: Self) -> Self {
                self.combine(other, f64::atan2)
            }
            $crate::scalar::dual_num::by_map! {
                cbrt exp2 ln log2 log10 ln_1p asin acos atan sinh cosh asinh acosh atanh sph_j0 sph_j1 sph_j2
            }
        }
    };
}

/// Functions of one number that are those of `f64`.
macro_rules! by_map {
    ($($function:ident)*) => {$(
        fn $function(&self) -> Self {
            self.map(|x| num_dual::DualNum::$function(&x))
        }
    )*};
}

pub(super) use {by_map, dual_num};
