//! Operations that are inlined for short numbers only.

/// An expression of scalars of type `$S`: inlined where their operations are short ([`Scalar::INLINED`]),
/// else a function of its own, which all places of one such expression share.
///
/// The pipeline is written for `f64`: its small functions are always inlined. Inlined for a number whose
/// operations are calls, they are only more code, several times as long to compile, not faster.
///
/// The expression must be the whole value of its function: a `return` or `?` in it leaves only a closure
/// where `INLINED` is false.
///
/// [`Scalar::INLINED`]: crate::scalar::Scalar::INLINED
macro_rules! inlined {
    ($S:ty, $expression:expr) => {
        if <$S as crate::scalar::Scalar>::INLINED {
            $expression
        } else {
            crate::scalar::inlined::called(|| $expression)
        }
    };
}
pub(crate) use inlined;

/// The result of a function that is not inlined.
#[inline(never)]
pub(crate) fn called<T>(function: impl FnOnce() -> T) -> T {
    function()
}
