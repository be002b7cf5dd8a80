//! Robots as models whose derivatives by q are those in the tangent space.

use crate::dynamics::{Contraction, Linearisation, Structure};
use crate::error::EvalError;
use crate::hamiltonian::{HamiltonianLinearisation, HamiltonianSecondOrder};
use crate::lagrangian::{LagrangianSecondOrder, StateLinearisation};
use crate::robot::Robot;
use crate::scalar::Scalar;

/// dx/dt = F(q, w, tau) of a robot, w its momenta or rates, x = (q, w): F has 2n entries, and derivatives by
/// q are those by d in q (+) d.
///
/// [`HamiltonianSecondOrder`] has momenta, [`LagrangianSecondOrder`] rates.
pub trait TangentModel<S: Scalar> {
    /// The workspace of a robot.
    fn of(robot: &Robot) -> Self;

    /// Number of degrees of freedom, n.
    fn dof(&self) -> usize;

    /// What is constant, of q with so many entries.
    fn structure(nq: usize) -> Structure;

    /// F.
    ///
    /// # Errors
    /// Those of the robot.
    fn rate(&mut self, q: &[S], w: &[S], tau: &[S]) -> Result<&[S], EvalError>;

    /// F and its first derivatives, 2n x 2n and 2n x n.
    ///
    /// # Errors
    /// As [`rate`](Self::rate).
    fn linear(&mut self, q: &[S], w: &[S], tau: &[S]) -> Result<Linearisation<'_, S>, EvalError>;

    /// The same with the second derivatives of y'F, 2n x 2n; those by (tau, q), n x n, unless they are zero.
    ///
    /// # Errors
    /// As [`rate`](Self::rate).
    fn second(&mut self, q: &[S], w: &[S], tau: &[S], y: &[S]) -> Result<Contraction<'_, S>, EvalError>;
}

fn in_momenta<'a, S: Scalar>(linear: HamiltonianLinearisation<'a, S>) -> Linearisation<'a, S> {
    Linearisation { f: linear.f(), f_x: linear.matrix(), f_u: linear.f_u() }
}

fn in_rates<'a, S: Scalar>(state: StateLinearisation<'a, S>) -> Linearisation<'a, S> {
    Linearisation { f: state.f, f_x: state.f_x.view(), f_u: state.f_u.view() }
}

impl<S: Scalar> TangentModel<S> for HamiltonianSecondOrder<S> {
    fn of(robot: &Robot) -> Self {
        Self::new(robot)
    }

    fn dof(&self) -> usize {
        Self::dof(self)
    }

    fn structure(_: usize) -> Structure {
        Structure { constant_f_u: true, affine_in_u: true, f_u_depends_on: 0 }
    }

    fn rate(&mut self, q: &[S], p: &[S], tau: &[S]) -> Result<&[S], EvalError> {
        self.first().evaluate(q, p, tau)
    }

    fn linear(&mut self, q: &[S], p: &[S], tau: &[S]) -> Result<Linearisation<'_, S>, EvalError> {
        self.first().linearise(q, p, tau).map(in_momenta)
    }

    fn second(&mut self, q: &[S], p: &[S], tau: &[S], y: &[S]) -> Result<Contraction<'_, S>, EvalError> {
        let all = self.contract(q, p, tau, y)?;
        Ok(Contraction { first: in_momenta(all.linearisation()), xx: all.matrix(), ux: None, uu: None })
    }
}

impl<S: Scalar> TangentModel<S> for LagrangianSecondOrder<S> {
    fn of(robot: &Robot) -> Self {
        Self::new(robot)
    }

    fn dof(&self) -> usize {
        Self::dof(self)
    }

    fn structure(nq: usize) -> Structure {
        Structure { constant_f_u: false, affine_in_u: true, f_u_depends_on: nq }
    }

    fn rate(&mut self, q: &[S], v: &[S], tau: &[S]) -> Result<&[S], EvalError> {
        self.first().evaluate(q, v, tau)
    }

    fn linear(&mut self, q: &[S], v: &[S], tau: &[S]) -> Result<Linearisation<'_, S>, EvalError> {
        self.first().linearise(q, v, tau).map(in_rates)
    }

    fn second(&mut self, q: &[S], v: &[S], tau: &[S], y: &[S]) -> Result<Contraction<'_, S>, EvalError> {
        let all = self.contract(q, v, tau, y)?;
        let first = in_rates(all.linearisation());
        Ok(Contraction { first, xx: all.xx(), ux: Some(all.uq()), uu: None })
    }
}
