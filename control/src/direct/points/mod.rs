//! What a motion is at the points of its intervals: torques and rows with their first and second
//! derivatives.
//!
//! The dynamics are behind [`PointDynamics`](values::PointDynamics), as generic code ([`generic_points`]) or
//! as machine code ([`programs`]), with constraints ([`closed_points`]), with another payload in each phase
//! ([`phases`]). Running costs, mechanical energy, jerks and rates of torques follow from the values at the
//! points.

pub(super) mod closed_points;
pub(super) mod energy;
pub(super) mod generic_points;
pub(super) mod panels;
pub(super) mod phases;
#[cfg(feature = "jit")]
pub(super) mod program_points;
#[cfg(feature = "jit")]
pub(super) mod programs;
pub(super) mod rates;
pub(super) mod robot_points;
pub(super) mod running;
pub(super) mod values;
