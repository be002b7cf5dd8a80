//! Numbers in words.

/// At most `digits` significant digits without trailing zeros; very large and very small numbers get an
/// exponent.
pub fn short(x: f64, digits: usize) -> String {
    if x == 0.0 {
        return "0".into();
    }
    if !x.is_finite() {
        return if x.is_nan() { "-".into() } else { x.to_string() };
    }
    let scientific = format!("{x:.*e}", digits.saturating_sub(1));
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let power: i32 = exponent.parse().unwrap_or(0);
    if (-4..7).contains(&power) {
        let decimals = (digits as i32 - 1 - power).max(0) as usize;
        return trimmed(&format!("{x:.decimals$}")).into();
    }
    format!("{}e{power}", trimmed(mantissa))
}

/// Two digits and an exponent, for a number that should be zero; an exact zero as such.
pub fn scientific(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{x:.1e}") }
}

/// Two numbers with four digits, or as many more as tell them apart.
pub(super) fn apart(a: f64, b: f64) -> (String, String) {
    let with = |digits| (short(a, digits), short(b, digits));
    (4..=17).map(with).find(|(a, b)| a != b).unwrap_or_else(|| with(17))
}

/// Without trailing zeros of the fraction.
fn trimmed(number: &str) -> &str {
    if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_have_at_most_the_given_digits_and_no_trailing_zeros() {
        for (x, digits, text) in [
            (145.13113754, 8, "145.13114"),
            (1.0, 6, "1"),
            (0.0, 3, "0"),
            (-0.00012, 3, "-0.00012"),
            (1.5e-7, 3, "1.5e-7"),
            (12_345_678.0, 3, "1.23e7"),
            (0.30000000000000004, 6, "0.3"),
            (f64::NAN, 3, "-"),
        ] {
            assert_eq!(short(x, digits), text);
        }
    }
}
