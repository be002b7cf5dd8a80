//! The gains of the optimal feedback and derivatives by limits and payloads: what `--feedback` writes.

use super::task::Task;
use costate_control::{Gains, Solution};
use std::error::Error;

/// The text of the file: gains at this rate (Hz) and at T, or at the points of the motion.
///
/// # Errors
/// A problem that the feedback is not computed for, a motion that is not solved or no strict minimum.
pub fn feedback(task: &Task, solution: &Solution, rate: Option<f64>) -> Result<String, Box<dyn Error>> {
    let gains = Gains::with_payloads(&task.problem, solution, rate, &task.payloads);
    let gains = gains.map_err(|error| format!("--feedback: {error}"))?;
    Ok(serde_json::to_string(&gains)?)
}
