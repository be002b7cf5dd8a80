//! What the cost changes by with the parameters of the robot.

use crate::report::Table;
use costate_control::{CostDerivative, Problem, Solution, cost_by_parameters};
use costate_report::numbers::short;
use std::error::Error;
use std::io::Write;

/// The derivatives of the cost by all parameters of the robot.
pub fn sensitivities(problem: &Problem, solution: &Solution) -> Result<Vec<CostDerivative>, Box<dyn Error>> {
    let found = cost_by_parameters(problem, solution, &problem.parameters());
    found.map_err(|error| format!("--sensitivities: {error}").into())
}

/// As a table.
pub fn print(derivatives: &[CostDerivative], out: &mut impl Write) -> std::io::Result<()> {
    let mut table = Table::new(&["parameter", "value", "dJ/dvalue"], 1);
    for CostDerivative { name, value, derivative, .. } in derivatives {
        table.row(vec![name.clone(), short(*value, 6), short(*derivative, 6)]);
    }
    write!(out, "\n{table}")
}
