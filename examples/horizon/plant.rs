//! The arms, their goal, and how they move.

use costate::EvalError;
use costate::kinematics::Kinematics;
use costate::lagrangian::Lagrangian;
use costate::robot::Robot;
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3};
use std::error::Error;

/// An arm that moves, with a goal that moves too.
#[derive(Clone, Debug)]
pub struct Arm {
    pub robot: Robot,
    /// s.
    pub time: f64,
    /// rad.
    pub q: Vec<f64>,
    /// rad/s.
    pub v: Vec<f64>,
    /// Torques at the end of the last period (N m).
    pub torques: Vec<f64>,
    /// Name of the frame that shall be at the goal, and its number.
    pub tool: &'static str,
    frame: usize,
    /// The middle of the circle, where the tool is at first (m).
    centre: [f64; 3],
    kinematics: Kinematics<f64>,
    model: Lagrangian<f64>,
}

/// The goal goes round on a circle (m) at this rate (rad/s).
const RADIUS: f64 = 0.15;
const RATE: f64 = 1.5;

/// The acceleration (rad/s^2) that a motor at its limit gives its own rotor.
const ACCELERATION: f64 = 400.0;

/// Steps of the integration in a period.
const STEPS: usize = 4;

impl Arm {
    /// The arm of that name.
    pub fn named(name: &str) -> Result<Self, Box<dyn Error>> {
        match name {
            "ur5" => Self::ur5(),
            "panda" => Self::panda(),
            _ => Err(format!("'{name}' is not known; ur5 and panda are").into()),
        }
    }

    /// The UR5.
    pub fn ur5() -> Result<Self, Box<dyn Error>> {
        Self::new("ur5.urdf", "tool0", &[0.4, -1.3, 1.6, -1.8, -1.57, 0.3])
    }

    /// The Panda.
    pub fn panda() -> Result<Self, Box<dyn Error>> {
        Self::new("panda.urdf", "panda_link8", &[0.1, -0.2, 0.0, -1.7, 0.1, 1.7, 0.5])
    }

    /// As its URDF describes it, with the inertia of rotors, which that leaves out: at rest, with its tool in
    /// the middle of the circle.
    fn new(file: &str, tool: &'static str, q: &[f64]) -> Result<Self, Box<dyn Error>> {
        let robot = Robot::from_file(format!("{}/../robots/{file}", env!("CARGO_MANIFEST_DIR")))?;
        let n = robot.dof();
        let rotors = robot.joints().iter().map(|joint| joint.limits.effort / ACCELERATION).collect();
        let robot = robot.with_armature(DMatrix::from_diagonal(&DVector::from_vec(rotors)))?;
        let number = robot.frames().iter().position(|frame| frame.name == tool);
        let mut arm = Self {
            time: 0.0,
            q: q.to_vec(),
            v: vec![0.0; n],
            torques: vec![0.0; n],
            tool,
            frame: number.ok_or("the robot has no such frame")?,
            centre: [0.0; 3],
            kinematics: Kinematics::new(&robot),
            model: Lagrangian::new(&robot),
            robot,
        };
        arm.centre = arm.position()?;
        Ok(arm)
    }

    /// Where the tool is (m).
    pub fn position(&mut self) -> Result<[f64; 3], EvalError> {
        self.kinematics.set_state(&self.q, &self.v)?;
        Ok(self.kinematics.pose(self.frame)?.position)
    }

    /// The axes of the tool in the world.
    pub fn orientation(&mut self) -> Result<Rotation3<f64>, EvalError> {
        self.kinematics.set_state(&self.q, &self.v)?;
        let [a, b, c] = self.kinematics.pose(self.frame)?.rotation;
        let matrix = Matrix3::new(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]);
        Ok(Rotation3::from_matrix_unchecked(matrix))
    }

    /// The goal at a time (m): a circle in the vertical plane along y.
    pub fn goal(&self, time: f64) -> [f64; 3] {
        let (sin, cos) = (RATE * time).sin_cos();
        let [x, y, z] = self.centre;
        [x, y + RADIUS * cos, z + RADIUS * sin]
    }

    /// The goal with its velocity (m/s).
    pub fn goal_with_rate(&self, time: f64) -> ([f64; 3], [f64; 3]) {
        let (sin, cos) = (RATE * time).sin_cos();
        (self.goal(time), [0.0, -RADIUS * RATE * sin, RADIUS * RATE * cos])
    }

    /// Moves for a period under torques that are a function of the time since its begin: steps of
    /// Runge and Kutta's method of order four.
    pub fn advance(
        &mut self,
        period: f64,
        mut torques: impl FnMut(f64, &mut [f64]) -> Result<(), Box<dyn Error>>,
    ) -> Result<(), Box<dyn Error>> {
        let (n, h) = (self.q.len(), period / STEPS as f64);
        let mut slopes = [(); 4].map(|()| vec![0.0; 2 * n]);
        for step in 0..STEPS {
            let begin = [&self.q[..], &self.v].concat();
            for stage in 0..4 {
                let part = [0.0, 0.5, 0.5, 1.0][stage] * h;
                let mut x = begin.clone();
                if stage > 0 {
                    x.iter_mut().zip(&slopes[stage - 1]).for_each(|(x, slope)| *x += part * slope);
                }
                let (q, v) = x.split_at(n);
                torques(step as f64 * h + part, &mut self.torques)?;
                let a = self.model.forward_dynamics(q, v, &self.torques)?;
                slopes[stage][..n].copy_from_slice(v);
                slopes[stage][n..].copy_from_slice(a);
            }
            for i in 0..2 * n {
                let slope = slopes[0][i] + 2.0 * slopes[1][i] + 2.0 * slopes[2][i] + slopes[3][i];
                let x = begin[i] + h / 6.0 * slope;
                if i < n { self.q[i] = x } else { self.v[i - n] = x }
            }
        }
        self.time += period;
        Ok(())
    }
}
