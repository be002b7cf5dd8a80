//! The paper's route: global inertia tensors, Christoffel coefficients, and the Hessian of L computed from
//! them.
//!
//! $$ \Gamma^k\_{ij} = \int OP\_{,i} \cdot OP\_{,kj} \enspace dm \qquad (38) $$
//!
//! $$ M\_{,k} = \Gamma^k + (\Gamma^k)^T, \qquad
//! M\_{,kl} = \Gamma^k\_{,l} + (\Gamma^k\_{,l})^T \qquad (36), (37) $$
//!
//! $$ P\_{ik} = \sum\_j M\_{ij,k} v\_j, \qquad
//! L\_{qq,kl} = \tfrac12 v^T M\_{,kl} v - V\_{,kl} \qquad (21), (22) $$
//!
//! $\Gamma^k\_{ij}$ is the Christoffel symbol of the first kind with the index order (kj, i).
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
