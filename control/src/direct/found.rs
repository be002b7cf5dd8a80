//! What the direct method found: the motion with its costates at all points.

use super::basis::{END_WEIGHT, INNER_WEIGHTS, PLACES, POINTS};
use super::interior::Interior;
use super::limits::Limited;
use super::points::PointDynamics;
use crate::problem::Problem;
use crate::result::trajectory::Trajectory;
use costate::EvalError;
use costate::lagrangian::LegendreTransform;

/// The trajectory at all points, with H*.
///
/// The costate of p is the derivative of the Lagrange function by the torque, over weight and duration:
/// `y_p = r tau + (eta_max - eta_min)`. In (q, v) the costates are `lambda_v = M y_p` and
///
/// $$ \lambda_q = l_v + \tau_v^\top y_p - \frac{d}{dt}(M y_p) $$
///
/// where l contains the limits on v with their multipliers; the derivative is that of the polynomial through
/// the points of an interval.
pub(super) fn trajectory<D: PointDynamics>(
    problem: &Problem,
    interior: &mut Interior<D>,
) -> Result<Trajectory, EvalError> {
    interior.refresh()?;
    let (spline, points) = (&interior.spline, &interior.points);
    let (n, count) = (spline.dof, points.count());
    let limits = problem.joint_limits();
    let mut rows: [Vec<Vec<f64>>; 6] = std::array::from_fn(|_| Vec::with_capacity(count));
    let (mut times, mut hamiltonian) = (Vec::with_capacity(count), Vec::with_capacity(count));
    let accelerations = (0..count).map(|p| points.z(p)[2 * n..].to_vec()).collect();
    let costates = smooth((0..count).map(|p| torque_costate(interior, p)).collect());
    // M y_p at all points.
    let impulse: Vec<Vec<f64>> = (0..count).map(|p| mass_times(points.tau_z(p), &costates[p])).collect();
    let mut transform = LegendreTransform::<f64>::new(&problem.robot);
    for p in 0..count {
        let (s, weight) = spline.point(p);
        let z = points.z(p);
        let (q, v, a) = (&z[..n], &z[n..2 * n], &z[2 * n..]);
        let tau: Vec<f64> = points
            .tau(p)
            .iter()
            .zip(&limits)
            .map(|(tau, limit)| tau.clamp(limit.torque[0], limit.torque[1]))
            .collect();
        let u: Vec<f64> = tau.iter().zip(&problem.gain).map(|(tau, gain)| tau / gain).collect();
        let slope = slope_at(interior, &impulse, p);
        let mut costate = vec![0.0; 2 * n];
        interior.running.add_rate_gradient(z, &mut costate[..n]);
        for (i, side) in interior.barrier.sides.iter().enumerate() {
            if side.limited == Limited::Rate {
                let eta = interior.barrier.multiplier[interior.barrier.sides.len() * p + i];
                costate[side.joint] -= side.sign * eta / (weight * spline.time);
            }
        }
        for i in 0..n {
            costate[i] -= slope[i];
            for (k, y) in costates[p].iter().enumerate() {
                costate[i] += points.tau_z(p)[3 * n * k + n + i] * y;
            }
        }
        costate[n..].copy_from_slice(&impulse[p]);
        let power: f64 =
            costate[..n].iter().zip(v).chain(costate[n..].iter().zip(a)).map(|(y, f)| y * f).sum();
        hamiltonian.push(power - interior.running.rate(z, points.tau(p)));
        let mut map = transform.at(q, v, &u)?;
        map.costate_to_hamiltonian(&mut costate)?;
        let momentum = map.momentum().to_vec();
        times.push(s * spline.time);
        let (y_q, y_p) = costate.split_at(n);
        for (rows, row) in rows.iter_mut().zip([q, v, &momentum, &u, y_q, y_p]) {
            rows.push(row.to_vec());
        }
    }
    Ok(Trajectory::from_rows(times, rows).with_hamiltonian(hamiltonian).with_accelerations(accelerations))
}

/// y_p at a point.
fn torque_costate<D: PointDynamics>(interior: &Interior<D>, p: usize) -> Vec<f64> {
    let n = interior.spline.dof;
    let scale = 1.0 / (interior.spline.point(p).1 * interior.spline.time);
    interior.points.weights[n * p..][..n].iter().map(|weight| scale * weight).collect()
}

