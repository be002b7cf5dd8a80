//! A linear step with quadratic costs, and its solution by dense algebra.

use crate::problem::Problem;
use costate::dynamics::QuadraticCost;
use costate::matrix::Matrix;
use costate::step::{Step, StepContraction, StepLinearisation};
use nalgebra::{DMatrix, DVector, dvector};
use std::ops::Range;

#[derive(Debug, thiserror::Error)]
#[error("refused")]
pub struct Refused;

/// `A x + B u`, refusing the calls of `advance` whose numbers are in `refuses`.
pub struct Linear {
    a: Matrix<f64>,
    b: Matrix<f64>,
    next: Vec<f64>,
    zero: Matrix<f64>,
    calls: usize,
    refuses: Range<usize>,
}

const A: [f64; 9] = [1.0, 0.3, 0.0, -0.2, 0.9, 0.4, 0.1, 0.0, 1.1];
const B: [f64; 6] = [0.0, 0.1, 0.5, 0.0, -0.2, 0.7];
pub const STAGES: usize = 5;

impl Linear {
    fn new(refuses: Range<usize>) -> Self {
        let (a, b) = (Matrix::from_rows(3, &A), Matrix::from_rows(2, &B));
        Self { a, b, next: vec![0.0; 3], zero: Matrix::zeros(3, 3), calls: 0, refuses }
    }
}

impl Step<f64> for Linear {
    type Error = Refused;

    fn states(&self) -> usize {
        3
    }

    fn controls(&self) -> usize {
        2
    }

    fn evaluate(&mut self, x: &[f64], u: &[f64], _: f64) -> Result<&[f64], Refused> {
        self.calls += 1;
        if self.refuses.contains(&(self.calls - 1)) {
            return Err(Refused);
        }
        let [a, b] = [&self.a, &self.b].map(|matrix| matrix.view().to_nalgebra());
        let next = a * DVector::from_column_slice(x) + b * DVector::from_column_slice(u);
        self.next.copy_from_slice(next.as_slice());
        Ok(&self.next)
    }

    fn linearise(&mut self, _: &[f64], _: &[f64], _: f64) -> Result<StepLinearisation<'_, f64>, Refused> {
        Ok(StepLinearisation {
            next: &self.next,
            phi_x: self.a.view(),
            phi_u: self.b.view(),
            phi_h: &self.next,
        })
    }

    fn contract(
        &mut self,
        _: &[f64],
        _: &[f64],
        _: f64,
        _: &[f64],
    ) -> Result<StepContraction<'_, f64>, Refused> {
        let first = StepLinearisation {
            next: &self.next,
            phi_x: self.a.view(),
            phi_u: self.b.view(),
            phi_h: &self.next,
        };
        Ok(StepContraction { first, xx: self.zero.view(), ux: None, uu: None })
    }
}

const Q: [f64; 3] = [1.0, 0.0, 0.5];
const R: [f64; 2] = [0.3, 0.7];
const END: [f64; 3] = [20.0, 3.0, 8.0];
const GOAL: [f64; 3] = [1.0, -2.0, 0.5];
pub const START: [f64; 3] = [0.4, 0.0, -0.3];
const H: f64 = 0.2;

pub type LinearProblem = Problem<Linear, QuadraticCost<f64>, QuadraticCost<f64>>;

/// A linear step with quadratic costs.
pub fn linear(refuses: Range<usize>) -> (LinearProblem, Vec<DVector<f64>>) {
    let costs = (QuadraticCost::running(&Q, &R), QuadraticCost::terminal(&END).about(&GOAL, &[]));
    let free = [f64::INFINITY; 2];
    let problem = Problem::new(Linear::new(refuses), costs, H, [&free.map(|x| -x), &free]);
    (problem, vec![dvector![0.5, -0.5]; STAGES])
}

/// The controls of the same by one dense solution with the conditions of Karush, Kuhn and Tucker.
pub fn dense() -> DVector<f64> {
    let (a, b) = (DMatrix::from_row_slice(3, 3, &A), DMatrix::from_row_slice(3, 2, &B));
    // Unknowns: u_0 ... u_{N-1}, x_1 ... x_N, multipliers of x_{k+1} = A x_k + B u_k.
    let (xs, ys, size) = (2 * STAGES, 5 * STAGES, 8 * STAGES);
    let (mut kkt, mut right) = (DMatrix::<f64>::zeros(size, size), DVector::<f64>::zeros(size));
    for k in 0..STAGES {
        for i in 0..2 {
            kkt[(2 * k + i, 2 * k + i)] = H * R[i];
        }
        let last = k + 1 == STAGES;
        for i in 0..3 {
            let row = xs + 3 * k + i;
            kkt[(row, row)] = if last { END[i] } else { H * Q[i] };
            right[row] = if last { END[i] * GOAL[i] } else { 0.0 };
        }
        let y = ys + 3 * k;
        kkt.view_mut((y, 2 * k), (3, 2)).copy_from(&b);
        kkt.view_mut((y, xs + 3 * k), (3, 3)).copy_from(&-DMatrix::identity(3, 3));
        if k == 0 {
            right.rows_mut(y, 3).copy_from(&(-&a * DVector::from_column_slice(&START)));
        } else {
            kkt.view_mut((y, xs + 3 * (k - 1)), (3, 3)).copy_from(&a);
        }
    }
    let constraints = kkt.view((ys, 0), (3 * STAGES, ys)).transpose();
    kkt.view_mut((0, ys), (ys, 3 * STAGES)).copy_from(&constraints);
    kkt.lu().solve(&right).unwrap().rows(0, 2 * STAGES).into_owned()
}
