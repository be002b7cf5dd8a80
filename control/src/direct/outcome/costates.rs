//! Costates of a motion from the multipliers of the direct method.

use crate::direct::interior::iterate::Interior;
use crate::direct::limits::side::Limited;
use crate::direct::motion::shape::{PLACES, POINTS};
use crate::direct::motion::spline::Spline;
use crate::direct::newton::interval::add_gradient;
use crate::direct::newton::point_terms::Work;
use crate::direct::points::values::PointDynamics;
use crate::numerics::lagrange::slopes;

/// The places of the points of an interval, and its ends.
const PLACES_AND_ENDS: [f64; POINTS + 2] = [0.0, PLACES[0], PLACES[1], PLACES[2], 1.0];

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
}

/// From an iterate whose points are contracted.
///
/// At a node the costate of a state is minus the derivative of the Lagrange function of what remains by
/// it: the part that the interval to the right adds to the gradient. At a point the costate of p is the
/// derivative of the Lagrange function by the torque, over weight and duration, `y_p = r tau + (eta_max
/// - eta_min)`. In (q, v) the costates are
///
/// $$ \lambda_v = M y_p + l_a, \qquad \lambda_q = l_v + \tau_v^\top y_p - \frac{d}{dt} \lambda_v $$
///
/// where l contains energy and the limits on v, powers and rows of tasks with their multipliers, l_v at
/// constant torques; l_a is that of limits on accelerations of tools. The derivative is that of the
/// polynomial through points and nodes of an interval.
pub(super) fn costates<D: PointDynamics>(interior: &mut Interior<D>) -> Costates {
    let spline = &interior.spline.clone();
    let (n, mesh) = (spline.dof, &spline.mesh);
    let mut found = Costates {
        at_nodes: vec![vec![0.0; 2 * n]; mesh.nodes.len()],
        before: Vec::with_capacity(mesh.intervals()),
        at_points: vec![vec![0.0; 2 * n]; mesh.points()],
        hamiltonian: vec![0.0; mesh.points()],
    };
    let mut work = Work::new(n, interior.rows());
    let mut gradient = vec![0.0; spline.unknowns.len()];
    for k in 0..mesh.intervals() {
        gradient.fill(0.0);
        for (j, p) in (POINTS * k..POINTS * (k + 1)).enumerate() {
            work.collect::<false>(
                p,
                false,
                spline,
                &interior.points,
                &interior.barrier,
                &mut interior.running,
            );
            add_gradient(
                spline,
                k,
                &spline.basis(k, j).in_time(1.0 / spline.clock(k)),
                &work.z[0],
                &mut gradient,
            );
        }
        let right = by_state(spline, &gradient, k + 1, 1.0);
        found.at_nodes[k] = by_state(spline, &gradient, k, -1.0);
        let mut impulses = vec![found.at_nodes[k][n..].to_vec()];
        impulses.extend((POINTS * k..POINTS * (k + 1)).map(|p| impulse(interior, p)));
        impulses.push(right[n..].to_vec());
        for j in 0..POINTS {
            let costate = at_point(interior, k, j, &impulses);
            let p = POINTS * k + j;
            let z = interior.points.z(p);
            let power: f64 = costate.iter().zip(&z[n..]).map(|(y, rate)| y * rate).sum();
            found.hamiltonian[p] =
                power - interior.running.rate(spline.time_of(p), z, interior.points.tau(p));
            found.at_points[p] = costate;
        }
        found.before.push(right.clone());
        found.at_nodes[k + 1] = right;
    }
    found
}

/// Derivatives by q and v at a node, times `sign`, from those by the unknowns: v = x/T.
pub(super) fn by_state(spline: &Spline, gradient: &[f64], k: usize, sign: f64) -> Vec<f64> {
    let (n, time) = (spline.dof, spline.clock_at(k));
    let scale = |i: usize| if i < n { sign } else { sign * time };
    gradient[spline.node() * k..][..2 * n].iter().enumerate().map(|(i, g)| scale(i) * g).collect()
}

