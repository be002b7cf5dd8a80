//! The motion integrated again by an adaptive integrator.

use crate::bvp::collocation::error::defined;
use crate::bvp::mesh::Span;
use crate::extremal::Extremal;
use crate::numerics::dormand_prince::{DormandPrince, Stopped};
use crate::solve::Solved;

/// Relative tolerance of one integration step.
const TOLERANCE: f64 = 1e-12;

impl Solved {
    /// x(T) integrated from x(0), with the controls that belong to the collocation polynomial of the
    /// costates.
    pub(crate) fn integrated_again(&self, extremal: &mut dyn Extremal) -> Result<Vec<f64>, Stopped> {
        let (states, m) = (extremal.states(), self.found.equations.m);
        let durations = self.found.durations(2 * states);
        let mut x = self.found.equations.current.nodes[..states].to_vec();
        let (mut w, mut u) = (vec![0.0; m], vec![0.0; extremal.controls()]);
        let mut rate = vec![0.0; 2 * states];
        let mut integrator = DormandPrince::new(states, TOLERANCE);
        for (k, span) in self.found.equations.mesh.spans.iter().enumerate() {
            if let Span::Interval { arc, length } = *span {
                let (law, h) = (self.found.arcs.law(arc), length * durations[arc]);
                integrator.integrate(&mut x, 0.0..h, |t, x, f| {
                    self.found.equations.polynomial(k, t / h, &mut w);
                    if u.is_empty() {
                        // Without controls the first half of z' = g(z), with these costates, is the state
                        // equation.
                        w[..states].copy_from_slice(x);
                        extremal.evaluate(&w[..2 * states], law, &mut rate)?;
                        f.copy_from_slice(&rate[..states]);
                        return Ok(());
                    }
                    extremal.controls_at(&w[..2 * states], law, &mut u);
                    extremal.state_rate(x, &u, f)
                })?;
            }
        }
        Ok(x)
    }

    /// Largest difference between x(T) of the mesh and `end`, relative to the size of each component;
    /// infinite without an end.
    pub(crate) fn end_defect(&self, extremal: &dyn Extremal, end: Option<&[f64]>) -> f64 {
        let (states, m, scale) = (extremal.states(), self.found.equations.m, &self.found.equations.scale);
        let last = (self.found.equations.mesh.nodes() - 1) * m;
        let found = &self.found.equations.current.nodes[last..last + states];
        end.map_or(f64::INFINITY, |end| {
            let defects = found.iter().zip(end).zip(scale).map(|((a, b), scale)| defined((a - b) / scale));
            defects.fold(0.0, f64::max)
        })
    }
}
