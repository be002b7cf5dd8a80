//! Residuals of the collocation equations.

use crate::bvp::collocation::Collocation;
use crate::bvp::collocation::lobatto::Lobatto;
use crate::bvp::mesh::Span;
use crate::bvp::timed::Timed;
use crate::bvp::values::Values;
use crate::extremal::Extremal;
use costate::EvalError;

impl Collocation {
    /// Residuals from the slopes; with `matrix`, also the conditions at the ends and switches into the
    /// matrix.
    pub(crate) fn set_residuals<E: Extremal + ?Sized>(
        &mut self,
        timed: &mut Timed<'_, E>,
        values: &Values,
        matrix: bool,
    ) -> Result<(), EvalError> {
        let (m, inner) = (self.m, self.method.len() - 2);
        self.borders.set(timed, &self.mesh, &values.nodes, &self.scale, matrix)?;
        for (k, span) in self.mesh.spans.iter().enumerate() {
            let Span::Interval { length, .. } = *span else { continue };
            let (left, right) = values.nodes[k * m..(k + 2) * m].split_at(m);
            let rows = self.borders.row(k)..self.borders.row(k + 1);
            let target = &mut self.borders.residual[rows];
            let points = Points {
                slopes: [&self.slopes.nodes[k * m..(k + 1) * m], &self.slopes.nodes[(k + 1) * m..]],
                inner: &self.slopes.inner[k * inner * m..(k + 1) * inner * m],
            };
            for c in 0..m {
                for j in 0..inner {
                    let at = (k * inner + j) * m + c;
                    let sum = points.sum(self.method, j + 1, m, c);
                    self.inner_residual[at] = (values.inner[at] - left[c] - length * sum) / self.scale[c];
                }
                let sum = points.sum(self.method, inner + 1, m, c);
                target[c] = (right[c] - left[c] - length * sum) / self.scale[c];
            }
        }
        Ok(())
    }

    /// The largest residual in each span at the last evaluation, relative to the scales.
    pub(crate) fn defects(&self) -> Vec<f64> {
        let (m, inner) = (self.m, self.method.len() - 2);
        let size = |residuals: &[f64]| residuals.iter().fold(0.0_f64, |largest, r| largest.max(r.abs()));
        let of_span = |k: usize| {
            let rows = self.borders.row(k)..self.borders.row(k + 1);
            size(&self.borders.residual[rows])
                .max(size(&self.inner_residual[k * inner * m..(k + 1) * inner * m]))
        };
        (0..self.mesh.spans.len()).map(of_span).collect()
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
