//! Loops compiled for the widest vectors of the processor, where the feature `jit` is on.

#[cfg(feature = "jit")]
pub(crate) use costate_jit::{widest, widest_fused};

/// Runs `work` as it was compiled.
#[cfg(not(feature = "jit"))]
pub(crate) fn widest_fused<R>(work: impl FnOnce(bool) -> R) -> R {
    work(cfg!(target_feature = "fma"))
}

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
