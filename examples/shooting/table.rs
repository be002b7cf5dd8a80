//! Logs as tables.

use crate::solver::Row;
use std::fmt::Write;

/// Rows of a long log that are shown at its start and at its end.
const SHOWN: usize = 8;

/// The log, one row an iteration; a long one without its middle.
pub fn iterations(log: &[Row]) -> String {
    let mut text = String::from("   k  cost            defects    dual  compl.      mu  part   added\n");
    let last = log.len().saturating_sub(1);
    for (k, row) in log.iter().enumerate() {
        if log.len() > 3 * SHOWN && (SHOWN..=last - SHOWN).contains(&k) {
            if k == SHOWN {
                let _ = writeln!(text, "      ... {} rows left out", log.len() - 2 * SHOWN);
            }
            continue;
        }
        let _ = write!(text, "{k:4}");
        match row.is_restoration {
            true => text += &" ".repeat(50),
            false => {
                let _ = write!(text, "  {:<13.8}  {:8.1e}", row.cost, row.violation);
                let _ = write!(text, "{:8.1e}{:8.1e}{:8.1e}", row.dual, row.complementarity, row.mu);
            }
        }
        if k > 0 {
            let what = if row.is_restoration { "  restoration" } else { "" };
            let _ = write!(text, "{:6.2}{:8.1e}{what}", row.part, row.added);
        }
        text.push('\n');
    }
    text
}

/// What the last step left of the error.
pub fn last_ratio(log: &[Row]) -> Option<f64> {
    let [.., before, after] = log else { return None };
    let ratio = after.error() / before.error();
    (after.part > 0.0 && ratio.is_finite()).then_some(ratio)
}
