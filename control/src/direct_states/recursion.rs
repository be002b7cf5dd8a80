//! Riccati's recursion over the nodes.

use super::interval::Interval;
use super::points::{Layout, POINTS};
use crate::numerics::cholesky;
use costate::matrix::{add_scaled, dot};

/// Value functions $\tfrac12 dz^\top P dz + p^\top dz$ of z = (x, T) at the nodes, and feedback.
pub(super) struct Recursion {
    p: Vec<Vec<f64>>,
    p_1: Vec<Vec<f64>>,
    gains: Vec<Vec<f64>>,
    // Hessian and gradient of an interval with what follows; rows of its end; workspaces.
    q: Vec<f64>,
    q_1: Vec<f64>,
    rows: Vec<f64>,
    product: Vec<f64>,
    next: Vec<f64>,
    factor: Vec<f64>,
    column: Vec<f64>,
}

impl Recursion {
    pub fn new(layout: &Layout) -> Self {
        let (z, u) = (layout.n + 1, POINTS * layout.m);
        let y = z + u;
        let most = z.max(u);
        Self {
            p: vec![vec![0.0; z * z]; layout.intervals + 1],
            p_1: vec![vec![0.0; z]; layout.intervals + 1],
            gains: vec![vec![0.0; u * (z + 1)]; layout.intervals],
            q: vec![0.0; y * y],
            q_1: vec![0.0; y],
            rows: vec![0.0; z * y],
            product: vec![0.0; y],
            next: vec![0.0; z],
            factor: vec![0.0; most * most],
            column: vec![0.0; most],
        }
    }

    /// P and p at the start ..
    pub fn start(&mut self) -> (&mut [f64], &mut [f64]) {
        (&mut self.p[0], &mut self.p_1[0])
    }

    /// .. and at the end.
    pub fn end(&mut self) -> (&mut [f64], &mut [f64]) {
        let last = self.gains.len();
        (&mut self.p[last], &mut self.p_1[last])
    }

    /// From the value at the end, which is set, to that at the start. False if the Hessian is not positive
    /// definite.
    pub fn go_back(&mut self, layout: &Layout, intervals: &[Interval]) -> bool {
        intervals.iter().enumerate().rev().all(|(k, interval)| {
            self.add_what_follows(layout, k, interval);
            self.eliminate_controls(layout, k)
        })
    }

    /// Hessian and gradient of interval k by (dx, dT, dU), with the value at its end.
    fn add_what_follows(&mut self, layout: &Layout, k: usize, interval: &Interval) {
        let Self { q, q_1, rows, product, next, .. } = self;
        let (n, z) = (layout.n, layout.n + 1);
        let y = z + POINTS * layout.m;
        q.copy_from_slice(&interval.q);
        q_1.copy_from_slice(&interval.q_1);
        let last = &interval.condensed[(POINTS - 1) * n * (y + 1)..];
        rows.fill(0.0);
        for (a, last) in last.chunks_exact(y + 1).enumerate() {
            rows[a * y..(a + 1) * y].copy_from_slice(&last[..y]);
            next[a] = last[y];
        }
        rows[n * y + n] = 1.0;
        next[n] = 0.0;
        let (p, p_1) = (&self.p[k + 1], &self.p_1[k + 1]);
        for a in 0..z {
            product.fill(0.0);
            (0..z).for_each(|b| add_scaled(product, p[a * z + b], &rows[b * y..(b + 1) * y]));
            let force = dot(&p[a * z..(a + 1) * z], next) + p_1[a];
            for r in 0..y {
                let entry = rows[a * y + r];
                add_scaled(&mut q[r * y..(r + 1) * y], entry, product);
                q_1[r] += entry * force;
            }
        }
    }

    /// Feedback of interval k, and the value at its start.
    fn eliminate_controls(&mut self, layout: &Layout, k: usize) -> bool {
        let Self { q, q_1, factor, column, .. } = self;
        let (z, u) = (layout.n + 1, POINTS * layout.m);
        let y = z + u;
        for r in 0..u {
            factor[r * u..(r + 1) * u].copy_from_slice(&q[(z + r) * y + z..(z + r) * y + y]);
        }
        if !cholesky::factorise(factor, u) {
            return false;
        }
        let (gains, column) = (&mut self.gains[k], &mut column[..u]);
        for c in 0..=z {
            for r in 0..u {
                column[r] = -if c < z { q[(z + r) * y + c] } else { q_1[z + r] };
            }
            cholesky::solve(factor, u, column);
            (0..u).for_each(|r| gains[r * (z + 1) + c] = column[r]);
        }
        let (p, p_1) = (&mut self.p[k], &mut self.p_1[k]);
        for a in 0..z {
            for b in 0..z {
                p[a * z + b] = q[a * y + b];
                (0..u).for_each(|r| p[a * z + b] += q[a * y + z + r] * gains[r * (z + 1) + b]);
            }
            p_1[a] = q_1[a];
            (0..u).for_each(|r| p_1[a] += q[a * y + z + r] * gains[r * (z + 1) + z]);
        }
        for a in 0..z {
            for b in 0..a {
                let mean = 0.5 * (p[a * z + b] + p[b * z + a]);
                (p[a * z + b], p[b * z + a]) = (mean, mean);
            }
        }
        true
    }

    /// The step of the free components of (x, T) at the start; the others stay. False if it is not at a
    /// minimum.
    pub fn first(&mut self, free: &[usize], step: &mut [f64]) -> bool {
        let (count, z) = (free.len(), step.len());
        let (p, p_1) = (&self.p[0], &self.p_1[0]);
        for (r, &a) in free.iter().enumerate() {
            free.iter().enumerate().for_each(|(c, &b)| self.factor[r * count + c] = p[a * z + b]);
            self.column[r] = -p_1[a];
        }
        if !cholesky::factorise(&mut self.factor[..count * count], count) {
            return false;
        }
        cholesky::solve(&self.factor, count, &mut self.column[..count]);
        step.fill(0.0);
        free.iter().zip(&self.column).for_each(|(&a, &value)| step[a] = value);
        true
    }

    /// (dx, dT, dU) of interval k by (dx, dT), which stands in front.
    pub fn controls(&self, k: usize, y_step: &mut [f64]) {
        let z = self.next.len();
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
