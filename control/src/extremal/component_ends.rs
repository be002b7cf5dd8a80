//! Conditions at the ends that fix components of x one by one.

use crate::problem::BoundaryState;

/// At each end every component of x has its given value, or its costate is zero.
#[derive(Clone, Debug)]
pub(crate) struct ComponentEnds {
    start: GivenComponents,
    /// The end of the current relaxation.
    end: GivenComponents,
    /// x of the original end.
    original: Vec<f64>,
}

/// The components of x at one end.
#[derive(Clone, Debug)]
pub(crate) struct GivenComponents {
    pub x: Vec<f64>,
    pub free: Vec<bool>,
}

impl ComponentEnds {
    pub fn new(start: GivenComponents, end: GivenComponents) -> Self {
        Self { start, original: end.x.clone(), end }
    }

    /// Moves the end to a fraction of the distance from the start to the original end.
    pub fn set_goal(&mut self, goal: f64) {
        for ((end, &to), &from) in self.end.x.iter_mut().zip(&self.original).zip(&self.start.x) {
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

impl GivenComponents {
    /// x = (q, v) of a robot.
    pub fn of_robot(BoundaryState { q, v, q_free, v_free, .. }: &BoundaryState) -> Self {
        let n = q.len();
        let free_q = (0..n).map(|j| q_free.contains(&j));
        let free = free_q.chain((0..n).map(|j| v_free.contains(&j))).collect();
        Self { x: [q.as_slice(), v].concat(), free }
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
