//! The sum of the user terms of the running cost, with gradient and Hessian.

use crate::problem::running_cost::{ExtremalScalar, Once, Twice, UserTerm};
use costate::matrix::Matrix;
use costate::scalar::{Scalar, Tangent};

/// l(q, v), its gradient and its Hessian in (q, v). The gradient takes one evaluation with dual numbers per
/// component, the Hessian one with nested dual numbers per pair of components.
#[derive(Clone, Debug)]
pub(crate) struct UserTerms<S: Scalar> {
    terms: Vec<UserTerm>,
    /// Factor of all terms; 1 unless the problem is relaxed.
    pub factor: f64,
    once: Vec<Once<S>>,
    twice: Vec<Twice<S>>,
    /// l(q, v).
    pub value: S,
    /// (l_q, l_v), 2n.
    pub gradient: Vec<S>,
    /// l_zz, 2n x 2n, z = (q, v).
    pub hessian: Matrix<S>,
}

impl<S: ExtremalScalar> UserTerms<S> {
    /// The terms of a robot with n joints.
    pub fn new(n: usize, terms: &[UserTerm]) -> Self {
        let (once, size) = (Tangent::new(S::zero(), S::zero()), if terms.is_empty() { 0 } else { 2 * n });
        Self {
            terms: terms.to_vec(),
            factor: 1.0,
            once: vec![once; size],
            twice: vec![Tangent::new(once, once); size],
            value: S::zero(),
            gradient: vec![S::zero(); size],
            hessian: Matrix::zeros(size, size),
        }
    }

    /// Whether there are user terms.
    pub fn any(&self) -> bool {
        !self.terms.is_empty()
    }

    /// l and its gradient.
    pub fn first(&mut self, q: &[S], v: &[S]) {
        for (number, &z) in self.once.iter_mut().zip(q.iter().chain(v)) {
            *number = Tangent::new(z, S::zero());
        }
        for i in 0..self.once.len() {
            self.once[i].eps = S::one();
            let (q, v) = self.once.split_at(q.len());
            let mut sum = Tangent::new(S::zero(), S::zero());
            self.terms.iter().for_each(|term| sum += S::first(term, q, v));
            let sum = sum.times(self.factor);
            (self.value, self.gradient[i]) = (sum.re, sum.eps);
            self.once[i].eps = S::zero();
        }
    }

    /// l, its gradient and its Hessian.
    pub fn second(&mut self, q: &[S], v: &[S]) {
        let constant = |value: S| Tangent::new(value, S::zero());
        for (number, &z) in self.twice.iter_mut().zip(q.iter().chain(v)) {
            *number = Tangent::new(constant(z), constant(S::zero()));
        }
        for i in 0..self.twice.len() {
            self.twice[i].eps.re = S::one();
            for j in 0..=i {
                self.twice[j].re.eps = S::one();
                let (q, v) = self.twice.split_at(q.len());
                let mut sum = Tangent::new(constant(S::zero()), constant(S::zero()));
                self.terms.iter().for_each(|term| sum += S::second(term, q, v));
                let sum = sum.times(self.factor);
                (self.value, self.gradient[i]) = (sum.re.re, sum.eps.re);
                (self.hessian[(i, j)], self.hessian[(j, i)]) = (sum.eps.eps, sum.eps.eps);
                self.twice[j].re.eps = S::zero();
            }
            self.twice[i].eps.re = S::zero();
        }
    }
}

impl UserTerms<f64> {
    /// l alone.
    pub fn at(&self, q: &[f64], v: &[f64]) -> f64 {
        self.factor * self.terms.iter().map(|term| term.value(q, v)).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::UserTerms;
    use crate::{RunningCost, UserTerm};
    use costate::scalar::Scalar;

    /// `20 q'q + 3 v'v + q_0^2 v_1`.
    struct Springs;

    impl RunningCost for Springs {
        fn evaluate<S: Scalar>(&self, q: &[S], v: &[S]) -> S {
            let squares = q
                .iter()
                .zip(v)
                .fold(S::zero(), |sum, (&q, &v)| sum + (q * q).times(20.0) + (v * v).times(3.0));
            squares + q[0] * q[0] * v[1]
        }
    }

    #[test]
    fn derivatives_are_those_of_the_sum_of_all_terms() {
        let terms = [UserTerm::new(Springs), UserTerm::new(Springs)];
        let mut sum = UserTerms::<f64>::new(2, &terms);
        let (q, v) = ([0.4, -0.7], [1.1, 0.3]);
        let value = 20.0 * (0.16 + 0.49) + 3.0 * (1.21 + 0.09) + 0.16 * 0.3;
        let gradient = [40.0 * 0.4 + 2.0 * 0.4 * 0.3, 40.0 * -0.7, 6.0 * 1.1, 6.0 * 0.3 + 0.16];
        let hessian =
            [[40.6, 0.0, 0.0, 0.8], [0.0, 40.0, 0.0, 0.0], [0.0, 0.0, 6.0, 0.0], [0.8, 0.0, 0.0, 6.0]];
        for factor in [1.0, 0.01] {
            sum.factor = factor;
            let near = |found: f64, expected: f64| (found - 2.0 * factor * expected).abs() < 1e-13;
            assert!(near(sum.at(&q, &v), value));
            sum.first(&q, &v);
            assert!(near(sum.value, value));
            assert!(sum.gradient.iter().zip(gradient).all(|(&found, expected)| near(found, expected)));
            sum.second(&q, &v);
            assert!(near(sum.value, value));
            for i in 0..4 {
                assert!(near(sum.gradient[i], gradient[i]));
                assert!((0..4).all(|j| near(sum.hessian[(i, j)], hessian[i][j])), "{i}");
            }
        }
    }
}
