//! Arcs on which each control stays on its side of its bounds, with borders that move.

use crate::bvp::mesh::{Mesh, Span};
use crate::bvp::timed::{Arcs, Clock};
use crate::extremal::actuation::half_width;
use crate::extremal::{BoundSide, Extremal};
use crate::result::crossings::Crossing;
use crate::search::LOOSE;
use crate::solve::{Context, Extremum};
use crate::status::Status;

/// How often the arcs are read off again from a solution that contradicts them.
const ROUNDS: usize = 5;
/// Smallest damping: where arcs were read off right, the first steps are nearly whole.
const LEAST_DAMPING: f64 = 0.01;
/// Part of the cost by which a solution on arcs may differ from the rough one that they were read off from.
const FAR: f64 = 0.05;
/// Part of its size below which a switching function does not decide between two bounds.
const UNDECIDED: f64 = 1e-6;
/// Most arcs that are tried.
const MOST_ARCS: usize = 60;

/// Solves with the arcs that are read off from a rough solution, to full accuracy: on each arc the equations are smooth, and
/// durations are unknowns, one for each arc, with the condition that the control that changes sides there is just at its
/// bound. `None` where no control changes sides, or where the solution contradicts its arcs.
pub(crate) fn solve_arcs<E: Extremal>(
    rough: &Extremum,
    extremal: &mut E,
    tolerance: f64,
    context: &mut Context<'_>,
) -> Option<Extremum> {
    let mut crossings = rough.crossings(extremal);
    let mut last: Option<Extremum> = None;
    let phase = std::mem::replace(&mut context.phase, "switches");
    let damping = std::mem::replace(&mut context.damping, LEAST_DAMPING);
    let mut found = None;
    for _ in 0..ROUNDS {
        let from = last.as_ref().unwrap_or(rough);
        if crossings.is_empty() || crossings.len() >= MOST_ARCS {
            break;
        }
        let arcs = from.on_arcs(extremal, &crossings, context);
        let solved = arcs.solve(extremal, LOOSE.max(tolerance), context);
        if !solved.status.is_converged() || solved.is_far_from(rough, extremal) {
            break;
        }
        let durations = solved.durations(2 * extremal.states());
        if durations.iter().any(|&duration| duration < 0.0) {
            // A control that changes sides and back in no time does not change sides at all.
            let before = crossings.len();
            crossings = without_backward(&crossings, &durations);
            if crossings.len() == before {
                break;
            }
            continue;
        }
        if solved.agrees_with_arcs(extremal) {
            let solved = solved.solve(extremal, tolerance, context);
            found = (solved.status.is_converged() && solved.agrees_with_arcs(extremal)).then_some(solved);
            break;
        }
        crossings = solved.crossings(extremal);
        last = Some(solved);
    }
    (context.phase, context.damping) = (phase, damping);
    found
}

/// Crossings without the pairs of one control around an arc of negative duration.
fn without_backward(crossings: &[Crossing], durations: &[f64]) -> Vec<Crossing> {
    let mut kept: Vec<Option<Crossing>> = crossings.iter().copied().map(Some).collect();
    for (arc, &duration) in durations.iter().enumerate() {
        if duration < 0.0 && arc > 0 && arc < crossings.len() {
            let (before, after) = (crossings[arc - 1], crossings[arc]);
            if before.control == after.control {
                kept[arc - 1] = None;
                kept[arc] = if before.sides.0 == after.sides.1 {
                    None
                } else {
                    Some(Crossing { sides: (before.sides.0, after.sides.1), ..after })
                };
            } else {
                // Two controls: the other order.
                kept[arc - 1] = Some(Crossing { time: before.time, ..after });
                kept[arc] = Some(Crossing { time: after.time, ..before });
            }
        }
    }
    kept.into_iter().flatten().collect()
}

