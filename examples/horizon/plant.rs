//! The arms, their goals, and how they move.

use costate::EvalError;
use costate::lagrangian::Lagrangian;
use costate::robot::Robot;
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
    /// The middle of the goal, and how far it swings (rad).
    middle: Vec<f64>,
    swing: Vec<f64>,
    model: Lagrangian<f64>,
}

/// The goal of joint i swings at 0.5 + 0.1 i rad/s.
const FREQUENCY: [f64; 2] = [0.5, 0.1];

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

    /// The UR5 as its URDF describes it, without rotor inertia.
    pub fn ur5() -> Result<Self, Box<dyn Error>> {
        let middle = [0.4, -1.3, 1.6, -1.8, -1.57, 0.3];
        Self::new("ur5.urdf", &middle, &[0.9, 0.4, 0.5, 0.5, 0.4, 0.6], &[0.5, -0.3, 0.3, 0.3, 0.2, -0.4])
    }

    /// The Panda as its URDF describes it.
    pub fn panda() -> Result<Self, Box<dyn Error>> {
        let middle = [0.1, -0.2, 0.0, -1.7, 0.1, 1.7, 0.5];
        let away = [0.4, -0.2, 0.3, 0.3, 0.2, -0.3, 0.4];
        Self::new("panda.urdf", &middle, &[0.7, 0.4, 0.5, 0.4, 0.5, 0.5, 0.6], &away)
    }

    /// At rest, `away` from the middle of its goal.
    fn new(file: &str, middle: &[f64], swing: &[f64], away: &[f64]) -> Result<Self, Box<dyn Error>> {
        let robot = Robot::from_file(format!("{}/../robots/{file}", env!("CARGO_MANIFEST_DIR")))?;
        let n = robot.dof();
        Ok(Self {
            time: 0.0,
            q: middle.iter().zip(away).map(|(q, away)| q + away).collect(),
            v: vec![0.0; n],
            torques: vec![0.0; n],
            middle: middle.to_vec(),
            swing: swing.to_vec(),
            model: Lagrangian::new(&robot),
            robot,
        })
    }

    /// Writes position and rate of the goal at a time.
    pub fn goal(&self, time: f64, q: &mut [f64], v: &mut [f64]) {
        for i in 0..q.len() {
            let frequency = FREQUENCY[0] + FREQUENCY[1] * i as f64;
            let (sin, cos) = (frequency * time + i as f64).sin_cos();
            (q[i], v[i]) = (self.middle[i] + self.swing[i] * sin, self.swing[i] * frequency * cos);
        }
    }

    /// Moves for a period under torques that are a function of the time since its begin and of the state: steps of
    /// Runge and Kutta's method of order four.
    pub fn advance(
        &mut self,
        period: f64,
        mut torques: impl FnMut(f64, &[f64], &[f64], &mut [f64]) -> Result<(), EvalError>,
    ) -> Result<(), EvalError> {
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
                torques(step as f64 * h + part, q, v, &mut self.torques)?;
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
