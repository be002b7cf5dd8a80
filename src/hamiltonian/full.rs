//! All second derivatives of the state equation.

use super::{HamiltonianSecondOrder, HessianTensor};
use crate::error::EvalError;
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;

/// Workspace for the whole tensor d2F_k/dx_i dx_j of one robot; no call allocates.
///
/// The third derivative of H along each joint, by the same rule as [`HamiltonianSecondOrder`]: n times kernel
/// two and its congruence. For one costate, [`HamiltonianSecondOrder::contract`] is much cheaper.
///
/// ```
/// use costate::hamiltonian::FullHessian;
/// use costate::robot::Robot;
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/ur5.urdf")?;
/// let mut full = FullHessian::<f64>::new(&robot);
/// let tensor = full.hessian_tensor(&[0.1; 6], &[0.2; 6])?;
/// assert_eq!(tensor.packed().len(), 308); // of 12 x 12 x 12
/// assert_eq!(tensor.entry(3, 0, 7), tensor.entry(3, 7, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FullHessian<S: Scalar> {
    pub(super) second: HamiltonianSecondOrder<S>,
    zero: Vec<S>,
    tensor: HessianTensor<S>,
}

impl<S: Scalar> FullHessian<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(Tree::from(robot))
    }

    /// As [`new`](Self::new), from an existing [`Tree`].
    pub fn from_tree(tree: Tree) -> Self {
        Self {
            tensor: HessianTensor::new(&tree),
            zero: vec![S::zero(); tree.dof()],
            second: HamiltonianSecondOrder::from_tree(tree),
        }
    }

    /// The tensor at q (rad, m) and p (kg m^2/s, kg m/s), n each; actuation does not enter.
    ///
    /// # Errors
    /// See [`Hamiltonian`](super::Hamiltonian).
    pub fn hessian_tensor(&mut self, q: &[S], p: &[S]) -> Result<&HessianTensor<S>, EvalError> {
        self.second.first().tree().refuse_free()?;
        self.second.first().check(&[("q", q), ("p", p)])?;
        self.second.first().prepare([q, p, &self.zero])?;
        self.second.first().assemble();
        self.second.first().add_slopes([q, p]);
        self.second.first().state.add_wrench_slopes(q);
        for l in 0..q.len() {
            let slice = self.second.along_joint(l)?;
            self.tensor.fill_slice(l, slice);
        }
        self.tensor.fill_friction(self.second.first());
        self.tensor.fill_wrenches(self.second.first(), q);
        Ok(&self.tensor)
    }
}
