//! The paper's route: global inertia tensors, Christoffel coefficients, and the Hessian of L computed from
//! them.
//!
//! ```text
//! Gamma^k_ij = Gamma_{i,kj} = int OP,i . OP,kj dm = [kj, i]        Christoffel symbol of the first kind   (38)
//! M,k = Gamma^k + Gamma^k'      M,kl = Gamma^k,l + Gamma^k,l'                                      (36), (37)
//! P_ik = sum_j M_ij,k v_j       L_qq,kl = 1/2 v' M,kl v - V,kl                                     (21), (22)
//! ```
//!
//! [`MassMatrixDerivatives`] computes and holds the coefficients, [`ChristoffelKernel`] contracts them with
//! the velocity, and [`Christoffel`] selects this route for [`Hamiltonian`](crate::hamiltonian::Hamiltonian)
//! and [`DualPass`](crate::hamiltonian::DualPass). The number of operations grows with the fourth power of
//! the depth of the tree, that of the default [kernel](crate::kernels::KernelOne) with the second. Use this
//! route if you need the coefficients (adaptive control, geometry), or to check the default one.
//!
//! On a tree `i <= j` means that i is j or an ancestor of j; coefficients with indices on different branches
//! are zero. Everything between a joint j and its ancestors is computed in frame j, whose z axis is Z_j.

mod bodies;
mod derivatives;
mod first;
mod global;
mod kernel;
mod paths;
mod second;
mod sets;
#[cfg(test)]
mod tests;

pub use derivatives::MassMatrixDerivatives;
pub use global::GlobalTensors;
pub use kernel::ChristoffelKernel;
pub use sets::IndexSets;

use crate::kernels::Route;
use crate::scalar::Scalar;

/// The route of the paper.
#[derive(Clone, Copy, Debug)]
pub struct Christoffel;

impl Route for Christoffel {
    type Hessian<S: Scalar> = ChristoffelKernel<S>;
}
