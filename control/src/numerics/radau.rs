//! Radau's method IIA of order five with adaptive steps, for stiff and unstable equations.

use super::dormand_prince::Stopped;
use super::lu;
use costate::EvalError;
use std::ops::Range;

/// Stages.
const STAGES: usize = 3;
/// $\sqrt 6$.
const ROOT: f64 = 2.449_489_742_783_178;
/// Places of the stages in a step, (4 -+ sqrt 6)/10 and 1.
pub(crate) const PLACES: [f64; STAGES] = [0.4 - 0.1 * ROOT, 0.4 + 0.1 * ROOT, 1.0];
const A: [[f64; STAGES]; STAGES] = [
    [(88.0 - 7.0 * ROOT) / 360.0, (296.0 - 169.0 * ROOT) / 1800.0, (-2.0 + 3.0 * ROOT) / 225.0],
    [(296.0 + 169.0 * ROOT) / 1800.0, (88.0 + 7.0 * ROOT) / 360.0, (-2.0 - 3.0 * ROOT) / 225.0],
    WEIGHTS,
];
/// Weights of the stages in the integral over a step.
pub(crate) const WEIGHTS: [f64; STAGES] = [(16.0 - ROOT) / 36.0, (16.0 + ROOT) / 36.0, 1.0 / 9.0];
/// The real eigenvalue of the inverse of A, and factors of the stages in the estimate of the error.
const REAL: f64 = 3.637_834_252_744_496;
const ERROR: [f64; STAGES] = [-(13.0 + 7.0 * ROOT) / 3.0, (-13.0 + 7.0 * ROOT) / 3.0, -1.0 / 3.0];
/// Most steps of one call.
const MOST_STEPS: usize = 20_000;
/// Most iterations of Newton's method in a step.
const ITERATIONS: usize = 8;
/// Newton's method ends where a correction is this small, relative to the tolerance.
const CORRECTION: f64 = 0.01;

/// The right-hand side of x' = f(t, x).
pub(crate) trait System {
    /// f and its Jacobian, row by row.
    ///
    /// # Errors
    /// States that cannot be evaluated.
    fn linearise(&mut self, t: f64, x: &[f64], f: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError>;

    /// Whether f is linear in x: then one iteration solves a step.
    fn is_linear(&self) -> bool;

    /// Sees the stages of each step that is taken: its start, its length, and x at the
    /// [places](PLACES).
    ///
    /// # Errors
    /// As [`linearise`](Self::linearise).
    fn accept(&mut self, _from: f64, _length: f64, _stages: [&[f64]; STAGES]) -> Result<(), EvalError> {
        Ok(())
    }

    /// Whether to end before the next step.
    fn stops(&mut self) -> bool {
        false
    }
}

/// Buffers for systems of one size.
#[derive(Clone, Debug)]
pub(crate) struct Radau {
    /// Lower limit of the size of each component.
    pub sizes: Vec<f64>,
    /// Tolerance of a step, relative to the size of each component.
    pub tolerance: f64,
    /// x at the stages, f and the Jacobian there and, last, at the start of a step.
    stages: Vec<f64>,
    slopes: Vec<f64>,
    jacobians: Vec<f64>,
    /// Newton's matrix of a step, its right-hand side, and the exchanges of rows.
    matrix: Vec<f64>,
    right: Vec<f64>,
    exchanges: Vec<usize>,
    /// The same of the estimate of the error.
    filter: Vec<f64>,
    error: Vec<f64>,
}

impl Radau {
    /// For n components with this tolerance of a step.
    pub fn new(n: usize, tolerance: f64) -> Self {
        let all = STAGES * n;
        Self {
            sizes: vec![1.0; n],
            tolerance,
            stages: vec![0.0; all],
            slopes: vec![0.0; all + n],
            jacobians: vec![0.0; (STAGES + 1) * n * n],
            matrix: vec![0.0; all * all],
            right: vec![0.0; all],
            exchanges: vec![0; all],
            filter: vec![0.0; n * n],
            error: vec![0.0; n],
        }
    }

