//! The state equation as a function for automatic differentiation.

use super::function::Function;
use crate::error::{EvalError, check_length};
use crate::hamiltonian::Hamiltonian;
use crate::matrix::filled;
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;

/// `x -> F(x) + (0, u)` for constant u, from 2n inputs (q, p) to 2n outputs.
#[derive(Clone, Debug)]
pub struct PhaseVelocity {
    tree: Tree,
    /// Actuation (N m, N), length n.
    pub u: Vec<f64>,
}

impl PhaseVelocity {
    /// The state equation of this robot, with u = 0.
    pub fn new(robot: &Robot) -> Self {
        Self { tree: Tree::from(robot), u: vec![0.0; robot.dof()] }
    }

    /// The same under the actuation u (N m, N), length n.
    #[must_use]
    pub fn under(mut self, u: &[f64]) -> Self {
        self.u = u.to_vec();
        self
    }
}

impl Function for PhaseVelocity {
    type Workspace<S: Scalar> = (Hamiltonian<S>, Vec<S>);
    type Error = EvalError;

    fn inputs(&self) -> usize {
        2 * self.tree.dof()
    }

    fn outputs(&self) -> usize {
        2 * self.tree.dof()
    }

    fn workspace<S: Scalar>(&self) -> Self::Workspace<S> {
        (Hamiltonian::from_tree(self.tree.clone()), filled(S::zero(), self.tree.dof()))
    }

    fn evaluate<S: Scalar>(
        &self,
        (hamiltonian, actuation): &mut Self::Workspace<S>,
        x: &[S],
        f: &mut [S],
    ) -> Result<(), EvalError> {
        let n = self.tree.dof();
        check_length("u", &self.u, n)?;
        check_length("x", x, 2 * n)?;
        check_length("f", f, 2 * n)?;
        actuation.iter_mut().zip(&self.u).for_each(|(lifted, &u)| *lifted = S::from_f64(u));
        let (q, p) = x.split_at(n);
        f.copy_from_slice(hamiltonian.evaluate(q, p, actuation)?);
        Ok(())
    }
}
