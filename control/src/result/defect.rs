//! How far a found motion is from one that is integrated.

use crate::bvp::collocation::error::defined;
use crate::bvp::mesh::Span;
use crate::constants::checks::defect::SEGMENTS;
use crate::extremal::Extremal;
use crate::numerics::dormand_prince::{DormandPrince, Stopped};
use crate::solve::Solved;

impl Solved {
    /// The largest mismatch of state and costates along segments, relative to the size of each component.
    ///
    /// Where that is above `bound`, the sum of the mismatches over all intervals of the mesh if it is less:
    /// narrow friction lets costates grow within a segment by more than any mesh makes good, so that segments
    /// say nothing about the motion. What is off at one node moves what follows by about as much, so it is
    /// their sum that has to be small.
    pub(crate) fn shooting_defect(
        &self,
        extremal: &mut dyn Extremal,
        [tolerance, bound]: [f64; 2],
        stops: &mut dyn FnMut() -> bool,
    ) -> Result<f64, Stopped> {
        let of_segments = match self.mismatches(extremal, tolerance, SEGMENTS, stops) {
            Err(Stopped::Interrupted) => return Err(Stopped::Interrupted),
            found => found.map(|found| found.into_iter().fold(0.0, f64::max)),
        };
        if of_segments.as_ref().is_ok_and(|defect| *defect <= bound) {
            return of_segments;
        }
        let of_intervals = self.mismatches(extremal, tolerance, usize::MAX, stops)?;
        let sum: f64 = of_intervals.into_iter().sum();
        Ok(of_segments.map_or(sum, |largest| largest.min(sum)))
    }

    /// Shoots along segments, at most so many on an arc, from the values found at their borders, `z' = g(z)`
    /// with its costates: the largest mismatch of each at its nodes and the next border, relative to the size
    /// of the component. `tolerance` is that of a step of the integration, relative to the same.
    fn mismatches(
        &self,
        extremal: &mut dyn Extremal,
        tolerance: f64,
        most: usize,
        stops: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<f64>, Stopped> {
        let equations = &self.found.equations;
        let mut timed = self.found.timed(extremal);
        let (m, (segments, parts)) = (equations.m, equations.mesh.coarsened(most));
        let mut integrator = DormandPrince::new(m, tolerance);
        integrator.sizes_mut().copy_from_slice(&equations.scale);
        let (mut w, mut left, mut mismatches) = (vec![0.0; m], 0, Vec::new());
        for (segment, parts) in segments.spans.iter().zip(parts) {
            if let Span::Interval { arc, .. } = *segment {
                w.copy_from_slice(&equations.current.nodes[left * m..(left + 1) * m]);
                let mut largest = 0.0_f64;
                for (k, length) in parts.iter().enumerate() {
                    integrator.integrate_until(&mut w, 0.0..*length, |_, w, rate| {
                        if stops() {
                            return Err(Stopped::Interrupted);
                        }
                        timed.evaluate(w, arc, rate)?;
                        Ok(())
                    })?;
                    let found = &equations.current.nodes[(left + k + 1) * m..(left + k + 2) * m];
                    let misses = found.iter().zip(&w).zip(&equations.scale);
                    let misses = misses.map(|((found, w), scale)| defined((found - w).abs() / scale));
                    largest = misses.fold(largest, f64::max);
                }
                mismatches.push(largest);
            }
            left += parts.len().max(1);
        }
        Ok(mismatches)
    }
}
