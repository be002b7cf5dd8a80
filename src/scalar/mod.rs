//! The scalar type that the whole pipeline is generic over.
//!
//! Every formula of the library is written once, for any [`Scalar`]: `f64` and `f32` compute values,
//! num-dual's numbers carry derivatives through the same code, [`Count`] counts operations, and `Lanes`
//! (feature `wide`) computes several states at once. A scalar has ring operations, division, a few functions,
//! and comparison only in the form [`less`](Scalar::less) and [`select`](Scalar::select): generic code cannot
//! branch on a value, so that every scalar takes the same path.

mod count;
mod dual;
mod dual_num;
pub(crate) mod inlined;
#[cfg(feature = "wide")]
mod lanes;
mod number;
mod pack;
mod real;
mod tangent;
mod tanh;
#[cfg(test)]
mod tests;

pub use count::{Constants, Count, Operations, count, count_with};
pub(crate) use inlined::inlined;
#[cfg(feature = "wide")]
pub use lanes::{F64x4, F64x8, LaneMask, Lanes, Vector};
pub use number::{Pack, Scalar};
pub(crate) use pack::MOST_LANES;
pub use tangent::Tangent;
pub(crate) use tanh::real_tanh_and_slope;
