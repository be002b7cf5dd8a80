//! The gains of the optimal feedback and derivatives by limits: what `--feedback` writes.

use costate_control::{Gains, Problem, Solution};
use std::error::Error;

/// The text of the file: gains at this rate (Hz) and at T, or at the points of the motion.
///
/// # Errors
/// A problem that the feedback is not computed for, a motion that is not solved or no strict minimum.
pub fn feedback(problem: &Problem, solution: &Solution, rate: Option<f64>) -> Result<String, Box<dyn Error>> {
    let gains = Gains::new(problem, solution, rate).map_err(|error| format!("--feedback: {error}"))?;
    Ok(serde_json::to_string(&gains)?)
}
