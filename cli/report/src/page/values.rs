//! Numbers, names and placements as JSON.

use costate::robot::{Placement, escape_hidden};
use serde_json::{Value, json};

/// Significant digits of numbers that are drawn.
const DIGITS: usize = 7;

/// A name without hidden characters.
pub fn shown(name: &str) -> String {
    escape_hidden(name).into_owned()
}

/// Numbers as they are drawn; null where they are not finite.
pub fn list(numbers: impl Iterator<Item = f64>) -> Value {
    Value::Array(numbers.map(number).collect())
}

/// A number with seven significant digits.
pub fn number(x: f64) -> Value {
    let rounded: f64 = format!("{x:.*e}", DIGITS - 1).parse().unwrap_or(f64::NAN);
    // As an integer where it is one: shorter.
    if rounded == rounded.trunc() && rounded.abs() < 1e7 { json!(rounded as i64) } else { json!(rounded) }
}

/// Rotation, column by column, and translation: twelve numbers.
pub fn placement(placement: &Placement) -> Value {
    let Placement { rotation, translation } = placement;
    let rounded = |x: f64| if x.abs() < 1e-15 { 0.0 } else { x };
    json!(rotation.iter().chain(translation.iter()).map(|&x| rounded(x)).collect::<Vec<_>>())
}

/// A vector as it is drawn.
pub fn vector(x: [f64; 3]) -> Value {
    list(x.into_iter())
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_are_short() {
        let text = [0.1 + 0.2, -3.0, 1.0 / 3.0, 0.0, f64::NAN, 6.02e23].map(|x| number(x).to_string());
        assert_eq!(text, ["0.3", "-3", "0.3333333", "0", "null", "6.02e+23"]);
    }
}
