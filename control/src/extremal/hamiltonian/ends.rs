//! Conditions at the two ends of a robot's motion.

use crate::problem::{BoundaryState, Problem};
use costate::EvalError;
use costate::hamiltonian::Hamiltonian;
use costate::robot::Robot;
use costate::scalar::Tangent;

/// At each end, for each joint j: its position is given or $(y_q + P^\top y_p)_j = 0$, and its rate is given
/// or $(M y_p)_j = 0$.
///
/// As p = M v, a change of $q_j$ at fixed rates changes p by $P e_j$, $P = \partial(M v)/\partial q$, and a
/// change of $v_j$ changes it by $M e_j$. Along these directions the cost must be stationary, and y is its
/// gradient up to the sign. The derivatives take one dual pass per component of x.
#[derive(Clone, Debug)]
pub(crate) struct Ends {
    start: Given,
    end: Given,
    /// (q, v) of the original end.
    original: Vec<f64>,
    work: Work,
}

/// What is given at one end.
#[derive(Clone, Debug)]
struct Given {
    /// q and p where all is given.
    x: Vec<f64>,
    v: Vec<f64>,
    q_free: Vec<bool>,
    v_free: Vec<bool>,
}

/// Residuals (2n) and their Jacobian (2n x 4n).
struct Conditions<'a> {
    residual: &'a mut [f64],
    jacobian: &'a mut [f64],
}

/// Workspace of the dual pass.
#[derive(Clone, Debug)]
struct Work {
    dual: Hamiltonian<Tangent<f64>>,
    q: Vec<Tangent<f64>>,
    p: Vec<Tangent<f64>>,
    rates: Vec<Tangent<f64>>,
}

impl Ends {
    pub fn new(problem: &Problem) -> Result<Self, EvalError> {
        let Problem { robot, start, end, .. } = problem;
        let n = robot.dof();
        let zero = Tangent::new(0.0, 0.0);
        let dual = Hamiltonian::new(robot);
        Ok(Self {
            start: Given::new(robot, start)?,
            end: Given::new(robot, end)?,
            original: end.q.iter().chain(&end.v).copied().collect(),
            work: Work { dual, q: vec![zero; n], p: vec![zero; n], rates: vec![zero; n] },
        })
    }

    /// Moves the end to a fraction of the distance from the start to the original end, in positions and
    /// rates.
    pub fn set_goal(&mut self, goal: f64) {
        let Self { start, end, original, work } = self;
        let n = end.v.len();
        let part = |from: f64, to: f64| if goal == 1.0 { to } else { from + goal * (to - from) };
        for i in 0..n {
            end.x[i] = part(start.x[i], original[i]);
            end.v[i] = part(start.v[i], original[n + i]);
            work.q[i] = Tangent::new(end.x[i], 0.0);
            work.rates[i] = Tangent::new(end.v[i], 0.0);
        }
        if let Ok(momentum) = work.dual.momentum(&work.q, &work.rates) {
            end.x[n..].iter_mut().zip(momentum).for_each(|(end, p)| *end = p.re);
        }
    }

    /// Whether nothing is free.
    pub fn are_fixed(&self) -> bool {
        self.start.is_fixed() && self.end.is_fixed()
    }

    pub fn start(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        self.start.conditions(&mut self.work, z, residual, jacobian)
    }

    pub fn end(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        self.end.conditions(&mut self.work, z, residual, jacobian)
    }
}

impl Given {
    fn new(
        robot: &Robot,
        BoundaryState { q, v, q_free, v_free, .. }: &BoundaryState,
    ) -> Result<Self, EvalError> {
        let mut hamiltonian = Hamiltonian::<f64>::new(robot);
        hamiltonian.inverse_mass_matrix(q)?;
        let x = q.iter().chain(hamiltonian.momentum(q, v)?).copied().collect();
        let marked = |joints: &[usize]| (0..robot.dof()).map(|j| joints.contains(&j)).collect();
        Ok(Self { x, v: v.clone(), q_free: marked(q_free), v_free: marked(v_free) })
    }

    fn is_fixed(&self) -> bool {
        !self.q_free.iter().chain(&self.v_free).any(|&free| free)
    }

    fn conditions(
        &self,
        work: &mut Work,
        z: &[f64],
        residual: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<(), EvalError> {
        jacobian.fill(0.0);
        if self.is_fixed() {
            for (i, given) in self.x.iter().enumerate() {
                residual[i] = z[i] - given;
                jacobian[i * z.len() + i] = 1.0;
            }
            return Ok(());
        }
        (0..self.x.len())
            .try_for_each(|direction| self.along(work, z, direction, Conditions { residual, jacobian }))
    }

    /// Residuals and the column of the Jacobian of one component of x; the first component also writes the
    /// columns of y.
    fn along(
        &self,
        Work { dual, q, p, rates }: &mut Work,
        z: &[f64],
        direction: usize,
        Conditions { residual, jacobian }: Conditions<'_>,
    ) -> Result<(), EvalError> {
        let n = self.v.len();
        let (y_q, y_p) = (&z[2 * n..3 * n], &z[3 * n..]);
        for i in 0..n {
            let seed = |component: usize| if component == direction { 1.0 } else { 0.0 };
            q[i] = Tangent::new(z[i], seed(i));
            p[i] = Tangent::new(z[n + i], seed(n + i));
        }
        rates.copy_from_slice(dual.velocity(q, p)?);
        let map = dual.linearise_momentum(q, rates)?;
        for j in 0..n {
            let mut set = |row: usize, value: Tangent<f64>| {
                residual[row] = value.re;
                jacobian[row * 4 * n + direction] = value.eps;
            };
            let pull = |matrix: &costate::matrix::Matrix<Tangent<f64>>| {
                (0..n).fold(Tangent::new(0.0, 0.0), |sum, k| {
                    let entry = matrix[(k, j)];
                    Tangent::new(sum.re + entry.re * y_p[k], sum.eps + entry.eps * y_p[k])
                })
            };
            if self.q_free[j] {
                let value = pull(map.dp_dq);
                set(j, Tangent::new(value.re + y_q[j], value.eps));
            } else {
                set(j, Tangent::new(q[j].re - self.x[j], q[j].eps));
            }
            if self.v_free[j] {
                set(n + j, pull(map.dp_dv));
            } else {
                set(n + j, Tangent::new(rates[j].re - self.v[j], rates[j].eps));
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
