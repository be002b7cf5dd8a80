//! Exact first and second derivatives of robot dynamics, for optimisers.
//!
//! For a robot (URDF, TOML, Denavit-Hartenberg table or code), the library computes the Hamiltonian state
//! equation $\dot x = F(x) + (0, u)$, its analytic Jacobian $F\_x$ and its costate-contracted Hessian $y^T
//! F\_{xx}$. One pipeline is generic over the scalar: `f64` evaluates the analytic formulas, num-dual's
//! numbers check them, and [`scalar::Count`] counts their operations.
//!
//! ```
//! use costate::hamiltonian::Hamiltonian;
//! use costate::robot::Robot;
//!
//! # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
//! let robot = Robot::from_file("robots/two_link.toml")?;
//! let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
//! let (q, p, u) = ([0.3, -0.8], [1.0, 0.5], [0.0, 0.0]);
//! let linear = hamiltonian.linearise(&q, &p, &u)?;
//! println!("dx/dt = {:?}\nF_x = {}", linear.f(), linear.matrix().as_nalgebra());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Every map has the same methods: `evaluate` (its value), `linearise` (value and Jacobian), `contract`
//! (value, Jacobian and costate-contracted Hessian), `adjoint` and `hessian_product` (products without the
//! matrix).
//!
//! A module uses only modules before it in this order: [`scalar`], [`matrix`], [`spatial`], [`robot`],
//! [`kernels`], [`tensors`], [`kinematics`], [`hamiltonian`], [`lagrangian`], [`parameters`], [`derivative`],
//! [`dynamics`], [`step`], and then [`batch`] and [`codegen`]. Equation numbers refer to G. Bessonnet, P.
//! Sardain, "Optimal dynamics of actuated kinematic chains. Part 1", European Journal of Mechanics A/Solids
//! 24 (2005) 452-471.

#![deny(unsafe_code)]
#![warn(missing_debug_implementations)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::panic))]

pub mod batch;
pub mod codegen;
pub mod configuration;
pub mod constraints;
pub mod contacts;
mod coordinates;
pub mod derivative;
pub mod dynamics;
mod error;
pub mod hamiltonian;
// Unit tests compile what they use; the whole takes longer than they do.
#[cfg(not(test))]
#[doc(hidden)]
pub mod instances;
pub mod kernels;
pub mod kinematics;
pub mod lagrangian;
pub mod matrix;
pub mod parameters;
pub mod robot;
pub mod scalar;
pub mod spatial;
pub mod step;
pub mod tensors;

pub use coordinates::{Coordinates, UnknownCoordinates};
pub use error::{EvalError, LengthError, PowerOfTen};
/// Dual and hyper-dual numbers, in the version whose numbers are scalars here.
pub use num_dual;

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// The example of the manual of contacts.
#[cfg(doctest)]
#[doc = include_str!("../docs/contacts.md")]
struct Contacts;
