//! An extremal whose evaluations are counted.

use costate::EvalError;
use costate_control::{Ease, Extremal, Law, Rate, Side};
use std::time::{Duration, Instant};

/// Counts until the found motion is integrated again: the first evaluation at a given control belongs to its check.
pub struct Counted<E> {
    extremal: E,
    begun: Instant,
    pub rates: usize,
    pub jacobians: usize,
    /// How long the search took, once it is over.
    taken: Option<Duration>,
}

impl<E: Extremal> Counted<E> {
    pub fn new(extremal: E) -> Self {
        Self { extremal, begun: Instant::now(), rates: 0, jacobians: 0, taken: None }
    }

    /// Since it was made, without the check.
    pub fn taken(&self) -> Duration {
        self.taken.unwrap_or_else(|| self.begun.elapsed())
    }

    fn searching(&self) -> usize {
        usize::from(self.taken.is_none())
    }
}

impl<E: Extremal> Extremal for Counted<E> {
    fn states(&self) -> usize {
        self.extremal.states()
    }

    fn controls(&self) -> usize {
        self.extremal.controls()
    }

    fn rate(&mut self, z: &[f64], law: Law<'_>, g: &mut [f64]) -> Result<Rate, EvalError> {
        self.rates += self.searching();
        self.extremal.rate(z, law, g)
    }

    fn linear(
        &mut self,
        z: &[f64],
        law: Law<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<Rate, EvalError> {
        self.jacobians += self.searching();
        self.extremal.linear(z, law, g, jacobian)
    }

    fn start(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        self.extremal.start(z, residual, jacobian)
    }

    fn end(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        self.extremal.end(z, residual, jacobian)
    }

    fn time_cost(&self) -> f64 {
        self.extremal.time_cost()
    }

    /// Not said, so that conjugate times, which are not part of the study, are not looked for.
    fn ends_are_fixed(&self) -> bool {
        false
    }

    fn set_ease(&mut self, ease: Ease) {
        self.extremal.set_ease(ease);
    }

    fn easiest(&self) -> Ease {
        self.extremal.easiest()
    }

    fn stretch(&self, z: &mut [f64], factor: f64) {
        self.extremal.stretch(z, factor);
    }

    fn group(&self, component: usize) -> usize {
        self.extremal.group(component)
    }

    fn unbounded_controls(&mut self, z: &[f64], u: &mut [f64]) {
        self.extremal.unbounded_controls(z, u);
    }

    fn bounds(&self, control: usize) -> (f64, f64) {
        self.extremal.bounds(control)
    }

    fn switching(&mut self, control: usize, sides: (Side, Side), z: &[f64], gradient: &mut [f64]) -> f64 {
        self.extremal.switching(control, sides, z, gradient)
    }

    fn controls_at(&mut self, z: &[f64], law: Law<'_>, u: &mut [f64]) {
        self.extremal.controls_at(z, law, u);
    }

    fn state_rate(&mut self, x: &[f64], u: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        self.taken.get_or_insert(self.begun.elapsed());
        self.extremal.state_rate(x, u, f)
    }
}
