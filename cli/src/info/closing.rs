//! Whether the loops of a robot can be closed, and which of their rows count there.

use costate::configuration::ConfigurationSpace;
use costate::constraints::{ConstrainedHamiltonian, ConstraintError};
use costate::robot::Robot;

/// Most positions from which one is looked for that is not singular, and how far they are from each other
/// (rad, m).
const ATTEMPTS: usize = 4;
const STEP: f64 = 0.1;

/// The constraints of a robot near q = 0.
pub enum Loops {
    /// Rows that depend on others where all are satisfied, for each constraint, from 0; and how many do not.
    Closed { redundant: Vec<Vec<usize>>, rank: usize },
    /// No position was found that satisfies all of them.
    Open(ConstraintError),
    /// There are none, or the robot cannot be evaluated, or all positions that were found are singular.
    Unknown,
}

impl Loops {
    pub fn of(robot: &Robot) -> Self {
        if robot.constraints().is_empty() {
            return Self::Unknown;
        }
        let mut model = ConstrainedHamiltonian::<f64>::new(robot);
        for attempt in 0..ATTEMPTS {
            match regular(robot, &mut model, attempt) {
                Ok(false) => {}
                Ok(true) => return Self::counted(robot, &model),
                Err(ConstraintError::Evaluation(_)) => break,
                Err(cause) if attempt == 0 => return Self::Open(cause),
                Err(_) => break,
            }
        }
        Self::Unknown
    }

    fn counted(robot: &Robot, model: &ConstrainedHamiltonian<f64>) -> Self {
        let mut rest = model.counted();
        let redundant = robot.constraints().iter().map(|one| {
            let (own, others) = rest.split_at(one.kind.rows());
            rest = others;
            own.iter().enumerate().filter(|(_, counts)| **counts == 0.0).map(|(row, _)| row).collect()
        });
        Self::Closed { redundant: redundant.collect(), rank: model.rank() }
    }
}

/// Moves the model to a position that satisfies the constraints; whether it is no singular one.
fn regular(
    robot: &Robot,
    model: &mut ConstrainedHamiltonian<f64>,
    attempt: usize,
) -> Result<bool, ConstraintError> {
    let (space, n) = (ConfigurationSpace::new(robot), robot.dof());
    let mut q = space.neutral();
    if attempt > 0 {
        let by: Vec<f64> = (0..n).map(|i| STEP * (1.0 + 2.0 * i as f64 + attempt as f64).sin()).collect();
        let from = q.clone();
        space.integrate(&from, &by, &mut q)?;
    }
    model.close(&mut q, &vec![false; n])?;
    let is_singular = model.singular_row(&q)?.is_some();
    let still = vec![0.0; n];
    model.velocity(&q, &still)?;
    Ok(!is_singular)
}
