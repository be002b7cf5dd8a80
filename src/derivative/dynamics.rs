//! Forward and inverse dynamics as functions for automatic differentiation.

use super::function::Function;
use super::positions::{Moved, Positions};
use crate::error::{EvalError, LengthError, check_length};
use crate::lagrangian::Lagrangian;
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;

/// A function of 3n inputs, q and two vectors more, with n outputs: a method of [`Lagrangian`].
macro_rules! function_of_motion {
    ($(#[$doc:meta])* $Name:ident, $method:ident) => {
        $(#[$doc])*
        ///
        /// With floating and spherical joints the first n inputs are a direction, as in
        /// [`PhaseVelocity`](super::PhaseVelocity).
        #[derive(Clone, Debug)]
        pub struct $Name {
            tree: Tree,
            positions: Positions,
        }

        impl $Name {
            /// That of this robot.
            pub fn new(robot: &Robot) -> Self {
                let tree = Tree::from(robot);
                Self { positions: Positions::new(&tree), tree }
            }

            /// As [`PhaseVelocity::set_centre`](super::PhaseVelocity::set_centre).
            ///
            /// # Errors
            /// [`LengthError`] unless q has nq entries.
            pub fn set_centre(&mut self, q: &[f64]) -> Result<(), LengthError> {
                self.positions.set_centre(q)
            }
        }

        impl Function for $Name {
            type Workspace<S: Scalar> = (Lagrangian<S>, Moved<S>);
            type Error = EvalError;

            fn inputs(&self) -> usize {
                3 * self.tree.dof()
            }

            fn outputs(&self) -> usize {
                self.tree.dof()
            }

            fn workspace<S: Scalar>(&self) -> Self::Workspace<S> {
                (Lagrangian::from_tree(self.tree.clone()), self.positions.room())
            }

            fn evaluate<S: Scalar>(
                &self,
                (lagrangian, moved): &mut Self::Workspace<S>,
                z: &[S],
                outputs: &mut [S],
            ) -> Result<(), EvalError> {
                let n = self.tree.dof();
                check_length("z", z, 3 * n)?;
                check_length("outputs", outputs, n)?;
                let (q, rest) = z.split_at(n);
                let (v, last) = rest.split_at(n);
                let q = self.positions.of(moved, q)?;
                outputs.copy_from_slice(lagrangian.$method(q, v, last)?);
                Ok(())
            }
        }
    };
}

function_of_motion! {
    /// `(q, v, u) -> a = M^-1 (u + D - C v - g)` (9), from 3n inputs to n outputs.
    ForwardDynamics, forward_dynamics
}

function_of_motion! {
    /// `(q, v, a) -> tau = M a + C v + g - D`, from 3n inputs to n outputs.
    InverseDynamics, inverse_dynamics
}
