//! Automatic differentiation of any function that is generic over [`Scalar`](crate::scalar::Scalar).
//!
//! | what | how | evaluations |
//! |---|---|---|
//! | [`Directional`] | one dual number | 1 |
//! | [`Jacobian`] (gradient: one output) | dual numbers with C derivatives | n / C, rounded up |
//! | [`Hessian`], contracted or whole | hyper-dual numbers, pairs i <= j | n (n + 1) / 2 |
//! | [`NestedHessian`], contracted | dual numbers in dual numbers | n times n / C |
//!
//! Values and derivatives are `f64`, or with `over` in place of `new` any other [`InnerNumber`]. [`Routes`]
//! compares the library's analytic derivatives with these, and [`OperationTable`] counts their operations.

mod called;
mod directional;
mod dynamics;
mod frame_motion;
mod function;
mod hessian;
mod jacobian;
mod methods;
mod nested;
mod operations;
mod other_route;
mod phase_velocity;
mod positions;
mod reference;
mod report;
mod routes;
mod row;
mod state;
mod weighted_frames;

pub use called::{ByCalls, Called};
pub use directional::{AlongDirection, Directional};
pub use dynamics::{ForwardDynamics, InverseDynamics};
pub use frame_motion::FrameMotion;
pub(crate) use function::check_length;
pub use function::{DerivativeError, Function, InnerNumber};
pub use hessian::{Hessian, SecondDerivatives};
pub use jacobian::{FirstDerivatives, Jacobian};
pub use nested::NestedHessian;
pub use operations::{OperationRow, OperationTable};
pub use other_route::{Evaluate, OtherRoute};
pub use phase_velocity::PhaseVelocity;
pub use reference::ComparedDerivative;
pub(crate) use reference::rounded_once;
pub use report::{Figure, StateReport, Verdict, largest, relative_difference, worse};
pub use routes::Routes;
pub(crate) use routes::{CLOSE, scales};
pub use row::SAFETY;
pub(crate) use row::{Judged, Row};

/// Number of derivatives that a dual number carries at once by default.
///
/// Of 1, 2, 4, 6, 8 and 12, the fastest or close to it for robots of 6, 7 and 12 joints: see `docs/times.md`.
pub const CHUNK: usize = 8;
