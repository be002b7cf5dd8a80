//! Transition matrices of linear equations `z' = G(t) z` by collocation.
//!
//! On an interval they are what is left of the equations of Lobatto's collocation (order 6) after its inner
//! points are eliminated: `[L R] (z_0, z_1) = 0`, so `z_1 = -R^{-1} L z_0`. The difference of the transition
//! over both halves to that over the whole is about 63 times the error of the former.

use crate::bvp::collocation::condensed::{Condensed, Interval};
use crate::bvp::collocation::lobatto::Lobatto;
use crate::bvp::collocation::to_scaled;
use crate::numerics::lu;
use crate::result::jacobi_fields::Undecided;
use costate::EvalError;
use nalgebra::DMatrix;
use std::ops::Range;

/// Points of the method: two inner ones.
const POINTS: usize = 4;

/// Buffers for systems of one size.
pub(crate) struct Collocated {
    method: &'static Lobatto,
    condensed: Condensed,
    /// Of each component: equations are solved in parts of it.
    scale: Vec<f64>,
    /// G at both ends of an interval and in its middle.
    nodes: [Vec<f64>; 3],
    rows: Vec<f64>,
    left: Vec<f64>,
    right: Vec<f64>,
    exchanges: Vec<usize>,
}

impl Collocated {
    /// For components of these sizes.
    pub fn new(scale: &[f64]) -> Self {
        let m = scale.len();
        let square = || vec![0.0; m * m];
        Self {
            method: Lobatto::of(POINTS),
            condensed: Condensed::new(m, POINTS - 2),
            scale: scale.to_vec(),
            nodes: [square(), square(), square()],
            rows: vec![0.0; 2 * m * m],
            left: square(),
            right: square(),
            exchanges: vec![0; m],
        }
    }

    /// The transition matrix over a time (s), on both halves and on the whole. `jacobian` writes G(t), row by
    /// row.
    ///
    /// # Errors
    /// G cannot be evaluated, or the equations are singular.
    pub fn transitions(
        &mut self,
        time: Range<f64>,
        mut jacobian: impl FnMut(f64, &mut [f64]) -> Result<(), EvalError>,
    ) -> Result<[DMatrix<f64>; 2], Undecided> {
        let Range { start: from, end: to } = time;
        let middle = 0.5 * (from + to);
        let scale = &self.scale;
        let mut scaled = |t: f64, target: &mut [f64]| {
            jacobian(t, target).map_err(|_| Undecided)?;
            to_scaled(target, scale);
            Ok(())
        };
        for (t, node) in [from, middle, to].into_iter().zip(&mut self.nodes) {
            scaled(t, node)?;
        }
        let [first, half, last] = &self.nodes;
        let mut over = |from: f64, to: f64, left: &[f64], right: &[f64]| {
            for j in 0..POINTS - 2 {
                let t = from + (to - from) * self.method.points[j + 1];
                scaled(t, self.condensed.jacobian_mut(j))?;
            }
            let interval = Interval { length: to - from, left, right };
            if !self.condensed.condense(self.method, interval, &mut self.rows) {
                return Err(Undecided);
            }
            let m = scale.len();
            for (i, row) in self.rows.chunks_exact(2 * m).enumerate() {
                self.left[m * i..][..m].iter_mut().zip(row).for_each(|(to, from)| *to = -from);
                self.right[m * i..][..m].copy_from_slice(&row[m..]);
            }
            if !lu::eliminate(&mut self.right, m, m, &mut self.exchanges) {
                return Err(Undecided);
            }
            lu::solve(&self.right, m, &self.exchanges, &mut self.left, m);
            Ok(DMatrix::from_fn(m, m, |i, j| self.left[m * i + j] * scale[i] / scale[j]))
        };
        let whole = over(from, to, first, last)?;
        let halves = over(middle, to, half, last)? * over(from, middle, first, half)?;
        Ok([halves, whole])
    }
}

#[cfg(test)]
mod tests {
    use super::Collocated;
    use nalgebra::DMatrix;

    /// `x'' = -k x` over h, with a scale that is far from 1.
    #[test]
    fn the_transition_of_an_oscillator() {
        let (k, scale) = (4.0_f64, [1e-3, 20.0]);
        let error = |h: f64| {
            let found = Collocated::new(&scale).transitions(0.0..h, |_, g| {
                g.copy_from_slice(&[0.0, 1.0, -k, 0.0]);
                Ok(())
            });
            let (sin, cos) = (k.sqrt() * h).sin_cos();
            let exact = DMatrix::from_row_slice(2, 2, &[cos, sin / k.sqrt(), -sin * k.sqrt(), cos]);
            let Ok([fine, rough]) = found else { panic!("singular") };
            ((&fine - &exact).amax(), (&rough - &fine).amax())
        };
        let (real, shown) = error(0.4);
        // Order 6 in both: an eighth of 2^6 is left for terms of higher order.
        assert!(real < shown / 50.0 && real > shown / 80.0, "{real} {shown}");
        let (finer, _) = error(0.2);
        assert!((real / finer).log2() > 6.5, "{real} {finer}");
    }

    /// `x'' = t x`: the Wronskian of two solutions is constant, and two steps are one.
    #[test]
    fn an_equation_that_changes_with_time() {
        let airy = |t: f64, g: &mut [f64]| {
            g.copy_from_slice(&[0.0, 1.0, t, 0.0]);
            Ok(())
        };
        let mut collocated = Collocated::new(&[1.0, 1.0]);
        let mut over = |from: f64, to: f64| match collocated.transitions(from..to, airy) {
            Ok([fine, _]) => fine,
            Err(_) => panic!("singular"),
        };
        let whole = over(1.0, 1.5);
        let parts = over(1.25, 1.5) * over(1.0, 1.25);
        assert!((&whole - &parts).amax() < 1e-7, "{whole} {parts}");
        assert!((whole.determinant() - 1.0).abs() < 1e-7);
        // Ai and its slope, of Abramowitz and Stegun, table 10.11.
        let at = |t: f64| match t {
            1.0 => [0.135_292_416_3, -0.159_147_441_3],
            _ => [0.071_749_497_0, -0.097_382_012_5],
        };
        let start = nalgebra::DVector::from_row_slice(&at(1.0));
        let end = &whole * start;
        assert!((end[0] - at(1.5)[0]).abs() < 1e-7 && (end[1] - at(1.5)[1]).abs() < 1e-7, "{end}");
    }
}
