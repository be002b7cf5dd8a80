//! A solution as JSON: its form in files, and with all that it holds, for another process.

use super::nodes::Interpolant;
use super::solution::Solution;
use crate::progress::Iteration;
use serde::{Deserialize, Deserializer, Serialize};

/// The JSON form of a solution and what it leaves out: numbers between the nodes, and how it was found. What
/// stages took is left out here too.
#[derive(Serialize, Deserialize)]
struct Complete {
    solution: Solution,
    interpolant: Option<Interpolant>,
    accelerations: Option<Vec<Vec<f64>>>,
    hamiltonian: Numbers,
    errors: Numbers,
    end_state: Option<Vec<f64>>,
    iterations: Vec<Step>,
}

/// Numbers that need not be finite: null is not a number.
#[derive(Serialize)]
#[serde(transparent)]
struct Numbers(Vec<f64>);

impl<'de> Deserialize<'de> for Numbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let numbers = Vec::<Option<f64>>::deserialize(deserializer)?;
        Ok(Self(numbers.into_iter().map(|number| number.unwrap_or(f64::NAN)).collect()))
    }
}

/// An iteration whose numbers need not be finite.
#[derive(Serialize, Deserialize)]
struct Step {
    #[serde(flatten)]
    iteration: Iteration,
    numbers: Numbers,
}

impl From<Iteration> for Step {
    fn from(mut iteration: Iteration) -> Self {
        let Iteration { residual, step, final_time, cost, .. } = &mut iteration;
        let numbers = [residual, step, final_time, cost].map(std::mem::take);
        Self { iteration, numbers: Numbers(numbers.to_vec()) }
    }
}

impl From<Step> for Iteration {
    fn from(Step { mut iteration, numbers }: Step) -> Self {
        let Self { residual, step, final_time, cost, .. } = &mut iteration;
        for (to, from) in [residual, step, final_time, cost].into_iter().zip(numbers.0) {
            *to = from;
        }
        iteration
    }
}

impl Solution {
    /// The JSON form by serde, that of files. It is compiled once, here.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string(self)
    }

    /// Reads what [`to_json`](Self::to_json) wrote.
    ///
    /// # Errors
    /// Those of the reader.
    pub fn from_json(text: &str) -> Result<Self, serde_json::Error> {
        serde_json::from_str(text)
    }

    /// The whole solution as JSON, to go on with it in another process: with the polynomials between the
    /// nodes, the iterations and the estimated errors, which its JSON form by serde leaves out. Not for
    /// keeping: another version of this library may not read it.
    ///
    /// ```
    /// use costate_control::{Problem, Solution, Solver, SolverOptions};
    /// use costate::robot::Robot;
    /// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
    /// let robot = Robot::from_file("robots/pendulum.toml")?;
    /// let problem = Problem::rest_to_rest(robot, &[0.0], &[3.0], 1.0);
    /// let solution = Solver::new(&problem, SolverOptions::default())?.solve();
    /// let there = Solution::from_complete_json(&solution.to_complete_json()?)?;
    /// assert_eq!(there.trajectory, solution.trajectory);
    /// assert_eq!(there.motion.iterations, solution.motion.iterations);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Those of the writer.
    pub fn to_complete_json(&self) -> Result<String, serde_json::Error> {
        let complete = Complete {
            solution: self.clone(),
            interpolant: self.trajectory.interpolant.clone(),
            accelerations: self.trajectory.accelerations.clone(),
            hamiltonian: Numbers(self.trajectory.hamiltonian.clone()),
            errors: Numbers(self.motion.errors.clone()),
            end_state: self.motion.end_state.clone(),
            iterations: self.motion.iterations.iter().cloned().map(Step::from).collect(),
        };
        serde_json::to_string(&complete)
    }

    /// Reads what [`to_complete_json`](Self::to_complete_json) wrote.
    ///
    /// # Errors
    /// Those of the reader, also for lists whose lengths do not fit.
    pub fn from_complete_json(text: &str) -> Result<Self, serde_json::Error> {
        let complete: Complete = serde_json::from_str(text)?;
        let mut solution = complete.solution;
        let trajectory = &mut solution.trajectory;
        let rows = trajectory.t.len();
        let fits = |found: usize| found == rows || found == 0;
        let interpolant_fits = complete.interpolant.as_ref().is_none_or(|between| between.fits(rows));
        let accelerations_fit = complete.accelerations.as_ref().is_none_or(|rows_of| {
            rows_of.len() == rows && rows_of.iter().zip(&trajectory.q).all(|(a, q)| a.len() == q.len())
        });
        if !(interpolant_fits && accelerations_fit && fits(complete.hamiltonian.0.len())) {
            return Err(serde::de::Error::custom("lists whose lengths do not fit the nodes"));
        }
        trajectory.interpolant = complete.interpolant;
        trajectory.accelerations = complete.accelerations;
        trajectory.hamiltonian = complete.hamiltonian.0;
        solution.motion.errors = complete.errors.0;
        solution.motion.end_state = complete.end_state;
        solution.motion.iterations = complete.iterations.into_iter().map(Iteration::from).collect();
        Ok(solution)
    }
}
