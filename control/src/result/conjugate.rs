//! Conjugate times, from the Jacobi fields along an extremal.

use crate::bvp::mesh::Span;
use crate::extremal::Extremal;
use crate::numerics::dormand_prince::{DormandPrince, Stopped};
use crate::numerics::lu;
use crate::result::motion::Certificate;
use crate::solve::Solved;

/// N fields `(dx, dy)' = G (dx, dy)` with dx = 0 and dy = 1 at the start, column by column.
struct Fields {
    states: usize,
    columns: Vec<f64>,
}

impl Fields {
    /// Sign of the determinant of the dx part, which is positive at first: the fields start as
    /// `dx = integral of (...) B R^-1 B' (...)`, a Gramian, times dy.
    fn sign(&self) -> f64 {
        let n = self.states;
        let mut matrix = vec![0.0; n * n];
        for (j, column) in self.columns.chunks_exact(2 * n).enumerate() {
            (0..n).for_each(|i| matrix[i * n + j] = column[i]);
        }
        let mut exchanges = vec![0; n];
        if !lu::eliminate(&mut matrix, n, n, &mut exchanges) {
            return 0.0;
        }
        let swaps = exchanges.iter().enumerate().filter(|&(i, &row)| i != row).count();
        let negative = (0..n).filter(|i| matrix[i * n + i] < 0.0).count();
        if (swaps + negative) % 2 == 0 { 1.0 } else { -1.0 }
    }

    /// Makes the columns orthonormal in scaled components: a change of basis with positive determinant.
    fn orthonormalise(&mut self, scale: &[f64]) {
        let size = 2 * self.states;
        for j in 0..self.states {
            let (done, rest) = self.columns.split_at_mut(j * size);
            let column = &mut rest[..size];
            for other in done.chunks_exact(size) {
                let along = inner(other, column, scale);
                costate::matrix::add_scaled(column, -along, other);
            }
            let length = inner(column, column, scale).sqrt();
            if length > 0.0 {
                column.iter_mut().for_each(|entry| *entry /= length);
            }
        }
    }
}

fn inner(a: &[f64], b: &[f64], scale: &[f64]) -> f64 {
    a.iter().zip(b).zip(scale).map(|((a, b), scale)| a * b / (scale * scale)).sum()
}

impl Solved {
    /// The first conjugate time before T, where fields that vanish at the start vanish together again: the determinant of
    /// their dx part changes its sign (a root of even order is not seen). Only for ends that are fixed
    /// and controls that stay within their bounds.
    pub(crate) fn second_variation<E: Extremal>(&self, extremal: &mut E) -> (Option<f64>, Certificate) {
        let bounded = self.found.arcs.sides.iter().any(Option::is_some) || self.found.excess(extremal) >= 1.0;
        if bounded || !extremal.ends_are_fixed() {
            return (None, Certificate::NotChecked);
        }
        let states = extremal.states();
        let size = 2 * states;
        let mut fields = Fields { states, columns: vec![0.0; size * states] };
        (0..states).for_each(|j| fields.columns[j * size + states + j] = 1.0);
        let durations = self.found.durations(size);
        let scale = &self.found.equations.scale[..size];
        let (mut now, mut seen) = (0.0, false);
        for (k, span) in self.found.equations.mesh.spans.iter().enumerate() {
            let Span::Interval { arc, length } = *span else { continue };
            let h = length * durations[arc];
            let start = fields.columns.clone();
            if self.carry(extremal, k, (0.0, h), &mut fields.columns).is_err() {
                return (None, Certificate::NotChecked);
            }
            let sign = fields.sign();
            seen |= sign > 0.0;
            if sign < 0.0 {
                let time = now + self.locate(extremal, k, h, start);
                return (Some(time), Certificate::NotMinimal);
            }
            fields.orthonormalise(scale);
            now += h;
        }
        if seen { (None, Certificate::LocalMinimum) } else { (None, Certificate::NotChecked) }
    }

    /// Takes fields along a part of an interval.
    fn carry<E: Extremal>(
        &self,
        extremal: &mut E,
        span: usize,
        times: (f64, f64),
        columns: &mut [f64],
    ) -> Result<(), Stopped> {
        let size = 2 * extremal.states();
        let Span::Interval { arc, length } = self.found.equations.mesh.spans[span] else { return Ok(()) };
        let h = length * self.found.durations(size)[arc];
        let law = self.found.arcs.law(arc);
        let (mut w, mut g) = (vec![0.0; self.found.equations.m], vec![0.0; size]);
        let mut jacobian = vec![0.0; size * size];
        let mut integrator = DormandPrince::new(columns.len(), 1e-11);
        integrator.integrate(columns, times, |t, columns, rates| {
            self.found.equations.polynomial(span, t / h, &mut w);
            extremal.linear(&w[..size], law, &mut g, &mut jacobian)?;
            for (column, rate) in columns.chunks_exact(size).zip(rates.chunks_exact_mut(size)) {
                for (rate, row) in rate.iter_mut().zip(jacobian.chunks_exact(size)) {
                    *rate = costate::matrix::dot(row, column);
                }
            }
            Ok(())
        })
    }

    /// Where in an interval of length h the sign changes, the fields at its start given.
    fn locate<E: Extremal>(&self, extremal: &mut E, span: usize, h: f64, start: Vec<f64>) -> f64 {
        let (mut from, mut to) = (0.0, h);
        let mut fields = Fields { states: extremal.states(), columns: start.clone() };
        let mut at_from = start;
        while to - from > 1e-12 * h {
            let middle = 0.5 * (from + to);
            fields.columns.copy_from_slice(&at_from);
            if self.carry(extremal, span, (from, middle), &mut fields.columns).is_err() {
                break;
            }
            if fields.sign() < 0.0 {
                to = middle;
            } else {
                from = middle;
                at_from.copy_from_slice(&fields.columns);
            }
            if to - from <= 1e-10 * h {
                break;
            }
        }
        0.5 * (from + to)
    }
}
