//! The gains of the optimal feedback and derivatives by limits, in tables over time.

mod derivatives;
mod error;
mod over_time;

pub use derivatives::{LimitDerivative, LimitDerivatives};
pub use error::GainError;
pub use over_time::Gains;
