//! Functions compiled for the widest vectors of the processor.

pub(crate) use costate_numerics::{widest, widest_fused};

/// Calls a function in the widest vectors, with `FUSED` as its parameter: whether products and sums are one
/// instruction of the processor (otherwise `f64::mul_add` would be a slow function). It must be
/// `#[inline(always)]`.
macro_rules! in_widest {
    ($($function:ident).+($($argument:expr),* $(,)?)) => {
        $crate::numerics::widest::widest_fused(
            #[inline(always)]
            |fused| match fused {
                true => $($function).+::<true>($($argument),*),
                false => $($function).+::<false>($($argument),*),
            },
        )
    };
}
pub(crate) use in_widest;
