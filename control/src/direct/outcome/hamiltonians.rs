//! H* of a motion, phase by phase.

use super::costates::Costates;
use crate::direct::interior::iterate::Interior;
use crate::direct::points::values::PointDynamics;
use crate::problem::Problem;

/// H* less what the clock adds to it, which is constant along each phase of an optimal motion.
#[derive(Clone, Debug)]
pub(crate) struct Hamiltonians {
    /// For each phase minus the derivative of the Lagrange function by its time, states at its ends and all
    /// multipliers as they are: minus that of the least cost on this mesh.
    pub phases: Vec<f64>,
    /// Largest difference between the mean on an interval and that of its phase, in parts of the largest
    /// |y'f| + |l| along the motion.
    pub drift: f64,
}

impl Hamiltonians {
    /// Minus the derivative by the duration of the motion: where the last phase alone follows it that of this
    /// phase, where all do, each with its part, their mean.
    pub fn by_duration(&self, problem: &Problem) -> f64 {
        match problem.parts_of_time() {
            Some(parts) => parts.iter().zip(&self.phases).map(|(part, value)| part * value).sum(),
            None => self.phases.last().copied().unwrap_or(f64::NAN),
        }
    }
}

/// From the costates of an iterate.
pub(super) fn hamiltonians<D: PointDynamics>(
    interior: &mut Interior<D>,
    costates: &Costates,
) -> Hamiltonians {
    let ahead = interior.ahead_of_points();
    let values: Vec<f64> =
        costates.means.iter().zip(&ahead.means).map(|(mean, ahead)| mean - ahead).collect();
    let (spline, points) = (&interior.spline, &interior.points);
    let mut phases = vec![0.0; spline.mesh.phases()];
    for (k, value) in values.iter().enumerate() {
        phases[spline.mesh.phase(k)] += spline.mesh.width(k) * value;
    }
    let far = values.iter().enumerate().map(|(k, value)| (value - phases[spline.mesh.phase(k)]).abs());
    let far = far.fold(0.0, f64::max);
    let mut size = interior.running.time;
    for (p, value) in costates.hamiltonian.iter().enumerate() {
        let cost = interior.running.rate(spline.time_of(p), points.z(p), points.tau(p));
        size = size.max((value + cost).abs() + cost.abs());
    }
    Hamiltonians { phases, drift: if size > 0.0 { far / size } else { 0.0 } }
}
