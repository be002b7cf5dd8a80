//! The conditions of first order of motions whose torques are the controls: those of
//! [`optimality`](super::optimality).

use super::adjoint::{Adjoint, Gaps, INSIDE, Place};
use crate::numerics::lu;
use crate::numerics::radau::System;
use crate::problem::limits::JointLimits;
use costate::EvalError;

/// The costates of (q, v), with torques as controls.
pub(super) struct TorqueEquations<'a> {
    place: Place<'a>,
    /// tau_a^-1 (tau_q, tau_v), and y.
    solved: Vec<f64>,
    price: Vec<f64>,
}

impl<'a> TorqueEquations<'a> {
    pub fn new(place: Place<'a>) -> Self {
        let n = place.tau.len();
        Self { place, solved: vec![0.0; 2 * n * n], price: vec![0.0; n] }
    }

    /// $y = \tau_a^{-\top} (\lambda_v + \sum \sigma \eta h_a)$; tau_a is symmetric.
    fn take_price(&mut self, costate: &[f64]) {
        let Place { prices, mass, exchanges, .. } = &self.place;
        let n = self.price.len();
        for i in 0..n {
            self.price[i] = costate[n + i] - prices.by_z[2 * n + i];
        }
        lu::solve(mass, n, exchanges, &mut self.price, 1);
    }

    /// The torques that a motor can have at a rate.
    fn range(&self, i: usize, v: f64) -> [f64; 2] {
        let JointLimits { torque: [mut lower, mut upper], power, speeds: [corner, no_load], .. } =
            self.place.limits[i];
        if no_load.is_finite() {
            // Where it drives forwards, tau + k v <= k v_0 with k = tau_max/(v_0 - v_c).
            let of = |most: f64, v: f64| (most * (no_load - v) / (no_load - corner)).min(most);
            (lower, upper) = (
                if lower < 0.0 { -of(-lower, -v) } else { lower },
                if upper > 0.0 { of(upper, v) } else { upper },
            );
        }
        if power.is_finite() && v != 0.0 {
            let most = power / v.abs();
            (lower, upper) = (lower.max(-most), upper.min(most));
        }
        [lower, upper]
    }

    /// G, and the residuals of torques inside their limits.
    fn gap_at(&mut self, x: f64) -> f64 {
        let n = self.price.len();
        let (mut gap, time) = (self.place.prices.slack, self.place.piece().time(x));
        for i in 0..n {
            let (v, tau) = (self.place.z[n + i], self.place.tau[i]);
            let price = self.price[i] - self.place.prices.by_torque[i];
            let [lower, upper] = self.range(i, v);
            let running = &self.place.running;
            if let Some(best) = running.best_torque(i, v, price, [lower, upper]) {
                gap += running.gain_of(i, v, price, best) - running.gain_of(i, v, price, tau);
            }
            let slope = running.by_torque[i];
            let Gaps { worst, largest, .. } = &mut self.place.found;
            largest[i] = largest[i].max(slope.abs()).max(if lower < upper { price.abs() } else { 0.0 });
            let margin = INSIDE * (upper - lower);
            let is_inside = !margin.is_finite() || (lower + margin < tau && tau < upper - margin);
            if lower < upper && is_inside && (price - slope).abs() > worst[i].0 {
                worst[i] = ((price - slope).abs(), time);
            }
        }
        gap
    }
}

impl<'a> Adjoint<'a> for TorqueEquations<'a> {
    fn place(&mut self) -> &mut Place<'a> {
        &mut self.place
    }
}

impl System for TorqueEquations<'_> {
    fn linearise(
        &mut self,
        x: f64,
        costate: &[f64],
        rate: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<(), EvalError> {
        let n = self.price.len();
        self.place.take(x)?;
        let Place { running, prices, tau_z, mass, exchanges, .. } = &self.place;
        let h = self.place.piece().length;
        for (i, row) in tau_z.chunks_exact(3 * n).enumerate() {
            self.solved[2 * n * i..2 * n * (i + 1)].copy_from_slice(&row[..2 * n]);
        }
        lu::solve(mass, n, exchanges, &mut self.solved, 2 * n);
        jacobian.fill(0.0);
        let (by_z, by_state) = (&prices.by_z, &running.by_state);
        for i in 0..2 * n {
            rate[i] = h * (by_state[i] + by_z[i]);
            for j in 0..n {
                let entry = h * self.solved[2 * n * j + i];
                jacobian[2 * n * i + n + j] = entry;
                rate[i] += entry * (costate[n + j] - by_z[2 * n + j]);
            }
        }
        for i in 0..n {
            jacobian[2 * n * (n + i) + i] = -h;
            rate[n + i] -= h * costate[i];
        }
        Ok(())
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn stops(&mut self) -> bool {
        (self.place.stops)()
    }

    fn accept(&mut self, from: f64, length: f64, stages: [&[f64]; 3]) -> Result<(), EvalError> {
        for ([x, weight], costate) in self.place.stages(from, length).zip(stages) {
            self.place.take(x)?;
            self.take_price(costate);
            self.place.found.gap += weight * self.gap_at(x);
        }
        Ok(())
    }
}
