//! Powers, and what else is bilinear in rates and torques: functions of one joint or of all.

use super::side::{Limited, Side};
use crate::direct::points::values::Points;
use crate::problem::Problem;
use std::ops::Range;

/// A function of the rates and torques of some joints,
///
/// $$ h = \sum_i (\alpha \tau_i v_i + \beta \tau_i + \gamma v_i) $$
///
/// with the derivatives $h_{v_i} = \alpha \tau_i + \gamma$, $h_{\tau_i} = \alpha v_i + \beta$. Along a motion
/// tau = tau(z), z = (q, v, a), so that
///
/// $$ h_z = h_v + \tau_z^\top h_\tau, \qquad h_{zz} = h_\tau^\top \tau_{zz} + \alpha \sum_i (e_{v_i}
///    \tau_{i,z} + \tau_{i,z}^\top e_{v_i}^\top) $$
#[derive(Clone, Debug, PartialEq)]
struct Function {
    joints: Range<usize>,
    /// alpha: 1 for a power.
    product: f64,
    /// beta.
    torque: f64,
    /// gamma.
    rate: f64,
}

impl Function {
    /// The power of these joints together.
    fn power(joints: Range<usize>) -> Self {
        Self { joints, product: 1.0, torque: 0.0, rate: 0.0 }
    }

    /// tau_i + gamma v_i.
    fn line(joint: usize, rate: f64) -> Self {
        Self { joints: joint..joint + 1, product: 0.0, torque: 1.0, rate }
    }

    fn value(&self, v: &[f64], tau: &[f64]) -> f64 {
        let of = |i: usize| (self.product * v[i] + self.torque) * tau[i] + self.rate * v[i];
        self.joints.clone().map(of).sum()
    }

    /// The derivative by the rate of one of its joints, at constant torque.
    fn by_rate(&self, tau: f64) -> f64 {
        self.product * tau + self.rate
    }

    /// The derivative by the torque of one of its joints.
    fn by_torque(&self, v: f64) -> f64 {
        self.product * v + self.torque
    }
}

/// The functions of a problem, rows h of its points, with their limits: powers of joints and of all of them,
/// torque-speed limits.
#[derive(Clone, Debug, Default)]
pub(crate) struct Powers {
    /// Those of the joints come first if any power is limited or costs: row i is that of joint i.
    functions: Vec<Function>,
    sides: Vec<Side>,
}

impl Powers {
    pub fn new(problem: &Problem) -> Self {
        let n = problem.coordinates();
        let limits = problem.joint_limits();
        let (mut functions, mut sides) = (Vec::new(), Vec::new());
        let total = problem.limits.total_power_max.unwrap_or(f64::INFINITY);
        let limited = limits.iter().any(|limits| limits.power.is_finite());
        if limited || problem.cost.has_energy() {
            functions.extend((0..n).map(|i| Function::power(i..i + 1)));
            for (i, limits) in limits.iter().enumerate() {
                sides.extend(Side::pair(Limited::Power, i, -limits.power, limits.power));
            }
        }
        if total.is_finite() {
            sides.extend(Side::pair(Limited::Power, functions.len(), -total, total));
            functions.push(Function::power(0..n));
        }
        // Where a motor drives forwards, tau + k v <= k v_0 with k = tau_max/(v_0 - v_c); elsewhere that is
        // less than tau_max asks for.
        for (i, limits) in limits.iter().enumerate().filter(|(_, limits)| limits.speeds[1].is_finite()) {
            let [corner, no_load] = limits.speeds;
            for (sign, most) in [(-1.0, limits.torque[1]), (1.0, -limits.torque[0])] {
                if most > 0.0 {
                    let slope = most / (no_load - corner);
                    sides.push(Side {
                        limited: Limited::TorqueSpeed,
                        joint: functions.len(),
                        sign,
                        bound: -sign * slope * no_load,
                        range: limits.torque[1] - limits.torque[0],
                        is_equation: false,
                        is_half: false,
                    });
                    functions.push(Function::line(i, slope));
                }
            }
        }
        Self { functions, sides }
    }

    /// Number of functions.
    pub fn rows(&self) -> usize {
        self.functions.len()
    }

    /// What is limited; `joint` is the row.
    pub fn sides(&self) -> &[Side] {
        &self.sides
    }

    /// The joint of a row; `None` for all of them.
    pub fn joint(&self, row: usize) -> Option<usize> {
        let Range { start, end } = self.functions[row].joints;
        (end - start == 1).then_some(start)
    }

    /// What depends on the rates alone in a function that is linear: a limit on it is one on the torque, less
    /// by so much.
    pub fn line(&self, row: usize, v: &[f64]) -> f64 {
        let Function { joints, rate, .. } = &self.functions[row];
        joints.clone().map(|i| rate * v[i]).sum()
    }

