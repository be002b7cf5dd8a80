//! Contacts with the ground: stances, contact forces with derivatives, friction cones, unilateral limits.
//!
//! A [`Contact`] is a place of a link that can stand on the ground: a point, or a foot that is held with its
//! orientation. A [`Stance`] is a robot with some of them on the ground; its constraints are those of
//! [`constraints`](crate::constraints), so that [`ConstrainedHamiltonian`] and [`ConstrainedLagrangian`]
//! compute its motions, and [`Impact`] its landing and release. [`ContactForces`] has the contact forces and
//! their [`Margin`]s, with first and contracted second derivatives, as functions of state and actuation.
//!
//! Forces (N) and moments (N m) are those of the ground on the robot, at the origin of the contact, in the
//! axes of the ground: z is its normal, and a positive z pushes the robot away from it. Nothing here decides
//! when a contact opens: a margin says by how much a force is inside its limits, and a motion that needs a
//! pulling force has a negative one.
//!
//! [`ConstrainedHamiltonian`]: crate::constraints::ConstrainedHamiltonian
//! [`ConstrainedLagrangian`]: crate::constraints::ConstrainedLagrangian
//! [`Impact`]: crate::constraints::Impact

mod contact;
mod force_map;
mod forces;
mod margin;
#[cfg(test)]
mod margin_tests;
#[cfg(test)]
mod samples;
mod stance;
#[cfg(test)]
mod tests;

pub use contact::{Contact, Sole};
pub use force_map::{ForceContraction, ForceLinearisation, ForceMap};
pub use forces::{ContactContraction, ContactForces, ContactLinearisation};
pub use margin::{Margin, MarginKind};
pub use stance::Stance;
