//! Constants that are replaced by expressions.

use super::expr::Expr;
use std::collections::{HashMap, HashSet};

/// Constants that are labels of expressions, and constants that are plain numbers, by their bits without
/// sign.
pub(super) struct Labels {
    table: HashMap<u64, Expr>,
    numbers: HashSet<u64>,
}

impl Labels {
    /// Labels with their expressions, and plain numbers; `None` if two of them are equal.
    pub fn new(table: Vec<(f64, Expr)>, numbers: Vec<f64>) -> Option<Self> {
        let count = table.len();
        let table: HashMap<u64, Expr> =
            table.into_iter().map(|(label, expr)| (label.to_bits(), expr)).collect();
        let numbers: HashSet<u64> = numbers.into_iter().map(|number| number.abs().to_bits()).collect();
        let distinct = table.len() == count && !table.keys().any(|label| numbers.contains(label));
        distinct.then_some(Self { table, numbers })
    }

    /// The expression that a constant is a label of, or the constant itself; `None` for a number that is
    /// neither.
    pub fn expr(&self, constant: f64) -> Option<Expr> {
        let magnitude = constant.abs();
        if let Some(&expr) = self.table.get(&magnitude.to_bits()) {
            return Some(if constant < 0.0 { -expr } else { expr });
        }
        let literal = matches!(magnitude, 0.0 | 0.5 | 1.0 | 2.0 | 4.0);
        (literal || self.numbers.contains(&magnitude.to_bits())).then_some(Expr::fixed(constant))
    }
}
