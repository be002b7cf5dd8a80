//! Poses in which a robot rests at little cost.

use crate::constants::waiting::rest_pose as constants;
use crate::numerics::cholesky;
use costate::EvalError;
use costate::lagrangian::Lagrangian;

/// What a second of rest costs, `l(q) = 1/2 sum r_i g_i(q)^2` with the torques g that hold the robot.
pub(super) struct Rest<'a> {
    pub model: &'a mut Lagrangian<f64>,
    /// r, n entries.
    pub effort: &'a [f64],
    /// Least and largest positions of each joint (rad, m).
    pub limits: &'a [[f64; 2]],
}

impl Rest<'_> {
    /// l(q), per second.
    ///
    /// # Errors
    /// Positions at which the dynamics cannot be evaluated.
    pub fn cost(&mut self, q: &[f64]) -> Result<f64, EvalError> {
        let still = vec![0.0; q.len()];
        let tau = self.model.inverse_dynamics(q, &still, &still)?;
        Ok(0.5 * self.effort.iter().zip(tau).map(|(r, tau)| r * tau * tau).sum::<f64>())
    }

    /// A pose near q at which l has a local minimum within the limits: damped Gauss-Newton steps, cut to the
    /// limits (Levenberg and Marquardt's method). Joints that no torque depends on stay.
    ///
    /// # Errors
    /// See [`cost`](Self::cost).
    pub fn near(&mut self, q: &[f64]) -> Result<Vec<f64>, EvalError> {
        let n = q.len();
        let still = vec![0.0; n];
        let limits = self.limits;
        let clamp = |i: usize, q: f64| q.clamp(limits[i][0], limits[i][1]);
        let mut q: Vec<f64> = q.iter().enumerate().map(|(i, &q)| clamp(i, q)).collect();
        let (mut gradient, mut hessian, mut damping) = (vec![0.0; n], vec![0.0; n * n], constants::DAMPING);
        for _ in 0..constants::STEPS {
            let found = self.model.linearise_inverse_dynamics(&q, &still, &still)?;
            let (mut cost, tau, tau_q) = (0.0, found.tau, found.tau_q);
            gradient.fill(0.0);
            hessian.fill(0.0);
            for (k, (&r, &tau)) in self.effort.iter().zip(tau).enumerate() {
                cost += 0.5 * r * tau * tau;
                for i in 0..n {
                    gradient[i] += r * tau_q[(k, i)] * tau;
                    for j in 0..n {
                        hessian[n * i + j] += r * tau_q[(k, i)] * tau_q[(k, j)];
                    }
                }
            }
            let largest = (0..n).map(|i| hessian[(n + 1) * i]).fold(0.0, f64::max);
            if largest == 0.0 {
                break;
            }
            // Joints at a limit that they press against stay there.
            for i in 0..n {
                let held = if gradient[i] > 0.0 { limits[i][0] } else { limits[i][1] };
                if q[i] == held {
                    gradient[i] = 0.0;
                    for j in 0..n {
                        (hessian[n * i + j], hessian[n * j + i]) = (0.0, 0.0);
                    }
                }
            }
            let (mut farthest, mut better) = (0.0_f64, false);
            while damping < constants::MOST_DAMPING && !better {
                let mut matrix = hessian.clone();
                for i in 0..n {
                    matrix[(n + 1) * i] +=
                        damping * matrix[(n + 1) * i].max(constants::LEAST_CURVATURE * largest);
                }
                let mut step: Vec<f64> = gradient.iter().map(|slope| -slope).collect();
                if cholesky::factorise(&mut matrix, n) {
                    cholesky::solve(&matrix, n, &mut step);
                    let trial: Vec<f64> = (0..n).map(|i| clamp(i, q[i] + step[i])).collect();
                    if self.cost(&trial)? < cost {
                        farthest = q.iter().zip(&trial).map(|(q, to)| (to - q).abs()).fold(0.0, f64::max);
                        (q, better) = (trial, true);
                    }
                }
                damping *= if better { constants::LESS } else { constants::MORE };
            }
            if farthest < constants::STILL {
                break;
            }
        }
        Ok(q)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use costate::robot::Robot;

    const FREE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

    /// The arm stands or hangs straight where no torque is needed; a limit of the shoulder leaves the least
    /// torque at the limit.
    #[test]
    fn arms_rest_where_it_costs_least() {
        let robot = Robot::from_file("../robots/ur5.urdf").unwrap();
        let mut model = Lagrangian::<f64>::new(&robot);
        let effort = [1.0 / 150.0_f64.powi(2), 1.0 / 28.0_f64.powi(2)].map(|r| [r; 3]).concat();
        let from = [0.3, -1.0, 0.8, -1.2, -0.5, 0.1];
        let mut limits = vec![FREE; 6];
        let mut rest = Rest { model: &mut model, effort: &effort, limits: &limits };
        let before = rest.cost(&from).unwrap();
        let free = rest.near(&from).unwrap();
        let left = rest.cost(&free).unwrap();
        assert!(left < 1e-12 * before, "{before} {left}");
        assert_eq!((free[0], free[5]), (0.3, 0.1), "no torque depends on these");
        limits[1] = [-1.1, 1.1];
        let mut rest = Rest { model: &mut model, effort: &effort, limits: &limits };
        let held = rest.near(&from).unwrap();
        let least = rest.cost(&held).unwrap();
        assert!(held[1] >= -1.1 && held[1] <= 1.1 && least < before, "{held:?} {least}");
        for i in [1, 2, 3, 4] {
            for step in [-1e-3, 1e-3] {
                let mut beside = held.clone();
                beside[i] = (beside[i] + step).clamp(limits[i][0], limits[i][1]);
                assert!(rest.cost(&beside).unwrap() >= least - 1e-12 * before, "joint {i}");
            }
        }
    }
}
