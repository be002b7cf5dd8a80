//! What a report is about: a problem, its solution, and the motion at many times.

use crate::options::ReportOptions;
use costate::robot::Robot;
use costate_control::{MotionRates, Problem, Samples, Solution, TrajectoryPoint};

/// Least number of equal steps of the times at which quantities are drawn.
const STEPS: usize = 400;

/// Most nodes that are times of their own.
const MOST_NODES: usize = 3000;

/// How long before a jump its left side is drawn, in parts of the whole time.
const BEFORE: f64 = 1e-9;

/// The contents of a report.
pub struct Motion<'a> {
    pub problem: &'a Problem,
    pub solution: &'a Solution,
    pub options: &'a ReportOptions,
    /// The motion at its nodes and at equal steps, and on both sides of each jump.
    pub samples: Samples,
    /// All else at these times; empty without a motion.
    pub points: Vec<TrajectoryPoint>,
    /// Jerks and rates of torques, of motions of the direct method.
    pub rates: Option<MotionRates>,
}

impl<'a> Motion<'a> {
    pub fn new(problem: &'a Problem, solution: &'a Solution, options: &'a ReportOptions) -> Self {
        let times = times(solution);
        let point = |&t: &f64| solution.trajectory.at(t);
        let points: Vec<TrajectoryPoint> = times.iter().filter_map(point).collect();
        let samples = solution.sample_at(problem, &times).unwrap_or_else(|_| without_dynamics(&points));
        let rates = solution.rates_at(problem, &times).ok().flatten();
        Self { problem, solution, options, samples, points, rates }
    }

    pub fn robot(&self) -> &'a Robot {
        &self.problem.robot
    }

    /// Whether there is something to move.
    pub fn exists(&self) -> bool {
        self.points.len() > 1
    }
}

/// What can be said of a motion whose dynamics cannot be evaluated.
fn without_dynamics(points: &[TrajectoryPoint]) -> Samples {
    let mut samples = Samples::default();
    samples.t = points.iter().map(|point| point.t).collect();
    samples.q = points.iter().map(|point| point.q.clone()).collect();
    samples.v = points.iter().map(|point| point.v.clone()).collect();
    samples.u = points.iter().map(|point| point.u.clone()).collect();
    samples
}

/// The times at which a motion is drawn.
fn times(solution: &Solution) -> Vec<f64> {
    let nodes = &solution.trajectory.t;
    let (Some(&first), Some(&last)) = (nodes.first(), nodes.last()) else { return Vec::new() };
    if !(last > first && nodes.len() > 1) {
        return Vec::new();
    }
    let whole = last - first;
    let mut times: Vec<f64> = (0..=STEPS).map(|k| first + whole * k as f64 / STEPS as f64).collect();
    if nodes.len() <= MOST_NODES {
        times.extend(nodes);
    }
    // Two nodes at one time: something may jump there.
    let jumps = nodes.windows(2).filter(|pair| pair[0] == pair[1] && pair[0] > first);
    let jumps: Vec<f64> = jumps.map(|pair| pair[0]).take(MOST_NODES).collect();
    times.extend(jumps.iter().map(|t| t - BEFORE * whole));
    times.extend(&jumps);
    times.push(last);
    times.iter_mut().for_each(|t| *t = t.clamp(first, last));
    times.sort_by(f64::total_cmp);
    // The step before a jump is the shortest that is kept.
    times.dedup_by(|next, before| *next - *before < 0.5 * BEFORE * whole);
    times
}
