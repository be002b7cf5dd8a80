//! Elimination of the inner points of one interval.

use crate::bvp::collocation::lobatto::Lobatto;
use crate::numerics::lu;

/// An interval: its length, and the Jacobians of the slopes at its nodes.
#[derive(Clone, Copy)]
pub(crate) struct Interval<'a> {
    pub length: f64,
    pub left: &'a [f64],
    pub right: &'a [f64],
}

/// The linear equations of one interval, those of its inner points solved.
///
/// With G the Jacobians of the slopes, inner corrections `d_j` satisfy
///
/// ```text
/// d_j - h sum_inner a_jl G_l d_l = (1 + h a_j0 G_L) d_L + h a_j,s-1 G_R d_R - r_j
/// ```
///
/// so `d = U_L d_L + U_R d_R + d_0`, and for the nodes there remains
/// `[ -1 - h b_0 G_L - h sum b_l G_l U_L,l ] d_L + ... = -r + h sum b_l G_l d_0,l`.
#[derive(Clone, Debug)]
pub(crate) struct Condensed {
    m: usize,
    inner: usize,
    /// G at the inner points.
    jacobians: Vec<f64>,
    /// `1 - h a G`, factored.
    factors: Vec<f64>,
    exchanges: Vec<usize>,
    /// `[U_L U_R]`, 2m wide.
    ends: Vec<f64>,
    /// `h b_l G_l` of all inner points side by side.
    weighted: Vec<f64>,
}

impl Condensed {
    pub fn new(m: usize, inner: usize) -> Self {
        let size = m * inner;
        Self {
            m,
            inner,
            jacobians: vec![0.0; inner * m * m],
            factors: vec![0.0; size * size],
            exchanges: vec![0; size],
            ends: vec![0.0; size * 2 * m],
            weighted: vec![0.0; m * size],
        }
    }

    /// G at inner point j, to be written before [`condense`](Self::condense).
    pub fn jacobian_mut(&mut self, j: usize) -> &mut [f64] {
        let size = self.m * self.m;
        &mut self.jacobians[j * size..(j + 1) * size]
    }

    /// Eliminates the inner points; writes the remaining rows, m x 2m, into those of the interval. False if
    /// the equations of the inner points are singular.
    pub fn condense(&mut self, method: &Lobatto, interval: Interval<'_>, rows: &mut [f64]) -> bool {
        let Interval { length: h, left, right } = interval;
        let (m, inner, s) = (self.m, self.inner, method.len());
        let (size, width) = (m * inner, 2 * m);
        for j in 0..inner {
            let a = &method.a[(j + 1) * s..(j + 2) * s];
            for c in 0..m {
                let row = &mut self.factors[(j * m + c) * size..(j * m + c + 1) * size];
                for l in 0..inner {
                    let jacobian = &self.jacobians[(l * m + c) * m..(l * m + c + 1) * m];
                    let factor = -h * a[l + 1];
                    let target = &mut row[l * m..(l + 1) * m];
                    target.iter_mut().zip(jacobian).for_each(|(to, from)| *to = factor * from);
                }
                row[j * m + c] += 1.0;
                let ends = &mut self.ends[(j * m + c) * width..(j * m + c + 1) * width];
                for d in 0..m {
                    ends[d] = h * a[0] * left[c * m + d];
                    ends[m + d] = h * a[s - 1] * right[c * m + d];
                }
                ends[c] += 1.0;
            }
        }
        if !lu::eliminate(&mut self.factors, size, size, &mut self.exchanges) {
            return false;
        }
        lu::solve(&self.factors, size, &self.exchanges, &mut self.ends, width);
        let b = method.weights();
        for (c, row) in rows.chunks_exact_mut(width).enumerate() {
            for d in 0..m {
                row[d] = -h * b[0] * left[c * m + d];
                row[m + d] = -h * b[s - 1] * right[c * m + d];
            }
            row[c] -= 1.0;
            row[m + c] += 1.0;
            for l in 0..inner {
                let jacobian = &self.jacobians[(l * m + c) * m..(l * m + c + 1) * m];
                let weighted = &mut self.weighted[c * size + l * m..][..m];
                weighted.iter_mut().zip(jacobian).for_each(|(to, from)| *to = h * b[l + 1] * from);
            }
        }
        lu::subtract_product(rows, width, &self.weighted, size, &self.ends);
        true
    }

    /// Right-hand sides: `inner` from -r to d_0, and what that adds to those of the interval.
    pub fn reduce(&self, method: &Lobatto, h: f64, inner: &mut [f64], interval: &mut [f64]) {
        let m = self.m;
        lu::solve(&self.factors, inner.len(), &self.exchanges, inner, 1);
        for (l, own) in inner.chunks_exact(m).enumerate() {
            let factor = h * method.weights()[l + 1];
            for (c, target) in interval.iter_mut().enumerate() {
                let row = &self.jacobians[(l * m + c) * m..(l * m + c + 1) * m];
                *target += factor * costate::matrix::dot(row, own);
            }
        }
    }

    /// `inner` from d_0 to d, given (d_L, d_R).
    pub fn expand(&self, ends: &[f64], inner: &mut [f64]) {
        for (e, target) in inner.iter_mut().enumerate() {
            *target += costate::matrix::dot(&self.ends[e * 2 * self.m..(e + 1) * 2 * self.m], ends);
        }
    }
}
