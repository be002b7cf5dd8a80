//! A motion of a model in its states.

use super::independent::StateVerification;
use super::points::{POINTS, Radau};
use crate::numerics::lagrange;
use crate::result::motion::Certificate;
use crate::status::Status;

/// A motion that [`DirectDynamics::solve`](crate::DirectDynamics::solve) found.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct StateMotion {
    /// How the solve ended.
    pub status: Status,
    /// J.
    pub cost: f64,
    /// T (s).
    pub final_time: f64,
    /// Times of the nodes and points (s), from 0 to T: three an interval.
    pub t: Vec<f64>,
    /// x at these times.
    pub x: Vec<Vec<f64>>,
    /// u at these times; that at 0 belongs to the first interval, that at a node to the interval before it.
    pub u: Vec<Vec<f64>>,
    /// y at these times, with $H = y^\top f - l$; that of the start is extrapolated.
    pub y: Vec<Vec<f64>>,
    /// $H^\ast$ at these times without the weight of time: constant, and equal to $c_t$ where T is free.
    pub hamiltonian: Vec<f64>,
    /// Largest residual of the equations of collocation at a point, in the units of x: what $x'$ differs from
    /// f by, times the width of the interval.
    pub defect: f64,
    /// Start of the interval where that is (s).
    pub defect_time: f64,
    /// Largest distance from a fixed component of the end, or of a linear function that is given there, in
    /// its unit; 0 where the end is met.
    pub end_missed: f64,
    /// This component, an index in x; of a function the one with the largest factor. None where the end is
    /// met to rounding.
    pub missed_component: Option<usize>,
    /// Largest estimated error of x over an interval, relative to the largest value of the component.
    pub error: f64,
    /// Largest excess of a limit of x halfway between neighbouring points, where the cubics are looked at;
    /// relative to the largest value of the component. At the points, and those of u, limits are kept.
    pub largest_violation: f64,
    /// Difference of J to that of the mesh before, relative as [`solve`](crate::DirectDynamics::solve) says;
    /// infinite if there was none. Of a motion that converged, that has twice the widths.
    pub cost_change: f64,
    /// What the end is missed by when u is integrated independently, or where that is less the sum of what 20
    /// parts of the motion miss, each integrated from its own start; relative to the largest value of the
    /// component. Infinite if the integration stops, or the time limit is reached.
    pub end_error: f64,
    /// What was found between the points of the solver.
    pub verified: StateVerification,
    /// What is known of second order.
    pub certificate: Certificate,
    /// Error of the conditions of first order on the last mesh: of stationarity and complementarity, in parts
    /// of the multipliers and of the size of the cost along the guess, and sum of the defects.
    pub residual: f64,
    /// Newton steps on all meshes.
    pub steps: Vec<StateStep>,
    /// Intervals of the last mesh.
    pub intervals: usize,
    pub(super) u_limits: [Vec<f64>; 2],
}

/// A step of Newton's method.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct StateStep {
    /// Intervals of the mesh.
    pub intervals: usize,
    /// Error of the conditions of first order before the step, as [`StateMotion::residual`].
    pub residual: f64,
    /// Sum of the defects and of what the end is missed by, before the step.
    pub infeasibility: f64,
    /// Cost before the step.
    pub cost: f64,
    /// Barrier.
    pub barrier: f64,
    /// Part of the step that was taken; 0 where none was accepted.
    pub length: f64,
}

impl StateMotion {
    /// Nothing known yet.
    pub(super) fn new() -> Self {
        Self {
            status: Status::MeshLimit,
            cost: f64::NAN,
            final_time: f64::NAN,
            t: Vec::new(),
            x: Vec::new(),
            u: Vec::new(),
            y: Vec::new(),
            hamiltonian: Vec::new(),
            defect: 0.0,
            defect_time: 0.0,
            end_missed: 0.0,
            missed_component: None,
            error: f64::INFINITY,
            largest_violation: f64::INFINITY,
            cost_change: f64::INFINITY,
            end_error: f64::INFINITY,
            verified: StateVerification::unknown(),
            certificate: Certificate::NotChecked,
            residual: f64::INFINITY,
            steps: Vec::new(),
            intervals: 0,
            u_limits: [Vec::new(), Vec::new()],
        }
    }

    /// (x, u) at time t (s), cut to [0, T]: x by the cubic of its interval, u by the parabola through its
    /// three points, cut to its limits. A node belongs to the interval before it.
    pub fn sample_at(&self, t: f64) -> (Vec<f64>, Vec<f64>) {
        let (x, mut u) = self.uncut_at(t);
        let [low, high] = &self.u_limits;
        u.iter_mut().zip(low.iter().zip(high)).for_each(|(u, (low, high))| *u = u.max(*low).min(*high));
        (x, u)
    }

    /// The same without the limits of u.
    pub(crate) fn uncut_at(&self, t: f64) -> (Vec<f64>, Vec<f64>) {
        let t = t.max(0.0).min(self.final_time);
        let after = self.t.partition_point(|&time| time < t).clamp(1, self.t.len() - 1);
        let first = (after - 1) / POINTS * POINTS;
        let (from, to) = (self.t[first], self.t[first + POINTS]);
        let (s, places) = ((t - from) / (to - from), Radau::new().places);
        let [_, a, b, c] = places;
        let sum = |factors: &[f64], rows: &[Vec<f64>], i: usize| -> f64 {
            factors.iter().zip(rows).map(|(factor, row)| factor * row[i]).sum()
        };
        let (of_x, of_u) = (lagrange::values(&places, s), lagrange::values(&[a, b, c], s));
        let x = (0..self.x[0].len()).map(|i| sum(&of_x, &self.x[first..], i)).collect();
        let u = (0..self.u[0].len()).map(|i| sum(&of_u, &self.u[first + 1..], i)).collect();
        (x, u)
    }
}