    /// Integrates x in place from the start to the end of `time`, which may lie before it, with a first step
    /// over the part `first` of it.
    ///
    /// A step solves $X\_i = x + h \sum\_j a\_{ij} f(t + c\_j h, X\_j)$ by Newton's method with the Jacobians
    /// of all stages; its error is estimated as in RADAU5, by
    /// $(\gamma/h - f\_x)^{-1} (f(t, x) + \sum\_i e\_i (X\_i - x) / h)$ with the real eigenvalue γ of the
    /// inverse of A. E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section IV.8.
    ///
    /// # Errors
    /// States that cannot be evaluated; steps that become too short or too many; a system that
    /// [stops](System::stops) it.
    pub fn integrate(
        &mut self,
        x: &mut [f64],
        time: Range<f64>,
        first: f64,
        system: &mut impl System,
    ) -> Result<(), Stopped> {
        let Range { start, end } = time;
        let (mut t, mut h, n) = (start, first * (end - start), x.len());
        let least = 1e-13 * (end - start).abs();
        let mut is_known = false;
        for _ in 0..MOST_STEPS {
            if (end - t).abs() <= least {
                return Ok(());
            }
            if system.stops() {
                return Err(Stopped::Interrupted);
            }
            if h.abs() * (1.0 + 1e-9) > (end - t).abs() {
                h = end - t;
            }
            if !is_known {
                let (f, jacobian) = (&mut self.slopes[STAGES * n..], &mut self.jacobians[STAGES * n * n..]);
                system.linearise(t, x, f, jacobian)?;
                is_known = true;
            }
            let solved = match self.solve_step(t, h, x, system) {
                Ok(solved) => solved,
                // A shorter step does not go where nothing can be evaluated.
                Err(Stopped::Evaluation(_)) if h.abs() > 1e3 * least && !system.is_linear() => false,
                Err(stopped) => return Err(stopped),
            };
            let error = if solved { self.estimate(h, x) } else { f64::INFINITY };
            if error <= 1.0 {
                let (a, others) = self.stages.split_at(n);
                let (b, c) = others.split_at(n);
                system.accept(t, h, [a, b, c])?;
                x.copy_from_slice(c);
                t += h;
                // The last stage is at the new point.
                let last = (STAGES - 1) * n;
                if system.is_linear() {
                    self.slopes.copy_within(last..last + n, STAGES * n);
                    self.jacobians.copy_within(last * n..(last + n) * n, STAGES * n * n);
                } else {
                    is_known = false;
                }
            } else if h.abs() <= least {
                return Err(Stopped::TooManySteps);
            }
            let factor = 0.9 * error.powf(-0.25);
            h *= if factor.is_nan() { 0.2 } else { factor.clamp(0.2, 5.0) };
        }
        Err(Stopped::TooManySteps)
    }

    /// Solves the equations of a step; false where Newton's method does not converge.
    fn solve_step(&mut self, t: f64, h: f64, x: &[f64], system: &mut impl System) -> Result<bool, Stopped> {
        let (n, all) = (x.len(), STAGES * x.len());
        for stage in self.stages.chunks_exact_mut(n) {
            stage.copy_from_slice(x);
        }
        if !system.is_linear() {
            let f = &self.slopes[all..];
            for (stage, place) in self.stages.chunks_exact_mut(n).zip(PLACES) {
                stage.iter_mut().zip(f).for_each(|(x, f)| *x += place * h * f);
            }
        }
        for _ in 0..ITERATIONS {
            for (i, place) in PLACES.into_iter().enumerate() {
                let f = &mut self.slopes[n * i..n * (i + 1)];
                let jacobian = &mut self.jacobians[n * n * i..n * n * (i + 1)];
                system.linearise(t + place * h, &self.stages[n * i..n * (i + 1)], f, jacobian)?;
            }
            for i in 0..STAGES {
                for r in 0..n {
                    let sum: f64 = (0..STAGES).map(|j| A[i][j] * self.slopes[n * j + r]).sum();
                    self.right[n * i + r] = x[r] + h * sum - self.stages[n * i + r];
                    let row = &mut self.matrix[all * (n * i + r)..][..all];
                    for j in 0..STAGES {
                        let factor = h * A[i][j];
                        let from = &self.jacobians[n * n * j + n * r..][..n];
                        row[n * j..n * (j + 1)]
                            .iter_mut()
                            .zip(from)
                            .for_each(|(to, f_x)| *to = -factor * f_x);
                    }
                    row[n * i + r] += 1.0;
                }
            }
            if !lu::eliminate(&mut self.matrix, all, all, &mut self.exchanges) {
                return Ok(false);
            }
            lu::solve(&self.matrix, all, &self.exchanges, &mut self.right, 1);
            let mut most = 0.0_f64;
            for (at, (stage, change)) in self.stages.iter_mut().zip(&self.right).enumerate() {
                *stage += change;
                let part = (change / self.sizes[at % n].max(stage.abs())).abs();
                most = if part.is_nan() { f64::INFINITY } else { most.max(part) };
            }
            if system.is_linear() {
                // f at the solution.
                let n2 = n * n;
                for (i, r) in (0..STAGES).flat_map(|i| (0..n).map(move |r| (i, r))) {
                    let row = &self.jacobians[n2 * i + n * r..][..n];
                    let change: f64 = row.iter().zip(&self.right[n * i..]).map(|(f_x, dx)| f_x * dx).sum();
                    self.slopes[n * i + r] += change;
                }
                return Ok(most.is_finite());
            }
            if most <= CORRECTION * self.tolerance {
                return Ok(true);
            }
            if !most.is_finite() {
                return Ok(false);
            }
        }
        Ok(false)
    }

