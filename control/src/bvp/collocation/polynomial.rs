//! The collocation polynomial.

use crate::bvp::collocation::Collocation;
use crate::bvp::mesh::Span;

impl Collocation {
    /// w at c in [0, 1] of an interval, by the collocation polynomial; slopes must be those of the current values.
    pub fn polynomial(&self, span: usize, c: f64, w: &mut [f64]) {
        let (m, inner) = (self.m, self.method.len() - 2);
        w.copy_from_slice(&self.current.nodes[span * m..(span + 1) * m]);
        if let Span::Interval { length, .. } = self.mesh.spans[span] {
            for j in 0..inner + 2 {
                let slope = match j {
                    0 => &self.slopes.nodes[span * m..(span + 1) * m],
                    j if j == inner + 1 => &self.slopes.nodes[(span + 1) * m..(span + 2) * m],
                    j => &self.slopes.inner[(span * inner + j - 1) * m..(span * inner + j) * m],
                };
                costate::matrix::add_scaled(w, length * self.method.weight(j, c), slope);
            }
        }
    }

    /// The same at a scaled time of an arc.
    pub fn sample(&self, arc: usize, s: f64, w: &mut [f64]) {
        let (mut at, mut found) = (0.0, (0, 0.0));
        for (k, span) in self.mesh.spans.iter().enumerate() {
            if let Span::Interval { arc: of, length } = *span
                && of == arc
            {
                found = (k, ((s - at) / length).min(1.0));
                at += length;
                if at >= s {
                    break;
                }
            }
        }
        self.polynomial(found.0, found.1, w);
    }
}
