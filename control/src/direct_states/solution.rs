//! A motion of a model in its states.

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
    /// Largest defect of an interval, in the units of x, and the time of its start.
    pub defect: f64,
    /// Where the largest defect is (s).
    pub defect_time: f64,
    /// Largest distance from a fixed component of the end, in its unit; 0 where the end is met.
    pub end_missed: f64,
    /// This component, an index in x. None where the end is met to rounding.
    pub missed_component: Option<usize>,
    /// Largest estimated error of x over an interval, relative to the largest value of the component.
    pub error: f64,
    /// Largest excess of a limit of x between the points, relative to the largest value of the component. At
    /// the points, and those of u, limits are kept.
    pub largest_violation: f64,
    /// Difference of J to that of the mesh before, relative; of a motion that converged, that has twice the
    /// widths.
    pub cost_change: f64,
    /// What the end is missed by when u is integrated independently, or where that is less the end of each
    /// interval; relative to the largest value of the component.
    pub end_error: f64,
    /// What is known of second order.
    pub certificate: Certificate,
    /// Error of the conditions of first order on the last mesh: of stationarity and complementarity, in parts
    /// of the multipliers, and sum of the defects.
    pub residual: f64,
    /// Newton steps on all meshes.
    pub steps: Vec<StateStep>,
    /// Intervals of the last mesh.
    pub intervals: usize,
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
            certificate: Certificate::NotChecked,
            residual: f64::INFINITY,
            steps: Vec::new(),
            intervals: 0,
        }
    }
}
