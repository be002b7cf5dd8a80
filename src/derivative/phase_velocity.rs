//! The state equation as a function for automatic differentiation.

use super::function::Function;
use super::positions::{Moved, Positions};
use crate::error::{EvalError, LengthError, check_length};
use crate::hamiltonian::Hamiltonian;
use crate::matrix::filled;
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;

/// `x -> F(x) + (0, u)` for constant u, from 2n inputs (q, p) to 2n outputs.
///
/// With floating and spherical joints the first n inputs are a direction d, and F is that at the
/// [centre](Self::set_centre) moved by d: derivatives at d = 0 are those in the tangent space.
#[derive(Clone, Debug)]
pub struct PhaseVelocity {
    tree: Tree,
    positions: Positions,
    /// Actuation (N m, N), length n.
    pub u: Vec<f64>,
}

impl PhaseVelocity {
    /// The state equation of this robot, with u = 0.
    pub fn new(robot: &Robot) -> Self {
        let tree = Tree::from(robot);
        Self { positions: Positions::new(&tree), tree, u: vec![0.0; robot.dof()] }
    }

    /// Takes the configuration (nq) that directions begin at, neutral before; without effect for robots
    /// without floating and spherical joints.
    ///
    /// # Errors
    /// [`LengthError`] unless q has nq entries.
    pub fn set_centre(&mut self, q: &[f64]) -> Result<(), LengthError> {
        self.positions.set_centre(q)
    }

    /// The same under the actuation u (N m, N), length n.
    #[must_use]
    pub fn under(mut self, u: &[f64]) -> Self {
        self.u = u.to_vec();
        self
    }
}

impl Function for PhaseVelocity {
    type Workspace<S: Scalar> = (Hamiltonian<S>, Vec<S>, Moved<S>);
    type Error = EvalError;

    fn inputs(&self) -> usize {
        2 * self.tree.dof()
    }

    fn outputs(&self) -> usize {
        2 * self.tree.dof()
    }

    fn workspace<S: Scalar>(&self) -> Self::Workspace<S> {
        let actuation = filled(S::zero(), self.tree.dof());
        (Hamiltonian::from_tree(self.tree.clone()), actuation, self.positions.room())
    }

    fn evaluate<S: Scalar>(
        &self,
        (hamiltonian, actuation, moved): &mut Self::Workspace<S>,
        x: &[S],
        f: &mut [S],
    ) -> Result<(), EvalError> {
        let n = self.tree.dof();
        check_length("u", &self.u, n)?;
        check_length("x", x, 2 * n)?;
        check_length("f", f, 2 * n)?;
        actuation.iter_mut().zip(&self.u).for_each(|(lifted, &u)| *lifted = S::from_f64(u));
        let (q, p) = x.split_at(n);
        let q = self.positions.of(moved, q)?;
        f.copy_from_slice(hamiltonian.evaluate(q, p, actuation)?);
        Ok(())
    }
}
