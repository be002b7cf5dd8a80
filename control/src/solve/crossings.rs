//! Where controls reach or leave their bounds.

use crate::bvp::mesh::Span;
use crate::bvp::timed::Switch;
use crate::constants::arcs::{SAMPLES, SHORTEST, SLACK, UNDECIDED};
use crate::extremal::{BoundSide, ControlRange, Extremal, SideChange};
use crate::solve::Discretisation;

/// A control reaches or leaves a bound.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// When (s).
    pub time: f64,
    pub switch: Switch,
}

impl Discretisation {
    /// Where the controls of one arc reach or leave their bounds, in the order of time; not at the ends.
    pub fn crossings(&self, extremal: &mut dyn Extremal) -> Vec<Crossing> {
        let (z_len, m, count) = (2 * extremal.states(), self.equations.m, extremal.controls());
        let durations = self.durations(z_len);
        let mut found: Vec<Crossing> = Vec::new();
        if count == 0 {
            return found;
        }
        let mut sides = |w: &[f64], u: &mut [f64]| -> Vec<BoundSide> {
            extremal.unbounded_controls(&w[..z_len], u);
            let side = |(i, &u): (usize, &f64)| extremal.bounds(i).side_of(u);
            u.iter().enumerate().map(side).collect()
        };
        let (mut w, mut u) = (self.equations.current.nodes[..m].to_vec(), vec![0.0; count]);
        let mut before = sides(&w, &mut u);
        let mut now = 0.0;
        for (k, span) in self.equations.mesh.spans.iter().enumerate() {
            let Span::Interval { arc, length } = *span else { continue };
            let h = length * durations[arc];
            let mut in_interval = Vec::new();
            for sample in 1..=SAMPLES {
                let (from, to) = ((sample - 1) as f64 / SAMPLES as f64, sample as f64 / SAMPLES as f64);
                self.equations.polynomial(k, to, &mut w);
                let after = sides(&w, &mut u);
                for control in 0..count {
                    let change = SideChange::new(before[control], after[control]);
                    if change.before != change.after {
                        let side = change.before;
                        let c = self.bisect(k, from..to, &mut w, |w| sides(w, &mut u)[control] == side);
                        let switch = Switch { control, change };
                        in_interval.push(Crossing { time: now + c * h, switch });
                    }
                }
                before = after;
            }
            in_interval.sort_by(|a, b| a.time.total_cmp(&b.time));
            found.extend(in_interval);
            now += h;
        }
        // A control that touches its bound at an end may be beyond it by rounding.
        found.retain(|crossing| (SHORTEST * now..=(1.0 - SHORTEST) * now).contains(&crossing.time));
        found
    }

    /// Where in an interval `before` stops to hold.
    fn bisect(
        &self,
        span: usize,
        within: std::ops::Range<f64>,
        w: &mut [f64],
        mut before: impl FnMut(&[f64]) -> bool,
    ) -> f64 {
        let (mut from, mut to) = (within.start, within.end);
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

    /// Whether at all inner points the maximum of the Hamiltonian is on the side of the bounds that the arc
    /// assumes.
    pub fn agrees_with_arcs(&self, extremal: &mut dyn Extremal) -> bool {
        let (z_len, m) = (2 * extremal.states(), self.equations.m);
        let inner = self.equations.method.len() - 2;
        let (mut u, mut gradient) = (vec![0.0; extremal.controls()], vec![0.0; z_len]);
        let scale = &self.equations.scale;
        self.equations.mesh.spans.iter().enumerate().all(|(k, span)| {
            let Span::Interval { arc, .. } = *span else { return true };
            let Some(sides) = &self.arcs.sides[arc] else { return true };
            (k * inner..(k + 1) * inner).all(|point| {
                let w = &self.equations.current.inner[point * m..point * m + z_len];
                extremal.unbounded_controls(w, &mut u);
                u.iter().zip(sides).enumerate().all(|(control, (&u, &side))| {
                    let bounds @ ControlRange { low, high } = extremal.bounds(control);
                    let slack = SLACK * bounds.half_width();
                    let agrees = match side {
                        BoundSide::Low => u <= low + slack,
                        BoundSide::Inside => (low - slack..=high + slack).contains(&u),
                        BoundSide::High => u >= high - slack,
                    };
                    // A control without effort is infinite before it is clipped: the switching function
                    // decides.
                    agrees || {
                        let change = SideChange::new(BoundSide::Low, BoundSide::High);
                        let value = extremal.switching(control, change, w, &mut gradient);
                        let size: f64 =
                            gradient.iter().zip(scale).map(|(entry, scale)| (entry * scale).abs()).sum();
                        u.is_infinite() && value.abs() <= UNDECIDED * size
                    }
                })
            })
        })
    }

    /// The largest unclipped control relative to its bounds: distance from their middle in half distances
    /// between them, 1 at a bound. Controls without effort, which are infinite, do not count.
    pub fn excess(&self, extremal: &mut dyn Extremal) -> f64 {
        let (z_len, m) = (2 * extremal.states(), self.equations.m);
        let mut u = vec![0.0; extremal.controls()];
        let mut largest = 0.0_f64;
        for w in self.equations.current.nodes.chunks_exact(m) {
            extremal.unbounded_controls(&w[..z_len], &mut u);
            for (control, &u) in u.iter().enumerate() {
                if u.is_finite() {
                    largest = largest.max(extremal.bounds(control).factor(u));
                }
            }
        }
        largest
    }
}
