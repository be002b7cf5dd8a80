//! Loops compiled for the widest vectors of the processor.
//!
//! A build for any x86-64 processor uses vectors of two doubles. [`widest`] runs a closure compiled for
//! AVX-512, AVX2 or the vectors of the build, chosen at run time, with the same bits on all processors;
//! [`widest_fused`] also fuses products and sums. Plain loops over rows of a dozen numbers and more gain,
//! such as those of an elimination.

#![warn(missing_debug_implementations)]
#![deny(unsafe_op_in_unsafe_fn, clippy::undocumented_unsafe_blocks)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::panic))]

mod widest;

/// Calls a function in the widest vectors, with `FUSED` as its parameter: whether products and sums are one
/// instruction of the processor (otherwise `f64::mul_add` would be a slow function). It must be
/// `#[inline(always)]`.
///
/// ```
/// use costate_numerics::in_widest;
///
/// #[inline(always)]
/// fn add<const FUSED: bool>(factor: f64, from: &[f64], to: &mut [f64]) {
///     for (to, from) in to.iter_mut().zip(from) {
///         *to = if FUSED { factor.mul_add(*from, *to) } else { factor * from + *to };
///     }
/// }
///
/// let (from, mut to) = (vec![1.0; 100], vec![2.0; 100]);
/// in_widest!(add(0.5, &from, &mut to));
/// assert_eq!(to, [2.5; 100]);
/// ```
#[macro_export]
macro_rules! in_widest {
    ($($function:ident).+($($argument:expr),* $(,)?)) => {
        $crate::widest_fused(
            #[inline(always)]
            |fused| match fused {
                true => $($function).+::<true>($($argument),*),
                false => $($function).+::<false>($($argument),*),
            },
        )
    };
}

pub use widest::{widest, widest_fused};
