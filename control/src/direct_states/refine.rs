//! Estimated errors between the points, and the next mesh.

use super::interior::Interior;
use super::points::{Layout, POINTS, lagrange};
use super::problem::DirectDynamics;
use crate::extremal::dynamics::response::eval_error;
use costate::EvalError;
use costate::dynamics::Dynamics;

/// Intervals below this part of the whole are not divided.
const NARROWEST: f64 = 1e-5;
/// Most parts of an interval.
const MOST_PARTS: f64 = 4.0;

/// What is known between the points.
pub(super) struct Between {
    /// Estimated error of each interval, relative to the sizes of the components.
    pub errors: Vec<f64>,
    /// Largest excess of a limit.
    pub excess: f64,
}

impl Interior {
    /// x at `s` in [0, 1] of interval k, and dx/ds.
    pub fn state(&self, k: usize, s: f64, x: &mut [f64], slope: &mut [f64]) {
        let (values, slopes) = lagrange(&self.radau.places, s);
        for i in 0..self.layout.n {
            (x[i], slope[i]) = (0.0, 0.0);
            for l in 0..=POINTS {
                let at = if l == 0 { self.layout.node(k) } else { self.layout.point(k, l - 1) };
                x[i] += values[l] * self.w[at + i];
                slope[i] += slopes[l] * self.w[at + i];
            }
        }
    }

    /// u at `s` in [0, 1] of interval k, cut to its limits.
    pub fn control(&self, k: usize, s: f64, u: &mut [f64]) {
        let [_, a, b, c] = self.radau.places;
        let (values, _) = lagrange(&[a, b, c], s);
        for (i, u) in u.iter_mut().enumerate() {
            let at = |j| self.layout.point(k, j) + self.layout.n + i;
            *u = (0..POINTS).map(|j| values[j] * self.w[at(j)]).sum();
            *u = u.max(self.low[at(0)]).min(self.high[at(0)]);
        }
    }

    /// Largest values of the components of x along the motion.
    pub fn sizes(&self) -> Vec<f64> {
        let Layout { n, intervals, .. } = self.layout;
        let mut sizes = vec![1e-3_f64; n];
        for k in 0..=intervals {
            let at = self.layout.node(k);
            sizes.iter_mut().zip(&self.w[at..at + n]).for_each(|(size, x)| *size = size.max(x.abs()));
        }
        sizes
    }

    /// Residuals of the model halfway between the points, times the width; and what limits are exceeded by.
    pub fn between<D: Dynamics<f64>, C>(
        &self,
        task: &mut DirectDynamics<D, C>,
    ) -> Result<Between, EvalError> {
        let Layout { n, m, intervals } = self.layout;
        let (mut x, mut slope, mut u) = (vec![0.0; n], vec![0.0; n], vec![0.0; m]);
        let (sizes, places) = (self.sizes(), self.radau.places);
        let mut between = Between { errors: vec![0.0; intervals], excess: 0.0 };
        for k in 0..intervals {
            for pair in places.windows(2) {
                let s = 0.5 * (pair[0] + pair[1]);
                self.state(k, s, &mut x, &mut slope);
                self.control(k, s, &mut u);
                let f = task.model.evaluate(&x, &u).map_err(eval_error)?;
                for i in 0..n {
                    let residual = (slope[i] - self.widths[k] * self.time() * f[i]).abs();
                    between.errors[k] = between.errors[k].max(residual / sizes[i]);
                    let [low, high] = &task.x_limits;
                    between.excess = between.excess.max(low[i] - x[i]).max(x[i] - high[i]);
                }
            }
        }
        Ok(between)
    }

    /// Widths of the next mesh, and x, u of this one there. None if no interval can be divided.
    pub fn divided(&self, errors: &[f64], tolerance: f64, most: usize) -> Option<(Vec<f64>, Vec<f64>)> {
        let Layout { n, m, .. } = self.layout;
        let mut widths = Vec::new();
        let mut w = self.w[..n].to_vec();
        let (mut x, mut slope, mut u) = (vec![0.0; n], vec![0.0; n], vec![0.0; m]);
        for (k, &error) in errors.iter().enumerate() {
            let parts = if error > tolerance && self.widths[k] > 2.0 * NARROWEST {
                (1.2 * (error / tolerance).powf(0.25)).ceil().clamp(2.0, MOST_PARTS)
            } else {
                1.0
            };
            for part in 0..parts as usize {
                widths.push(self.widths[k] / parts);
                for place in &self.radau.places[1..] {
                    let s = (part as f64 + place) / parts;
                    self.state(k, s, &mut x, &mut slope);
                    self.control(k, s, &mut u);
                    w.extend_from_slice(&x);
                    w.extend_from_slice(&u);
                }
            }
        }
        w.push(self.time());
        (widths.len() > errors.len() && widths.len() <= most).then_some((widths, w))
    }
}
