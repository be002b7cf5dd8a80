//! Costates of motions whose accelerations are continuous.

use super::costates::Costates;
use super::interval_part::IntervalPart;
use super::stationarity::Stationarity;
use crate::direct::interior::iterate::Interior;
use crate::direct::points::values::PointDynamics;

/// From an iterate whose points are contracted.
///
/// The state is (q, v, a). Its costate at a node is minus the derivative by it of the Lagrange function of
/// what remains: the part that the interval to the right adds. Between the nodes the costates of q and v are
/// linear, and H* differs from its mean by what the clock makes of it.
pub(super) fn smooth_costates<D: PointDynamics>(interior: &mut Interior<D>) -> Costates {
    let spline = &interior.spline.clone();
    let (n, mesh) = (spline.dof, &spline.mesh);
    let mut part = IntervalPart::new(spline, interior.rows());
    let mut at_nodes = vec![vec![0.0; 2 * n]; mesh.nodes.len()];
    let mut before: Vec<Vec<f64>> = Vec::with_capacity(mesh.intervals());
    let mut means = Vec::with_capacity(mesh.intervals());
    let mut stationarity = Stationarity::new(spline);
    for k in 0..mesh.intervals() {
        part.take(interior, k);
        stationarity.add(&part, spline, k);
        means.push(-part.by_duration);
        let right = part.by_state(spline, k + 1, 1.0);
        at_nodes[k] = part.by_state(spline, k, -1.0);
        before.push(right.clone());
        at_nodes[k + 1] = right;
    }
    let ahead = interior.ahead_of_points();
    let of_point = |p: usize, k: usize| means[k] + ahead.at_points[p] - ahead.means[k];
    let places = (0..mesh.points()).map(|p| mesh.interval_of(p));
    let linear = |(k, j): (usize, usize)| -> Vec<f64> {
        let x = mesh.shape.places()[j];
        let right = if mesh.is_end(k + 1) { &before[k] } else { &at_nodes[k + 1] };
        at_nodes[k].iter().zip(right).map(|(left, right)| left + x * (right - left)).collect()
    };
    Costates {
        at_points: places.clone().map(linear).collect(),
        hamiltonian: places.enumerate().map(|(p, (k, _))| of_point(p, k)).collect(),
        at_nodes,
        before,
        means,
        stationarity: stationarity.residual(interior),
    }
}
