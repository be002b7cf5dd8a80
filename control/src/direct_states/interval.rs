//! The derivatives of one interval, and its condensation to the unknowns of its node, T and its controls.

use super::points::{Layout, POINTS, Radau};
use crate::numerics::lu;
use costate::matrix::{add_scaled, dot};

/// Values and derivatives of an interval; matrices row by row.
#[derive(Clone)]
pub(super) struct Interval {
    /// Defects, 3n.
    pub defect: Vec<f64>,
    /// Gradient of the cost at the points, and by T; barrier included.
    pub gradient: Vec<f64>,
    pub gradient_t: f64,
    /// Hessian of the Lagrange function at each point, (n + m)^2, and its cross terms with T.
    pub hessian: Vec<f64>,
    pub cross: Vec<f64>,
    /// Defects by the states at the points, 3n x 3n, and by the controls, 3 blocks n x m, and by T.
    pub by_states: Vec<f64>,
    pub by_controls: Vec<f64>,
    pub by_time: Vec<f64>,
    /// Inverse of `by_states`.
    pub inverse: Vec<f64>,
    /// dX by (dx, dT, dU, 1).
    pub condensed: Vec<f64>,
    /// Hessian and gradient by (dx, dT, dU).
    pub q: Vec<f64>,
    pub q_1: Vec<f64>,
}

/// What condensing an interval needs besides.
pub(super) struct Scratch {
    lu: Vec<f64>,
    exchanges: Vec<usize>,
    rows: Vec<f64>,
    product: Vec<f64>,
}

impl Scratch {
    pub fn new(n: usize, m: usize) -> Self {
        let (c, w, y) = (POINTS * n, n + m, n + 1 + POINTS * m);
        let zeros = |count| vec![0.0; count];
        Self {
            lu: zeros(c * c),
            exchanges: vec![0; c],
            rows: zeros(w * (y + 1)),
            product: zeros(w * (y + 1)),
        }
    }
}

impl Interval {
    pub fn new(n: usize, m: usize) -> Self {
        let (c, w, y) = (POINTS * n, n + m, n + 1 + POINTS * m);
        let zeros = |count| vec![0.0; count];
        Self {
            defect: zeros(c),
            gradient: zeros(POINTS * w),
            gradient_t: 0.0,
            hessian: zeros(POINTS * w * w),
            cross: zeros(POINTS * w),
            by_states: zeros(c * c),
            by_controls: zeros(c * m),
            by_time: zeros(c),
            inverse: zeros(c * c),
            condensed: zeros(c * (y + 1)),
            q: zeros(y * y),
            q_1: zeros(y),
        }
    }

    /// Solves the defects for the states at the points. False if they do not determine them.
    pub fn eliminate(&mut self, layout: &Layout, radau: &Radau, scratch: &mut Scratch) -> bool {
        let (n, m) = (layout.n, layout.m);
        let (c, y) = (POINTS * n, n + 1 + POINTS * m);
        let Scratch { lu, exchanges, .. } = scratch;
        lu.copy_from_slice(&self.by_states);
        self.inverse.fill(0.0);
        (0..c).for_each(|i| self.inverse[i * c + i] = 1.0);
        if !lu::eliminate(lu, c, c, exchanges) {
            return false;
        }
        lu::follow(lu, c, c, exchanges, &mut self.inverse, c);
        lu::substitute(lu, c, c, &mut self.inverse, c);
        self.condensed.fill(0.0);
        for (row, inverse) in self.condensed.chunks_exact_mut(y + 1).zip(self.inverse.chunks_exact(c)) {
            for (i, &part) in inverse.iter().enumerate() {
                let (j, component) = (i / n, i % n);
                row[component] -= part * radau.slopes[j][0];
                row[n] -= part * self.by_time[i];
                row[y] -= part * self.defect[i];
                let first = n + 1 + j * m;
                add_scaled(&mut row[first..first + m], -part, &self.by_controls[i * m..(i + 1) * m]);
            }
        }
        true
    }

