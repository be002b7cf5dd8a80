//! Where the direct method begins.

use super::shape::Shape;
use super::spline::{Mesh, Spline};
use crate::constants::direct::NEIGHBOUR;
use crate::cubics::{Cubics, Disturbance};
use crate::problem::Problem;
use crate::result::trajectory::Trajectory;
use crate::task::build::TaskRows;
use crate::task::reach::reach;
use std::borrow::Cow;

/// Cubics from start to end with a disturbance, or a saved motion, on equal intervals.
pub(super) fn guess(
    problem: &Problem,
    saved: Option<&Trajectory>,
    disturbance: &Disturbance,
    intervals: usize,
) -> Spline {
    let n = problem.robot.dof();
    let time = problem.time.value();
    let cubics = Cubics { problem, disturbance, goal: 1.0 };
    let duration = saved.and_then(|saved| Some(saved.t.last()? - saved.t.first()?)).filter(|&t| t > 0.0);
    // q and dq/ds at a place.
    let at = |s: f64, q: &mut [f64], rate: &mut [f64]| {
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
    let nodes = (0..=intervals).map(|k| k as f64 / intervals as f64).collect();
    // The second derivative is that of rates around the place: for a guess as good as the exact one.
    let step = NEIGHBOUR / intervals as f64;
    let (mut q, mut before, mut after) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let state = |s: f64, z: &mut [f64]| {
        let (left, right) = ((s - step).max(0.0), (s + step).min(1.0));
        at(left, &mut q, &mut before);
        at(right, &mut q, &mut after);
        let (position, rates) = z.split_at_mut(n);
        let (rate, curvature) = rates.split_at_mut(n);
        at(s, position, rate);
        for ((to, before), after) in curvature.iter_mut().zip(&before).zip(&after) {
            *to = (after - before) / (right - left);
        }
    };
    let mesh = Mesh::new(nodes, Shape::of(problem));
    let mut spline = Spline::through(n, mesh, duration.unwrap_or(time), state);
    if matches!(problem.time, crate::problem::FinalTime::Fixed(_)) {
        spline.time = time;
    }
    meet_ends(problem, &mut spline);
    spline
}

/// Puts the given positions, rates and accelerations of both ends into the unknowns.
fn meet_ends(problem: &Problem, spline: &mut Spline) {
    let (n, time) = (spline.dof, spline.time);
    let offsets = [0, 1].map(|end| spline.end_unknowns(end).start);
    for (end, offset) in [&problem.start, &problem.end].into_iter().zip(offsets) {
        for i in 0..n {
            if !end.q_free.contains(&i) {
                spline.unknowns[offset + i] = end.q[i];
            }
            if !end.v_free.contains(&i) {
                spline.unknowns[offset + n + i] = time * end.v[i];
            }
        }
        if let Some(a) = &end.a {
            for (i, a) in a.iter().enumerate() {
                spline.unknowns[offset + 2 * n + i] = time * time * a;
            }
        }
    }
}

/// The problem with positions at its ends at which tools are where they shall be. Later starts look for other
/// ones.
pub(super) fn with_tools_reached<'a>(
    problem: &'a Problem,
    rows: &TaskRows,
    number: usize,
) -> Cow<'a, Problem> {
    let mut found = Cow::Borrowed(problem);
    let limits: Vec<[f64; 2]> = problem.joint_limits().iter().map(|limits| limits.q).collect();
    for (end, rows) in [&rows.start, &rows.end].into_iter().enumerate() {
        if rows.is_empty() {
            continue;
        }
        let state = if end == 0 { &problem.start } else { &problem.end };
        let reached = reach(&mut rows.clone(), &state.q, &state.q_free, &limits, number);
        let problem = found.to_mut();
        (if end == 0 { &mut problem.start } else { &mut problem.end }).q = reached.q;
    }
    found
}
