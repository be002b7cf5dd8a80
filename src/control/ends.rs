//! Conditions at the two ends of a robot's motion.

use super::problem::Problem;
use crate::error::EvalError;
use crate::hamiltonian::Hamiltonian;
use crate::scalar::Tangent;

/// `x = x_start` at the start. At the end, for each joint j: its position as given, or `(y_q + P'y_p)_j = 0`; its rate as
/// given, or `(M y_p)_j = 0`.
///
/// As p = M v, moving q_j at fixed rates moves p by `P e_j`, P = d(M v)/dq, and moving v_j moves it by `M e_j`: these are
/// the directions in which a free end may not gain. Their derivatives come from one dual pass for each component of x.
#[derive(Clone, Debug)]
pub(super) struct Ends {
    start: Vec<f64>,
    /// q and p at an end that is all given.
    end: Vec<f64>,
    v: Vec<f64>,
    /// (q, v) at the start and at the end asked for.
    asked: [Vec<f64>; 2],
    q_free: Vec<bool>,
    v_free: Vec<bool>,
    dual: Hamiltonian<Tangent<f64>>,
    q: Vec<Tangent<f64>>,
    p: Vec<Tangent<f64>>,
    rates: Vec<Tangent<f64>>,
}

impl Ends {
    pub fn new(problem: &Problem) -> Result<Self, EvalError> {
        let n = problem.robot.len();
        let mut hamiltonian = Hamiltonian::<f64>::new(&problem.robot);
        let mut state = |q: &[f64], v: &[f64]| -> Result<Vec<f64>, EvalError> {
            hamiltonian.inverse_mass_matrix(q)?;
            Ok(q.iter().chain(hamiltonian.momentum(q, v)?).copied().collect())
        };
        let zero = Tangent::new(0.0, 0.0);
        let marked = |joints: &[usize]| (0..n).map(|j| joints.contains(&j)).collect();
        Ok(Self {
            start: state(&problem.start.q, &problem.start.v)?,
            end: state(&problem.end.q, &problem.end.v)?,
            v: problem.end.v.clone(),
            asked: [
                problem.start.q.iter().chain(&problem.start.v).copied().collect(),
                problem.end.q.iter().chain(&problem.end.v).copied().collect(),
            ],
            q_free: marked(&problem.end.q_free),
            v_free: marked(&problem.end.v_free),
            dual: Hamiltonian::new(&problem.robot),
            q: vec![zero; n],
            p: vec![zero; n],
            rates: vec![zero; n],
        })
    }

    /// An end that lies a part of the way from the start to the one asked for, in positions and rates.
    pub fn set_goal(&mut self, goal: f64) {
        let n = self.v.len();
        let [from, to] = &self.asked;
        let part = |i: usize| if goal == 1.0 { to[i] } else { from[i] + goal * (to[i] - from[i]) };
        for i in 0..n {
            self.end[i] = part(i);
            self.v[i] = part(n + i);
            self.q[i] = Tangent::new(self.end[i], 0.0);
            self.rates[i] = Tangent::new(self.v[i], 0.0);
        }
        if let Ok(momentum) = self.dual.momentum(&self.q, &self.rates) {
            self.end[n..].iter_mut().zip(momentum).for_each(|(end, p)| *end = p.re);
        }
    }

    /// Whether nothing is free at the end.
    pub fn are_fixed(&self) -> bool {
        !self.q_free.iter().chain(&self.v_free).any(|&free| free)
    }

    pub fn start(&self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        equal(&self.start, z, residual, jacobian);
    }

    pub fn end(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        if self.are_fixed() {
            equal(&self.end, z, residual, jacobian);
            return Ok(());
        }
        let n = self.v.len();
        jacobian.fill(0.0);
        for direction in 0..2 * n {
            self.along(z, direction, residual, jacobian)?;
        }
        Ok(())
    }

    /// Residuals, and the column of the Jacobian that belongs to one component of x; with the first the columns of y.
    fn along(
        &mut self,
        z: &[f64],
        direction: usize,
        residual: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<(), EvalError> {
        let n = self.v.len();
        let (y_q, y_p) = (&z[2 * n..3 * n], &z[3 * n..]);
        for i in 0..n {
            let seed = |component: usize| if component == direction { 1.0 } else { 0.0 };
            self.q[i] = Tangent::new(z[i], seed(i));
            self.p[i] = Tangent::new(z[n + i], seed(n + i));
        }
        self.rates.copy_from_slice(self.dual.velocity(&self.q, &self.p)?);
        let map = self.dual.momentum_jacobian(&self.q, &self.rates)?;
        for j in 0..n {
            let mut set = |row: usize, value: Tangent<f64>| {
                residual[row] = value.re;
                jacobian[row * 4 * n + direction] = value.eps;
            };
            let pull = |matrix: &crate::matrix::Matrix<Tangent<f64>>| {
                (0..n).fold(Tangent::new(0.0, 0.0), |sum, k| {
                    let entry = matrix[(k, j)];
                    Tangent::new(sum.re + entry.re * y_p[k], sum.eps + entry.eps * y_p[k])
                })
            };
            if self.q_free[j] {
                let value = pull(map.dp_dq);
                set(j, Tangent::new(value.re + y_q[j], value.eps));
            } else {
                set(j, Tangent::new(self.q[j].re - self.end[j], self.q[j].eps));
            }
            if self.v_free[j] {
                set(n + j, pull(map.dp_dv));
            } else {
                set(n + j, Tangent::new(self.rates[j].re - self.v[j], self.rates[j].eps));
            }
            if direction == 0 {
                for k in 0..n {
                    if self.q_free[j] {
                        jacobian[j * 4 * n + 3 * n + k] = map.dp_dq[(k, j)].re;
                    }
                    if self.v_free[j] {
                        jacobian[(n + j) * 4 * n + 3 * n + k] = map.dp_dv[(k, j)].re;
                    }
                }
                if self.q_free[j] {
                    jacobian[j * 4 * n + 2 * n + j] = 1.0;
                }
            }
        }
        Ok(())
    }
}

/// `x - given = 0`.
fn equal(given: &[f64], z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
    jacobian.fill(0.0);
    for (i, given) in given.iter().enumerate() {
        residual[i] = z[i] - given;
        jacobian[i * z.len() + i] = 1.0;
    }
}
