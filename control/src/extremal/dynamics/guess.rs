//! A first guess for the extremals of any model.

use crate::extremal::dynamics::DynamicsExtremal;
use crate::numerics::lu;
use costate::dynamics::{Cost, Dynamics};
use costate::matrix::{Block, dot};

impl<D: Dynamics<f64>, C: Cost<f64>> DynamicsExtremal<D, C> {
    /// z on the straight line between the ends at s = t/T. Controls follow the line in the sense of least
    /// squares, and the costate is the smallest one that gives these controls: `f_u'y = R u`. Zero costates
    /// where `f_u` lacks rank.
    pub(crate) fn straight_line(&mut self, s: f64, z: &mut [f64]) {
        let (from, to, time) = (&self.problem.start.x, &self.problem.end.x, self.problem.time.value());
        z.fill(0.0);
        let (x, y) = z.split_at_mut(from.len());
        for (x, (from, to)) in x.iter_mut().zip(from.iter().zip(to)) {
            *x = from + s * (to - from);
        }
        self.u.fill(0.0);
        let Ok(first) = self.model.linearise(x, &self.u) else { return };
        let excess = from.iter().zip(to).zip(first.f).map(|((from, to), f)| (to - from) / time - f);
        let excess: Vec<f64> = excess.collect();
        let Some(controls) = least_squares(first.f_u, &transposed_product(first.f_u, &excess)) else {
            return;
        };
        let efforts: Vec<f64> =
            controls.iter().zip(&self.problem.cost.effort).map(|(u, weight)| weight * u).collect();
        let Some(factors) = least_squares(first.f_u, &efforts) else { return };
        for (y, row) in y.iter_mut().zip(first.f_u.iter_rows()) {
            *y = dot(row, &factors);
        }
    }
}

/// `A'd`.
fn transposed_product(a: Block<'_, f64>, d: &[f64]) -> Vec<f64> {
    let columns = a.iter_rows().next().map_or(0, <[f64]>::len);
    (0..columns).map(|i| a.iter_rows().zip(d).map(|(row, d)| row[i] * d).sum()).collect()
}

/// `(A'A)^-1 b`; `None` where A lacks rank.
fn least_squares(a: Block<'_, f64>, b: &[f64]) -> Option<Vec<f64>> {
    let n = b.len();
    let mut normal = vec![0.0; n * n];
    for row in a.iter_rows() {
        for (i, &left) in row.iter().enumerate() {
            costate::matrix::add_scaled(&mut normal[i * n..(i + 1) * n], left, row);
        }
    }
    let (mut exchanges, mut solution) = (vec![0; n], b.to_vec());
    if !lu::eliminate(&mut normal, n, n, &mut exchanges) {
        return None;
    }
    lu::solve(&normal, n, &exchanges, &mut solution, 1);
    solution.iter().all(|value| value.is_finite()).then_some(solution)
}
