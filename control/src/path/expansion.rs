//! The gradient and the second derivatives of the cost of a path.

use super::band::Band;
use super::coefficients::Unknowns;
use super::objective::{Objective, Point};
use super::spline::ACTIVE;
use costate::EvalError;

/// J and its derivatives; T enters as log T, the last unknown where it is free.
#[derive(Clone, Debug)]
pub(crate) struct Expansion {
    pub value: f64,
    pub gradient: Vec<f64>,
    pub hessian: Band,
    /// The last row of the Hessian: unknowns, then the diagonal entry.
    pub border: Vec<f64>,
}

impl Objective {
    /// A workspace for an expansion.
    pub fn expansion(&self) -> Expansion {
        let count = self.coefficients.count;
        Expansion {
            value: 0.0,
            gradient: vec![0.0; count + 1],
            hessian: Band::zeros(count, (5 * self.joints()).min(count)),
            border: vec![0.0; count + 1],
        }
    }

    /// L, dL/dz and d2L/dzdz at z. With `exact` the Hessian includes second derivatives of tau; without them
    /// it is positive semidefinite (Gauss-Newton).
    fn expand_point(&mut self, exact: bool) -> Result<f64, EvalError> {
        let n = self.joints();
        let (q, rest) = self.z[0].split_at(n);
        let (v, a) = rest.split_at(n);
        let width = 3 * n;
        self.first.fill(0.0);
        self.second.fill(0.0);
        let mut value = 0.0;
        let jacobian = self.dynamics.first().linearise_inverse_dynamics(q, v, a)?;
        for i in 0..n {
            let gain = self.gain[i];
            let cost = self.controls[i].at(jacobian.tau[i] / gain);
            value += cost.value;
            let (pull, curvature) = (cost.first / gain, cost.second / (gain * gain));
            self.pull[i] = pull;
            let row = |r: usize| match r / n {
                0 => jacobian.tau_q[(i, r)],
                1 => jacobian.tau_v[(i, r - n)],
                _ => jacobian.tau_a[(i, r - 2 * n)],
            };
            for r in 0..width {
                let entry = row(r);
                self.first[r] += pull * entry;
                let scaled = curvature * entry;
                for c in 0..=r {
                    self.second[r * width + c] += scaled * row(c);
                }
            }
            for (at, term) in [(i, self.penalties.position(i, q[i])), (n + i, self.penalties.rate(i, v[i]))] {
                value += term.value;
                self.first[at] += term.first;
                self.second[at * width + at] += term.second;
            }
        }
        if self.terms.any() {
            if exact {
                self.terms.second(q, v)
            } else {
                self.terms.first(q, v)
            }
            value += self.terms.value;
            for r in 0..2 * n {
                self.first[r] += self.terms.gradient[r];
                for c in 0..=r {
                    self.second[r * width + c] += if exact { self.terms.hessian[(r, c)] } else { 0.0 };
                }
            }
        }
        if exact {
            let hessian = self.dynamics.contract_inverse_dynamics(q, v, a, &self.pull)?.zz();
            for r in 0..width {
                for c in 0..=r {
                    self.second[r * width + c] += hessian[(r, c)];
                }
            }
        }
        for r in 0..width {
            for c in 0..r {
                self.second[c * width + r] = self.second[r * width + c];
            }
        }
        Ok(value)
    }

    /// J and its derivatives in theta and log T.
    pub fn expand(&mut self, at: &Unknowns, exact: bool, target: &mut Expansion) -> Result<(), EvalError> {
        let (n, count, time) = (self.joints(), self.coefficients.count, at.time);
        target.gradient.fill(0.0);
        target.border.fill(0.0);
        target.hessian.clear();
        let (mut total, mut first_t, mut second_t) = (0.0, 0.0, 0.0);
        for point in 0..self.points.len() {
            let Point { interval, weight, basis } = self.points[point];
            self.path(interval, &basis, &at.theta, time);
            let l = self.expand_point(exact)?;
            total += weight * l;
            self.add_unknowns(&Point { interval, weight, basis }, time, target);
            let [_, z_t, z_tt] = &self.z;
            let width = 3 * n;
            let l_t: f64 = (0..width).map(|r| self.first[r] * z_t[r]).sum();
            let mut curved = 0.0;
            for r in 0..width {
                let row = &self.second[r * width..(r + 1) * width];
                curved += z_t[r] * costate::matrix::dot(row, z_t) + self.first[r] * z_tt[r];
            }
            first_t += weight * (l + time * l_t);
            second_t += weight * (2.0 * l_t + time * curved);
        }
        first_t += self.time_cost;
        target.value = time * (self.time_cost + total);
        if self.time_is_free {
            target.gradient[count] = time * first_t;
            target.border[count] = time * (first_t + time * second_t);
        }
        Ok(())
    }

    /// Adds the derivatives at one point in the unknowns: with `z_theta = B^(o) T^-o`.
    fn add_unknowns(&mut self, point: &Point, time: f64, target: &mut Expansion) {
        let Point { interval, weight, basis } = *point;
        let (n, width) = (self.joints(), 3 * self.joints());
        let powers = [1.0, 1.0 / time, 1.0 / (time * time)];
        let factor = |order: usize, k: usize| basis[order][k] * powers[order];
        for k in 0..ACTIVE {
            for j in 0..n {
                let Some(row) = self.coefficients.places[(interval + k) * n + j].unknown else { continue };
                let mut slope_t = 0.0;
                for o in 0..3 {
                    let r = o * n + j;
                    target.gradient[row] += weight * time * factor(o, k) * self.first[r];
                    if self.time_is_free {
                        let second = &self.second[r * width..(r + 1) * width];
                        let along = costate::matrix::dot(second, &self.z[1]);
                        // d/dT of T L_z z_theta: L_z z_theta + T (z_T L_zz z_theta + L_z z_theta,T).
                        slope_t += factor(o, k) * (self.first[r] * (1.0 - o as f64) + time * along);
                    }
                }
                target.border[row] += weight * time * slope_t;
                for k2 in 0..ACTIVE {
                    for j2 in 0..n {
                        let place = (interval + k2) * n + j2;
                        let Some(column) = self.coefficients.places[place].unknown else { continue };
                        if column > row {
                            continue;
                        }
                        let mut sum = 0.0;
                        for o in 0..3 {
                            let second = &self.second[(o * n + j) * width..];
                            let part: f64 = (0..3).map(|o2| second[o2 * n + j2] * factor(o2, k2)).sum();
                            sum += factor(o, k) * part;
                        }
                        *target.hessian.entry_mut(row, column) += weight * time * sum;
                    }
                }
            }
        }
    }
}
