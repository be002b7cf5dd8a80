//! The Jacobian of an extremal along an interval of its mesh.

use crate::bvp::mesh::Span;
use crate::extremal::Extremal;
use crate::solve::Solved;
use costate::EvalError;

/// An extremal on an interval of its mesh.
pub(crate) struct Along<'a> {
    solved: &'a Solved,
    extremal: &'a mut dyn Extremal,
    span: usize,
    arc: usize,
    /// Duration of the interval (s).
    duration: f64,
    w: Vec<f64>,
    g: Vec<f64>,
}

impl<'a> Along<'a> {
    /// On a span of the mesh, with the durations of all arcs (s); none for a switch.
    pub fn new(
        solved: &'a Solved,
        extremal: &'a mut dyn Extremal,
        span: usize,
        durations: &[f64],
    ) -> Option<Self> {
        let Span::Interval { arc, length } = solved.found.equations.mesh.spans[span] else { return None };
        let (w, g) = (vec![0.0; solved.found.equations.m], vec![0.0; 2 * extremal.states()]);
        Some(Self { solved, extremal, span, arc, duration: length * durations[arc], w, g })
    }

    /// The Jacobian of z', row by row, at a time (s) from the start of the interval, on the collocation
    /// polynomial.
    pub fn jacobian(&mut self, t: f64, jacobian: &mut [f64]) -> Result<(), EvalError> {
        let found = &self.solved.found;
        found.equations.polynomial(self.span, t / self.duration, &mut self.w);
        let z = &self.w[..self.g.len()];
        self.extremal.linearise_exactly(z, found.arcs.law(self.arc), &mut self.g, jacobian)?;
        Ok(())
    }
}
