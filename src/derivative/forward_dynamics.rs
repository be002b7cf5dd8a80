//! Forward dynamics as a function for automatic differentiation.

use super::function::Function;
use crate::error::{EvalError, check_length};
use crate::lagrangian::Lagrangian;
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;

/// `(q, v, u) -> a = M^-1 (u + D - C v - g)` (9), from 3n inputs to n outputs.
#[derive(Clone, Debug)]
pub struct ForwardDynamics(Tree);

impl ForwardDynamics {
    /// The forward dynamics of this robot.
    pub fn new(robot: &Robot) -> Self {
        Self(Tree::from(robot))
    }
}

impl Function for ForwardDynamics {
    type Workspace<S: Scalar> = Lagrangian<S>;
    type Error = EvalError;

    fn inputs(&self) -> usize {
        3 * self.0.dof()
    }

    fn outputs(&self) -> usize {
        self.0.dof()
    }

    fn workspace<S: Scalar>(&self) -> Lagrangian<S> {
        Lagrangian::from_tree(self.0.clone())
    }

    fn evaluate<S: Scalar>(
        &self,
        lagrangian: &mut Lagrangian<S>,
        z: &[S],
        a: &mut [S],
    ) -> Result<(), EvalError> {
        let n = self.0.dof();
        check_length("z", z, 3 * n)?;
        check_length("a", a, n)?;
        let (q, rest) = z.split_at(n);
        let (v, u) = rest.split_at(n);
        a.copy_from_slice(lagrangian.forward_dynamics(q, v, u)?);
        Ok(())
    }
}
