//! Costates of a motion from the multipliers of the direct method.

use super::interval_part::IntervalPart;
use super::stationarity::Stationarity;
use crate::direct::interior::iterate::Interior;
use crate::direct::motion::shape::{PLACES, POINTS, WEIGHTS};
use crate::direct::points::values::PointDynamics;
use crate::numerics::lagrange::values;

/// Costates of (q, v), 2n a row, and H*.
#[derive(Clone, Debug)]
pub(super) struct Costates {
    /// At the nodes; after the node where a limit makes them jump.
    pub at_nodes: Vec<Vec<f64>>,
    /// At the right ends of the intervals, before such a jump.
    pub before: Vec<Vec<f64>>,
    pub at_points: Vec<Vec<f64>>,
    /// H* at the points.
    pub hamiltonian: Vec<f64>,
    /// The mean of H* on each interval.
    pub means: Vec<f64>,
    /// What is left of the gradient of the Lagrange function, in parts of its terms.
    pub stationarity: f64,
}

/// From an iterate whose points are contracted.
///
/// At a node the costate of a state is minus the derivative of the Lagrange function of what remains by
/// it: the part that the interval to the right adds. At a point, with the Lagrange function L per second of
/// (q, v, a), all limits with their multipliers in it,
///
/// $$ \lambda_v = L_a, \qquad \lambda_q = \lambda_q(t_k) + \int_{t_k}^t L_q \\, dt $$
///
/// with the quadratic through the three values of L_q, by which λ_q comes to its value at the next node:
/// Gauss's method for $\dot\lambda_q = L_q$. W. W. Hager, Runge-Kutta methods in optimal control and the
/// transformed adjoint system, Numerische Mathematik 87, 2000.
pub(super) fn costates<D: PointDynamics>(interior: &mut Interior<D>) -> Costates {
    let spline = &interior.spline.clone();
    let (n, mesh) = (spline.dof, &spline.mesh);
    let mut found = Costates {
        at_nodes: vec![vec![0.0; 2 * n]; mesh.nodes.len()],
        before: Vec::with_capacity(mesh.intervals()),
        at_points: vec![vec![0.0; 2 * n]; mesh.points()],
        hamiltonian: vec![0.0; mesh.points()],
        means: Vec::with_capacity(mesh.intervals()),
        stationarity: 0.0,
    };
    let mut stationarity = Stationarity::new(spline);
    let (mut part, integrals) = (IntervalPart::new(spline, interior.rows()), integrals());
    for k in 0..mesh.intervals() {
        part.take(interior, k);
        stationarity.add(&part, spline, k);
        found.means.push(-part.by_duration);
        let (left, right) = (part.by_state(spline, k, -1.0), part.by_state(spline, k + 1, 1.0));
        for (j, integrals) in integrals.iter().enumerate() {
            let p = POINTS * k + j;
            let costate = &mut found.at_points[p];
            costate[n..].copy_from_slice(&part.densities(j)[2 * n..]);
            for (i, costate) in costate[..n].iter_mut().enumerate() {
                let slopes = (0..POINTS).map(|l| integrals[l] * part.densities(l)[i]);
                *costate = left[i] + spline.length(k) * slopes.sum::<f64>();
            }
            let z = interior.points.z(p);
            let power: f64 = costate.iter().zip(&z[n..]).map(|(y, rate)| y * rate).sum();
            found.hamiltonian[p] =
                power - interior.running.rate(spline.time_of(p), z, interior.points.tau(p));
        }
        found.at_nodes[k] = left;
        found.before.push(right.clone());
        found.at_nodes[k + 1] = right;
    }
    found.stationarity = stationarity.residual(interior);
    found
}

/// The integrals from 0 to each of Gauss's points of the three polynomials that are 1 at one of them and 0 at
/// the others.
fn integrals() -> [[f64; POINTS]; POINTS] {
    PLACES.map(|end| {
        let mut sum = [0.0; POINTS];
        for (place, weight) in PLACES.into_iter().zip(WEIGHTS) {
            let at = values(&PLACES, end * place);
            sum.iter_mut().zip(at).for_each(|(sum, value)| *sum += end * weight * value);
        }
        sum
    })
}

#[cfg(test)]
mod tests {
    use super::{PLACES, integrals};

    #[test]
    fn integrals_of_quadratics_are_exact() {
        let (y, integral) =
            (|x: f64| 0.3 - x + 2.0 * x * x, |x: f64| x * (0.3 - 0.5 * x + 2.0 / 3.0 * x * x));
        for (x, factors) in PLACES.into_iter().zip(integrals()) {
            let sum: f64 = factors.into_iter().zip(PLACES).map(|(f, x)| f * y(x)).sum();
            assert!((sum - integral(x)).abs() < 1e-15, "{x}");
        }
    }
}
