//! Positions as functions of n inputs.

use crate::configuration::ConfigurationSpace;
use crate::error::{EvalError, LengthError};
use crate::matrix::filled;
use crate::robot::Tree;
use crate::scalar::Scalar;

/// Positions for automatic differentiation: the n inputs are q itself, or, where joints are floating or
/// spherical, a direction d of `q = centre (+) d`. At d = 0 derivatives are those in the tangent space.
#[derive(Clone, Debug)]
pub(super) struct Positions {
    space: ConfigurationSpace,
    /// Empty where q itself is the input.
    centre: Vec<f64>,
}

/// The centre, and q.
pub type Moved<S> = [Vec<S>; 2];

impl Positions {
    /// About the neutral configuration.
    pub fn new(tree: &Tree) -> Self {
        let space = ConfigurationSpace::from_tree(tree.clone());
        let centre = if space.nq() == space.dof() { Vec::new() } else { space.neutral() };
        Self { space, centre }
    }

    /// Whether the inputs are directions.
    pub fn is_moved(&self) -> bool {
        !self.centre.is_empty()
    }

    /// Takes another centre, of nq entries, where there is one.
    pub fn set_centre(&mut self, q: &[f64]) -> Result<(), LengthError> {
        LengthError::check("q", self.space.nq(), q.len())?;
        if self.is_moved() {
            self.centre.copy_from_slice(q);
        }
        Ok(())
    }

    /// Buffers.
    pub fn room<S: Scalar>(&self) -> Moved<S> {
        let zeros = filled(S::zero(), self.centre.len());
        [zeros.clone(), zeros]
    }

    /// q of the inputs.
    pub fn of<'a, S: Scalar>(&self, room: &'a mut Moved<S>, inputs: &'a [S]) -> Result<&'a [S], EvalError> {
        if !self.is_moved() {
            return Ok(inputs);
        }
        let [centre, q] = room;
        centre.iter_mut().zip(&self.centre).for_each(|(lifted, &entry)| *lifted = S::from_f64(entry));
        self.space.integrate(centre, inputs, q)?;
        Ok(q)
    }
}
