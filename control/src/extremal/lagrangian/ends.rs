//! Conditions at the two ends of a robot's motion in Lagrangian coordinates.

use crate::problem::Problem;

/// At each end every component of x = (q, v) as given, or its costate zero.
#[derive(Clone, Debug)]
pub(crate) struct LagrangianEnds {
    start: Given,
    /// That which is aimed at now.
    end: Given,
    /// x of the end asked for.
    asked: Vec<f64>,
}

/// What is given at one end.
#[derive(Clone, Debug)]
struct Given {
    x: Vec<f64>,
    free: Vec<bool>,
}

impl LagrangianEnds {
    pub fn new(problem: &Problem) -> Self {
        let Problem { start, end, .. } = problem;
        let end = Given::new((&end.q, &end.v), (&end.q_free, &end.v_free));
        let start = Given::new((&start.q, &start.v), (&start.q_free, &start.v_free));
        Self { start, asked: end.x.clone(), end }
    }

    /// An end that lies a part of the way from the start to the one asked for.
    pub fn set_goal(&mut self, goal: f64) {
        for ((end, &to), &from) in self.end.x.iter_mut().zip(&self.asked).zip(&self.start.x) {
            *end = if goal == 1.0 { to } else { from + goal * (to - from) };
        }
    }

    /// Whether nothing is free.
    pub fn are_fixed(&self) -> bool {
        !self.start.free.iter().chain(&self.end.free).any(|&free| free)
    }

    pub fn start(&self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        self.start.conditions(z, residual, jacobian);
    }

    pub fn end(&self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        self.end.conditions(z, residual, jacobian);
    }
}

impl Given {
    fn new((q, v): (&[f64], &[f64]), (q_free, v_free): (&[usize], &[usize])) -> Self {
        let n = q.len();
        let free_q = (0..n).map(|j| q_free.contains(&j));
        let free = free_q.chain((0..n).map(|j| v_free.contains(&j))).collect();
        Self { x: [q, v].concat(), free }
    }

    fn conditions(&self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        jacobian.fill(0.0);
        let states = self.x.len();
        for (i, (given, &free)) in self.x.iter().zip(&self.free).enumerate() {
            let (at, value) = if free { (states + i, z[states + i]) } else { (i, z[i] - given) };
            residual[i] = value;
            jacobian[i * z.len() + at] = 1.0;
        }
    }
}
