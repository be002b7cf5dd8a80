//! Loops compiled for the widest vectors of the processor, where the feature `jit` is on.

#[cfg(feature = "jit")]
pub(crate) use costate_jit::widest;

/// Runs `work` as it was compiled.
#[cfg(not(feature = "jit"))]
pub(crate) fn widest<R>(work: impl FnOnce() -> R) -> R {
    work()
}
