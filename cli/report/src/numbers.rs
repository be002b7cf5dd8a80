//! Formatted numbers and positions of ticks.

pub use costate_control::numbers::{scientific, short};

/// `2.5e-2`, `5e-2`.
pub(crate) fn tick(x: f64) -> String {
    format!("{x:.1e}").replace(".0e", "e")
}

/// A number with a fixed count of decimals, from a million on with an exponent; zero has no sign.
pub fn fixed(x: f64, decimals: usize) -> String {
    if x.abs() >= 1e6 && x.is_finite() {
        return format!("{x:.decimals$e}");
    }
    let text = format!("{x:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.chars().all(|c| matches!(c, '0' | '.')) => digits.into(),
        _ => text,
    }
}

/// Multiples of 1, 2 or 5 times a power of ten within `low..high`, about `count` of them.
pub(crate) fn ticks(low: f64, high: f64, count: usize) -> Vec<f64> {
    let raw = (high - low) / count.max(1) as f64;
    let power = 10_f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|&step| step >= raw * 0.999);
    let step = step.unwrap_or(10.0 * power);
    let (first, last) = ((low / step - 1e-9).ceil() as i64, (high / step + 1e-9).floor() as i64);
    if !step.is_finite() || last - first > 100 {
        return Vec::new();
    }
    (first..=last).map(|k| k as f64 * step).collect()
}

/// Powers of ten within `low..high`, at most about eight; if there are few, also 2 and 5 times them; within
/// less than a decade any round numbers.
pub(crate) fn decades(low: f64, high: f64) -> Vec<f64> {
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let every = 1 + (last - first).max(0) / 8;
    let factors: &[f64] = if last - first <= 3 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let powers = (first..=last).filter(|power| power.rem_euclid(every) == 0);
    let all = powers.flat_map(|power| factors.iter().map(move |factor| factor * 10_f64.powi(power)));
    let within: Vec<f64> = all.filter(|x| (low..=high).contains(x)).collect();
    if within.len() < 2 { ticks(low, high, 4) } else { within }
}

/// A range of positive width that contains all values; `None` without values.
pub(crate) fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let finite = values.filter(|x| x.is_finite());
    let (low, high) = finite.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
    if low > high {
        return None;
    }
    let size = low.abs().max(high.abs());
    let least = if size == 0.0 { 1.0 } else { 1e-9 * size };
    let widen = if high - low >= least { 0.0 } else { 0.5 * size.max(least) };
    Some((low - widen, high + widen))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_short_exponents() {
        assert_eq!([0.025, 1e-12].map(tick), ["2.5e-2", "1e-12"]);
    }

    #[test]
    fn fixed_numbers_have_no_negative_zero() {
        assert_eq!(
            [fixed(-0.00001, 3), fixed(-0.0, 0), fixed(-0.05, 1), fixed(1e308, 1)],
            ["0.000", "0", "-0.1", "1.0e308"]
        );
    }

    #[test]
    fn ticks_are_round_and_lie_within_the_range() {
        let close =
            |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(close(&ticks(-0.1, 1.0, 5), &[0.0, 0.5, 1.0]));
        assert!(close(&ticks(0.0, 100.0, 5), &[0.0, 20.0, 40.0, 60.0, 80.0, 100.0]));
        assert!(ticks(0.0, f64::NAN, 5).is_empty());
        assert_eq!(decades(2e-3, 5e1), [1e-2, 1e-1, 1.0, 10.0]);
        assert_eq!(decades(0.015, 0.3), [0.02, 0.05, 0.1, 0.2]);
        assert!(close(&decades(0.021, 0.049), &[0.03, 0.04]));
        assert_eq!(decades(3e-12, 2e7).len(), 6);
    }

    #[test]
    fn a_range_is_never_empty() {
        assert_eq!(range([0.0, 0.0].into_iter()), Some((-0.5, 0.5)));
        assert_eq!(range([2.0, 3.0, f64::NAN].into_iter()), Some((2.0, 3.0)));
        assert_eq!(range(std::iter::empty()), None);
        assert_eq!(range([-4.0].into_iter()), Some((-6.0, -2.0)));
    }
}