    /// What dX is for other defects.
    pub fn change_defects(&mut self, layout: &Layout) {
        let (c, y) = (POINTS * layout.n, layout.n + 1 + POINTS * layout.m);
        for (row, inverse) in self.condensed.chunks_exact_mut(y + 1).zip(self.inverse.chunks_exact(c)) {
            row[y] = -dot(inverse, &self.defect);
        }
    }

    /// Hessian and gradient by (dx, dT, dU), with this much added to the diagonal of that at the points.
    pub fn condense(&mut self, layout: &Layout, damping: f64, scratch: &mut Scratch) {
        let (n, m) = (layout.n, layout.m);
        let (w, y) = (n + m, n + 1 + POINTS * m);
        let Scratch { rows, product, .. } = scratch;
        self.q.fill(0.0);
        self.q_1.fill(0.0);
        for j in 0..POINTS {
            rows.fill(0.0);
            rows[..n * (y + 1)].copy_from_slice(&self.condensed[j * n * (y + 1)..(j + 1) * n * (y + 1)]);
            (0..m).for_each(|i| rows[(n + i) * (y + 1) + n + 1 + j * m + i] = 1.0);
            let (hessian, cross) = (&self.hessian[j * w * w..], &self.cross[j * w..(j + 1) * w]);
            product.fill(0.0);
            for a in 0..w {
                let out = &mut product[a * (y + 1)..(a + 1) * (y + 1)];
                for b in 0..w {
                    let value = hessian[a * w + b] + if a == b { damping } else { 0.0 };
                    add_scaled(out, value, &rows[b * (y + 1)..(b + 1) * (y + 1)]);
                }
                out[n] += cross[a];
                out[y] += self.gradient[j * w + a];
            }
            for a in 0..w {
                let (row, out) = (&rows[a * (y + 1)..], &product[a * (y + 1)..]);
                for (r, &value) in row[..y].iter().enumerate() {
                    add_scaled(&mut self.q[r * y..(r + 1) * y], value, &out[..y]);
                    self.q_1[r] += value * out[y];
                }
                // The cross terms of T with what the states do.
                add_scaled(&mut self.q[n * y..(n + 1) * y], cross[a], &row[..y]);
                self.q_1[n] += cross[a] * row[y];
            }
        }
        self.q_1[n] += self.gradient_t;
    }

    /// dX of the points by (dx, dT, dU), to steps of (x, u) at the points.
    pub fn expand(&self, layout: &Layout, y_step: &[f64], steps: &mut [f64]) {
        let (n, w, y) = (layout.n, layout.n + layout.m, y_step.len());
        for (i, row) in self.condensed.chunks_exact(y + 1).enumerate() {
            steps[(i / n) * w + i % n] = dot(&row[..y], y_step) + row[y];
        }
        for j in 0..POINTS {
            let first = n + 1 + j * layout.m;
            steps[j * w + n..(j + 1) * w].copy_from_slice(&y_step[first..first + layout.m]);
        }
    }

    /// New multipliers of the defects, with the gradient of what follows by the state at the end.
    pub fn multipliers(
        &self,
        layout: &Layout,
        steps: &[f64],
        dt: f64,
        damping: f64,
        after: &[f64],
        out: &mut [f64],
    ) {
        let (n, w) = (layout.n, layout.n + layout.m);
        let c = POINTS * n;
        out.fill(0.0);
        for j in 0..POINTS {
            let step = &steps[j * w..(j + 1) * w];
            for a in 0..n {
                let row = &self.hessian[(j * w + a) * w..][..w];
                let mut force = dot(row, step) + damping * step[a];
                force += self.cross[j * w + a] * dt + self.gradient[j * w + a];
                if j + 1 == POINTS {
                    force += after[a];
                }
                add_scaled(out, -force, &self.inverse[(j * n + a) * c..][..c]);
            }
        }
    }
}
