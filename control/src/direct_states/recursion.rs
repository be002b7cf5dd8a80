//! Riccati's recursion over the nodes.

use super::interval::Interval;
use super::points::{Layout, POINTS};
use costate::matrix::{add_scaled, dot};

/// Value functions $\tfrac12 dz^\top P dz + p^\top dz$ of z = (x, T) at the nodes, and feedback.
pub(super) struct Recursion {
    pub p: Vec<Vec<f64>>,
    pub p_1: Vec<Vec<f64>>,
    gains: Vec<Vec<f64>>,
}

impl Recursion {
    pub fn new(layout: &Layout) -> Self {
        let (z, u) = (layout.n + 1, POINTS * layout.m);
        Self {
            p: vec![vec![0.0; z * z]; layout.intervals + 1],
            p_1: vec![vec![0.0; z]; layout.intervals + 1],
            gains: vec![vec![0.0; u * (z + 1)]; layout.intervals],
        }
    }

    /// From the value at the end, which is set, to that at the start. False if the Hessian is not positive
    /// definite.
    pub fn backward(&mut self, layout: &Layout, intervals: &[Interval]) -> bool {
        let (n, z) = (layout.n, layout.n + 1);
        let y = z + POINTS * layout.m;
        let u = y - z;
        let (mut q, mut q_1) = (vec![0.0; y * y], vec![0.0; y]);
        let (mut rows, mut product, mut next) = (vec![0.0; z * y], vec![0.0; y], vec![0.0; z]);
        for k in (0..layout.intervals).rev() {
            let interval = &intervals[k];
            q.copy_from_slice(&interval.q);
            q_1.copy_from_slice(&interval.q_1);
            let last = &interval.condensed[(POINTS - 1) * n * (y + 1)..];
            rows.fill(0.0);
            for a in 0..n {
                rows[a * y..(a + 1) * y].copy_from_slice(&last[a * (y + 1)..][..y]);
                next[a] = last[a * (y + 1) + y];
            }
            rows[n * y + n] = 1.0;
            next[n] = 0.0;
            let (p, p_1) = (&self.p[k + 1], &self.p_1[k + 1]);
            for a in 0..z {
                product.fill(0.0);
                (0..z).for_each(|b| add_scaled(&mut product, p[a * z + b], &rows[b * y..(b + 1) * y]));
                let force = dot(&p[a * z..(a + 1) * z], &next) + p_1[a];
                for r in 0..y {
                    let entry = rows[a * y + r];
                    add_scaled(&mut q[r * y..(r + 1) * y], entry, &product);
                    q_1[r] += entry * force;
                }
            }
            let mut factor = vec![0.0; u * u];
            for r in 0..u {
                factor[r * u..(r + 1) * u].copy_from_slice(&q[(z + r) * y + z..(z + r) * y + y]);
            }
            if !cholesky(&mut factor, u) {
                return false;
            }
            let gains = &mut self.gains[k];
            let mut column = vec![0.0; u];
            for c in 0..=z {
                for r in 0..u {
                    column[r] = -if c < z { q[(z + r) * y + c] } else { q_1[z + r] };
                }
                solve(&factor, u, &mut column);
                (0..u).for_each(|r| gains[r * (z + 1) + c] = column[r]);
            }
            for a in 0..z {
                for b in 0..z {
                    let mut value = q[a * y + b];
                    (0..u).for_each(|r| value += q[a * y + z + r] * gains[r * (z + 1) + b]);
                    self.p[k][a * z + b] = value;
                }
                let mut value = q_1[a];
                (0..u).for_each(|r| value += q[a * y + z + r] * gains[r * (z + 1) + z]);
                self.p_1[k][a] = value;
            }
            for a in 0..z {
                for b in 0..a {
                    let mean = 0.5 * (self.p[k][a * z + b] + self.p[k][b * z + a]);
                    (self.p[k][a * z + b], self.p[k][b * z + a]) = (mean, mean);
                }
            }
        }
        true
    }

    /// The step of the free components of (x, T) at the start. None if it is not at a minimum.
    pub fn first(&self, free: &[usize], z: usize) -> Option<Vec<f64>> {
        let count = free.len();
        let mut factor: Vec<f64> =
            free.iter().flat_map(|&a| free.iter().map(move |&b| self.p[0][a * z + b])).collect();
        let mut column: Vec<f64> = free.iter().map(|&a| -self.p_1[0][a]).collect();
        if !cholesky(&mut factor, count) {
            return None;
        }
        solve(&factor, count, &mut column);
        let mut step = vec![0.0; z];
        free.iter().zip(column).for_each(|(&a, value)| step[a] = value);
        Some(step)
    }

    /// (dx, dT, dU) of interval k by (dx, dT).
    pub fn controls(&self, k: usize, y_step: &mut [f64], z: usize) {
        let (state, controls) = y_step.split_at_mut(z);
        for (u, row) in controls.iter_mut().zip(self.gains[k].chunks_exact(z + 1)) {
            *u = dot(&row[..z], state) + row[z];
        }
    }

    /// Gradient of what follows by x at node k.
    pub fn gradient(&self, k: usize, step: &[f64], out: &mut [f64]) {
        let z = step.len();
        for (a, out) in out.iter_mut().enumerate() {
            *out = dot(&self.p[k][a * z..(a + 1) * z], step) + self.p_1[k][a];
        }
    }
}

/// A = L L' in place, in the lower triangle. False unless A is positive definite.
fn cholesky(a: &mut [f64], n: usize) -> bool {
    for i in 0..n {
        for j in 0..=i {
            let mut sum = a[i * n + j];
            (0..j).for_each(|k| sum -= a[i * n + k] * a[j * n + k]);
            if i == j {
                let positive = sum > 1e-13 * a[i * n + i].abs() && sum.is_finite();
                if !positive {
                    return false;
                }
                a[i * n + i] = sum.sqrt();
            } else {
                a[i * n + j] = sum / a[j * n + j];
            }
        }
    }
    true
}

/// Solves with the factor of [`cholesky`].
fn solve(a: &[f64], n: usize, b: &mut [f64]) {
    for i in 0..n {
        (0..i).for_each(|k| b[i] -= a[i * n + k] * b[k]);
        b[i] /= a[i * n + i];
    }
    for i in (0..n).rev() {
        (i + 1..n).for_each(|k| b[i] -= a[k * n + i] * b[k]);
        b[i] /= a[i * n + i];
    }
}
