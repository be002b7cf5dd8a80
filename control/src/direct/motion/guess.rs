//! Where the direct method begins.

use super::closing::{Closing, Stepping};
use super::mesh::Mesh;
use super::phase_times::{fill_rates, phase_times, ways, with_guesses};
use super::shape::Shape;
use super::spline::Spline;
use crate::constants::direct::NEIGHBOUR;
use crate::cubics::{Cubics, Disturbance};
use crate::problem::{FinalTime, Problem};
use crate::result::trajectory::Trajectory;

/// Cubics from end to end of the phases with a disturbance, or a saved motion, on these nodes.
pub(crate) fn guess(
    problem: &Problem,
    saved: Option<&Trajectory>,
    disturbance: &Disturbance,
    nodes: Vec<f64>,
) -> Spline {
    let n = problem.coordinates();
    let duration = saved.and_then(|saved| Some(saved.t.last()? - saved.t.first()?)).filter(|&t| t > 0.0);
    let saved = saved.zip(duration);
    let mut ends = with_guesses(problem);
    let lengths =
        saved.and_then(|(saved, _)| saved.phase_times()).filter(|all| all.len() == problem.phases());
    let times = match (lengths, problem.time) {
        (lengths, FinalTime::Free { guess }) => {
            phase_times(problem, &lengths.unwrap_or_else(|| ways(&ends)), duration.unwrap_or(guess))
        }
        (lengths, FinalTime::Fixed(time)) => {
            phase_times(problem, &lengths.unwrap_or_else(|| ways(&ends)), time)
        }
    };
    fill_rates(problem, &mut ends, &times);
    let phases: Vec<Problem> = ends
        .windows(2)
        .zip(&times)
        .map(|(ends, &time)| Problem {
            start: ends[0].clone(),
            end: ends[1].clone(),
            time: FinalTime::Fixed(time),
            ..problem.clone()
        })
        .collect();
    let sum: f64 = times.iter().sum();
    let began: Vec<f64> = (0..times.len()).map(|phase| times[..phase].iter().sum()).collect();
    // q and dq/ds at a place of a phase.
    let time_of = |saved: &Trajectory, duration: f64, phase: usize, part: f64| {
        let since = (began[phase] + part * times[phase]) / sum * duration;
        Some((saved.t[0] + since).min(*saved.t.last()?))
    };
    let mut closing = problem.loops.as_ref().map(|loops| Closing::new(loops));
    let stepping = problem.loops.as_ref().and_then(|loops| Stepping::new(loops, times.clone()));
    // From the start to the end of a step.
    let step = stepping.as_ref().map(|_| Problem {
        start: ends[0].clone(),
        end: ends[ends.len() - 1].clone(),
        time: FinalTime::Fixed(sum),
        ..problem.clone()
    });
    let mut at = |phase: usize, s: f64, q: &mut [f64], rate: &mut [f64]| {
        let (part, time) = (s - phase as f64, times[phase]);
        let found = saved.and_then(|(saved, duration)| {
            Some((saved.at(time_of(saved, duration, phase, part)?)?, duration / sum))
        });
        match found {
            Some((point, stretch)) => {
                q.copy_from_slice(&point.q);
                rate.iter_mut().zip(&point.v).for_each(|(rate, v)| *rate = stretch * time * v);
            }
            None => {
                if let (Some(stepping), Some(step)) = (&stepping, &step) {
                    let cubics = Cubics { problem: step, disturbance, goal: 1.0 };
                    let near = |part: f64, q: &mut [f64]| {
                        q.iter_mut().enumerate().for_each(|(i, q)| *q = cubics.at(i, part).q);
                    };
                    stepping.guess(phase, part, near, q, rate);
                    return;
                }
                let cubics = Cubics { problem: &phases[phase], disturbance, goal: 1.0 };
                for (i, (q, rate)) in q.iter_mut().zip(&mut *rate).enumerate() {
                    let at = cubics.at(i, part);
                    (*q, *rate) = (at.q, time * at.v);
                }
                if let Some(closing) = &mut closing {
                    closing.close(q, rate);
                }
            }
        }
    };
    // Continuous accelerations of a saved motion are those of the guess.
    let curved = saved.filter(|(saved, _)| saved.has_continuous_accelerations());
    let acceleration = |phase: usize, s: f64, curvature: &mut [f64]| {
        let (saved, duration) = curved?;
        let a = saved.acceleration(time_of(saved, duration, phase, s - phase as f64)?)?;
        let stretch = (duration / sum * times[phase]).powi(2);
        curvature.iter_mut().zip(a).for_each(|(to, a)| *to = stretch * a);
        Some(())
    };
    // Otherwise the second derivative is that of rates around the place: for a guess as good as the exact
    // one.
    let narrowest = nodes.windows(2).map(|ends| ends[1] - ends[0]).fold(1.0, f64::min);
    let step = NEIGHBOUR * narrowest;
    let (mut q, mut before, mut after) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let state = |phase: usize, s: f64, z: &mut [f64]| {
        let (left, right) = ((s - step).max(phase as f64), (s + step).min(phase as f64 + 1.0));
        at(phase, left, &mut q, &mut before);
        at(phase, right, &mut q, &mut after);
        let (position, rates) = z.split_at_mut(n);
        let (rate, curvature) = rates.split_at_mut(n);
        at(phase, s, position, rate);
        if acceleration(phase, s, curvature).is_some() {
            return;
        }
        for ((to, before), after) in curvature.iter_mut().zip(&before).zip(&after) {
            *to = (after - before) / (right - left);
        }
    };
    let mesh = Mesh::new(nodes, Shape::of(problem));
    let mut spline = Spline::through(n, mesh, times.clone(), state);
    meet_ends(problem, &mut spline);
    spline
}

/// Puts what is given at the ends of phases into the unknowns; the end of a periodic motion follows its
/// start.
fn meet_ends(problem: &Problem, spline: &mut Spline) {
    let n = spline.dof;
    for (number, end) in problem.ends().iter().enumerate() {
        let place = spline.end_unknowns(number);
        let unknowns = &mut spline.unknowns[place];
        for i in 0..n {
            if !end.q_free.contains(&i) {
                unknowns[i] = end.q[i];
            }
            if !end.v_free.contains(&i) {
                unknowns[n + i] = end.v[i];
            }
        }
        if let Some(a) = &end.a {
            unknowns[2 * n..].iter_mut().zip(a).for_each(|(to, a)| *to = *a);
        }
    }
    let (start, end) = (spline.end_unknowns(0), spline.end_unknowns(spline.mesh.phases()));
    if let Some(walk) = problem.loops.as_ref().and_then(|loops| loops.walk.as_ref()) {
        let joints = walk.shift.len();
        let last = walk.mirrored_back(&spline.unknowns[start][..joints]);
        spline.unknowns[end][..joints].copy_from_slice(&last);
        return;
    }
    let Some(shift) = &problem.periodic else { return };
    for (k, (from, to)) in start.zip(end).enumerate() {
        spline.unknowns[to] = spline.unknowns[from] + shift.get(k).copied().unwrap_or(0.0);
    }
}
