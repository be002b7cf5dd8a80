//! Every method for F, F_x and y'F_xx of a few robots, as the benches `scaling` and `instructions` call them.

#![allow(missing_docs, reason = "two benches are all that uses it")]

pub mod cases;
mod compiled;
mod generated;
mod names;
pub mod numbers;
pub mod robots;
#[path = "../../../cli/src/bench/routes.rs"]
pub mod routes;
pub mod texts;
#[allow(dead_code, reason = "the command line uses the rest")]
#[path = "../../../cli/src/work.rs"]
mod work;

use cases::Case;
pub use names::{FIRST, FUNCTION, NODES, SECOND};
use routes::{Candidate, Failure};

/// All methods for the three quantities, those of `costate bench` first.
pub fn candidates(case: &Case) -> Result<Vec<Candidate<'_>>, Failure> {
    wanted(case, &|_, _| true)
}

/// The same, only those methods for a quantity that are wanted: no other is compiled.
pub fn wanted<'a>(
    case: &'a Case,
    wanted: &dyn Fn(&str, &str) -> bool,
) -> Result<Vec<Candidate<'a>>, Failure> {
    let mut list = routes::candidates(&case.robot, &case.state, &mut Vec::new())?;
    // Dual numbers stand in the list of chunks.
    list.retain(|c| [FUNCTION, FIRST, SECOND].contains(&c.quantity) && c.route != "dual numbers");
    numbers::candidates(case, &mut list);
    generated::candidates(case, &mut list);
    compiled::candidates(case, wanted, &mut list)?;
    list.retain(|c| wanted(c.quantity, c.route));
    Ok(list)
}

/// States that one call of a method computes: what its time is divided by.
pub fn states(route: &str) -> usize {
    generated::states(route).or(compiled::states(route)).unwrap_or(1)
}
