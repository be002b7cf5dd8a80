//! An extremal that changes a few evaluations of another one.

use crate::extremal::{
    BoundaryValueProblem, BoundedControls, ControlLaw, ControlRange, Extremal, HamiltonianTerms, Homotopy,
    Relaxation, SideChange,
};
use costate::EvalError;

/// Replacements for methods of an extremal E. Each forwards by default.
pub trait Hooks<E: Extremal> {
    /// In place of [`BoundaryValueProblem::evaluate`].
    ///
    /// # Errors
    /// The dynamics cannot be evaluated at z.
    fn evaluate(
        &mut self,
        inner: &mut E,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        inner.evaluate(z, law, g)
    }

    /// In place of [`BoundaryValueProblem::linearise`].
    ///
    /// # Errors
    /// The dynamics cannot be evaluated at z.
    fn linearise(
        &mut self,
        inner: &mut E,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        inner.linearise(z, law, g, jacobian)
    }

    /// In place of [`BoundaryValueProblem::linearise_exactly`]. Hooks that change the equations must replace
    /// it together with [`linearise`](Self::linearise).
    ///
    /// # Errors
    /// The dynamics cannot be evaluated at z.
    fn linearise_exactly(
        &mut self,
        inner: &mut E,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        inner.linearise_exactly(z, law, g, jacobian)
    }

    /// In place of [`BoundaryValueProblem::ends_are_fixed`].
    fn ends_are_fixed(&self, inner: &E) -> bool {
        inner.ends_are_fixed()
    }

    /// In place of [`BoundedControls::state_rate`].
    ///
    /// # Errors
    /// The dynamics cannot be evaluated at x.
    fn state_rate(&mut self, inner: &mut E, x: &[f64], u: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        inner.state_rate(x, u, f)
    }
}

/// An extremal with [`Hooks`]. All other methods are those of `inner`.
#[derive(Clone, Debug)]
pub struct Wrapped<E, H> {
    /// The extremal itself.
    pub inner: E,
    /// What replaces its methods.
    pub hooks: H,
}

// Every method must be forwarded here: the lint finds one that is left to its default.

#[deny(clippy::missing_trait_methods)]
impl<E: Extremal, H: Hooks<E>> BoundaryValueProblem for Wrapped<E, H> {
    fn states(&self) -> usize {
        self.inner.states()
    }

    fn evaluate(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        self.hooks.evaluate(&mut self.inner, z, law, g)
    }

    fn linearise(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        self.hooks.linearise(&mut self.inner, z, law, g, jacobian)
    }

    fn linearise_exactly(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        self.hooks.linearise_exactly(&mut self.inner, z, law, g, jacobian)
    }

    fn start(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        self.inner.start(z, residual, jacobian)
    }

    fn end(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        self.inner.end(z, residual, jacobian)
    }

    fn time_cost(&self) -> f64 {
        self.inner.time_cost()
    }

    fn ends_are_fixed(&self) -> bool {
        self.hooks.ends_are_fixed(&self.inner)
    }

    fn group(&self, component: usize) -> usize {
        self.inner.group(component)
    }
}

#[deny(clippy::missing_trait_methods)]
impl<E: Extremal, H: Hooks<E>> BoundedControls for Wrapped<E, H> {
    fn controls(&self) -> usize {
        self.inner.controls()
    }

    fn unbounded_controls(&mut self, z: &[f64], u: &mut [f64]) {
        self.inner.unbounded_controls(z, u);
    }

    fn bounds(&self, control: usize) -> ControlRange {
        self.inner.bounds(control)
    }

    fn switching(&mut self, control: usize, change: SideChange, z: &[f64], gradient: &mut [f64]) -> f64 {
        self.inner.switching(control, change, z, gradient)
    }

    fn controls_at(&mut self, z: &[f64], law: ControlLaw<'_>, u: &mut [f64]) {
        self.inner.controls_at(z, law, u);
    }

    fn state_rate(&mut self, x: &[f64], u: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        self.hooks.state_rate(&mut self.inner, x, u, f)
    }
}

#[deny(clippy::missing_trait_methods)]
impl<E: Extremal, H: Hooks<E>> Homotopy for Wrapped<E, H> {
    fn relaxation(&self) -> Relaxation {
        self.inner.relaxation()
    }

    fn set_relaxation(&mut self, relaxation: Relaxation) {
        self.inner.set_relaxation(relaxation);
    }

    fn easiest(&self) -> Relaxation {
        self.inner.easiest()
    }

    fn stretch(&self, z: &mut [f64], factor: f64) {
        self.inner.stretch(z, factor);
    }
}
