//! The cost of references across their knots.
//!
//! `int w/2 |g(q(t)) - r(t)|^2 dt` on an interval of the mesh. Between its knots a reference is smooth, and
//! so is the motion; at a knot only the reference bends. Where no knot is inside of an interval, the points
//! of the interval integrate this cost with all the rest. Otherwise Gauss's rule with three points integrates
//! it on each panel between two knots, so the error on a panel of length p falls with `p^6` as that of an
//! interval does, and no knot is missed, however many there are and however short the event between two of
//! them. The value, its gradient and its Hessian are those of the same sum, so Newton's method is exact.
//! Times of knots are those of the clock: with a free final time they move through the mesh, and the rule
//! with them.

use crate::direct::motion::shape::{PLACES, POINTS, WEIGHTS};
use crate::direct::motion::spline::Spline;
use crate::task::references::References;

/// Places and weights of the rule on a panel.
pub(crate) const GAUSS: [[f64; 2]; POINTS] =
    [[PLACES[0], WEIGHTS[0]], [PLACES[1], WEIGHTS[1]], [PLACES[2], WEIGHTS[2]]];

/// Panels shorter than this part of their interval belong to the one before them.
const SHORTEST: f64 = 1e-9;

/// Which intervals have knots inside.
#[derive(Clone, Debug, Default)]
pub(crate) struct Panels {
    pub(super) split: Vec<bool>,
    /// q, v, a at a place.
    pub(super) z: Vec<f64>,
}

impl Panels {
    /// For n joints.
    pub fn new(n: usize) -> Self {
        Self { split: Vec::new(), z: vec![0.0; 3 * n] }
    }

    /// Whether a knot is inside of an interval.
    pub fn is_split(&self, k: usize) -> bool {
        self.split.get(k).is_some_and(|split| *split)
    }

    /// The weight of a point in the integral of references over s: without intervals that have panels.
    pub fn weight(&self, spline: &Spline, p: usize) -> f64 {
        let (mesh, shape) = (&spline.mesh, spline.mesh.shape);
        let (k, j) = mesh.interval_of(p);
        let own = if self.is_split(k) { 0.0 } else { shape.weights()[j] * mesh.width(k) };
        // A point that two intervals share.
        let shared = shape.is_smooth() && j == 0 && !mesh.is_end(k) && !self.is_split(k - 1);
        own + if shared { shape.weights()[shape.stride()] * mesh.width(k - 1) } else { 0.0 }
    }
}

/// The end of the panel of interval `k` that begins at the part `from` of it: the next knot, or 1; `None`
/// where that is the end of the interval.
pub(crate) fn next_panel(references: &References, spline: &Spline, k: usize, from: f64) -> Option<f64> {
    if from >= 1.0 {
        return None;
    }
    let (left, length) = (spline.time_at(spline.mesh.nodes[k]), spline.length(k));
    let mut time = left + (from + SHORTEST) * length;
    loop {
        let knot = references.next_knot(time);
        let to = (knot - left) / length;
        // Rounding of times may find the knot before once more.
        let is_before = to <= from + SHORTEST && knot < f64::INFINITY;
        if !is_before {
            // So times and lengths that are not numbers end the interval.
            return Some(if to < 1.0 - SHORTEST { to } else { 1.0 });
        }
        let known = knot.max(time);
        // The part of a short interval may be less than the spacing of numbers at this time.
        time = (known + SHORTEST * length).max(known.next_up());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direct::solve::prepare::interior;
    use crate::options::SolverOptions;
    use crate::problem::{JointReference, Problem, Task};
    use crate::task::build::TaskRows;
    use costate::robot::Robot;

    /// Panels go on to the end of each interval, of motions whose times are no numbers, or zero, too; those
    /// have no knots inside.
    #[test]
    fn panels_end_whatever_the_times_are() {
        let robot = Robot::from_file("../robots/pendulum.toml").unwrap();
        let knots = vec![0.0, 0.31, 0.72, 1.0];
        let positions = knots.iter().map(|time| vec![*time]).collect();
        let reference = JointReference::new(knots, positions, vec![1.0]);
        let problem = Problem::rest_to_rest(robot, &[0.0], &[1.0], 1.0)
            .with_task(Task::default().with_reference(reference));
        let rows = TaskRows::new(&problem).unwrap();
        let mut spline = interior(&problem, &rows, &SolverOptions::default(), 0, None).spline;
        let references = References::new(&problem.task.references, rows.references.clone(), 1);
        let count = |spline: &Spline| {
            let mut count = 0;
            for k in 0..spline.mesh.intervals() {
                let mut from = 0.0;
                while let Some(to) = next_panel(&references, spline, k, from) {
                    assert!(to > from && to <= 1.0, "{from} {to}");
                    (from, count) = (to, count + 1);
                }
            }
            count
        };
        let intervals = spline.mesh.intervals();
        spline.times[0] = 1.1;
        assert_eq!(count(&spline), intervals + 3);
        for time in [f64::NAN, 0.0] {
            spline.times[0] = time;
            assert_eq!(count(&spline), intervals, "{time}");
        }
    }
}