    /// The estimated error of a step, relative to the tolerance.
    fn estimate(&mut self, h: f64, x: &[f64]) -> f64 {
        let n = x.len();
        let (f, jacobian) = (&self.slopes[STAGES * n..], &self.jacobians[STAGES * n * n..]);
        for r in 0..n {
            let sum: f64 = (0..STAGES).map(|i| ERROR[i] * (self.stages[n * i + r] - x[r])).sum();
            self.error[r] = f[r] + sum / h;
            for c in 0..n {
                self.filter[n * r + c] = -jacobian[n * r + c];
            }
            self.filter[n * r + r] += REAL / h;
        }
        if !lu::eliminate(&mut self.filter, n, n, &mut self.exchanges[..n]) {
            return f64::INFINITY;
        }
        lu::solve(&self.filter, n, &self.exchanges[..n], &mut self.error, 1);
        let last = &self.stages[(STAGES - 1) * n..];
        let part =
            |r: usize| self.error[r] / (self.tolerance * self.sizes[r].max(x[r].abs()).max(last[r].abs()));
        let square: f64 = (0..n).map(|r| part(r).powi(2)).sum();
        let error = (square / n as f64).sqrt();
        if error.is_nan() { f64::INFINITY } else { error }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Prothero and Robinson's x' = rate (x - sin t) + cos t with x = sin t.
    struct Stiff(f64);

    impl System for Stiff {
        fn linearise(&mut self, t: f64, x: &[f64], f: &mut [f64], j: &mut [f64]) -> Result<(), EvalError> {
            (f[0], j[0]) = (self.0 * (x[0] - t.sin()) + t.cos(), self.0);
            Ok(())
        }

        fn is_linear(&self) -> bool {
            true
        }
    }

    /// A pendulum, y'' = -sin y.
    struct Pendulum(usize);

    impl System for Pendulum {
        fn linearise(&mut self, _: f64, x: &[f64], f: &mut [f64], j: &mut [f64]) -> Result<(), EvalError> {
            f.copy_from_slice(&[x[1], -x[0].sin()]);
            j.copy_from_slice(&[0.0, 1.0, -x[0].cos(), 0.0]);
            Ok(())
        }

        fn is_linear(&self) -> bool {
            false
        }

        fn accept(&mut self, _: f64, _: f64, _: [&[f64]; 3]) -> Result<(), EvalError> {
            self.0 += 1;
            Ok(())
        }
    }

    #[test]
    fn stiff_equations_take_few_steps() {
        for rate in [-1e7, -10.0, 2.0] {
            let mut x = [0.0];
            let mut radau = Radau::new(1, 1e-9);
            radau.integrate(&mut x, 0.0..2.0, 1.0, &mut Stiff(rate)).unwrap();
            assert!((x[0] - 2_f64.sin()).abs() < 1e-7, "{rate}: {x:?}");
            radau.integrate(&mut x, 2.0..1.0, 0.3, &mut Stiff(-rate)).unwrap();
            assert!((x[0] - 1_f64.sin()).abs() < 1e-7, "{rate}: {x:?}");
        }
    }

    /// The energy of a swing is kept, and halving the tolerance ten times takes eight times as many steps at
    /// most: the error is of the fourth order at least.
    #[test]
    fn a_pendulum_keeps_its_energy() {
        let energy = |x: &[f64]| 0.5 * x[1] * x[1] - x[0].cos();
        let mut steps = Vec::new();
        for tolerance in [1e-6, 1e-9] {
            let (mut x, mut pendulum) = ([1.2, 0.0], Pendulum(0));
            let before = energy(&x);
            Radau::new(2, tolerance).integrate(&mut x, 0.0..10.0, 0.01, &mut pendulum).unwrap();
            assert!((energy(&x) - before).abs() < 100.0 * tolerance, "{}", energy(&x) - before);
            steps.push(pendulum.0);
        }
        assert!(steps[1] < 8 * steps[0], "{steps:?}");
    }
}
