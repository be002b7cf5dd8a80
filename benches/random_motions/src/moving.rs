//! A motion that was found, at any time: position, rate, acceleration, torque.

use costate::constraints::Constraints;
use costate::lagrangian::Lagrangian;
use costate::robot::Robot;
use costate_control::{Problem, Solution};
use nalgebra::{DMatrix, DVector};

/// The motion at one time.
#[derive(Clone, Debug)]
pub struct State {
    pub t: f64,
    pub phase: usize,
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub a: Vec<f64>,
    /// Torques that the robot needs for q, v and a: by inverse dynamics where they follow from these.
    pub needed: Vec<f64>,
    /// Torques as the solution has them, cut to their limits.
    pub given: Vec<f64>,
}

/// A solution with the robot of each of its phases.
pub struct Moving<'a> {
    pub problem: &'a Problem,
    pub solution: &'a Solution,
    pub robots: Vec<Robot>,
    models: Vec<Model>,
}

/// What gives the torques of a motion.
enum Model {
    Tree(Box<Lagrangian<f64>>),
    /// `S' tau - J' lambda = M a + c` for as many motors as the loops leave degrees of freedom.
    Loop {
        tree: Box<Lagrangian<f64>>,
        rows: Box<Constraints<f64>>,
        motors: Vec<usize>,
    },
    /// Torques do not follow from the motion alone: those of the solution count.
    Given,
}

impl<'a> Moving<'a> {
    pub fn new(problem: &'a Problem, solution: &'a Solution) -> Self {
        let mut robots = vec![problem.robot.clone()];
        for via in &problem.vias {
            let before = robots[robots.len() - 1].clone();
            let loaded = via.payload.as_ref().and_then(|payload| {
                payload
                    .iter()
                    .try_fold(problem.robot.clone(), |robot, body| {
                        robot.with_payload(&body.frame, &body.inertia)
                    })
                    .ok()
            });
            robots.push(loaded.unwrap_or(before));
        }
        let models = robots.iter().map(|robot| Model::new(problem, robot)).collect();
        Self { problem, solution, robots, models }
    }

    /// Whether torques are those of the solution at its nodes, interpolated.
    pub fn torques_are_interpolated(&self) -> bool {
        self.models.iter().any(|model| matches!(model, Model::Given))
    }

    pub fn start(&self) -> f64 {
        self.solution.trajectory.t.first().copied().unwrap_or(f64::NAN)
    }

    pub fn end(&self) -> f64 {
        self.solution.trajectory.t.last().copied().unwrap_or(f64::NAN)
    }

    /// The motion at these times; `None` if it cannot be evaluated there.
    pub fn at(&mut self, times: &[f64]) -> Option<Vec<State>> {
        let mut states = Vec::with_capacity(times.len());
        for times in times.chunks(100_000) {
            let samples = self.solution.sample_at(self.problem, times).ok()?;
            let rows = samples.q.into_iter().zip(samples.v).zip(samples.a).zip(samples.tau);
            for (&t, (((q, v), a), given)) in times.iter().zip(rows) {
                let phase = self.solution.trajectory.phase_at(t).min(self.models.len() - 1);
                let needed = self.models[phase].torques(&q, &v, &a, &given)?;
                states.push(State { t, phase, q, v, a, needed, given });
            }
        }
        Some(states)
    }

    /// The times of its rows, each once: polynomials join there.
    pub fn joints_of_polynomials(&self) -> Vec<f64> {
        let mut times = self.solution.trajectory.t.clone();
        times.dedup();
        times
    }
}

impl Model {
    fn new(problem: &Problem, robot: &Robot) -> Self {
        if problem.gait.is_some() || !robot.free_joints().is_empty() {
            return Self::Given;
        }
        let tree = Box::new(Lagrangian::new(&robot.without_constraints()));
        if robot.constraints().is_empty() {
            return Self::Tree(tree);
        }
        let rows = Box::new(Constraints::new(robot));
        let limits = problem.joint_limits();
        let motors: Vec<usize> =
            (0..robot.dof()).filter(|&i| limits[i].torque[0] < limits[i].torque[1]).collect();
        match motors.len() + rows.count() == robot.dof() {
            true => Self::Loop { tree, rows, motors },
            false => Self::Given,
        }
    }

    fn torques(&mut self, q: &[f64], v: &[f64], a: &[f64], given: &[f64]) -> Option<Vec<f64>> {
        match self {
            Self::Tree(tree) => Some(tree.inverse_dynamics(q, v, a).ok()?.to_vec()),
            Self::Loop { tree, rows, motors } => {
                let load = DVector::from_column_slice(tree.inverse_dynamics(q, v, a).ok()?);
                rows.set_position(q).ok()?;
                let n = q.len();
                let mut matrix = DMatrix::zeros(n, n);
                for (column, &motor) in motors.iter().enumerate() {
                    matrix[(motor, column)] = 1.0;
                }
                let jacobian = rows.jacobian();
                for row in 0..rows.count() {
                    for i in 0..n {
                        matrix[(i, motors.len() + row)] = -jacobian[(row, i)];
                    }
                }
                let found = matrix.lu().solve(&load)?;
                let mut torques = vec![0.0; n];
                for (column, &motor) in motors.iter().enumerate() {
                    torques[motor] = found[column];
                }
                Some(torques)
            }
            Self::Given => Some(given.to_vec()),
        }
    }
}