    /// The value of a row at these rates and torques.
    pub fn value(&self, row: usize, v: &[f64], tau: &[f64]) -> f64 {
        self.functions[row].value(v, tau)
    }

    /// Adds `price` times the derivatives of a row by the rates at constant torques, and by the torques.
    pub fn add_price(&self, row: usize, price: f64, v: &[f64], tau: &[f64], [by_v, by_tau]: [&mut [f64]; 2]) {
        let function = &self.functions[row];
        for i in function.joints.clone() {
            by_v[i] += price * function.by_rate(tau[i]);
            by_tau[i] += price * function.by_torque(v[i]);
        }
    }

    /// Largest violation of a limit at these rates and torques, in parts of its range.
    pub fn violation(&self, v: &[f64], tau: &[f64]) -> f64 {
        let of =
            |side: &Side| side.violation(side.sign * (self.functions[side.joint].value(v, tau) - side.bound));
        self.sides.iter().map(of).fold(0.0, f64::max)
    }

    /// By how much powers (W), and torques where motors drive fast (N m, N), exceed their limits most.
    pub fn excesses(&self, v: &[f64], tau: &[f64]) -> [f64; 2] {
        let mut most = [0.0_f64; 2];
        for side in &self.sides {
            let excess = side.sign * (side.bound - self.functions[side.joint].value(v, tau));
            let most = &mut most[usize::from(side.limited == Limited::TorqueSpeed)];
            *most = most.max(excess);
        }
        most
    }

    /// h at all points, from z and the torques.
    pub fn evaluate(&self, points: &mut Points) {
        let (n, rows) = (points.dof, points.powers);
        if self.functions.is_empty() {
            return;
        }
        let states = points.z.chunks_exact(3 * n).zip(points.tau.chunks_exact(n));
        for ((z, tau), h) in states.zip(points.h.chunks_exact_mut(rows)) {
            for (h, function) in h.iter_mut().zip(&self.functions) {
                *h = function.value(&z[n..2 * n], tau);
            }
        }
    }

    /// Adds what the weights of the rows make to those of the torques.
    pub fn weigh_torques(&self, points: &mut Points) {
        let (n, rows) = (points.dof, points.powers);
        if self.functions.is_empty() {
            return;
        }
        let states = points.z.chunks_exact(3 * n).zip(points.weights.chunks_exact_mut(n));
        for ((z, weights), of_rows) in states.zip(points.h_weights.chunks_exact(rows)) {
            for (function, weight) in self.functions.iter().zip(of_rows) {
                function.joints.clone().for_each(|i| weights[i] += weight * function.by_torque(z[n + i]));
            }
        }
    }

    /// h and h_z at contracted points. To the Hessian, which holds the torques with their weights, are added
    /// the products of rates and torques.
    pub fn contract(&self, points: &mut Points) {
        let (n, rows) = (points.dof, points.powers);
        if self.functions.is_empty() {
            return;
        }
        self.evaluate(points);
        let width = 3 * n;
        for p in 0..points.count() {
            let (z, tau) = (&points.z[width * p..][..width], &points.tau[n * p..][..n]);
            let tau_z = &points.tau_z[width * n * p..][..width * n];
            let hessian = &mut points.hessian[width * width * p..][..width * width];
            let weights = &points.h_weights[rows * p..][..rows];
            let h_z = points.h_z[rows * width * p..][..rows * width].chunks_exact_mut(width);
            for ((function, h_z), weight) in self.functions.iter().zip(h_z).zip(weights) {
                h_z.fill(0.0);
                let factor = weight * function.product;
                for i in function.joints.clone() {
                    let (row, by_torque) = (&tau_z[width * i..][..width], function.by_torque(z[n + i]));
                    h_z.iter_mut().zip(row).for_each(|(to, from)| *to += by_torque * from);
                    h_z[n + i] += function.by_rate(tau[i]);
                    for (j, entry) in row.iter().enumerate() {
                        hessian[width * (n + i) + j] += factor * entry;
                        hessian[width * j + n + i] += factor * entry;
                    }
                }
            }
        }
    }

    /// What a row changes by with the torques, at these rates.
    pub fn change(&self, row: usize, v: &[f64], torques: &[f64]) -> f64 {
        let function = &self.functions[row];
        function.joints.clone().map(|i| function.by_torque(v[i]) * torques[i]).sum()
    }

    /// Adds a multiple of what the derivatives of a row by the rates change by with the torques.
    pub fn add_products(&self, row: usize, factor: f64, torques: &[f64], gradient: &mut [f64]) {
        let function = &self.functions[row];
        function.joints.clone().for_each(|i| gradient[i] += factor * function.product * torques[i]);
    }
}

#[cfg(test)]
#[path = "power_tests.rs"]
mod tests;
