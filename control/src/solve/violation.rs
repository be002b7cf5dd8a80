//! By how much a motion exceeds the bounds of the problem.

use crate::bvp::mesh::Span;
use crate::constants::arcs::BEYOND;
use crate::extremal::{ControlRange, Extremal, Relaxation};
use crate::solve::Solved;
use crate::status::BoundViolation;

impl Solved {
    /// Where the controls exceed the bounds of the problem itself most; `None` where all are within. A motion
    /// with relaxed bounds may exceed them, one with the bounds of the problem never does.
    ///
    /// The relaxation of `extremal` is changed in between and then restored.
    pub fn bound_violation(&self, extremal: &mut dyn Extremal) -> Option<BoundViolation> {
        let (z_len, m, before) = (2 * extremal.states(), self.found.equations.m, extremal.relaxation());
        let mut bounds = vec![ControlRange::UNBOUNDED; extremal.controls()];
        extremal.set_relaxation(Relaxation::NONE);
        bounds.iter_mut().enumerate().for_each(|(i, bounds)| *bounds = extremal.bounds(i));
        extremal.set_relaxation(self.relaxation);
        let durations = self.found.durations(z_len);
        let (mut u, mut now, mut worst) = (vec![0.0; bounds.len()], 0.0, None::<BoundViolation>);
        for (i, w) in self.found.equations.current.nodes.chunks_exact(m).enumerate() {
            let mesh = &self.found.equations.mesh;
            extremal.controls_at(&w[..z_len], self.found.arcs.law(mesh.arc_of_node(i)), &mut u);
            for (control, (&u, bounds)) in u.iter().zip(&bounds).enumerate() {
                let factor = bounds.factor(u);
                if factor > 1.0 + BEYOND && worst.is_none_or(|worst| factor > worst.factor) {
                    let bound = if u > bounds.high { bounds.high } else { bounds.low };
                    worst = Some(BoundViolation { control, time: now, u, bound, factor });
                }
            }
            if let Some(&Span::Interval { arc, length }) = mesh.spans.get(i) {
                now += length * durations[arc];
            }
        }
        extremal.set_relaxation(before);
        worst
    }
}
