//! The heights of the feet that swing, along the motion.

use super::{GaitRows, pairs};
use crate::direct::points::values::Points;
use costate::EvalError;

impl GaitRows {
    /// The heights of the points of feet that swing above their parabolas, at the position q of the joints.
    ///
    /// # Errors
    /// A position that cannot be evaluated.
    pub fn heights(&mut self, q: &[f64], heights: &mut [f64]) -> Result<(), EvalError> {
        let q = &q[..self.rest.len()];
        self.swing.set_position(q)?;
        self.foot.set_position(q)?;
        let [h, length] = self.arch;
        for (i, height) in heights.iter_mut().enumerate() {
            let part = self.distance(i) / length;
            *height = self.swing.values()[2 * i + 1] - h * (1.0 - part * part);
        }
        Ok(())
    }

    /// x of a point that swings from the one whose place it takes.
    fn distance(&self, i: usize) -> f64 {
        self.swing.values()[2 * i] - self.foot.values()[2 * i]
    }

    /// The same in the rows of the points from `first` on, with derivatives; second ones are added to those
    /// of the points.
    ///
    /// # Errors
    /// As [`heights`](Self::heights).
    pub fn contract_heights(&mut self, points: &mut Points, first: usize) -> Result<(), EvalError> {
        let (n, all, rows, count) = (self.rest.len(), points.dof, points.rows, self.heights.len());
        let [h, length] = self.arch;
        let bend = 2.0 * h / (length * length);
        for p in 0..points.count() {
            let own = rows * p + first;
            self.heights(&points.z[3 * all * p..][..n], &mut points.g[own..own + count])?;
            let hessian = &mut points.hessian[9 * all * all * p..][..9 * all * all];
            for i in 0..count {
                let (weight, slope) = (points.g_weights[own + i], bend * self.distance(i));
                (self.of_swing[2 * i], self.of_swing[2 * i + 1]) = (weight * slope, weight);
                self.of_foot[2 * i] = -weight * slope;
                let [swing, foot] = [self.swing.jacobian(), self.foot.jacobian()];
                let along = |a: usize| swing[(2 * i, a)] - foot[(2 * i, a)];
                let g_x = &mut points.g_x[2 * all * (own + i)..][..2 * all];
                g_x.fill(0.0);
                for a in 0..n {
                    g_x[a] = swing[(2 * i + 1, a)] + slope * along(a);
                    for b in 0..n {
                        hessian[3 * all * a + b] += weight * bend * along(a) * along(b);
                    }
                }
            }
            let [swing, foot] = [self.swing.hessian(&self.of_swing)?, self.foot.hessian(&self.of_foot)?];
            for (a, b) in pairs(n) {
                hessian[3 * all * a + b] += swing[(a, b)] + foot[(a, b)];
            }
        }
        Ok(())
    }
}
