//! How far a found motion is from one that is integrated.

use crate::bvp::mesh::Span;
use crate::constants::checks::defect::SEGMENTS;
use crate::extremal::Extremal;
use crate::numerics::dormand_prince::{DormandPrince, Stopped};
use crate::solve::Solved;

impl Solved {
    /// Shoots over segments from the values found at their borders, `z' = g(z)` with its costates, and gives
    /// the largest mismatch at the next border, in parts of the size of the component. `tolerance` is that of
    /// a step of the integration, in the same parts.
    pub(crate) fn shooting_defect(
        &self,
        extremal: &mut dyn Extremal,
        tolerance: f64,
    ) -> Result<f64, Stopped> {
        let equations = &self.found.equations;
        let mut timed = self.found.timed(extremal);
        let (m, (segments, parts)) = (equations.m, equations.mesh.coarsened(SEGMENTS));
        let mut integrator = DormandPrince::new(m, tolerance);
        integrator.sizes_mut().copy_from_slice(&equations.scale);
        let (mut w, mut left, mut largest) = (vec![0.0; m], 0, 0.0_f64);
        for (segment, parts) in segments.spans.iter().zip(parts) {
            let right = left + parts.len().max(1);
            if let Span::Interval { arc, length } = *segment {
                w.copy_from_slice(&equations.current.nodes[left * m..(left + 1) * m]);
                integrator
                    .integrate(&mut w, 0.0..length, |_, w, rate| timed.evaluate(w, arc, rate).map(|_| ()))?;
                let found = &equations.current.nodes[right * m..(right + 1) * m];
                for ((found, w), scale) in found.iter().zip(&w).zip(&equations.scale) {
                    largest = largest.max((found - w).abs() / scale);
                }
            }
            left = right;
        }
        Ok(largest)
    }
}