/// The costate at point `j` of interval `k`, from M y_p at its nodes and points.
fn at_point<D>(interior: &mut Interior<D>, k: usize, j: usize, impulses: &[Vec<f64>]) -> Vec<f64> {
    let (spline, points, p) = (&interior.spline, &interior.points, POINTS * k + j);
    let n = spline.dof;
    let mut costate = vec![0.0; 2 * n];
    interior.running.add_rate_gradient(points.z(p), points.tau(p), &mut costate[..n]);
    let scale = 1.0 / spline.weight(p);
    let multipliers = &interior.barrier.multiplier[interior.barrier.at_point(p)];
    for (side, eta) in interior.barrier.sides().iter().zip(multipliers) {
        match side.limited {
            Limited::Rate => costate[side.joint] -= side.sign * eta * scale,
            Limited::Power | Limited::TorqueSpeed => {
                let factor = -side.sign * eta * scale;
                interior.model.powers.add_by_rates(side.joint, factor, points.tau(p), &mut costate[..n]);
            }
            Limited::ToolAcceleration => {
                let slopes = &points.h_z(p)[3 * n * side.joint + n..][..n];
                let costate = costate.iter_mut().zip(slopes);
                costate.for_each(|(costate, slope)| *costate -= side.sign * eta * scale * slope);
            }
            Limited::Task => {
                let slopes = &points.g_x(p)[2 * n * side.joint + n..][..n];
                let costate = costate.iter_mut().zip(slopes);
                costate.for_each(|(costate, slope)| *costate -= side.sign * eta * scale * slope);
            }
            _ => {}
        }
    }
    let (y_p, factors) = (torque_costate(interior, p), slopes(&PLACES_AND_ENDS, PLACES[j]));
    let rate = 1.0 / spline.length(k);
    for i in 0..n {
        let slope: f64 = factors.iter().zip(impulses).map(|(factor, impulse)| factor * impulse[i]).sum();
        costate[i] -= rate * slope;
        for (l, y) in y_p.iter().enumerate() {
            costate[i] += points.tau_z(p)[3 * n * l + n + i] * y;
        }
    }
    costate[n..].copy_from_slice(&impulses[j + 1]);
    costate
}

/// y_p at a point.
fn torque_costate<D>(interior: &Interior<D>, p: usize) -> Vec<f64> {
    let n = interior.spline.dof;
    let scale = 1.0 / interior.spline.weight(p);
    interior.points.weights[n * p..][..n].iter().map(|weight| scale * weight).collect()
}

/// The derivative of the Lagrange function by the accelerations, over weight and duration: M y_p, and what
/// limits on accelerations of tools add.
fn impulse<D>(interior: &Interior<D>, p: usize) -> Vec<f64> {
    let (points, barrier, n) = (&interior.points, &interior.barrier, interior.spline.dof);
    let mut impulse = mass_times(points.tau_z(p), &torque_costate(interior, p));
    let scale = 1.0 / interior.spline.weight(p);
    for (side, eta) in barrier.sides().iter().zip(&barrier.multiplier[barrier.at_point(p)]) {
        if side.limited == Limited::ToolAcceleration {
            let slopes = &points.h_z(p)[3 * n * side.joint + 2 * n..][..n];
            let impulse = impulse.iter_mut().zip(slopes);
            impulse.for_each(|(impulse, slope)| *impulse -= side.sign * eta * scale * slope);
        }
    }
    impulse
}

/// M y, from the Jacobian of the torques.
fn mass_times(tau_z: &[f64], y: &[f64]) -> Vec<f64> {
    let n = y.len();
    let rows = tau_z.chunks_exact(3 * n);
    rows.map(|row| row[2 * n..].iter().zip(y).map(|(m, y)| m * y).sum()).collect()
}
