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
    /// Largest estimated error of x over an interval, relative to the largest value of the component.
    pub error: f64,
    /// Largest distance by which a limit of x or u is exceeded at the points or between them.
    pub largest_violation: f64,
    /// Difference of J to that of the mesh before, relative.
    pub cost_change: f64,
    /// Largest difference at the end of an interval, or of the motion where that is less, when u is integrated
    /// independently; relative to the largest value of the component.
    pub end_error: f64,
    /// What is known of second order.
    pub certificate: Certificate,
    /// Newton steps on all meshes.
    pub iterations: usize,
    /// Intervals of the last mesh.
    pub intervals: usize,
}
