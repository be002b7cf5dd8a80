//! The interior-point iteration on one mesh: directions, how far to go, the barrier, and what is done about
//! steps that fail.
//!
//! [`Interior`](iterate::Interior) owns the iterate and its workspaces. The other files are its steps:
//! directions ([`step`], [`corrector`]), the search along them with its [`filter`], the elastic phase, warm
//! starts.

mod active;
pub(super) mod corrector;
pub(super) mod elastic;
pub(super) mod figures;
pub(super) mod filter;
pub(super) mod inertia;
pub(super) mod iterate;
pub(super) mod looseness;
pub(super) mod measures;
pub(super) mod relaxation;
mod relaxation_border;
pub(super) mod rounding;
pub(super) mod search;
mod shortfall;
mod small_cost;
pub(super) mod snapshot;
mod soften_equations;
mod softer;
pub(super) mod squares;
mod start;
pub(super) mod step;
pub(super) mod warm;
