//! Relative error of every route, `max |a - b| / max |b|`, b by numbers that are exact to rounding.

use crate::robots::Case;
use crate::routes::{Candidate, Failure};
use crate::{FIRST, FUNCTION};

/// Exact routes must agree to this much at a state where M is well conditioned.
const EXACT: f64 = 1e-9;

/// Central differences lose half of the digits, more where second derivatives are large.
const DIFFERENCES: f64 = 1e-4;

/// What b is computed by: dual numbers for F_x, hyper-dual pairs for y'F_xx.
pub fn judge(quantity: &str) -> &'static str {
    match quantity {
        FUNCTION => "analytic",
        FIRST => "dual numbers, 1 at once",
        _ => "hyper-dual pairs through F",
    }
}

/// Errors in the order of the list.
pub fn check(case: &Case, list: &mut [Candidate<'_>]) -> Result<Vec<f64>, Failure> {
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
        let error = relative(found, &figures[expected]);
        let most = if candidate.route.contains("differences") { DIFFERENCES } else { EXACT };
        if error.is_nan() || error > most || found.is_empty() {
            let Candidate { quantity, route, .. } = candidate;
            return Err(format!("{}: {quantity} by {route} is off by {error:.1e}", case.title).into());
        }
        errors.push(error);
    }
    Ok(errors)
}

fn relative(a: &[f64], b: &[f64]) -> f64 {
    if a.len() != b.len() {
        return f64::INFINITY;
    }
    let scale = b.iter().fold(0.0, |most: f64, b| most.max(b.abs()));
    let worst = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    worst.fold(0.0, |most: f64, error| if error.is_nan() || error > most { error } else { most }) / scale
}
