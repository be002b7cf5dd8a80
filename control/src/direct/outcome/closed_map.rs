//! Momenta and costates of robots whose loops are closed.

use crate::numerics::lu;
use crate::problem::loop_rows::{LoopPhase, LoopRow, Loops};
use costate::EvalError;
use costate::constraints::Constraints;
use costate::hamiltonian::Hamiltonian;
use costate::scalar::Tangent;

/// The Legendre transform of `L(q, v) - mu.J v`: momenta `p = M v - J'mu` of the joints and `-J v` of the
/// multipliers, which is zero along a motion.
#[derive(Debug)]
pub(super) struct ClosedMap {
    open: Hamiltonian<f64>,
    /// Those that hold, and the masses of the others, whose momenta are these times their rates.
    rows: Vec<LoopRow>,
    idle: Vec<f64>,
    constraints: Constraints<Tangent<f64>>,
}

impl ClosedMap {
    /// That of a phase.
    pub fn new(loops: &Loops, phase: usize) -> Self {
        let LoopPhase { robot, rows } = &loops.phases[phase];
        Self {
            open: Hamiltonian::new(&robot.without_constraints()),
            rows: loops.rows[..*rows].to_vec(),
            idle: loops.rows[*rows..].iter().map(|row| row.mass).collect(),
            constraints: Constraints::new(robot),
        }
    }

    /// The momenta at (q, nu), (v, mu) of all coordinates; costates of positions and rates become those of
    /// positions and momenta:
    ///
    /// ```text
    /// y_p = MM^-1 y_v,   y_q less PP' y_p,   MM = (M, -J'; -J, 0),   PP = (P - (mu.J)_q; -(J v)_q)
    /// ```
    ///
    /// They are not a number where MM is singular.
    ///
    /// # Errors
    /// States that cannot be evaluated.
    pub fn apply(&mut self, q: &[f64], v: &[f64], costate: &mut [f64]) -> Result<Vec<f64>, EvalError> {
        let (all, k) = (q.len(), self.rows.len() + self.idle.len());
        let n = all - k;
        let path: Vec<_> = q[..n].iter().zip(v).map(|(&q, &v)| Tangent::new(q, v)).collect();
        self.constraints.set_position(&path)?;
        let mut mu = vec![Tangent::new(0.0, 0.0); self.constraints.count()];
        for (LoopRow { row, mass, .. }, v) in self.rows.iter().zip(&v[n..]) {
            mu[*row] = Tangent::new(mass * v, 0.0);
        }
        let curvature = self.constraints.hessian(&mu)?.clone();
        let jacobian = self.constraints.jacobian();
        let map = self.open.linearise_momentum(&q[..n], &v[..n])?;
        let (mut matrix, mut cross) = (vec![0.0; all * all], vec![0.0; all * n]);
        for i in 0..n {
            for j in 0..n {
                matrix[all * i + j] = map.dp_dv[(i, j)];
                cross[n * i + j] = map.dp_dq[(i, j)] - curvature[(i, j)].re;
            }
        }
        for (k, LoopRow { row, mass, .. }) in self.rows.iter().enumerate() {
            for (j, entry) in jacobian.row(*row).iter().enumerate() {
                matrix[all * (n + k) + j] = -mass * entry.re;
                matrix[all * j + n + k] = -mass * entry.re;
                cross[n * (n + k) + j] = -mass * entry.eps;
            }
        }
        let held = n + self.rows.len();
        for (i, mass) in (held..).zip(&self.idle) {
            matrix[all * i + i] = *mass;
        }
        let rows = matrix.chunks_exact(all);
        let momenta = rows.map(|row| row.iter().zip(v).map(|(m, v)| m * v).sum()).collect();
        let mut exchanges = vec![0; all];
        if !lu::eliminate(&mut matrix, all, all, &mut exchanges) {
            costate.fill(f64::NAN);
            return Ok(momenta);
        }
        let (y_q, y_p) = costate.split_at_mut(all);
        lu::solve(&matrix, all, &exchanges, y_p, 1);
        for (row, weight) in cross.chunks_exact(n).zip(&*y_p) {
            y_q.iter_mut().zip(row).for_each(|(y, entry)| *y -= weight * entry);
        }
        Ok(momenta)
    }
}
