//! Straight-line Rust that `build.rs` writes with `costate::codegen`, compiled with the bench.

use costate::scalar::{F64x4, F64x8, Scalar};
use std::array::TryFromSliceError;

include!(concat!(env!("OUT_DIR"), "/texts.rs"));

/// Arguments and results of one call.
#[derive(Clone, Debug)]
pub struct Arrays<T> {
    /// Positions.
    pub q: Vec<T>,
    /// Momenta.
    pub p: Vec<T>,
    /// Actuation.
    pub u: Vec<T>,
    /// Costate.
    pub y: Vec<T>,
    /// Result F.
    pub f: Vec<T>,
    /// Result F_x, row by row.
    pub f_x: Vec<T>,
    /// Result y'F_xx, row by row.
    pub y_f_xx: Vec<T>,
}

impl<T: Scalar> Arrays<T> {
    /// Arguments x = (q, p), u, y, and room for the results.
    pub fn new(x: &[T], u: &[T], y: &[T]) -> Self {
        let (q, p) = x.split_at(u.len());
        let zeros = |length| vec![T::zero(); length];
        Self {
            q: q.to_vec(),
            p: p.to_vec(),
            u: u.to_vec(),
            y: y.to_vec(),
            f: zeros(x.len()),
            f_x: zeros(x.len() * x.len()),
            y_f_xx: zeros(x.len() * x.len()),
        }
    }
}

/// A text over one kind of number. Its error is a robot of another size.
pub type Call<T> = fn(&mut Arrays<T>) -> Result<(), TryFromSliceError>;

/// One quantity of one robot.
#[derive(Clone, Copy, Debug)]
pub struct Text {
    /// Name of the robot.
    pub robot: &'static str,
    /// `f`, `f_x`, `y_f_xx`: with the results they build on.
    pub quantity: &'static str,
    /// One state.
    pub one: Call<f64>,
    /// Four states at once.
    pub four: Call<F64x4>,
    /// Eight states at once.
    pub eight: Call<F64x8>,
}

impl Text {
    /// The text for this robot, if there is one.
    pub fn of(robot: &str, quantity: &str) -> Option<&'static Self> {
        TEXTS.iter().find(|text| (text.robot, text.quantity) == (robot, quantity))
    }
}

/// Lanes are numbers of the generated text.
macro_rules! number {
    ($($lanes:ty)*) => {$(
        impl Number for $lanes {
            type Mask = <Self as Scalar>::Mask;
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                Scalar::from_f64(value)
            }
            #[inline(always)]
            fn times(self, factor: f64) -> Self {
                Scalar::times(self, factor)
            }
            #[inline(always)]
            fn plus(self, term: f64) -> Self {
                Scalar::plus(self, term)
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                Scalar::mul_add(self, factor, term)
            }
            #[inline(always)]
            fn recip(self) -> Self {
                Scalar::recip(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Scalar::sqrt(self)
            }
            fn sin_cos(self) -> (Self, Self) {
                Scalar::sin_cos(self)
            }
            fn exp(self) -> Self {
                Scalar::exp(self)
            }
            fn exp_m1(self) -> Self {
                Scalar::exp_m1(self)
            }
            #[inline(always)]
            fn less(self, other: Self) -> Self::Mask {
                Scalar::less(self, other)
            }
            #[inline(always)]
            fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self {
                Scalar::select(mask, if_true, if_false)
            }
        }
    )*};
}

number! { F64x4 F64x8 }
