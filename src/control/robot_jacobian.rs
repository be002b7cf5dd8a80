//! The Jacobian of the extremals of a robot.

use super::extremal::{Extremal, Law};
use super::options::Jacobian;
use super::robot_extremal::RobotExtremal;
use crate::error::EvalError;

impl RobotExtremal {
    /// The Jacobian from F_x and, where they are known, second derivatives.
    pub(super) fn exact(&mut self, z: &[f64], g: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        let n = self.force.len();
        let m = 4 * n;
        let (q, p) = z[..2 * n].split_at(n);
        let (linear, hessian) = if self.jacobian == Jacobian::WithoutHessian {
            (self.second.first().jacobian(q, p, &self.force)?, None)
        } else {
            let all = self.second.contracted_hessian(q, p, &self.force, &self.shifted)?;
            (all.linearisation(), Some(all.matrix()))
        };
        let f_x = linear.matrix();
        g[..2 * n].copy_from_slice(linear.f());
        g[2 * n..].fill(0.0);
        jacobian.fill(0.0);
        for i in 0..2 * n {
            let row = f_x.row(i);
            jacobian[i * m..i * m + 2 * n].copy_from_slice(row);
            for (j, &entry) in row.iter().enumerate() {
                jacobian[(2 * n + j) * m + 2 * n + i] = -entry;
                g[2 * n + j] -= self.shifted[i] * entry;
            }
            if let Some(hessian) = hessian {
                let target = &mut jacobian[(2 * n + i) * m..(2 * n + i) * m + 2 * n];
                target.iter_mut().zip(hessian.row(i)).for_each(|(target, &entry)| *target = -entry);
            }
        }
        for i in 0..n {
            let gain = self.actuation.gain[i];
            jacobian[(n + i) * m + 3 * n + i] = gain * gain * self.slopes[i];
            if self.penalties.any() {
                g[2 * n + i] += self.l_q[i];
                jacobian[(2 * n + i) * m + i] += self.l_qq[i];
            }
        }
        if self.penalties.limit_rates() {
            for k in 0..n {
                if self.l_vv[k] == 0.0 {
                    continue;
                }
                let row = f_x.row(k);
                for i in 0..2 * n {
                    let target = &mut jacobian[(2 * n + i) * m..(2 * n + i) * m + 2 * n];
                    crate::matrix::add_scaled(target, self.l_vv[k] * row[i], row);
                }
            }
        }
        Ok(())
    }

    /// The Jacobian by central differences of the right-hand side.
    pub(super) fn differences(
        &mut self,
        z: &[f64],
        law: Law<'_>,
        jacobian: &mut [f64],
    ) -> Result<(), EvalError> {
        let m = z.len();
        let mut point = std::mem::take(&mut self.point);
        let mut beside = std::mem::take(&mut self.beside);
        point.copy_from_slice(z);
        let mut outcome = Ok(());
        for j in 0..m {
            let step = f64::EPSILON.cbrt() * z[j].abs().max(1.0);
            for (g, sign) in beside.iter_mut().zip([1.0, -1.0]) {
                point[j] = z[j] + sign * step;
                outcome = outcome.and_then(|()| self.rate(&point, law, g).map(|_| ()));
            }
            point[j] = z[j];
            for i in 0..m {
                jacobian[i * m + j] = (beside[0][i] - beside[1][i]) / (2.0 * step);
            }
        }
        (self.point, self.beside) = (point, beside);
        outcome
    }
}
