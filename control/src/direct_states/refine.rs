//! Estimated errors between the points, and the next mesh.

use super::interior::Interior;
use super::points::{Layout, POINTS};
use super::problem::DirectDynamics;
use crate::bvp::collocation::error::defined;
use crate::constants::{direct as shared, states as constants};
use crate::extremal::dynamics::response::eval_error;
use crate::numerics::lagrange;
use costate::EvalError;
use costate::dynamics::{Cost, Dynamics};

/// What is known between the points.
pub(super) struct Between {
    /// Estimated error of each interval, relative to the sizes of the components.
    pub errors: Vec<f64>,
    /// Largest excess of a limit of x in each interval, relative to these sizes.
    pub excess: Vec<f64>,
    /// What these excesses gain in the cost: with the multipliers of the limits nearby.
    pub gains: Vec<f64>,
}

impl Interior {
    /// x at `s` in [0, 1] of interval k, and dx/ds.
    pub fn state(&self, k: usize, s: f64, x: &mut [f64], slope: &mut [f64]) {
        let places = &self.radau.places;
        let (values, slopes) = (lagrange::values(places, s), lagrange::slopes(places, s));
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
        let values = lagrange::values(&[a, b, c], s);
        for (i, u) in u.iter_mut().enumerate() {
            let at = |j| self.layout.point(k, j) + self.layout.n + i;
            *u = (0..POINTS).map(|j| values[j] * self.w[at(j)]).sum();
            *u = u.max(self.low[at(0)]).min(self.high[at(0)]);
        }
    }

    /// Residuals of the model halfway between the points, times the width; and what limits are exceeded by.
    pub fn between<D: Dynamics<f64>, C>(
        &self,
        task: &mut DirectDynamics<D, C>,
    ) -> Result<Between, EvalError> {
        let Layout { n, m, intervals } = self.layout;
        let (mut x, mut slope, mut u) = (vec![0.0; n], vec![0.0; n], vec![0.0; m]);
        let (sizes, places) = (self.sizes(), self.radau.places);
        let mut between = Between {
            errors: vec![0.0; intervals],
            excess: vec![0.0; intervals],
            gains: vec![0.0; intervals],
        };
        for k in 0..intervals {
            for pair in places.windows(2) {
                let s = 0.5 * (pair[0] + pair[1]);
                self.state(k, s, &mut x, &mut slope);
                self.control(k, s, &mut u);
                let f = task.model.evaluate(&x, &u).map_err(eval_error)?;
                for i in 0..n {
                    let residual = defined(slope[i] - self.widths[k] * self.time() * f[i]);
                    between.errors[k] = between.errors[k].max(residual / sizes[i]);
                    let [low, high] = [task.x_limits[0][i] - x[i], x[i] - task.x_limits[1][i]];
                    between.excess[k] = between.excess[k].max(low.max(high) / sizes[i]);
                    let gain = low.max(0.0) * self.price(&self.z_low, k, i)
                        + high.max(0.0) * self.price(&self.z_high, k, i);
                    between.gains[k] = between.gains[k].max(gain);
                }
            }
        }
        Ok(between)
    }

    /// Multipliers of the limits of component i of x in interval k and those beside it.
    fn price(&self, z: &[f64], k: usize, i: usize) -> f64 {
        let near = k.saturating_sub(1)..(k + 2).min(self.layout.intervals);
        near.flat_map(|k| (0..POINTS).map(move |j| self.layout.point(k, j) + i)).map(|at| z[at]).sum()
    }

    /// Into how many parts each interval is divided for its errors, of x and of the cost, and the limits that
    /// it exceeds.
    pub fn parts(&self, between: &Between, accuracy: f64, cost_error: f64) -> Vec<usize> {
        let share = cost_error / self.widths.len() as f64;
        let of_cost = self.errors_of_cost().into_iter().zip(&between.gains).map(|(error, gain)| error + gain);
        let all = between.errors.iter().zip(&between.excess).zip(of_cost).zip(&self.widths);
        all.map(|(((&error, &excess), of_cost), &width)| {
            let off = (error / accuracy).max(excess / constants::EXCESS).max(of_cost / share);
            if off <= 1.0 || width <= 2.0 * shared::NARROWEST {
                return 1;
            }
            (constants::MORE * off.powf(constants::ORDER)).ceil().clamp(2.0, shared::MOST_PARTS) as usize
        })
        .collect()
    }

    /// The next mesh, with x, u and the multipliers of this one.
    pub fn divided<D: Dynamics<f64>, C: Cost<f64>>(
        &self,
        task: &DirectDynamics<D, C>,
        parts: &[usize],
    ) -> Self {
        let Layout { n, m, .. } = self.layout;
        let (mut widths, mut lambda, mut w) = (Vec::new(), Vec::new(), self.w[..n].to_vec());
        let (mut x, mut slope, mut u) = (vec![0.0; n], vec![0.0; n], vec![0.0; m]);
        for (k, &parts) in parts.iter().enumerate() {
            for part in 0..parts {
                widths.push(self.widths[k] / parts as f64);
                for (place, weight) in self.radau.places[1..].iter().zip(self.radau.weights) {
                    let s = (part as f64 + place) / parts as f64;
                    self.state(k, s, &mut x, &mut slope);
                    self.control(k, s, &mut u);
                    w.extend_from_slice(&x);
                    w.extend_from_slice(&u);
                    lambda.extend((0..n).map(|i| weight * self.costate(k, s, i)));
                }
            }
        }
        w.push(self.time());
        let mut next = Self::new(task, widths, w, true);
        next.lambda = lambda;
        next.nu.copy_from_slice(&self.nu);
        next
    }

    /// Component i of y at `s` in [0, 1] of interval k.
    pub fn costate(&self, k: usize, s: f64, i: usize) -> f64 {
        let [_, a, b, c] = self.radau.places;
        let y = |j: usize| self.lambda[(k * POINTS + j) * self.layout.n + i] / self.radau.weights[j];
        lagrange::values(&[a, b, c], s).into_iter().enumerate().map(|(j, value)| value * y(j)).sum()
    }
}
