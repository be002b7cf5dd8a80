//! Numbers of messages.

use costate::robot::printable_number;

/// Four digits of a number that was computed; those that a user gave are shown as they are. Zero has no sign.
pub(crate) fn rounded(number: f64) -> String {
    shown(format!("{number:.3e}").parse().unwrap_or(number))
}

/// The least number of `digits` significant digits that is not below `x`, which is positive.
pub(crate) fn rounded_up(x: f64, digits: usize) -> f64 {
    let shown = |x: f64| format!("{x:.*e}", digits.saturating_sub(1)).parse::<f64>().unwrap_or(x);
    let nearest = shown(x);
    if nearest >= x {
        return nearest;
    }
    // One unit of the last digit more.
    shown(nearest + 10.0_f64.powi(x.log10().floor() as i32 + 1 - digits as i32))
}

/// A position (rad, m) that can be given as it is shown: to 1e-10.
pub(crate) fn coordinate(number: f64) -> String {
    shown(format!("{number:.10}").parse().unwrap_or(number))
}

/// Six digits of the ends of a range that was computed, and none of what is small beside it.
pub(crate) fn rounded_range(ends: [f64; 2]) -> [String; 2] {
    let size = ends.iter().filter(|end| end.is_finite()).fold(0.0_f64, |size, end| size.max(end.abs()));
    ends.map(|end| match end.abs() < 1e-9 * size {
        true => shown(0.0),
        false => shown(format!("{end:.5e}").parse().unwrap_or(end)),
    })
}

/// Zero has no sign.
fn shown(number: f64) -> String {
    printable_number(if number == 0.0 { 0.0 } else { number })
}

#[cfg(test)]
mod tests {
    use super::{coordinate, rounded, rounded_range, rounded_up};

    #[test]
    fn four_digits_are_left() {
        let numbers = [0.346_548_589, -0.0, 12_345.678, 6.666_666_6e9, -1e-9, f64::INFINITY, f64::NAN];
        assert_eq!(numbers.map(rounded), ["0.3465", "0", "12350", "6.667e9", "-1e-9", "inf", "NaN"]);
        assert_eq!([1.0 / 3.0, -1e-14, 12.5].map(coordinate), ["0.3333333333", "0", "12.5"]);
        assert_eq!(rounded_range([-2.3e-32, 3.190_999_9]), ["0", "3.191"]);
        assert_eq!(rounded_range([-0.0, 0.0]), ["0", "0"]);
        assert_eq!(rounded_range([f64::NEG_INFINITY, 2.718_254_5]), ["-inf", "2.71825"]);
    }

    #[test]
    fn rounded_up_numbers_are_no_smaller_and_shown_whole() {
        let cases = [(2.00001, 2.001), (2.0, 2.0), (0.99999, 1.0), (12_034.98, 12_040.0), (9.9991, 10.0)];
        for (x, expected) in cases {
            let found = rounded_up(x, 4);
            assert!(found >= x && (found - expected).abs() < 1e-12 * expected, "{x}: {found}");
            assert_eq!(rounded(found).parse::<f64>().unwrap(), found);
        }
    }
}
