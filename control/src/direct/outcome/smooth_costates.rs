//! Costates of motions whose accelerations are continuous.

use super::costates::{Costates, by_state};
use crate::direct::interior::iterate::Interior;
use crate::direct::motion::shape::POINTS;
use crate::direct::newton::interval::{add_gradient, add_local};
use crate::direct::newton::point_terms::Work;
use crate::direct::newton::rate_rows::RateRows;
use crate::direct::points::values::PointDynamics;

/// From an iterate whose points are contracted.
///
/// The state is (q, v, a). Its costate at a node is minus the derivative by it of the Lagrange function of
/// what remains: the part that the interval to the right adds. An interval has no other unknowns than the
/// states at its ends, so the derivative of its part by its duration, at constant states and times of its
/// points, is minus the mean of H*. Between the nodes the costates of q and v are linear.
pub(super) fn smooth_costates<D: PointDynamics>(interior: &mut Interior<D>) -> Costates {
    let spline = &interior.spline.clone();
    let (n, node, mesh) = (spline.dof, spline.node(), &spline.mesh);
    let (mut work, mut rows) = (Work::new(n, interior.rows()), RateRows::new(n));
    let mut at_nodes = vec![vec![0.0; 2 * n]; mesh.nodes.len()];
    let mut before: Vec<Vec<f64>> = Vec::with_capacity(mesh.intervals());
    let mut hamiltonian = Vec::with_capacity(mesh.intervals());
    let mut gradient = vec![0.0; spline.unknowns.len()];
    let (mut point, mut scaled) = (vec![0.0; 3 * n], vec![0.0; 3 * n]);
    // Those of rates of torques are added interval by interval.
    let has_torques = std::mem::replace(&mut interior.points.rates.has_torques, false);
    for k in 0..mesh.intervals() {
        gradient.fill(0.0);
        // The cost of time, which does not depend on the unknowns.
        let (time, mut by_time) = (spline.clock(k), interior.running.time * mesh.width(k));
        for (j, part) in mesh.shape.weights().iter().enumerate() {
            let p = mesh.first_point(k) + j;
            let (weight, cost) = work.collect::<false>(
                p,
                false,
                spline,
                &interior.points,
                &interior.barrier,
                &mut interior.running,
            );
            // A node belongs to the intervals beside it in proportion to their widths.
            let own = part * mesh.width(k) / weight;
            point.copy_from_slice(interior.points.z(p));
            let factors = spline.basis(k, j).in_time(1.0 / time);
            work.differentiate_in_time(&point, spline, k, &factors);
            scaled.iter_mut().zip(&work.z[0]).for_each(|(to, from)| *to = own * from);
            by_time += own * weight * cost;
            by_time += scaled.iter().zip(&work.z_t).map(|(a, b)| a * b).sum::<f64>();
            add_gradient(spline, k, &factors, &scaled, &mut gradient);
        }
        if has_torques {
            rows.differentiate_torques(k, spline, &interior.points);
        }
        for (j, i) in (0..POINTS).flat_map(|j| (0..n).map(move |i| (j, i))) {
            let (rates, p) = (&interior.points.rates, n * (POINTS * k + j) + i);
            let [first, _] = rows.take_jerk(k, j, i, spline, &interior.points);
            add_local(spline, k, &rows.row, rates.jerk_terms[p].first[0], &mut gradient);
            by_time += rates.jerk_terms[p].cost + rates.jerk_terms[p].first[0] * first;
            if has_torques {
                let first = rows.take_torque_rate(k, j, i, spline, &interior.points);
                add_local(spline, k, &rows.row, rates.torque_terms[p].first[0], &mut gradient);
                by_time += rates.torque_terms[p].cost + rates.torque_terms[p].first[0] * first;
            }
        }
        // v and a are constant: q' = T v, q'' = T^2 a.
        let states = gradient.iter().zip(&spline.unknowns).enumerate().skip(node * k).take(2 * node);
        for (i, (g, x)) in states.filter(|(i, _)| !mesh.is_end(i / node)) {
            by_time += [0.0, 1.0, 2.0][i % node / n] * g * x / time;
        }
        hamiltonian.push(-by_time / mesh.width(k));
        let right = by_state(spline, &gradient, k + 1, 1.0);
        at_nodes[k] = by_state(spline, &gradient, k, -1.0);
        before.push(right.clone());
        at_nodes[k + 1] = right;
    }
    interior.points.rates.has_torques = has_torques;
    let times: Vec<f64> = (0..mesh.points()).map(|p| spline.time_of(p)).collect();
    let ahead = interior.clock_ahead(&times);
    let mean_ahead = |k: usize| -> f64 {
        let parts = mesh.shape.weights().iter().enumerate();
        parts.map(|(j, part)| part * ahead[mesh.first_point(k) + j]).sum()
    };
    let of_point = |p: usize, k: usize| hamiltonian[k] + ahead[p] - mean_ahead(k);
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
    }
}
