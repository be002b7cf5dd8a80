//! The paper's own route: global inertia tensors, Christoffel coefficients, and the Hessian of L made of
//! them.
//!
//! ```text
//! Gamma^k_ij = Gamma_{i,kj} = int OP,i . OP,kj dm = [kj, i]        Christoffel symbol of the first kind   (38)
//! M,k = Gamma^k + Gamma^k'      M,kl = Gamma^k,l + Gamma^k,l'                                      (36), (37)
//! P_ik = sum_j M_ij,k v_j       L_qq,kl = 1/2 v' M,kl v - V,kl                                     (21), (22)
//! ```
//!
//! [`MassMatrixDerivatives`] computes and holds the coefficients, [`ChristoffelKernel`] contracts them with
//! the velocity, and [`Christoffel`] is the route that gives it to
//! [`Hamiltonian`](crate::hamiltonian::Hamiltonian) and [`DualPass`](crate::hamiltonian::DualPass). The
//! effort grows with the fourth power of the depth of the tree; the [kernel](crate::kernels::KernelOne) that
//! contracts first does with the second. This route is for those who need the coefficients (adaptive control,
//! geometry) and for checking the other one.
//!
//! On a tree `i <= j` means that i is j or an ancestor of j; what has indices on different branches is zero.
//! All that a joint j and its ancestors have to do with each other is computed in frame j, the z axis of
//! which is Z_j.

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
