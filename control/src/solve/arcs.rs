//! Arcs on which the set of active bounds does not change, with unknown switching times.
//!
//! On each arc k the equations are smooth. Its duration `theta_k` is one more unknown, in the scaled time `s`
//! from 0 to 1, and the switching function of the control that changes sides is one more condition at its
//! end:
//!
//! $$ \frac{dz}{ds} = \theta_k \thinspace g_k(z), \qquad \sigma_k(z(t_k)) = 0, \qquad \sum_k \theta_k = T $$
//!
//! `sigma = r u_bound - b y_p` for a control with effort `r`, and `sigma = b y_p` for one without. State and
//! costates are continuous. Source: A. E. Bryson, Y.-C. Ho, *Applied Optimal Control*, Taylor & Francis 1975,
//! sections 3.8 to 3.11 (switching conditions); the multipoint form follows H. J. Oberle, W. Grimm, *BNDSCO*,
//! DLR 1989.

use crate::bvp::mesh::Mesh;
use crate::bvp::timed::{Arcs, Clock, Switch};
use crate::constants::arcs::{FAR, LEAST_DAMPING, LEAST_INTERVALS, MOST_ARCS, ROUNDS};
use crate::extremal::{BoundSide, Extremal, SideChange};
use crate::progress::Phase;
use crate::solve::crossings::Crossing;
use crate::solve::{Attempt, Discretisation, Layout, Recorder, Solved};

/// Solves with the arcs that a rough solution shows, to the tolerance of the attempt. `None` where no control
/// changes sides, or where the solution contradicts its arcs.
pub(crate) fn solve_arcs(
    rough: &Discretisation,
    extremal: &mut dyn Extremal,
    attempt: &Attempt,
    recorder: &mut Recorder<'_>,
) -> Option<Solved> {
    let crossings = rough.crossings(extremal);
    solve_given_arcs(rough, crossings, extremal, attempt, recorder)
}

/// The same with the arcs between these crossings first.
pub(crate) fn solve_given_arcs(
    rough: &Discretisation,
    mut crossings: Vec<Crossing>,
    extremal: &mut dyn Extremal,
    attempt: &Attempt,
    recorder: &mut Recorder<'_>,
) -> Option<Solved> {
    let attempt = Attempt { least_damping: LEAST_DAMPING, ..attempt.in_phase(Phase::Switches) };
    let mut last: Option<Discretisation> = None;
    for _ in 0..ROUNDS {
        let from = last.as_ref().unwrap_or(rough);
        if crossings.is_empty() || crossings.len() >= MOST_ARCS {
            return None;
        }
        let arcs = from.on_arcs(extremal, &crossings, &attempt);
        let solved = arcs.solve(extremal, &attempt.loose(), recorder);
        if !solved.is_converged() || solved.found.is_far_from(rough, extremal) {
            return None;
        }
        let solved = solved.found;
        let durations = solved.durations(2 * extremal.states());
        if durations.iter().any(|&duration| duration < 0.0) {
            // A control that changes sides and back in no time does not change sides at all.
            let before = crossings.len();
            crossings = without_backward(&crossings, &durations);
            if crossings.len() == before {
                return None;
            }
            continue;
        }
        if solved.agrees_with_arcs(extremal) {
            let sharp = solved.solve(extremal, &attempt, recorder);
            return (sharp.is_converged() && sharp.found.agrees_with_arcs(extremal)).then_some(sharp);
        }
        crossings = solved.crossings(extremal);
        last = Some(solved);
    }
    None
}

/// Crossings without the pairs of one control around an arc of negative duration.
fn without_backward(crossings: &[Crossing], durations: &[f64]) -> Vec<Crossing> {
    let mut kept: Vec<Option<Crossing>> = crossings.iter().copied().map(Some).collect();
    for (arc, &duration) in durations.iter().enumerate() {
        if duration < 0.0 && arc > 0 && arc < crossings.len() {
            let (before, after) = (crossings[arc - 1], crossings[arc]);
            if before.switch.control == after.switch.control {
                let change = SideChange::new(before.switch.change.before, after.switch.change.after);
                let switch = Switch { change, ..after.switch };
                kept[arc - 1] = None;
                kept[arc] = (change.before != change.after).then_some(Crossing { switch, ..after });
            } else {
                // Two controls: the other order.
                kept[arc - 1] = Some(Crossing { time: before.time, ..after });
                kept[arc] = Some(Crossing { time: after.time, ..before });
            }
        }
    }
    kept.into_iter().flatten().collect()
}

impl Discretisation {
    /// Equations on the arcs between crossings, with the values of this motion.
    fn on_arcs(&self, extremal: &mut dyn Extremal, crossings: &[Crossing], attempt: &Attempt) -> Self {
        let z_len = 2 * extremal.states();
        let final_time = self.final_time(extremal);
        let arcs = self.arcs_between(extremal, crossings);
        let mut starts = vec![0.0];
        starts.extend(crossings.iter().map(|crossing| crossing.time));
        starts.push(final_time);
        let durations: Vec<f64> = starts.windows(2).map(|pair| (pair[1] - pair[0]).max(0.0)).collect();
        let share = (attempt.nodes - 1) as f64 / final_time;
        let intervals = |duration: &f64| ((share * duration).round() as usize).max(LEAST_INTERVALS);
        let counts: Vec<usize> = durations.iter().map(intervals).collect();
        let clock = match self.clock {
            Clock::Fixed(time) | Clock::Split(time) => Clock::Split(time),
            Clock::Free => Clock::Free,
        };
        let own = self.durations(z_len);
        let mut old = vec![0.0; self.equations.m];
        let layout =
            Layout { clock, arcs, mesh: Mesh::uniform(&counts), points: self.equations.method.len() };
        Self::new(extremal, layout, |arc, s, w| {
            let t = starts[arc] + s * durations[arc];
            self.sample_time(&own, t, &mut old);
            w[..z_len].copy_from_slice(&old[..z_len]);
            w[z_len] = durations[arc];
            if let Some(time) = w.get_mut(z_len + 1) {
                *time = t;
            }
        })
    }

    /// The sides of the controls between crossings. The first crossing of a control says where it was before;
    /// one without any stays where it is.
    fn arcs_between(&self, extremal: &mut dyn Extremal, crossings: &[Crossing]) -> Arcs {
        let mut u = vec![0.0; extremal.controls()];
        extremal.unbounded_controls(&self.equations.current.nodes[..2 * extremal.states()], &mut u);
        let first = |(control, &u): (usize, &f64)| {
            let first = crossings.iter().find(|crossing| crossing.switch.control == control);
            first.map_or_else(|| extremal.bounds(control).side_of(u), |first| first.switch.change.before)
        };
        let mut at: Vec<BoundSide> = u.iter().enumerate().map(first).collect();
        let mut arcs = Arcs { sides: vec![Some(at.clone())], switches: Vec::new() };
        for Crossing { switch, .. } in crossings {
            at[switch.control] = switch.change.after;
            arcs.sides.push(Some(at.clone()));
            arcs.switches.push(*switch);
        }
        arcs
    }

    /// Whether the cost differs so much from that of a rough solution that the arcs are those of another
    /// motion.
    fn is_far_from(&self, rough: &Self, extremal: &mut dyn Extremal) -> bool {
        let (cost, near) = (self.costs(extremal).0, rough.costs(extremal).0);
        (cost - near).abs() > FAR * near.abs()
    }
}
