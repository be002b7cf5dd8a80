//! Numbers of messages.

use costate::robot::printable_number;

/// Four digits of a number that was computed; those that a user gave are shown as they are. Zero has no sign.
pub(crate) fn rounded(number: f64) -> String {
    let digits = format!("{number:.3e}").parse().unwrap_or(number);
    printable_number(if digits == 0.0 { 0.0 } else { digits })
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn four_digits_are_left() {
        let numbers = [0.346_548_589, -0.0, 12_345.678, 6.666_666_6e9, -1e-9, f64::INFINITY, f64::NAN];
        assert_eq!(numbers.map(rounded), ["0.3465", "0", "12350", "6.667e9", "-1e-9", "inf", "NaN"]);
    }
}
