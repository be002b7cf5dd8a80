//! TODO.

pub(crate) mod conjugate;
pub(crate) mod defect;
pub(crate) mod motion;
pub(crate) mod solution;
