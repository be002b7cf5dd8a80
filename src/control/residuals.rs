//! Residuals of the collocation equations and of the conditions at ends and switches.

use super::collocation::Collocation;
use super::extremal::Extremal;
use super::lobatto::Lobatto;
use super::mesh::Span;
use super::timed::Timed;
use super::values::Values;
use crate::error::EvalError;

impl Collocation {
    /// Residuals from the slopes; with `matrix`, also the conditions at the ends and switches into the matrix.
    pub(super) fn set_residuals<E: Extremal>(
        &mut self,
        timed: &mut Timed<'_, E>,
        values: &Values,
        matrix: bool,
    ) -> Result<(), EvalError> {
        let (m, inner, first, last) = (self.m, self.method.len() - 2, self.at_start, self.mesh.spans.len());
        timed.start(&values.nodes[..m], &mut self.residual[..first], &mut self.conditions[..first * m])?;
        if matrix {
            set_divisors(&mut self.conditions[..first * m], &self.scale, &mut self.divisors[..first]);
            self.matrix.left_mut().copy_from_slice(&self.conditions[..first * m]);
        }
        let (end, rows) = (last * m + first, m - first);
        let conditions = &mut self.conditions[..rows * m];
        timed.end(&values.nodes[last * m..], &mut self.residual[end..], conditions)?;
        if matrix {
            set_divisors(conditions, &self.scale, &mut self.divisors[first..m]);
            self.matrix.right_mut().copy_from_slice(conditions);
        }
        for (r, divisor) in self.divisors[..m].iter().enumerate() {
            let at = if r < first { r } else { end + r - first };
            self.residual[at] /= divisor;
        }
        for (k, span) in self.mesh.spans.iter().enumerate() {
            let (left, right) = values.nodes[k * m..(k + 2) * m].split_at(m);
            let target = &mut self.residual[first + k * m..first + (k + 1) * m];
            match *span {
                Span::Switch { arc } => {
                    for c in 0..m {
                        target[c] = (right[c] - left[c]) / self.scale[c];
                        if matrix {
                            let row = self.matrix.block_row_mut(k, c);
                            row.fill(0.0);
                            (row[c], row[m + c]) = (-1.0, 1.0);
                        }
                    }
                    // In place of the continuity of the duration.
                    let z = timed.z_len();
                    let (value, gradient) = timed.switching(arc, left);
                    if matrix {
                        let row = self.matrix.block_row_mut(k, z);
                        row.fill(0.0);
                        row[..z].copy_from_slice(gradient);
                        set_divisors(&mut row[..m], &self.scale, &mut self.divisors[m + k..m + k + 1]);
                    }
                    target[z] = value / self.divisors[m + k];
                }
                Span::Interval { length, .. } => {
                    let points = Points {
                        slopes: [&self.slopes.nodes[k * m..(k + 1) * m], &self.slopes.nodes[(k + 1) * m..]],
                        inner: &self.slopes.inner[k * inner * m..(k + 1) * inner * m],
                    };
                    for c in 0..m {
                        for j in 0..inner {
                            let at = (k * inner + j) * m + c;
                            let sum = points.sum(&self.method, j + 1, m, c);
                            self.inner_residual[at] =
                                (values.inner[at] - left[c] - length * sum) / self.scale[c];
                        }
                        let sum = points.sum(&self.method, inner + 1, m, c);
                        target[c] = (right[c] - left[c] - length * sum) / self.scale[c];
                    }
                }
            }
        }
        Ok(())
    }
}

/// Slopes at the points of one interval.
struct Points<'a> {
    slopes: [&'a [f64]; 2],
    inner: &'a [f64],
}

impl Points<'_> {
    /// `sum_l a_il g_l` of component c.
    fn sum(&self, method: &Lobatto, i: usize, m: usize, c: usize) -> f64 {
        let s = method.len();
        let row = &method.a[i * s..(i + 1) * s];
        let inner: f64 = (1..s - 1).map(|l| row[l] * self.inner[(l - 1) * m + c]).sum();
        row[0] * self.slopes[0][c] + inner + row[s - 1] * self.slopes[1][c]
    }
}

/// Columns for scaled components, rows divided by their largest entry.
fn set_divisors(rows: &mut [f64], scale: &[f64], divisors: &mut [f64]) {
    for (row, divisor) in rows.chunks_exact_mut(scale.len()).zip(divisors) {
        row.iter_mut().zip(scale).for_each(|(entry, scale)| *entry *= scale);
        let largest = row.iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
        *divisor = if largest > 0.0 { largest } else { 1.0 };
        row.iter_mut().for_each(|entry| *entry /= *divisor);
    }
}
