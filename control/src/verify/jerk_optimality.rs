//! The conditions of first order of motions whose accelerations are continuous.
//!
//! The state is (q, v, a) and the jerk j is the control. With the rates of torques
//! $r = \tau_q v + \tau_v a + \tau_a j$ and
//!
//! $$ L = l + \tfrac12 \sum w j^2 + \tfrac12 \sum z r^2 - \sum \sigma \eta h $$
//!
//! in which h are all limits but those of jerks, the costates are integrals along the motion:
//!
//! $$ \dot\lambda_q = L_q, \qquad \dot\lambda_v = L_v - \lambda_q, \qquad \dot\lambda_a = L_a - \lambda_v $$
//!
//! With $\pi_i = z_i r_i - \sum \sigma \eta_i$ of the rates of torques and $p = \lambda_a - \tau_a^\top \pi$
//! the jerk gains $p^\top j - \tfrac12 \sum w j^2$. So the gap is
//!
//! $$ G = \sum_i \left( \max_{|w| \le j_{\max,i}} g_i(w) - g_i(j_i) \right) + \sum \eta d, \qquad
//!    g_i(w) = p_i w - \tfrac12 w_i w^2 $$
//!
//! Where jerks are neither limited nor cost anything, but rates of torques are or do, these are the controls,
//! with $s = \tau_a^{-\top} (p - w j)$ in the place of p: what a change d of r gains is
//! $s d - \tfrac12 z d^2$. The cost is convex in the jerk, so that both are bounds.
//!
//! Both bounds are made smaller where jerks are the controls, by what is free in them
//! ([`Stages`](super::jerk_gaps::Stages)).

use super::adjoint::{Adjoint, Gaps, INSIDE, Place};
use super::jerk_gaps::{Stage, Stages};
use super::running::Running;
use crate::numerics::lu;
use crate::numerics::radau::System;
use crate::problem::limits::JointLimits;
use costate::EvalError;

/// Whether the controls are known: every jerk is limited or costs something, or every rate of a torque.
pub(crate) fn has_controls(limits: &[JointLimits], running: &Running) -> bool {
    has_jerks(limits, running)
        || (limits.iter().enumerate())
            .all(|(i, limits)| limits.torque_rate.is_finite() || running.torque_rate_weight(i) > 0.0)
}

/// Whether every jerk is limited or costs something: then jerks are the controls.
pub(crate) fn has_jerks(limits: &[JointLimits], running: &Running) -> bool {
    limits.iter().enumerate().all(|(i, limits)| limits.jerk.is_finite() || running.jerk_weight(i) > 0.0)
}

/// The costates of (q, v, a), with jerks as controls, or rates of torques.
pub(super) struct JerkEquations<'a> {
    place: Place<'a>,
    /// Whether every jerk is limited or costs something; else every rate of a torque is or does.
    by_jerks: bool,
    has_rates: bool,
    /// r and pi.
    rates: Vec<f64>,
    weights: Vec<f64>,
    /// The Hessian of pi.tau, and L_z.
    hessian: Vec<f64>,
    by_z: Vec<f64>,
    price: Vec<f64>,
    slack: f64,
    /// Where jerks are the controls, all stages, backwards in time.
    stages: Stages,
}

impl<'a> JerkEquations<'a> {
    pub fn new(place: Place<'a>) -> Self {
        let (n, zeros) = (place.tau.len(), |count: usize| vec![0.0; count]);
        let (limits, running) = (place.limits, &*place.running);
        let by_jerks = has_jerks(limits, running);
        let has_rates =
            running.costs_torque_rates() || limits.iter().any(|limits| limits.torque_rate.is_finite());
        Self {
            by_jerks,
            has_rates,
            rates: zeros(n),
            weights: zeros(n),
            hessian: zeros(if has_rates { 9 * n * n } else { 0 }),
            by_z: zeros(3 * n),
            price: zeros(n),
            slack: 0.0,
            stages: Stages::new(n),
            place,
        }
    }

    /// The motion at a place with L_z.
    fn take(&mut self, x: f64) -> Result<(), EvalError> {
        self.place.take(x)?;
        let n = self.price.len();
        let piece = self.place.piece();
        let Place { dynamics, running, multipliers, number, z, tau, tau_z, prices, .. } = &mut self.place;
        self.slack = prices.slack;
        self.by_z.copy_from_slice(&prices.by_z);
        self.by_z.iter_mut().zip(&running.by_state).for_each(|(to, from)| *to += from);
        for (i, row) in tau_z.chunks_exact(3 * n).enumerate() {
            let price = running.by_torque[i] + prices.by_torque[i];
            self.by_z.iter_mut().zip(row).for_each(|(to, tau_z)| *to += price * tau_z);
        }
        if !self.has_rates {
            return Ok(());
        }
        for (i, row) in tau_z.chunks_exact(3 * n).enumerate() {
            self.rates[i] = row.iter().zip(&z[n..]).map(|(tau_z, z)| tau_z * z).sum();
            self.weights[i] = running.torque_rate_weight(i) * self.rates[i];
        }
        self.slack += multipliers.add_rates(*number, x, &self.rates, &mut self.weights);
        dynamics.contract(piece.phase, z, &self.weights, [tau, tau_z, &mut self.hessian])?;
        for (to, row) in self.by_z.iter_mut().zip(self.hessian.chunks_exact(3 * n)) {
            *to += row.iter().zip(&z[n..]).map(|(second, z)| second * z).sum::<f64>();
        }
        // r = tau_q v + tau_v a + tau_a j depends on v and a themselves, too.
        for (row, weight) in tau_z.chunks_exact(3 * n).zip(&self.weights) {
            self.by_z[n..].iter_mut().zip(row).for_each(|(to, tau_z)| *to += weight * tau_z);
        }
        Ok(())
    }

