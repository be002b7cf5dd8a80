//! The paper's own route: global inertia tensors and Christoffel coefficients.

use crate::kernels::{KernelOne, Route};
use crate::scalar::Scalar;

/// The route of the paper.
#[derive(Clone, Copy, Debug)]
pub struct Christoffel;

impl Route for Christoffel {
    type Hessian<S: Scalar> = KernelOne<S>;
}
