//! Semi-implicit Euler in positions and velocities.

use super::error::check;
use super::outcome::Outcome;
use super::{Step, StepContraction, StepError, StepLinearisation};
use crate::dynamics::{Contraction, Dynamics, Linearisation};
use crate::lagrangian::LagrangianSecondOrder;
use crate::matrix::{add_scaled, filled};
use crate::scalar::Scalar;

/// A model in x = (q, v): the first half of f is the second half of x: `f(x, u) = (v, a(q, v, u))`.
///
/// Implement it for models of this form; the state has even length.
pub trait VelocityForm<S: Scalar>: Dynamics<S> {}

impl<S: Scalar> VelocityForm<S> for LagrangianSecondOrder<S> {}

impl<S: Scalar, D: VelocityForm<S>> VelocityForm<S> for &mut D {}

/// `v+ = v + h a(q, v, u)`, then `q+ = q + h v+`: explicit, first order, one evaluation of f; no call
/// allocates.
///
/// Commonly used by simulators of robots and contact. It is symplectic only if the mass matrix is constant
/// and forces do not depend on v; otherwise energy drifts ([`StoermerVerlet`](super::StoermerVerlet) is
/// symplectic). With `y+ = y_v + h y_q`
///
/// ```text
/// y'Phi_zz = h y+'a_zz ,   z = (q, v, u)
/// ```
///
/// ```
/// use costate::lagrangian::LagrangianSecondOrder;
/// use costate::robot::Robot;
/// use costate::step::{SemiImplicitEuler, Step};
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let mut step = SemiImplicitEuler::new(LagrangianSecondOrder::<f64>::new(&robot));
/// let next = step.evaluate(&[0.3, -0.8, 1.0, 0.5], &[0.0, 0.0], 0.01)?;
/// assert_eq!(next[0], 0.3 + 0.01 * next[2]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SemiImplicitEuler<S, D> {
    model: D,
    outcome: Outcome<S>,
    /// Costate of f.
    mu: Vec<S>,
}

impl<S: Scalar, D: VelocityForm<S>> SemiImplicitEuler<S, D> {
    /// Builds the workspace. Later calls do not allocate.
    ///
    /// # Panics
    /// If the state has odd length.
    pub fn new(model: D) -> Self {
        let (states, controls) = (model.states(), model.controls());
        assert!(states.is_multiple_of(2), "{states} states are not positions and as many velocities");
        Self { outcome: Outcome::new(states, controls), mu: filled(S::zero(), states), model }
    }

    /// The model.
    pub fn model(&self) -> &D {
        &self.model
    }

    /// The model, to change its parameters (not its sizes).
    pub fn model_mut(&mut self) -> &mut D {
        &mut self.model
    }

    fn sizes(&self) -> [usize; 2] {
        [self.model.states(), self.model.controls()]
    }
}

/// Phi from f.
fn arrive<S: Scalar>(next: &mut [S], x: &[S], h: S, f: &[S]) {
    let n = x.len() / 2;
    for k in (0..n).rev() {
        next[n + k] = x[n + k] + h * f[n + k];
        next[k] = x[k] + h * next[n + k];
    }
}

/// Phi and its derivatives in (x, u, h) from those of f: `dv+ = dv + h da + a dh`,
/// `dq+ = dq + h dv+ + v+ dh`.
fn arrive_with_derivatives<S: Scalar>(outcome: &mut Outcome<S>, x: &[S], h: S, first: &Linearisation<'_, S>) {
    let n = x.len() / 2;
    arrive(&mut outcome.next, x, h, first.f);
    let phi_z = &mut outcome.phi_z;
    phi_z.fill_zero();
    for k in 0..n {
        let v = n + k;
        let row = phi_z.row_mut(v);
        add_scaled(row, h, first.f_x.row(v));
        add_scaled(&mut row[2 * n..], h, first.f_u.row(v));
        row[v] = row[v].plus(1.0);
        row[row.len() - 1] = first.f[v];
        let (row, velocity) = phi_z.row_mut_and_below(k, v);
        add_scaled(row, h, velocity);
        row[k] = row[k].plus(1.0);
        row[row.len() - 1] += outcome.next[v];
    }
}

impl<S: Scalar, D: VelocityForm<S>> Step<S> for SemiImplicitEuler<S, D> {
    type Error = StepError<D::Error>;

    fn states(&self) -> usize {
        self.model.states()
    }

    fn controls(&self) -> usize {
        self.model.controls()
    }

    fn evaluate(&mut self, x: &[S], u: &[S], h: S) -> Result<&[S], Self::Error> {
        check(self.sizes(), [x, u], h, None)?;
        arrive(&mut self.outcome.next, x, h, self.model.evaluate(x, u)?);
        Ok(&self.outcome.next)
    }

    fn linearise(&mut self, x: &[S], u: &[S], h: S) -> Result<StepLinearisation<'_, S>, Self::Error> {
        check(self.sizes(), [x, u], h, None)?;
        arrive_with_derivatives(&mut self.outcome, x, h, &self.model.linearise(x, u)?);
        Ok(self.outcome.first())
    }

    fn contract(&mut self, x: &[S], u: &[S], h: S, y: &[S]) -> Result<StepContraction<'_, S>, Self::Error> {
        check(self.sizes(), [x, u], h, Some(y))?;
        let Self { model, outcome, mu } = self;
        let n = x.len() / 2;
        for k in 0..n {
            mu[n + k] = h * (y[n + k] + h * y[k]);
        }
        let second = model.contract(x, u, mu)?;
        arrive_with_derivatives(outcome, x, h, &second.first);
        let Contraction { xx, ux, uu, .. } = second;
        Ok(StepContraction { first: outcome.first(), xx, ux, uu })
    }
}