impl Extremum {
    /// Equations on the arcs between crossings, with the values of this solution; not yet solved.
    fn on_arcs<E: Extremal>(&self, extremal: &mut E, crossings: &[Crossing], context: &Context<'_>) -> Self {
        let z_len = 2 * extremal.states();
        let final_time = self.final_time(extremal);
        let mut at = vec![BoundSide::Inside; extremal.controls()];
        // The first crossing of a control says where it was before; one without any stays where it is.
        let mut u = vec![0.0; at.len()];
        extremal.unbounded_controls(&self.equations.current.nodes[..z_len], &mut u);
        for (control, side) in at.iter_mut().enumerate() {
            let first = crossings.iter().find(|crossing| crossing.control == control);
            *side =
                first.map_or_else(|| side_of(u[control], extremal.bounds(control)), |first| first.sides.0);
        }
        let mut arcs = Arcs { sides: vec![Some(at.clone())], switches: Vec::new() };
        let mut starts = vec![0.0];
        for crossing in crossings {
            at[crossing.control] = crossing.sides.1;
            arcs.sides.push(Some(at.clone()));
            arcs.switches.push((crossing.control, crossing.sides));
            starts.push(crossing.time);
        }
        starts.push(final_time);
        let durations: Vec<f64> = starts.windows(2).map(|pair| (pair[1] - pair[0]).max(0.0)).collect();
        let share = (context.options.nodes - 1) as f64 / final_time;
        let counts: Vec<usize> =
            durations.iter().map(|duration| ((share * duration).round() as usize).max(4)).collect();
        let clock = match self.clock {
            Clock::Fixed(time) | Clock::Split(time) => Clock::Split(time),
            Clock::Free => Clock::Free,
        };
        let own = self.durations(z_len);
        let mut old = vec![0.0; self.equations.m];
        let (mesh, points) = (Mesh::uniform(&counts), self.equations.method.len());
        Self::guess(extremal, (clock, arcs), mesh, points, |arc, s, w| {
            let t = starts[arc] + s * durations[arc];
            self.sample_time(&own, t, &mut old);
            w[..z_len].copy_from_slice(&old[..z_len]);
            w[z_len] = durations[arc];
            if let Some(time) = w.get_mut(z_len + 1) {
                *time = t;
            }
        })
    }

    /// w at a time, given the durations of the arcs.
    fn sample_time(&self, durations: &[f64], t: f64, w: &mut [f64]) {
        let mut start = 0.0;
        for (arc, &duration) in durations.iter().enumerate() {
            if t <= start + duration || arc + 1 == durations.len() {
                let s = if duration > 0.0 { ((t - start) / duration).clamp(0.0, 1.0) } else { 0.0 };
                self.equations.sample(arc, s, w);
                return;
            }
            start += duration;
        }
    }

    /// Whether at all inner points the maximum of the Hamiltonian is on the side that the arc says.
    pub(crate) fn agrees_with_arcs<E: Extremal>(&self, extremal: &mut E) -> bool {
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
                    let (low, high) = extremal.bounds(control);
                    let slack = 2e-7 * half_width((low, high));
                    let agrees = match side {
                        BoundSide::Low => u <= low + slack,
                        BoundSide::Inside => (low - slack..=high + slack).contains(&u),
                        BoundSide::High => u >= high - slack,
                    };
                    // A control that costs nothing has no size before it is cut: what decides has.
                    agrees || {
                        let value =
                            extremal.switching(control, (BoundSide::Low, BoundSide::High), w, &mut gradient);
                        let size: f64 =
                            gradient.iter().zip(scale).map(|(entry, scale)| (entry * scale).abs()).sum();
                        u.is_infinite() && value.abs() <= UNDECIDED * size
                    }
                })
            })
        })
    }

    /// How far a free control is beyond its bounds at most, in parts of their half width; 1 at a bound, less between them.
    pub(crate) fn excess<E: Extremal>(&self, extremal: &mut E) -> f64 {
        let (z_len, m) = (2 * extremal.states(), self.equations.m);
        let mut u = vec![0.0; extremal.controls()];
        let mut largest = 0.0_f64;
        for w in self.equations.current.nodes.chunks_exact(m) {
            extremal.unbounded_controls(&w[..z_len], &mut u);
            for (control, &u) in u.iter().enumerate() {
                let (low, high) = extremal.bounds(control);
                if u.is_finite() {
                    largest = largest.max(1.0 + (low - u).max(u - high) / half_width((low, high)));
                }
            }
        }
        largest
    }

    /// Whether the cost is so much higher than that of a rough solution that the arcs are those of another motion.
    fn is_far_from<E: Extremal>(&self, rough: &Self, extremal: &mut E) -> bool {
        let (cost, near) = (self.costs(extremal).0, rough.costs(extremal).0);
        (cost - near).abs() > FAR * near.abs()
    }

    /// The same with a status.
    pub(crate) fn with_status(self, status: Status) -> Self {
        Self { status, ..self }
    }
}

/// Where a free control is.
pub(crate) fn side_of(u: f64, (low, high): (f64, f64)) -> BoundSide {
    if u <= low {
        BoundSide::Low
    } else if u >= high {
        BoundSide::High
    } else {
        BoundSide::Inside
    }
}
