//! Inverse dynamics of robots whose loops are closed, with the constraints as equations.

use super::values::{PointDynamics, Points};
use crate::problem::loop_rows::{LoopPhase, LoopRow, Loops};
use costate::EvalError;
use costate::constraints::Constraints;
use costate::lagrangian::LagrangianSecondOrder;
use costate::scalar::Tangent;
use std::ops::Range;

type First = Tangent<f64>;
type Second = Tangent<First>;

/// With the coordinates (q, nu) of n joints and k rows, and the accelerations (a, lambda): for the rows g,
/// each times its mass,
///
/// ```text
/// tau = ID(q, v, a) - J' lambda            n torques
///     = -d2 g/dt2 = -(J a + (J v)_q v)     k entries, zero along the motion
/// ```
///
/// Rows that do not hold in the phase have no force, and their entry is lambda: it is zero along the motion.
///
/// d2 g/dt2 is the coefficient of s t in g(q + (s + t) v + s t a), and its derivatives by q are those of J
/// and of the contracted Hessian of g there: tangents of tangents of the code of the constraints. That of s
/// alone gives the derivatives by v, the value those by a.
#[derive(Debug)]
pub(crate) struct ClosedPoints {
    open: LagrangianSecondOrder<f64>,
    rows: Vec<LoopRow>,
    /// The masses of the rows that do not hold.
    idle: Vec<f64>,
    /// Along the motion.
    moving: Constraints<Second>,
    path: Vec<Second>,
    moving_weights: Vec<Second>,
    /// Along the weights of the torques.
    along: Constraints<First>,
    line: Vec<First>,
    forces: Vec<First>,
}

impl ClosedPoints {
    /// Those of a phase.
    pub fn new(loops: &Loops, phase: usize) -> Self {
        let LoopPhase { robot, rows } = &loops.phases[phase];
        let (moving, along) = (Constraints::new(robot), Constraints::new(robot));
        let (n, all) = (moving.dof(), moving.count());
        let zero = Tangent::new(0.0, 0.0);
        Self {
            open: LagrangianSecondOrder::new(&robot.without_constraints()),
            rows: loops.rows[..*rows].to_vec(),
            idle: loops.rows[*rows..].iter().map(|row| row.mass).collect(),
            moving,
            path: vec![Tangent::new(zero, zero); n],
            moving_weights: vec![Tangent::new(zero, zero); all],
            along,
            line: vec![zero; n],
            forces: vec![zero; all],
        }
    }

    /// The torques and the constraints at (q, v, a) of all coordinates, into `tau`.
    ///
    /// # Errors
    /// States that cannot be evaluated.
    pub fn inverse_dynamics(&mut self, z: &[f64], tau: &mut [f64]) -> Result<(), EvalError> {
        let (n, width) = (self.path.len(), tau.len());
        let (q, v, a) = (&z[..n], &z[width..width + n], &z[2 * width..2 * width + n]);
        tau[..n].copy_from_slice(self.open.first().inverse_dynamics(q, v, a)?);
        self.place([q, v, a])?;
        for (k, LoopRow { row, mass, .. }) in self.rows.iter().enumerate() {
            let force = mass * z[2 * width + n + k];
            for (tau, j) in tau[..n].iter_mut().zip(self.moving.jacobian().row(*row)) {
                *tau -= force * j.re.re;
            }
            tau[n + k] = -mass * self.moving.values()[*row].eps.eps;
        }
        let held = n + self.rows.len();
        for (i, mass) in (held..).zip(&self.idle) {
            tau[i] = mass * z[2 * width + i];
        }
        Ok(())
    }

    /// g along the motion.
    fn place(&mut self, [q, v, a]: [&[f64]; 3]) -> Result<(), EvalError> {
        for (i, to) in self.path.iter_mut().enumerate() {
            *to = Tangent::new(Tangent::new(q[i], v[i]), Tangent::new(v[i], a[i]));
        }
        self.moving.set_position(&self.path)
    }

