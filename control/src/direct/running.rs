//! The running cost of a motion: time, effort, user terms.

use super::points::Points;
use super::spline::Spline;
use crate::extremal::user_terms::UserTerms;
use crate::problem::Problem;

/// `c_t + 1/2 sum r_i tau_i^2 + terms`, per second.
#[derive(Debug)]
pub(crate) struct Running {
    /// c_t.
    pub time: f64,
    /// r_i over the square of the gain.
    pub effort: Vec<f64>,
    terms: UserTerms<f64>,
}

impl Running {
    pub fn new(problem: &Problem) -> Self {
        let effort = problem.cost.effort.iter().zip(&problem.gain).map(|(r, gain)| r / (gain * gain)).collect();
        let terms = UserTerms::new(problem.robot.dof(), &problem.terms);
        Self { time: problem.cost.time, effort, terms }
    }

    /// The cost of a motion.
    pub fn cost(&self, spline: &Spline, points: &Points) -> f64 {
        let n = points.dof;
        let mut sum = 0.0;
        for p in 0..points.count() {
            let (z, tau) = (points.z(p), points.tau(p));
            let effort: f64 = tau.iter().zip(&self.effort).map(|(tau, r)| 0.5 * r * tau * tau).sum();
            sum += spline.point(p).1 * (effort + self.terms.at(&z[..n], &z[n..2 * n]));
        }
        spline.time * (self.time + sum)
    }

    /// Adds the terms at a point: `T w l_z` to the gradient, `w l_z` to the slope, `T w l_zz` to the Hessian. The
    /// value is l without the effort.
    pub fn add_terms(
        &mut self,
        z: &[f64],
        [weight, time]: [f64; 2],
        gradient: &mut [f64],
        slope: &mut [f64],
        hessian: &mut [f64],
    ) -> f64 {
        if !self.terms.any() {
            return 0.0;
        }
        let (n, width) = (z.len() / 3, z.len());
        self.terms.second(&z[..n], &z[n..2 * n]);
        for i in 0..2 * n {
            gradient[i] += time * weight * self.terms.gradient[i];
            slope[i] += weight * self.terms.gradient[i];
            for j in 0..2 * n {
                hessian[width * i + j] += time * weight * self.terms.hessian[(i, j)];
            }
        }
        self.terms.value
    }
}
