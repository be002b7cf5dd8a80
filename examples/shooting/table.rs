//! Logs as tables.

use crate::solver::Row;
use std::fmt::Write;

/// Rows of a long log that are shown at its start and at its end.
const SHOWN: usize = 8;

/// The log, one row an iteration; a long one without its middle.
pub fn iterations(log: &[Row]) -> String {
    let mut text =
        String::from("   k  cost            defects    dual  compl.      mu    step  part  convex\n");
    let last = log.len().saturating_sub(1);
    for (k, row) in log.iter().enumerate() {
        if log.len() > 3 * SHOWN && (SHOWN..=last - SHOWN).contains(&k) {
            if k == SHOWN {
                let _ = writeln!(text, "      ... {} rows left out", log.len() - 2 * SHOWN);
            }
            continue;
        }
        let _ = write!(text, "{k:4}  {:<13.8}  {:8.1e}", row.cost, row.violation);
        let _ = write!(text, "{:8.1e}{:8.1e}{:8.1e}", row.dual, row.complementarity, row.mu);
        if k < last {
            let corrected = if row.second_order { "  corrected" } else { "" };
            let _ = write!(text, "{:8.1e}{:6.2}{:8.3}{corrected}", row.step, row.part, row.convexified);
        }
        text.push('\n');
    }
    text
}

/// The error reduction of the last step with constant mu.
pub fn last_ratio(log: &[Row]) -> Option<f64> {
    let pairs = log.windows(2).rev();
    let mut ratios = pairs.filter(|pair| pair[0].mu == pair[1].mu);
    ratios.next().map(|pair| pair[1].barrier_error() / pair[0].barrier_error())
}