/// Each interval's values on the polynomial of degree two next to them, means of both sides at nodes.
///
/// Where as many torques are at limits as there are joints, the multipliers of the four points of an interval
/// balance only three unknowns a joint: what oscillates faster has no meaning.
fn smooth(mut values: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let [a, b, c] = PLACES;
    let places = [0.0, a, b, c, 1.0];
    let [d, e, _] = INNER_WEIGHTS;
    let weights = [END_WEIGHT, d, e, d, END_WEIGHT];
    // Legendre polynomials on [0, 1].
    let legendre = |x: f64| [1.0, 2.0 * x - 1.0, 6.0 * x * x - 6.0 * x + 1.0];
    let raw = values.clone();
    let last = values.len() - 1;
    for p in (POINTS..values.len()).step_by(POINTS) {
        values[p].fill(0.0);
    }
    values[0].fill(0.0);
    for first in (0..last).step_by(POINTS) {
        for i in 0..raw[0].len() {
            let mut coefficients = [0.0; 3];
            for (j, (&place, weight)) in places.iter().zip(weights).enumerate() {
                for (degree, (to, base)) in coefficients.iter_mut().zip(legendre(place)).enumerate() {
                    *to += (2.0 * degree as f64 + 1.0) * weight * base * raw[first + j][i];
                }
            }
            for (j, &place) in places.iter().enumerate() {
                let value: f64 = coefficients.iter().zip(legendre(place)).map(|(c, base)| c * base).sum();
                let p = first + j;
                let inner_node = j % POINTS == 0 && p > 0 && p < last;
                match (j % POINTS, inner_node) {
                    (0, true) => values[p][i] += 0.5 * value,
                    _ => values[p][i] = value,
                }
            }
        }
    }
    values
}

/// M y, from the Jacobian of the torques.
fn mass_times(tau_z: &[f64], y: &[f64]) -> Vec<f64> {
    let n = y.len();
    let rows = tau_z.chunks_exact(3 * n);
    rows.map(|row| row[2 * n..].iter().zip(y).map(|(m, y)| m * y).sum()).collect()
}

/// The derivative in time of values at all points, at point `p`; at inner nodes the mean of both sides.
fn slope_at<D: PointDynamics>(interior: &Interior<D>, values: &[Vec<f64>], p: usize) -> Vec<f64> {
    let spline = &interior.spline;
    let (k, j) = (p / POINTS, p % POINTS);
    let in_interval = |k: usize, j: usize| -> Vec<f64> {
        let factors = slopes(j);
        let rate = 1.0 / (spline.width(k) * spline.time);
        let entry =
            |i: usize| rate * (0..=POINTS).map(|l| factors[l] * values[POINTS * k + l][i]).sum::<f64>();
        (0..spline.dof).map(entry).collect()
    };
    match j {
        0 if k == 0 => in_interval(0, 0),
        0 if k == spline.intervals() => in_interval(k - 1, POINTS),
        0 => {
            let (left, right) = (in_interval(k - 1, POINTS), in_interval(k, 0));
            left.iter().zip(&right).map(|(left, right)| 0.5 * (left + right)).collect()
        }
        j => in_interval(k, j),
    }
}

/// Derivatives at place `j` of the Lagrange polynomials of the places 0, [`PLACES`], 1 of an interval.
fn slopes(j: usize) -> [f64; POINTS + 1] {
    let [a, b, c] = PLACES;
    let places = [0.0, a, b, c, 1.0];
    std::array::from_fn(|l| {
        let others = |skip: usize| (0..=POINTS).filter(move |&m| m != l && m != skip);
        if l == j {
            return others(l).map(|m| 1.0 / (places[l] - places[m])).sum();
        }
        let product: f64 = others(j).map(|m| (places[j] - places[m]) / (places[l] - places[m])).product();
        product / (places[l] - places[j])
    })
}

#[cfg(test)]
mod tests {
    use super::{PLACES, slopes};

    #[test]
    fn slopes_of_a_quartic_are_exact() {
        let [a, b, c] = PLACES;
        let places = [0.0, a, b, c, 1.0];
        for (j, x) in places.into_iter().enumerate() {
            let slope: f64 = slopes(j).iter().zip(places).map(|(factor, x)| factor * (x.powi(4) - x)).sum();
            assert!((slope - (4.0 * x.powi(3) - 1.0)).abs() < 1e-13);
        }
    }
}
