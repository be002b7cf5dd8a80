//! [`Lanes`] as a number of num-dual's, so that dual and hyper-dual numbers can be made of it.
//!
//! num-dual reads one real part from a number and compares numbers as a whole. Here the real part is the number that all
//! lanes hold, not a number where they differ, and a comparison holds where it holds in every lane. The functions that
//! the pipeline uses look at neither; of the others, `abs`, `abs_sub` and the spherical Bessel functions of a dual number
//! choose a formula by the real part and are right only where all lanes choose alike: use
//! [`Scalar::abs`] and [`Scalar::select`]. With num-dual's feature `ndarray`, which asks for one more trait, this does not
//! compile.

use super::{Lanes, Vector};
use crate::scalar::Scalar;
use num_dual::{DualNum, DualStruct, Mappable};

impl<V: Vector> DualStruct for Lanes<V> {
    type Real = f64;
    type Inner = f64;
    fn re(&self) -> f64 {
        let first = self.lane(0);
        if self.as_slice().iter().all(|&lane| lane == first) { first } else { f64::NAN }
    }
    fn from_inner(inner: &f64) -> Self {
        Self::from(*inner)
    }
}

impl<V: Vector> Mappable<Self> for Lanes<V> {
    type Output<O> = O;
    fn map_dual<M: Fn(Self) -> O, O>(self, f: M) -> O {
        f(self)
    }
}

/// Functions that are computed lane by lane.
macro_rules! lane_by_lane {
    ($($function:ident)*) => {$(
        fn $function(&self) -> Self {
            self.map(|lane| DualNum::$function(&lane))
        }
    )*};
}

impl<V: Vector> DualNum for Lanes<V> {
    type Primitive = f64;
    const NDERIV: usize = 0;
    type InnerDual = f64;

    fn from_re(re: f64) -> Self {
        Self::from(re)
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
        self.map(|lane| lane.powi(n))
    }
    fn powf(&self, n: f64) -> Self {
        self.map(|lane| lane.powf(n))
    }
    fn powd(&self, exponent: Self) -> Self {
        self.combine(exponent, f64::powf)
    }
    fn log(&self, base: f64) -> Self {
        self.map(|lane| lane.log(base))
    }
    fn atan2(&self, other: Self) -> Self {
        self.combine(other, f64::atan2)
    }
    lane_by_lane! {
        cbrt exp2 ln log2 log10 ln_1p asin acos atan sinh cosh asinh acosh atanh sph_j0 sph_j1 sph_j2
    }
}
