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
    use crate::constants::attempts::PathAttempt;
    use crate::path::cubics::Disturbance;
    use crate::path::lowest_path;
    use crate::solve::Recorder;
    use crate::{Problem, RunningCost, Solver, SolverOptions, UserTerm};
    use costate::robot::Robot;
    use costate::scalar::Scalar;

    struct Springs;

    impl RunningCost for Springs {
        fn evaluate<S: Scalar>(&self, q: &[S], v: &[S]) -> S {
            q.iter()
                .zip(v)
                .fold(S::zero(), |sum, (&q, &v)| sum + q * q.times(20.0) + (v * v).times(3.0) + q * v)
        }
    }

    #[test]
    fn user_terms_and_a_free_start_belong_to_a_path() {
        let robot = Robot::from_file("../robots/two_link.toml").unwrap();
        let mut problem = Problem::rest_to_rest(robot, &[0.4, 0.2], &[1.0, -0.5], 1.2);
        problem.terms = vec![UserTerm::new(Springs)];
        let attempt = PathAttempt { smoothing: 0.0, penalty: 1.0, halvings: 0 };
        for v_free in [vec![], vec![1]] {
            problem.start.v_free = v_free;
            let mut path =
                lowest_path(&problem, &Disturbance::default(), attempt, &mut Recorder::default()).unwrap();
            let solution = Solver::new(&problem, SolverOptions::default()).unwrap().solve();
            assert!(solution.motion.status.is_converged());
            let cost = solution.motion.cost;
            assert!((path.cost() - cost).abs() < 2e-3 * cost, "{} {cost}", path.cost());
            let (mut z, middle) = ([0.0; 8], solution.trajectory.t.partition_point(|&t| t < 0.6));
            path.sample(solution.trajectory.t[middle] / 1.2, &mut z).unwrap();
            let largest = solution.trajectory.y_q.iter().flatten().fold(0.0_f64, |most, y| most.max(y.abs()));
            for (found, expected) in z[4..6].iter().zip(&solution.trajectory.y_q[middle]) {
                assert!((found - expected).abs() < 0.02 * largest, "{found} {expected}");
            }
        }
    }
}