    /// tau, tau_z and the Hessian of w.tau at one point.
    fn contract_at(&mut self, points: &mut Points, p: usize) -> Result<(), EvalError> {
        let (n, all) = (self.path.len(), points.dof);
        let z = &points.z[3 * all * p..][..3 * all];
        let (q, v, a) = (&z[..n], &z[all..all + n], &z[2 * all..2 * all + n]);
        let weights = &points.weights[all * p..][..all];
        self.place([q, v, a])?;
        for (k, LoopRow { row, mass, .. }) in self.rows.iter().enumerate() {
            let constant = |value| Tangent::new(mass * value, 0.0);
            self.forces[*row] = constant(z[2 * all + n + k]);
            self.moving_weights[*row] = Tangent::new(constant(weights[n + k]), Tangent::new(0.0, 0.0));
        }
        for (i, to) in self.line.iter_mut().enumerate() {
            *to = Tangent::new(q[i], weights[i]);
        }
        self.along.set_position(&self.line)?;
        let bent = self.along.hessian(&self.forces)?.clone();
        let curved = self.moving.hessian(&self.moving_weights)?.clone();
        let open = self.open.contract_inverse_dynamics(q, v, a, &weights[..n])?;
        let (first, hessian) = (open.inverse_dynamics(), open.zz());
        let (width, jacobian) = (3 * all, self.moving.jacobian());
        let tau = &mut points.tau[all * p..][..all];
        tau[..n].copy_from_slice(first.tau);
        let tau_z = &mut points.tau_z[width * all * p..][..width * all];
        tau_z.fill(0.0);
        for (i, row) in tau_z.chunks_exact_mut(width).take(n).enumerate() {
            for j in 0..n {
                row[j] = first.tau_q[(i, j)] - bent[(i, j)].re;
                row[all + j] = first.tau_v[(i, j)];
                row[2 * all + j] = first.tau_a[(i, j)];
            }
        }
        let second = &mut points.hessian[width * width * p..][..width * width];
        second.fill(0.0);
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            for (rows, columns) in (0..3).flat_map(|rows| (0..3).map(move |columns| (rows, columns))) {
                let more = match (rows, columns) {
                    (0, 0) => bent[(i, j)].eps + curved[(i, j)].eps.eps,
                    (0, 1) | (1, 0) => 2.0 * curved[(i, j)].re.eps,
                    (1, 1) => 2.0 * curved[(i, j)].re.re,
                    (0, 2) | (2, 0) => curved[(i, j)].re.re,
                    _ => 0.0,
                };
                let open = hessian[(n * rows + i, n * columns + j)];
                second[width * (all * rows + i) + all * columns + j] = open - more;
            }
        }
        for (k, LoopRow { row, mass, .. }) in self.rows.iter().enumerate() {
            let force = 2 * all + n + k;
            let own = &mut tau_z[width * (n + k)..][..width];
            for (j, entry) in jacobian.row(*row).iter().enumerate() {
                own[j] = -mass * entry.eps.eps;
                own[all + j] = -2.0 * mass * entry.re.eps;
                own[2 * all + j] = -mass * entry.re.re;
            }
            tau[n + k] = -mass * self.moving.values()[*row].eps.eps;
            for (i, entry) in jacobian.row(*row).iter().enumerate() {
                tau[i] -= mass * z[force] * entry.re.re;
                tau_z[width * i + force] = -mass * entry.re.re;
                let mixed = -mass * self.along.jacobian().row(*row)[i].eps;
                second[width * i + force] = mixed;
                second[width * force + i] = mixed;
            }
        }
        let held = n + self.rows.len();
        for (i, mass) in (held..).zip(&self.idle) {
            tau[i] = mass * z[2 * all + i];
            tau_z[width * i + 2 * all + i] = *mass;
        }
        Ok(())
    }
}

impl PointDynamics for ClosedPoints {
    fn evaluate_some(&mut self, points: &mut Points, which: Range<usize>) -> Result<(), EvalError> {
        let all = points.dof;
        which.into_iter().try_for_each(|p| {
            let (z, tau) = (&points.z[3 * all * p..][..3 * all], &mut points.tau[all * p..][..all]);
            self.inverse_dynamics(z, tau)
        })
    }

    fn contract_some(&mut self, points: &mut Points, which: Range<usize>) -> Result<(), EvalError> {
        which.into_iter().try_for_each(|p| self.contract_at(points, p))
    }
}

#[cfg(test)]
#[path = "closed_points_tests.rs"]
mod tests;
