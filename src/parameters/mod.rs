//! Derivatives by parameters of the model: masses, first moments, inertias, payloads, lengths, friction.
//!
//! For parameters theta of a robot, p the momentum, y a costate and w weights:
//!
//! | workspace | derivatives |
//! |---|---|
//! | [`Regressor`] | tau_theta (the regressor Y of `tau = Y(q, v, a) pi`), w'tau_theta, p_theta, L_q,theta, E_theta |
//! | [`HamiltonianParameters`] | F_theta, y'F_theta, y'F_x,theta in x = (q, p) |
//! | [`LagrangianParameters`] | a_theta, y'a_theta in x = (q, v) |
//!
//! A [`ParameterSet`] says which parameters, and names them. All quantities are exact, and generic over the
//! scalar. H(q, p) is the extremal value of p.v - L(q, v) over v, so at fixed (q, p) and (q, v)
//!
//! $$ H\_\theta = -L\_\theta, \qquad v\_\theta = -M^{-1} p\_\theta, \qquad F\_\theta = \begin{pmatrix}
//! v\_\theta \\\\ L\_{q\theta} + P^T v\_\theta \end{pmatrix}, \qquad y^T F\_\theta = -D\_{\tilde w} L\_\theta
//! $$
//!
//! L is linear in inertial parameters: its derivatives by them are those of unit bodies. A geometric
//! parameter is the coordinate of a joint that is inserted into the tree and locked at 0, so that its
//! derivatives are entries of the kernels. No derivation is specific to a parameter.
//!
//! Identification of an object that an arm holds, by least squares of torques over 20 states:
//!
//! ```
//! use costate::{lagrangian::Lagrangian, parameters::{ParameterSet, Regressor}, robot::Robot};
//! use nalgebra::{DMatrix, DVector};
//! # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
//! let arm = Robot::from_file("robots/ur5.urdf")?;
//! let set = ParameterSet::new(&arm).payload("object", "tool0")?;
//!
//! // Measured: the torques of the arm with an object of 1.5 kg.
//! let object = [1.5, 0.03, -0.02, 0.12, 0.02, 0.02, 0.005, 0.0, -0.003, 0.001];
//! let mut measured = Lagrangian::<f64>::new(&set.robot_with(&object)?);
//! let mut model = Lagrangian::<f64>::new(&arm);
//! let mut regressor = Regressor::<f64>::new(&set);
//! let (mut rows, mut torques) = (DMatrix::zeros(120, 10), DVector::zeros(120));
//! for k in 0..20 {
//!     let at = |shift: f64| -> [f64; 6] { std::array::from_fn(|i| (shift + (6 * k + i) as f64).sin()) };
//!     let (q, v, a) = (at(0.1), at(0.7).map(|v| 2.0 * v), at(1.9).map(|a| 5.0 * a));
//!     let y = regressor.inverse_dynamics(&q, &v, &a)?.view().to_nalgebra(); // 6 x 10
//!     rows.rows_mut(6 * k, 6).copy_from(&y);
//!     let (with, without) = (measured.inverse_dynamics(&q, &v, &a)?, model.inverse_dynamics(&q, &v, &a)?);
//!     (0..6).for_each(|i| torques[6 * k + i] = with[i] - without[i]);
//! }
//! let found = rows.svd(true, true).solve(&torques, 1e-12)?;
//! assert!(found.iter().zip(object).all(|(found, value)| (found - value).abs() < 1e-9));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `docs/parameters.md` lists the names of parameters and says how they compare with those of Pinocchio.

mod bodies;
mod changed;
mod columns;
mod error;
mod friction;
mod hamiltonian;
mod lagrangian;
mod layout;
mod mixed;
mod names;
mod parameter;
mod regressor;
mod response;
mod set;
mod unit;
mod value;
mod wrenches;

pub use error::ParameterError;
pub use hamiltonian::{HamiltonianParameters, ParameterContraction};
pub use lagrangian::{LagrangianParameters, ParameterLinearisation};
pub use parameter::{Axis, DisplacedIn, Displacement, Inertial, Parameter};
pub use regressor::{MomentumRegressor, Regressor};
pub use set::ParameterSet;
