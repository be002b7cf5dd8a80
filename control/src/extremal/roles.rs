//! What an extremal must offer, by role.

use crate::extremal::{BoundSide, ControlLaw, ControlRange, Relaxation, SideChange};
use costate::EvalError;

/// Hamiltonian and running cost at one point of an extremal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HamiltonianTerms {
    /// $H^\ast = y^\top f - l$.
    pub hamiltonian: f64,
    /// Running cost l without penalties.
    pub cost: f64,
    /// Penalties.
    pub penalty: f64,
    /// The rest of l: cost that only a relaxed problem has.
    pub smoothing: f64,
}

impl HamiltonianTerms {
    /// $|y^\top f| + |l|$: the scale for errors of $H^\ast$.
    pub fn magnitude(&self) -> f64 {
        let l = self.cost + self.penalty + self.smoothing;
        (self.hamiltonian + l).abs() + l.abs()
    }
}

/// A differential equation with conditions at both ends, $z' = g(z)$, $z = (x, y)$, of a maximised
/// Hamiltonian:
///
/// $$ H^\ast(x, y) = \max_u \left[ y^\top f(x, u) - l(x, u) \right], \qquad
///    x' = \frac{\partial H^\ast}{\partial y}, \qquad y' = -\frac{\partial H^\ast}{\partial x} $$
///
/// There are N conditions at each end, N being the length of x and of the costate y. Matrices are row-major.
pub trait BoundaryValueProblem {
    /// Length N of x.
    fn states(&self) -> usize;

    /// g(z), 2N entries.
    ///
    /// # Errors
    /// The dynamics cannot be evaluated at z.
    fn evaluate(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError>;

    /// g(z) and its Jacobian, 2N x 2N.
    ///
    /// # Errors
    /// The dynamics cannot be evaluated at z.
    fn linearise(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError>;

    /// Residuals of the N conditions at the start, and their Jacobian, N x 2N.
    ///
    /// # Errors
    /// The dynamics cannot be evaluated at z.
    fn start(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError>;

    /// Residuals of the N conditions at the end, and their Jacobian, N x 2N.
    ///
    /// # Errors
    /// The dynamics cannot be evaluated at z.
    fn end(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError>;

    /// $c_t$, the constant part of l: the cost of time.
    fn time_cost(&self) -> f64 {
        0.0
    }

    /// As [`linearise`](Self::linearise), with all second derivatives. It is used for the second variation,
    /// which is wrong without them.
    ///
    /// Override it where `linearise` writes an approximation. The default is `linearise`.
    ///
    /// # Errors
    /// The dynamics cannot be evaluated at z.
    fn linearise_exactly(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        self.linearise(z, law, g, jacobian)
    }

    /// Whether both ends fix all of x, and $H^\ast_{yy}$ is positive semidefinite everywhere.
    ///
    /// Override with `true` only if both ends fix all of x and H_yy >= 0; conjugate times are checked only
    /// then. The default is `false`: [`Motion::certificate`](crate::Motion::certificate) is then
    /// [`Certificate::NotChecked`](crate::Certificate::NotChecked).
    fn ends_are_fixed(&self) -> bool {
        false
    }

    /// The group of a component of z. Components of one group have one unit; each is scaled by at least a
    /// fraction of the largest of its group.
    fn group(&self, component: usize) -> usize {
        component / self.states().max(1)
    }
}

/// The controls of an extremal and their bounds. The defaults are those of an equation without controls.
pub trait BoundedControls {
    /// Number of controls; unbounded controls may be left out.
    fn controls(&self) -> usize {
        0
    }

    /// The controls at z before clipping to their bounds: infinite where only the sign of a costate decides,
    /// NaN where they cannot be computed.
    fn unbounded_controls(&mut self, _z: &[f64], _u: &mut [f64]) {}

    /// Lower and upper bound of a control.
    fn bounds(&self, _control: usize) -> ControlRange {
        ControlRange::UNBOUNDED
    }

    /// The function whose zero is the time at which `control` leaves or reaches a bound, and its
    /// gradient in z, 2N.
    fn switching(&mut self, _control: usize, _change: SideChange, _z: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        0.0
    }

    /// The controls under this law.
    fn controls_at(&mut self, z: &[f64], law: ControlLaw<'_>, u: &mut [f64]) {
        self.unbounded_controls(z, u);
        for (i, u) in u.iter_mut().enumerate() {
            let ControlRange { low, high } = self.bounds(i);
            *u = match law {
                ControlLaw::Maximal => u.clamp(low, high),
                ControlLaw::Given(sides) => match sides[i] {
                    BoundSide::Low => low,
                    BoundSide::Inside => *u,
                    BoundSide::High => high,
                },
            };
        }
    }

    /// $x' = f(x, u)$ for any control, N entries. A solution is verified by integrating it once more with its
    /// controls.
    ///
    /// The default writes NaN: the motion cannot be integrated again and ends as
    /// [`Status::NotVerified`](crate::Status::NotVerified). Implement it for every extremal with controls.
    ///
    /// # Errors
    /// The dynamics cannot be evaluated at x.
    fn state_rate(&mut self, _x: &[f64], _u: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        f.fill(f64::NAN);
        Ok(())
    }
}

/// A family of easier problems. The defaults are those of a problem that cannot be relaxed.
pub trait Homotopy {
    /// The current relaxation.
    fn relaxation(&self) -> Relaxation {
        Relaxation::NONE
    }

    /// Relaxes the problem, or restores it by [`Relaxation::NONE`]. Parts that the problem does not have are
    /// ignored.
    fn set_relaxation(&mut self, _: Relaxation) {}

    /// The most relaxed problem. Fields that equal those of [`Relaxation::NONE`] cannot be relaxed.
    fn easiest(&self) -> Relaxation {
        Relaxation::NONE
    }

    /// Turns z at some t/T into a guess for a motion that takes `factor` times as long.
    fn stretch(&self, _z: &mut [f64], _factor: f64) {}
}

/// A boundary-value problem with its controls and relaxations. Implemented for every type that has the three
/// roles.
pub trait Extremal: BoundaryValueProblem + BoundedControls + Homotopy {}

impl<E: BoundaryValueProblem + BoundedControls + Homotopy> Extremal for E {}
