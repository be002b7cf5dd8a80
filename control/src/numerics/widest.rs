//! Loops compiled for the widest vectors of the processor, where the feature `jit` is on.

#[cfg(feature = "jit")]
pub(crate) use costate_jit::{widest, widest_fused};

/// Runs `work` as it was compiled.
#[cfg(not(feature = "jit"))]
pub(crate) fn widest_fused<R>(work: impl FnOnce(bool) -> R) -> R {
    work(cfg!(target_feature = "fma"))
}
