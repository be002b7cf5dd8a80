//! Any function generic over the scalar as a step, differentiated automatically.

use super::error::check;
use super::outcome::Outcome;
use super::{Step, StepContraction, StepError, StepLinearisation};
use crate::derivative::{DerivativeError, Function, InnerNumber};
use crate::dynamics::{Automatic, Dynamics, Linearisation};
use crate::scalar::Scalar;
use std::fmt;

/// `x_next = Phi(x, u, h)` of a function of the states, the controls and the duration, with as many outputs
/// as states.
///
/// Jacobians by dual numbers, y'Phi_xx, y'Phi_ux and y'Phi_uu by hyper-dual numbers. `T`: as for
/// [`Jacobian`](crate::derivative::Jacobian).
///
/// ```
/// use costate::derivative::{DerivativeError, Function};
/// use costate::scalar::Scalar;
/// use costate::step::{AutomaticStep, Step};
/// use std::convert::Infallible;
///
/// /// A falling body with drag, stepped by semi-implicit Euler: x = (height, rate), no control.
/// #[derive(Clone)]
/// struct Fall;
///
/// impl Function for Fall {
///     type Workspace<S: Scalar> = ();
///     type Error = Infallible;
///     fn inputs(&self) -> usize { 3 }
///     fn outputs(&self) -> usize { 2 }
///     fn workspace<S: Scalar>(&self) {}
///     fn evaluate<S: Scalar>(&self, _: &mut (), z: &[S], next: &mut [S]) -> Result<(), Infallible> {
///         let [x, v, h] = [z[0], z[1], z[2]];
///         next[1] = v + h * (v * v).times(0.1).plus(-9.81);
///         next[0] = x + h * next[1];
///         Ok(())
///     }
/// }
///
/// let mut step: AutomaticStep<_> = AutomaticStep::new(Fall);
/// let second = step.contract(&[100.0, -3.0], &[], 0.1, &[0.0, 1.0])?;
/// assert!((second.xx[(1, 1)] - 0.1 * 0.2).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct AutomaticStep<F: Function, T: InnerNumber = f64> {
    /// The same function with h as its last control.
    automatic: Automatic<F, T>,
    u_h: Vec<T>,
    outcome: Outcome<T>,
}

impl<F: Function, T: InnerNumber> fmt::Debug for AutomaticStep<F, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AutomaticStep").field("automatic", &self.automatic).finish_non_exhaustive()
    }
}

impl<F: Function + Clone, T: InnerNumber> AutomaticStep<F, T> {
    /// The step of a function: as many states as outputs. The last input is the duration h; the inputs
    /// between are controls.
    ///
    /// # Panics
    /// If the function has no more inputs than outputs.
    pub fn new(function: F) -> Self {
        let (inputs, states) = (function.inputs(), function.outputs());
        assert!(inputs > states, "{states} states and a duration are not among {inputs} inputs");
        Self {
            automatic: Automatic::new(function),
            u_h: vec![Scalar::zero(); inputs - states],
            outcome: Outcome::new(states, inputs - states - 1),
        }
    }
}

impl<F: Function, T: InnerNumber> AutomaticStep<F, T> {
    /// The last control is h.
    fn set(
        &mut self,
        [x, u]: [&[T]; 2],
        h: T,
        y: Option<&[T]>,
    ) -> Result<(), StepError<DerivativeError<F::Error>>> {
        let controls = self.u_h.len() - 1;
        check([self.outcome.next.len(), controls], [x, u], h, y)?;
        self.u_h[..controls].copy_from_slice(u);
        self.u_h[controls] = h;
        Ok(())
    }
}

/// Copies Phi and its derivatives in (x, u, h) from those of the function.
fn take<T: Scalar>(outcome: &mut Outcome<T>, first: &Linearisation<'_, T>) {
    outcome.next.copy_from_slice(first.f);
    for (i, (in_x, in_u_h)) in first.f_x.iter_rows().zip(first.f_u.iter_rows()).enumerate() {
        let (left, right) = outcome.phi_z.row_mut(i).split_at_mut(in_x.len());
        left.copy_from_slice(in_x);
        right.copy_from_slice(in_u_h);
    }
}

impl<F: Function, T: InnerNumber> Step<T> for AutomaticStep<F, T>
where
    F::Error: 'static,
{
    type Error = StepError<DerivativeError<F::Error>>;

    fn states(&self) -> usize {
        self.outcome.next.len()
    }

    fn controls(&self) -> usize {
        self.u_h.len() - 1
    }

    fn evaluate(&mut self, x: &[T], u: &[T], h: T) -> Result<&[T], Self::Error> {
        self.set([x, u], h, None)?;
        Ok(self.automatic.evaluate(x, &self.u_h)?)
    }

    fn linearise(&mut self, x: &[T], u: &[T], h: T) -> Result<StepLinearisation<'_, T>, Self::Error> {
        self.set([x, u], h, None)?;
        take(&mut self.outcome, &self.automatic.linearise(x, &self.u_h)?);
        Ok(self.outcome.first())
    }

    fn contract(&mut self, x: &[T], u: &[T], h: T, y: &[T]) -> Result<StepContraction<'_, T>, Self::Error> {
        self.set([x, u], h, Some(y))?;
        let second = self.automatic.contract(x, &self.u_h, y)?;
        take(&mut self.outcome, &second.first);
        Ok(StepContraction {
            first: self.outcome.first(),
            xx: second.xx,
            ux: second.ux.map(|ux| ux.corner(u.len(), x.len())),
            uu: second.uu.map(|uu| uu.corner(u.len(), u.len())),
        })
    }
}
