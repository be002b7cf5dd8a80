//! An adaptive Runge-Kutta integrator, for multiple shooting and for the verification of solutions.

use costate::EvalError;
use std::ops::Range;

/// Stages of the pair of Dormand and Prince of orders 5 and 4.
const STAGES: usize = 7;
const C: [f64; STAGES] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const A: [[f64; 6]; STAGES] = [
    [0.0; 6],
    [0.2, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Weights of order 5 minus weights of order 4.
const ERROR: [f64; STAGES] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

/// Buffers for systems of one size.
#[derive(Clone, Debug)]
pub(crate) struct DormandPrince {
    slopes: Vec<Vec<f64>>,
    point: Vec<f64>,
    /// Tolerance of a step, relative to the size of each component.
    tolerance: f64,
    /// Lower limit of the size of each component.
    sizes: Vec<f64>,
}

/// An integration stopped before its end.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Stopped {
    Evaluation(EvalError),
    TooManySteps,
    /// The search is to stop.
    Interrupted,
}

impl From<EvalError> for Stopped {
    fn from(error: EvalError) -> Self {
        Self::Evaluation(error)
    }
}

/// Most steps of one call.
const MOST_STEPS: usize = 100_000;

impl DormandPrince {
    pub fn new(size: usize, tolerance: f64) -> Self {
        let sizes = vec![1.0; size];
        Self { slopes: vec![vec![0.0; size]; STAGES], point: vec![0.0; size], tolerance, sizes }
    }

    /// Lower limit of the size of each component, 1 by default. Infinite for a component that must not limit
    /// steps.
    pub fn sizes_mut(&mut self) -> &mut [f64] {
        &mut self.sizes
    }

    /// Changes the tolerance of a step.
    pub fn set_tolerance(&mut self, tolerance: f64) {
        self.tolerance = tolerance;
    }

    /// Integrates `x' = rate(t, x)` in place from the start to the end of `time`, which may lie before it.
    /// NaN and diverging values stop it.
    pub fn integrate(
        &mut self,
        x: &mut [f64],
        time: Range<f64>,
        mut rate: impl FnMut(f64, &[f64], &mut [f64]) -> Result<(), EvalError>,
    ) -> Result<(), Stopped> {
        self.integrate_until(x, time, |t, x, slope| rate(t, x, slope).map_err(Stopped::Evaluation))
    }

    /// The same, for a `rate` that may also stop it.
    pub fn integrate_until(
        &mut self,
        x: &mut [f64],
        time: Range<f64>,
        mut rate: impl FnMut(f64, &[f64], &mut [f64]) -> Result<(), Stopped>,
    ) -> Result<(), Stopped> {
        let Range { start: from, end: to } = time;
        let (mut t, mut h) = (from, to - from);
        let least = 1e-14 * (to - from).abs();
        let mut first = 0;
        for _ in 0..MOST_STEPS {
            if (to - t).abs() <= least {
                return Ok(());
            }
            if (to - t).abs() < h.abs() * (1.0 + 1e-12) {
                h = to - t;
            }
            for stage in first..STAGES {
                self.point.copy_from_slice(x);
                for (a, slope) in A[stage].iter().zip(&self.slopes[..stage]) {
                    costate::matrix::add_scaled(&mut self.point, h * a, slope);
                }
                rate(t + C[stage] * h, &self.point, &mut self.slopes[stage])?;
            }
            // The last stage is at the new point.
            let mut square = 0.0;
            for (i, (&old, &new)) in x.iter().zip(&self.point).enumerate() {
                let error: f64 = (0..STAGES).map(|stage| ERROR[stage] * self.slopes[stage][i]).sum();
                let size = old.abs().max(new.abs()).max(self.sizes[i]);
                square += (h * error / (self.tolerance * size)).powi(2);
            }
            let error = (square / x.len() as f64).sqrt();
            if error <= 1.0 {
                t += h;
                x.copy_from_slice(&self.point);
                // Its slope is the first of the next step.
                self.slopes.swap(0, STAGES - 1);
            }
            first = 1;
            let factor = 0.9 * error.powf(-0.2);
            h *= if factor.is_nan() { 0.2 } else { factor.clamp(0.2, 5.0) };
            if h.abs() < least {
                break;
            }
        }
        Err(Stopped::TooManySteps)
    }
}

#[cfg(test)]
mod tests {
    use super::{DormandPrince, Stopped};

    #[test]
    fn a_finite_escape_time_is_an_error() {
        let mut x = [1.0];
        let mut integrator = DormandPrince::new(1, 1e-9);
        // x = 1 / (1 - t).
        let escape = |_: f64, x: &[f64], f: &mut [f64]| {
            f[0] = x[0] * x[0];
            Ok(())
        };
        assert_eq!(integrator.integrate(&mut x, 0.0..2.0, escape), Err(Stopped::TooManySteps));
    }

    #[test]
    fn a_circle_closes() {
        let mut x = [1.0, 0.0];
        let mut integrator = DormandPrince::new(2, 1e-13);
        let turn = |_: f64, x: &[f64], f: &mut [f64]| {
            (f[0], f[1]) = (-x[1], x[0]);
            Ok(())
        };
        integrator.integrate(&mut x, 0.0..std::f64::consts::TAU, turn).unwrap();
        assert!((x[0] - 1.0).abs() < 1e-11 && x[1].abs() < 1e-11, "{x:?}");
        integrator.integrate(&mut x, std::f64::consts::TAU..0.5, turn).unwrap();
        assert!((x[0] - 0.5_f64.cos()).abs() < 1e-10);
    }
}
