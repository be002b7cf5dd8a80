//! Where controls reach or leave their bounds on a solution without arcs.

use crate::bvp::mesh::Span;
use crate::extremal::{BoundSide, Extremal};
use crate::solve::Extremum;
use crate::solve::arcs::side_of;

impl Extremum {
    /// Where the controls of one arc reach or leave their bounds, in the order of time.
    pub(crate) fn crossings<E: Extremal>(&self, extremal: &mut E) -> Vec<Crossing> {
        let (z_len, m, count) = (2 * extremal.states(), self.equations.m, extremal.controls());
        let durations = self.durations(z_len);
        let mut found: Vec<Crossing> = Vec::new();
        if count == 0 {
            return found;
        }
        let mut sides = |w: &[f64], u: &mut [f64]| -> Vec<BoundSide> {
            extremal.unbounded_controls(&w[..z_len], u);
            let side = |(i, &u): (usize, &f64)| side_of(u, extremal.bounds(i));
            u.iter().enumerate().map(side).collect()
        };
        let (mut w, mut u) = (self.equations.current.nodes[..m].to_vec(), vec![0.0; count]);
        let mut before = sides(&w, &mut u);
        let mut now = 0.0;
        for (k, span) in self.equations.mesh.spans.iter().enumerate() {
            let Span::Interval { arc, length } = *span else { continue };
            let h = length * durations[arc];
            let mut in_interval = Vec::new();
            // Several looks at each interval, for arcs that are short.
            for look in 1..=LOOKS {
                let (from, to) = ((look - 1) as f64 / LOOKS as f64, look as f64 / LOOKS as f64);
                self.equations.polynomial(k, to, &mut w);
                let after = sides(&w, &mut u);
                for control in 0..count {
                    let pair = (before[control], after[control]);
                    if pair.0 != pair.1 {
                        let c = self.bisect(k, (from, to), &mut w, |w| sides(w, &mut u)[control] == pair.0);
                        in_interval.push(Crossing { time: now + c * h, control, sides: pair });
                    }
                }
                before = after;
            }
            in_interval.sort_by(|a, b| a.time.total_cmp(&b.time));
            found.extend(in_interval);
            now += h;
        }
        found
    }

    /// Where in an interval `before` stops to hold.
    fn bisect(
        &self,
        span: usize,
        (mut from, mut to): (f64, f64),
        w: &mut [f64],
        mut before: impl FnMut(&[f64]) -> bool,
    ) -> f64 {
        for _ in 0..50 {
            let middle = 0.5 * (from + to);
            self.equations.polynomial(span, middle, w);
            if before(w) {
                from = middle;
            } else {
                to = middle;
            }
        }
        0.5 * (from + to)
    }
}

/// How often an interval is looked at for a control that reaches or leaves a bound.
const LOOKS: usize = 8;

/// A control reaches or leaves a bound.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub time: f64,
    pub control: usize,
    pub sides: (BoundSide, BoundSide),
}
