//! Relative error of every method, block by block: `max |a - b| / max |b|` over a block, b by numbers that
//! are exact to rounding.

use costate_routes::cases::Case;
use costate_routes::numbers::GRADIENT;
use costate_routes::routes::{Candidate, Failure};
use costate_routes::{FIRST, FUNCTION};

/// Exact methods must agree to this much at a state where M is well conditioned.
const EXACT: f64 = 1e-9;

/// Central differences lose half of the digits, more where second derivatives are large.
const DIFFERENCES: f64 = 1e-4;

/// A block that is smaller than this part of the largest is all rounding, and measured by the largest.
const ROUNDING: f64 = 1e-14;

/// What b is computed by: dual numbers for F and F_x, hyper-dual pairs for y'F_xx.
pub fn judge(quantity: &str) -> &'static str {
    match quantity {
        FUNCTION => GRADIENT,
        FIRST => "dual numbers, 1 at once",
        _ => "hyper-dual pairs through F",
    }
}

/// The largest error of a method, and in which block.
#[derive(Clone, Copy)]
pub struct Error {
    pub relative: f64,
    pub block: &'static str,
}

/// Errors in the order of the list.
pub fn check(case: &Case, list: &mut [Candidate<'_>]) -> Result<Vec<Error>, Failure> {
    let mut figures = Vec::new();
    for candidate in list.iter_mut() {
        let mut found = Vec::new();
        (candidate.work)(Some(&mut found))?;
        figures.push(found);
    }
    let mut errors = Vec::new();
    for (candidate, found) in list.iter().zip(&figures) {
        let of_judge = |other: &Candidate<'_>| {
            other.quantity == candidate.quantity && other.route == judge(other.quantity)
        };
        let expected = list.iter().position(of_judge).ok_or("a quantity without its judge")?;
        let error = worst(found, &figures[expected], case.robot.dof());
        let most = if candidate.route.contains("differences") { DIFFERENCES } else { EXACT };
        if error.relative.is_nan() || error.relative > most {
            let Candidate { quantity, route, .. } = candidate;
            let Error { relative, block } = error;
            return Err(
                format!("{}: {quantity} by {route} is off by {relative:.1e} in {block}", case.title).into()
            );
        }
        errors.push(error);
    }
    Ok(errors)
}

/// Blocks of F are its halves, those of F_x and y'F_xx the four n x n ones: rows, then columns.
fn block(entry: usize, entries: usize, n: usize) -> usize {
    let order = 2 * n;
    if entries == order { 3 * (entry / n) } else { 2 * (entry / order / n) + entry % order / n }
}
const HALVES: [&str; 4] = ["q", "", "", "p"];
const BLOCKS: [&str; 4] = ["qq", "qp", "pq", "pp"];

fn worst(a: &[f64], b: &[f64], n: usize) -> Error {
    let entries = b.len();
    let names = if entries == 2 * n { HALVES } else { BLOCKS };
    if a.len() != entries {
        return Error { relative: f64::INFINITY, block: "its length" };
    }
    let [mut errors, mut scales] = [[0.0; 4]; 2];
    let keep = |most: &mut f64, value: f64| {
        if value.is_nan() || value > *most {
            *most = value;
        }
    };
    for (entry, (a, b)) in a.iter().zip(b).enumerate() {
        let block = block(entry, entries, n);
        keep(&mut errors[block], (a - b).abs());
        keep(&mut scales[block], b.abs());
    }
    let largest = scales.into_iter().fold(0.0, f64::max);
    let mut worst = Error { relative: 0.0, block: "" };
    for ((error, scale), block) in errors.into_iter().zip(scales).zip(names) {
        let relative = error / if scale > ROUNDING * largest { scale } else { largest };
        if relative.is_nan() || relative > worst.relative {
            worst = Error { relative, block };
        }
    }
    worst
}

/// What stands in a table.
impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.relative == 0.0 {
            return write!(f, "0");
        }
        write!(f, "{:.0e} {}", self.relative, self.block)
    }
}
