//! The motions that are compared: from rest to rest with the least effort, within bounds.

use crate::problem::{Bounds, Problem};
use costate::dynamics::{Dynamics, QuadraticCost};
use costate::hamiltonian::HamiltonianSecondOrder as Canonical;
use costate::lagrangian::LagrangianSecondOrder as Rates;
use costate::robot::{Robot, RobotError};
use costate::step::RungeKutta4;

/// The data of a motion, independent of the coordinates.
#[derive(Clone)]
pub struct Motion {
    pub robot: Robot,
    pub from: Vec<f64>,
    pub to: Vec<f64>,
    pub duration: f64,
    pub intervals: usize,
    /// Largest actuation.
    pub effort: Vec<f64>,
    /// Actuation units: the cost of one unit is the same in all joints.
    pub unit: Vec<f64>,
    /// Smallest and largest joint angles, and largest rates.
    pub angles: Bounds,
    pub rates: Vec<f64>,
}

type Effort = QuadraticCost<f64>;
/// A problem of a model under fourth-order Runge-Kutta steps.
pub type RobotProblem<D> = Problem<RungeKutta4<f64, D>, Effort, Effort>;

impl Motion {
    /// The two-link arm unfolds and turns within 3 s, its torques at most 1 Nm.
    pub fn two_link() -> Result<Self, RobotError> {
        Ok(Self {
            robot: Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/../robots/two_link.toml"))?,
            from: vec![0.0, 2.0],
            to: vec![1.5, -0.4],
            duration: 3.0,
            intervals: 40,
            effort: vec![1.0, 1.0],
            unit: vec![1.0, 1.0],
            angles: Bounds { lower: vec![-0.05, -0.5], upper: vec![3.0, 3.0] },
            rates: vec![1.2, 1.5],
        })
    }

    /// The UR5 lifts its arm and turns it by 1.8 rad about the base within 1 s, with at most a third of its
    /// rated torques.
    pub fn ur5() -> Result<Self, RobotError> {
        Ok(Self {
            robot: Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/../robots/ur5.urdf"))?,
            from: vec![0.0, -0.3, 0.6, -0.3, 0.0, 0.0],
            to: vec![1.8, -1.6, 1.4, 0.4, 1.2, 1.0],
            duration: 1.0,
            intervals: 25,
            effort: vec![14.0, 50.0, 12.0, 5.0, 5.0, 5.0],
            unit: vec![50.0, 50.0, 25.0, 5.0, 5.0, 5.0],
            angles: Bounds {
                lower: vec![-3.0, -2.8, -2.6, -3.0, -3.0, -3.0],
                upper: vec![3.0, 0.2, 2.6, 3.0, 3.0, 3.0],
            },
            rates: vec![3.0; 6],
        })
    }

    /// The same robot and bounds with other end points: `reach` is the largest change of an angle.
    pub fn elsewhere(&self, random: &mut fastrand::Rng, reach: f64) -> Self {
        let mut other = self.clone();
        for i in 0..other.from.len() {
            let room = |bounds: &Bounds| [bounds.lower[i] + 0.1, bounds.upper[i] - 0.1];
            let [lower, upper] = room(&self.angles);
            other.from[i] = lower + (upper - lower) * random.f64();
            other.to[i] = (other.from[i] + reach * (2.0 * random.f64() - 1.0)).clamp(lower, upper);
        }
        other
    }

    /// With x = (q, v): bounds on angles, rates and actuation.
    pub fn in_rates(&self) -> RobotProblem<Rates<f64>> {
        self.problem(Rates::new(&self.robot), Bounds::symmetric(&self.rates))
    }

    /// With x = (q, v): bounds on angles and actuation.
    pub fn in_free_rates(&self) -> RobotProblem<Rates<f64>> {
        self.problem(Rates::new(&self.robot), Bounds::none(self.from.len()))
    }

    /// With x = (q, p): bounds on angles and actuation.
    pub fn in_momenta(&self) -> RobotProblem<Canonical<f64>> {
        self.problem(Canonical::new(&self.robot), Bounds::none(self.from.len()))
    }

    fn problem<D: Dynamics<f64>>(&self, model: D, second: Bounds) -> RobotProblem<D> {
        let rest = vec![0.0; self.from.len()];
        let [start, end] = [&self.from, &self.to].map(|q| [&q[..], &rest].concat());
        let weights: Vec<f64> = self.unit.iter().map(|unit| 1.0 / (unit * unit)).collect();
        Problem {
            step: RungeKutta4::new(model),
            running: QuadraticCost::running(&vec![0.0; start.len()], &weights),
            terminal: QuadraticCost::terminal(&vec![0.0; start.len()]),
            intervals: self.intervals,
            h: self.duration / self.intervals as f64,
            start,
            end: Some(end),
            state_bounds: self.angles.clone().then(&second),
            control_bounds: Bounds::symmetric(&self.effort),
        }
    }
}
