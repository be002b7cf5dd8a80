//! Counts the evaluations of an extremal.

use costate::EvalError;
use costate_control::{ControlLaw, Extremal, HamiltonianTerms, Hooks, Wrapped};
use std::time::{Duration, Instant};

/// An extremal whose evaluations are counted.
pub type Counted<E> = Wrapped<E, Counts>;

/// Counts until the solution is verified. Verification begins with the first evaluation at a given control.
#[derive(Debug)]
pub struct Counts {
    begun: Instant,
    pub rates: usize,
    pub jacobians: usize,
    /// Duration of the search, once it is over.
    duration: Option<Duration>,
}

impl Counts {
    /// Counts from zero, from now on.
    pub fn of<E>(extremal: E) -> Counted<E> {
        let hooks = Self { begun: Instant::now(), rates: 0, jacobians: 0, duration: None };
        Wrapped { inner: extremal, hooks }
    }

    /// Duration without the verification.
    pub fn duration(&self) -> Duration {
        self.duration.unwrap_or_else(|| self.begun.elapsed())
    }

    fn searching(&self) -> usize {
        usize::from(self.duration.is_none())
    }
}

impl<E: Extremal> Hooks<E> for Counts {
    fn evaluate(
        &mut self,
        inner: &mut E,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        self.rates += self.searching();
        inner.evaluate(z, law, g)
    }

    fn linearise(
        &mut self,
        inner: &mut E,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        self.jacobians += self.searching();
        inner.linearise(z, law, g, jacobian)
    }

    /// False, so that no conjugate times are computed: they are not part of the study.
    fn ends_are_fixed(&self, _: &E) -> bool {
        false
    }

    fn state_rate(&mut self, inner: &mut E, x: &[f64], u: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        self.duration.get_or_insert(self.begun.elapsed());
        inner.state_rate(x, u, f)
    }
}