    /// G with this lambda_a, and the residuals of controls inside their limits; of a stage with this weight.
    fn gap_at(&mut self, x: f64, costate: &[f64], stage: f64) -> f64 {
        let own = costate.len() / 3;
        let (costate, lambda_v) = (&costate[2 * own..], &costate[own..2 * own]);
        let time = self.place.piece().time(x);
        let Place { running, limits, z, tau_z, mass, exchanges, found, number, .. } = &mut self.place;
        let n = self.price.len();
        let jerks = &z[3 * n..];
        self.price.copy_from_slice(costate);
        for (row, weight) in tau_z.chunks_exact(3 * n).zip(&self.weights) {
            self.price.iter_mut().zip(&row[2 * n..]).for_each(|(to, tau_a)| *to -= weight * tau_a);
        }
        if self.by_jerks {
            self.stages.push(Stage {
                piece: *number,
                time,
                weight: stage,
                slack: self.slack,
                prices: self.price.clone(),
                jerks: jerks.to_vec(),
                rates: (0..n).map(|i| self.by_z[2 * n + i] - lambda_v[i]).collect(),
                curvature: match self.has_rates {
                    true => Vec::new(),
                    false => curvature(&running.effort, tau_z, n),
                },
            });
        } else {
            for (i, (price, jerk)) in self.price.iter_mut().zip(jerks).enumerate() {
                *price -= running.jerk_weight(i) * jerk;
            }
            lu::solve(mass, n, exchanges, &mut self.price, 1);
            let largest = found.largest.iter_mut().zip(&self.weights);
            largest.for_each(|(most, weight)| *most = most.max(weight.abs()));
        }
        let mut gap = self.slack;
        for (i, limits) in limits[..n].iter().enumerate() {
            let price = self.price[i];
            // The slope of the gain at the value of the control, less what it costs to change it.
            let (slope, weight, [value, most]) = match self.by_jerks {
                true => {
                    let weight = running.jerk_weight(i);
                    (price - weight * jerks[i], weight, [jerks[i], limits.jerk])
                }
                false => (price, running.torque_rate_weight(i), [self.rates[i], limits.torque_rate]),
            };
            let change = match weight > 0.0 {
                true => slope / weight,
                false => most.copysign(slope) - value,
            };
            // Beyond its limit a control gains what it may not.
            let change = change.clamp(-most - value, most - value);
            if change.is_finite() {
                gap += slope * change - 0.5 * weight * change * change;
            }
            let Gaps { worst, largest, .. } = &mut *found;
            largest[i] = largest[i].max(price.abs()).max((price - slope).abs());
            let is_inside = most.is_infinite() || value.abs() < (1.0 - 2.0 * INSIDE) * most;
            if is_inside && slope.abs() > worst[i].0 {
                worst[i] = (slope.abs(), time);
            }
        }
        gap
    }
}

impl<'a> Adjoint<'a> for JerkEquations<'a> {
    fn place(&mut self) -> &mut Place<'a> {
        &mut self.place
    }

    fn settle(&mut self, gaps: &mut [f64]) {
        let Place { path, limits, running, .. } = &self.place;
        let controls: Vec<[f64; 2]> =
            limits.iter().enumerate().map(|(i, limits)| [limits.jerk, running.jerk_weight(i)]).collect();
        self.stages.settle(&controls, |piece| path.pieces[piece].phase, gaps);
    }
}

/// $\tau_a^\top r \tau_a$, what the cost of torques is curved by in the accelerations; empty without it.
fn curvature(effort: &[f64], tau_z: &[f64], n: usize) -> Vec<f64> {
    let mut found = vec![0.0; if effort.is_empty() { 0 } else { n * n }];
    for (weight, row) in effort.iter().zip(tau_z.chunks_exact(3 * n)) {
        let row = &row[2 * n..];
        for (to, a) in found.chunks_exact_mut(n).zip(row) {
            to.iter_mut().zip(row).for_each(|(to, b)| *to += weight * a * b);
        }
    }
    found
}

impl System for JerkEquations<'_> {
    fn linearise(
        &mut self,
        x: f64,
        costate: &[f64],
        rate: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<(), EvalError> {
        self.take(x)?;
        let (n, h) = (self.price.len(), self.place.piece().length);
        rate.iter_mut().zip(&self.by_z).for_each(|(rate, by_z)| *rate = h * by_z);
        jacobian.fill(0.0);
        for i in n..3 * n {
            rate[i] -= h * costate[i - n];
            jacobian[3 * n * i + i - n] = -h;
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
            self.take(x)?;
            self.place.found.gap += weight * self.gap_at(x, costate, weight);
        }
        Ok(())
    }
}
