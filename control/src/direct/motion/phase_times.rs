//! First guesses of what is free at vias.

use crate::constants::checks::phase_times::LEAST_SHARE;
use crate::problem::{BoundaryState, Problem};

/// Times of phases in proportion to these lengths, but for those that are given; after the last given time
/// they take what is left of `duration`. Phases whose parts of the duration are given take these.
pub(super) fn phase_times(problem: &Problem, lengths: &[f64], duration: f64) -> Vec<f64> {
    if let Some(parts) = problem.parts_of_time() {
        return parts.map(|part| part * duration).to_vec();
    }
    let given = problem.times_at_ends();
    let mut times = vec![0.0; lengths.len()];
    let (mut first, mut before) = (0, 0.0);
    for end in 1..given.len() {
        let is_last = end == lengths.len();
        let Some(time) = given[end].or(is_last.then_some(duration)) else { continue };
        let sum: f64 = lengths[first..end].iter().sum();
        for (to, length) in times[first..end].iter_mut().zip(&lengths[first..end]) {
            *to = (time - before) * length / sum;
        }
        (first, before) = (end, time);
    }
    times
}

/// How long the ways between the ends of phases are, each at least a small part of all.
pub(super) fn ways(ends: &[BoundaryState]) -> Vec<f64> {
    let way = |pair: &[BoundaryState]| {
        let squares = pair[0].q.iter().zip(&pair[1].q).map(|(from, to)| (to - from).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let ways: Vec<f64> = ends.windows(2).map(way).collect();
    let all: f64 = ways.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    ways.iter().map(|way| way + LEAST_SHARE * all).collect()
}

/// The ends of the phases with guesses of what is free at vias: positions in the middle between the places
/// beside them, rates of a path that does not swing.
pub(super) fn with_guesses(problem: &Problem) -> Vec<BoundaryState> {
    let mut ends = problem.ends();
    let last = ends.len() - 1;
    for (k, via) in problem.vias.iter().enumerate().map(|(number, via)| (number + 1, via)) {
        if via.q.is_some() {
            continue;
        }
        // The next place that is known.
        let next = (k + 1..=last).find(|&next| next == last || problem.vias[next - 1].q.is_some());
        let next = next.unwrap_or(last);
        let part = 1.0 / (next - k + 1) as f64;
        let (from, to) = (ends[k - 1].q.clone(), ends[next].q.clone());
        ends[k].q = from.iter().zip(&to).map(|(from, to)| from + part * (to - from)).collect();
    }
    ends
}

/// Fills in the free rates of vias, and those of both ends of a periodic motion, from the slopes beside them:
/// zero where these have different signs, else their harmonic mean.
pub(super) fn fill_rates(problem: &Problem, ends: &mut [BoundaryState], times: &[f64]) {
    let phases = times.len();
    let slope = |ends: &[BoundaryState], p: usize, i: usize| (ends[p + 1].q[i] - ends[p].q[i]) / times[p];
    for k in 0..=phases {
        let is_via = k > 0 && k < phases;
        if !is_via && problem.periodic.is_none() {
            continue;
        }
        for i in ends[k].v_free.clone() {
            let (before, after) = (slope(ends, (k + phases - 1) % phases, i), slope(ends, k % phases, i));
            let product = before * after;
            ends[k].v[i] = if product > 0.0 { 2.0 * product / (before + after) } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{FinalTime, Via};
    use costate::robot::Robot;

    fn problem(time: FinalTime) -> Problem {
        let robot = Robot::from_file("../robots/two_link.toml").unwrap();
        let via = |q: [f64; 2]| Via::at(&q);
        Problem::rest_to_rest(robot, &[0.0; 2], &[4.0, 0.0], 8.0)
            .with_time(time)
            .with_via(via([1.0, 0.0]))
            .with_via(via([2.0, 0.0]).with_time(2.0))
            .with_via(via([3.0, 1.0]))
    }

    #[test]
    fn given_times_are_kept_and_the_others_shared() {
        for time in [FinalTime::Fixed(8.0), FinalTime::Free { guess: 8.0 }] {
            let times = phase_times(&problem(time), &[1.0, 3.0, 2.0, 1.0], 8.0);
            assert_eq!(times, [0.5, 1.5, 4.0, 2.0]);
        }
    }

    #[test]
    fn rates_are_those_of_a_path_that_does_not_swing() {
        let problem = problem(FinalTime::Fixed(8.0));
        let mut ends = with_guesses(&problem);
        fill_rates(&problem, &mut ends, &[1.0, 1.0, 0.5, 1.0]);
        let rates: Vec<&[f64]> = ends.iter().map(|end| &end.v[..]).collect();
        let expected: [[f64; 2]; 5] = [[0.0; 2], [1.0, 0.0], [4.0 / 3.0, 0.0], [4.0 / 3.0, 0.0], [0.0; 2]];
        assert!(rates.iter().zip(expected).all(|(a, b)| (a[0] - b[0]).abs() < 1e-14 && a[1] == b[1]));
    }

    #[test]
    fn places_that_are_not_known_lie_between_the_others() {
        let mut problem = problem(FinalTime::Fixed(8.0));
        problem.vias[0].q = None;
        problem.vias[1].q = None;
        let ends = with_guesses(&problem);
        assert!((ends[1].q[0] - 1.0).abs() < 1e-14 && (ends[2].q[0] - 2.0).abs() < 1e-14);
        assert!((ends[2].q[1] - 2.0 / 3.0).abs() < 1e-14);
    }
}
