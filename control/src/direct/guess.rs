//! Where the direct method begins.

use super::spline::Spline;
use crate::path::cubics::{Cubics, Disturbance};
use crate::problem::Problem;
use crate::result::trajectory::Trajectory;

/// Distance in s over which accelerations of a guess are taken from its rates.
const STEP: f64 = 1e-4;

/// Cubics from start to end with a disturbance, on equal intervals; or a saved motion on its own times.
pub(super) fn guess(
    problem: &Problem,
    saved: Option<&Trajectory>,
    disturbance: &Disturbance,
    intervals: usize,
) -> Spline {
    let n = problem.robot.dof();
    let time = problem.time.value();
    let cubics = Cubics { problem, disturbance, goal: 1.0 };
    let mut unknowns = vec![0.0; 3 * n * (intervals + 1)];
    let nodes: Vec<f64> = (0..=intervals).map(|k| k as f64 / intervals as f64).collect();
    let duration = saved.and_then(|saved| Some(saved.t.last()? - saved.t.first()?)).filter(|&t| t > 0.0);
    // q and dq/ds at a place.
    let state = |s: f64, q: &mut [f64], rate: &mut [f64]| {
        let found = saved.zip(duration).and_then(|(saved, duration)| {
            Some((saved.at((saved.t[0] + s * duration).min(*saved.t.last()?))?, duration))
        });
        match found {
            Some((point, duration)) => {
                q.copy_from_slice(&point.q);
                rate.iter_mut().zip(&point.v).for_each(|(rate, v)| *rate = duration * v);
            }
            None => {
                for (i, (q, rate)) in q.iter_mut().zip(rate).enumerate() {
                    let at = cubics.at(i, s);
                    (*q, *rate) = (at.q, time * at.v);
                }
            }
        }
    };
    let (mut unused, mut before, mut after) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    for (&s, block) in nodes.iter().zip(unknowns.chunks_exact_mut(3 * n)) {
        let (q, rest) = block.split_at_mut(n);
        let (rate, second) = rest.split_at_mut(n);
        state(s, q, rate);
        let (left, right) = ((s - STEP).max(0.0), (s + STEP).min(1.0));
        state(left, &mut unused, &mut before);
        state(right, &mut unused, &mut after);
        for (second, (after, before)) in second.iter_mut().zip(after.iter().zip(&before)) {
            *second = (after - before) / (right - left);
        }
    }
    let mut spline = Spline { dof: n, nodes, unknowns, time: duration.unwrap_or(time) };
    if matches!(problem.time, crate::problem::FinalTime::Fixed(_)) {
        spline.time = time;
    }
    meet_ends(problem, &mut spline);
    spline
}

/// Puts the given positions and rates of both ends into the unknowns.
fn meet_ends(problem: &Problem, spline: &mut Spline) {
    let (n, time, last) = (spline.dof, spline.time, 3 * spline.dof * spline.intervals());
    for (end, offset) in [(&problem.start, 0), (&problem.end, last)] {
        for i in 0..n {
            if !end.q_free.contains(&i) {
                spline.unknowns[offset + i] = end.q[i];
            }
            if !end.v_free.contains(&i) {
                spline.unknowns[offset + n + i] = time * end.v[i];
            }
        }
    }
}
