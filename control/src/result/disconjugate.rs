//! A bound that shows that a part of a motion is too short for two conjugate times.
//!
//! The second variation over $[a, b]$ with the blocks $A = H_{yx}$, $B = H_{yy} \ge 0$, $C = H_{xx}$ of the
//! maximised Hamiltonian is
//!
//! $$ J_2 = \tfrac12 \int_a^b \left( w^\top B w - \delta x^\top C \thinspace \delta x \right) dt, \qquad
//!    \delta x' = A \thinspace \delta x + B w, \quad \delta x(a) = \delta x(b) = 0 $$
//!
//! With the Gramian $G' = A G + G A^\top + B$, $G(a) = 0$, the inequality of Cauchy and Schwarz gives
//! $\delta x \thinspace \delta x^\top \le G \int w^\top B w \thinspace dt$. So $J_2$ is positive, and no two
//! times of $[a, b]$ are conjugate to each other, if
//!
//! $$ \int_a^b \max \left( 0, \lambda_{\max} (G^{1/2} C G^{1/2}) \right) dt < 1 . $$

use crate::constants::checks::disconjugate::{MOST, NEGLIGIBLE};
use nalgebra::DMatrix;

/// The Jacobian of an extremal at one time.
pub(crate) struct Sample {
    /// Time (s) from the start of the mesh interval.
    t: f64,
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    c: DMatrix<f64>,
}

impl Sample {
    /// From the Jacobian `[A B; -C -A']` of z', row-major.
    pub fn new(t: f64, states: usize, jacobian: &[f64]) -> Self {
        let size = 2 * states;
        let block = |row: usize, column: usize| {
            DMatrix::from_fn(states, states, |i, j| jacobian[(row + i) * size + column + j])
        };
        let symmetric = |block: DMatrix<f64>| 0.5 * (&block + block.transpose());
        Self { t, a: block(0, 0), b: symmetric(block(0, states)), c: -symmetric(block(states, 0)) }
    }

    /// G'.
    fn gramian_rate(&self, gramian: &DMatrix<f64>) -> DMatrix<f64> {
        let half = &self.a * gramian;
        &half + half.transpose() + &self.b
    }

    /// At least the largest positive eigenvalue of `G^1/2 C G^1/2`; its Frobenius norm where that is `small`.
    fn largest(&self, gramian: &DMatrix<f64>, small: f64) -> f64 {
        // The product has the same eigenvalues.
        let product = &self.c * gramian;
        let norm = product.dot(&product.transpose()).max(0.0).sqrt();
        if norm <= small {
            return norm;
        }
        let parts = gramian.clone().symmetric_eigen();
        let roots = parts.eigenvalues.map(|value| value.max(0.0).sqrt());
        let root = parts.eigenvectors * DMatrix::from_diagonal(&roots);
        (root.transpose() * &self.c * root).symmetric_eigenvalues().max().max(0.0)
    }
}

/// The Gramian and the integral from the start of a piece to a time within the motion.
#[derive(Clone)]
pub(crate) struct Reach {
    gramian: DMatrix<f64>,
    integral: f64,
    /// A rate that counts as small.
    small: f64,
}

impl Reach {
    /// At the start of a piece of about this duration (s).
    pub fn new(states: usize, piece: f64) -> Self {
        Self { gramian: DMatrix::zeros(states, states), integral: 0.0, small: NEGLIGIBLE / piece }
    }

    /// Continued over a part of a mesh interval. The integral is over the larger of the two rates between
    /// samples.
    pub fn over(mut self, samples: &[Sample]) -> Self {
        let pairs = samples.iter().zip(samples.iter().skip(1));
        for (from, to) in pairs.filter(|(from, to)| to.t > from.t) {
            let h = to.t - from.t;
            let rate = from.gramian_rate(&self.gramian);
            let ahead = &self.gramian + h * &rate;
            let next = &self.gramian + 0.5 * h * (rate + to.gramian_rate(&ahead));
            let most = from.largest(&self.gramian, self.small).max(to.largest(&next, self.small));
            self.integral += h * most;
            self.gramian = next;
        }
        self
    }

    /// Whether no two times are conjugate to each other.
    pub fn is_disconjugate(&self) -> bool {
        self.integral < MOST
    }
}

/// Orders the samples that an integrator took.
pub(crate) fn ordered(mut samples: Vec<Sample>) -> Vec<Sample> {
    samples.sort_by(|a, b| a.t.total_cmp(&b.t));
    samples
}

#[cfg(test)]
mod tests {
    use super::{Reach, Sample};

    /// `x'' = -k x` up to h: the integral is `k h^2 / 2`.
    fn oscillator(k: f64, h: f64) -> Reach {
        let sample = |i: u32| Sample::new(h * f64::from(i) / 1000.0, 1, &[0.0, 1.0, -k, 0.0]);
        Reach::new(1, h).over(&(0..=1000).map(sample).collect::<Vec<_>>())
    }

    #[test]
    fn the_bound_holds_well_before_half_a_period() {
        assert!((oscillator(4.0, 0.5).integral - 0.5).abs() < 1e-3);
        assert!(oscillator(4.0, 0.6).is_disconjugate());
        assert!(!oscillator(4.0, 0.5 * std::f64::consts::PI).is_disconjugate());
        assert!(oscillator(-1e6, 1.0).is_disconjugate(), "a convex cost has no conjugate times");
    }

    /// `q'''' = k q` with q and its rate at zero: `G_qq = t^3 / 3`, so that the integral is `k h^4 / 12`.
    #[test]
    fn states_that_the_control_moves_through_others_count_too() {
        let (k, h) = (2.0, 1.2_f64);
        #[rustfmt::skip]
        let jacobian = [
            0.0, 1.0, 0.0, 0.0,
            0.0, 0.0, 0.0, 1.0,
            -k, 0.0, 0.0, 0.0,
            0.0, 0.0, -1.0, 0.0,
        ];
        let sample = |i: u32| Sample::new(h * f64::from(i) / 1000.0, 2, &jacobian);
        let reach = Reach::new(2, h).over(&(0..=1000).map(sample).collect::<Vec<_>>());
        assert!((reach.integral - k * h.powi(4) / 12.0).abs() < 2e-3, "{}", reach.integral);
    }
}
