//! Cost, defects and their derivatives at the points.

use super::interior::{Interior, Work};
use super::points::{Layout, POINTS};
use super::problem::DirectDynamics;
use crate::bvp::collocation::error::defined;
use crate::direct::Figure;
use crate::extremal::dynamics::response::eval_error;
use costate::EvalError;
use costate::dynamics::{Cost, Dynamics};

impl Interior {
    /// Cost, infeasibility and logarithms at w, or at the trial.
    pub(super) fn figure<D: Dynamics<f64>, C: Cost<f64>>(
        &self,
        task: &mut DirectDynamics<D, C>,
        w: &[f64],
    ) -> Result<Figure, EvalError> {
        let Layout { n, m, .. } = self.layout;
        let time = w[self.layout.time()];
        let mut figure = Figure { cost: task.time_weight() * time, ..Figure::default() };
        for (k, h) in self.widths.iter().enumerate() {
            for j in 0..POINTS {
                let at = self.layout.point(k, j);
                let (x, u) = w[at..at + n + m].split_at(n);
                figure.cost += h * time * self.radau.weights[j] * task.running(x, u)?;
                let f = task.model.evaluate(x, u).map_err(eval_error)?;
                for (i, f) in f.iter().enumerate() {
                    figure.theta += self.radau.defect(&self.layout, w, (k, j), i, h * time * f).abs();
                }
            }
        }
        figure.theta += self.ends.iter().map(|end| end.missed(&self.layout, w).abs()).sum::<f64>();
        let limits = self.low.iter().zip(&self.high).zip(&self.weights);
        for (&w, ((&low, &high), &weight)) in w.iter().zip(limits) {
            if low.is_finite() {
                figure.logarithms += weight * (w - low).ln();
            }
            if high.is_finite() {
                figure.logarithms += weight * (high - w).ln();
            }
        }
        Ok(figure)
    }

    /// Derivatives at the iterate; returns the largest error of stationarity.
    pub(super) fn linearise<D: Dynamics<f64>, C: Cost<f64>>(
        &mut self,
        task: &mut DirectDynamics<D, C>,
    ) -> Result<f64, EvalError> {
        let layout = self.layout;
        let Layout { n, m, .. } = layout;
        let (size, time) = (n + m, self.time());
        let Work { residual, l_1, l_2, f_2, .. } = &mut self.work;
        for ((residual, high), low) in residual.iter_mut().zip(&self.z_high).zip(&self.z_low) {
            *residual = high - low;
        }
        residual[layout.time()] += task.time_weight();
        for k in 0..layout.intervals {
            let h = self.widths[k];
            let interval = &mut self.intervals[k];
            interval.gradient_t = 0.0;
            interval.by_states.fill(0.0);
            for j in 0..POINTS {
                let at = layout.point(k, j);
                let (x, u) = self.w[at..at + size].split_at(n);
                let l = task.running_derivatives(x, u, l_1, l_2)?;
                let lambda = &self.lambda[(k * POINTS + j) * n..][..n];
                let all = task.model.contract(x, u, lambda).map_err(eval_error)?;
                all.hessian(f_2);
                let weight = h * self.radau.weights[j];
                for i in 0..size * size {
                    interval.hessian[j * size * size + i] = weight * time * l_2[i] - h * time * f_2[i];
                }
                interval.gradient_t += weight * l;
                residual[layout.time()] += weight * l;
                for i in 0..size {
                    interval.gradient[j * size + i] = weight * time * l_1[i];
                    interval.cross[j * size + i] = weight * l_1[i];
                    residual[at + i] += weight * time * l_1[i];
                }
                for (i, &y) in lambda.iter().enumerate() {
                    let row = j * n + i;
                    let f = all.first.f[i];
                    interval.defect[row] = self.radau.defect(&layout, &self.w, (k, j), i, h * time * f);
                    residual[layout.node(k) + i] += self.radau.slopes[j][0] * y;
                    for l in 0..POINTS {
                        let slope = self.radau.slopes[j][l + 1];
                        interval.by_states[row * POINTS * n + l * n + i] += slope;
                        residual[layout.point(k, l) + i] += slope * y;
                    }
                    interval.by_time[row] = -h * f;
                    residual[layout.time()] -= h * f * y;
                    for (c, f_x) in all.first.f_x.row(i).iter().enumerate() {
                        interval.by_states[row * POINTS * n + j * n + c] -= h * time * f_x;
                        interval.cross[j * size + c] -= h * y * f_x;
                        residual[at + c] -= h * time * y * f_x;
                    }
                    for (c, f_u) in all.first.f_u.row(i).iter().enumerate() {
                        interval.by_controls[row * m + c] = -h * time * f_u;
                        interval.cross[j * size + n + c] -= h * y * f_u;
                        residual[at + n + c] -= h * time * y * f_u;
                    }
                }
            }
        }
        let last = layout.node(layout.intervals);
        for (end, nu) in self.ends.iter().zip(&self.nu) {
            end.entries().for_each(|(i, c)| residual[last + i] += c * nu);
        }
        // Components that are fixed at the start, and a fixed time, are no unknowns.
        (0..n).filter(|i| !self.free.contains(i)).for_each(|i| residual[i] = 0.0);
        if !self.free.contains(&n) {
            residual[layout.time()] = 0.0;
        }
        Ok(residual.iter().fold(0.0, |most: f64, value| most.max(defined(*value))))
    }

    /// Slope of cost and barrier along the step. The gradient of the points has that of the barrier already.
    pub(super) fn slope<D, C>(&self, task: &DirectDynamics<D, C>) -> f64 {
        let step = &self.work.step;
        let (time, start) = (self.layout.time(), self.layout.point(0, 0));
        let others = (0..start).chain([time]).map(|i| self.barrier(i).1 * step[i]).sum::<f64>();
        let mut slope = others + task.time_weight() * step[time];
        for (k, interval) in self.intervals.iter().enumerate() {
            slope += interval.gradient_t * step[time];
            let first = self.layout.point(k, 0);
            slope += interval.gradient.iter().zip(&step[first..]).map(|(g, step)| g * step).sum::<f64>();
        }
        slope
    }
}
