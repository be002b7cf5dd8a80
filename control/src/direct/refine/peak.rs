//! The least distance to a limit in an interval, from its values at some places.

use super::between::BETWEEN;
use crate::numerics::lagrange::values;

/// The places between the points of an interval, and both its ends.
pub(crate) const WITH_ENDS: [f64; BETWEEN.len() + 2] = {
    let mut places = [0.0; BETWEEN.len() + 2];
    let mut at = 0;
    while at < BETWEEN.len() {
        places[at + 1] = BETWEEN[at];
        at += 1;
    }
    places[BETWEEN.len() + 1] = 1.0;
    places
};

/// What values between the points give at both ends.
const ENDS: [[f64; BETWEEN.len()]; 2] = [values(&BETWEEN, 0.0), values(&BETWEEN, 1.0)];

/// Where a function is least and what it is there, from its values at [`WITH_ENDS`]: by the parabola through
/// the least of them and its neighbours, which is exact for a quadratic.
pub(crate) fn least(value: [f64; WITH_ENDS.len()]) -> (f64, f64) {
    let at = (0..value.len()).fold(0, |least, at| if value[at] < value[least] { at } else { least });
    let (x, y) = (WITH_ENDS[at], value[at]);
    if at == 0 || at + 1 == value.len() {
        return (x, y);
    }
    let slope = |from: usize| (value[from + 1] - value[from]) / (WITH_ENDS[from + 1] - WITH_ENDS[from]);
    let (falls, rises) = (slope(at - 1), slope(at));
    let second = (rises - falls) / (WITH_ENDS[at + 1] - WITH_ENDS[at - 1]);
    // Half of the second derivative; none where all three are equal.
    if !(second > 0.0 && second.is_finite()) {
        return (x, y);
    }
    let first = falls + second * (x - WITH_ENDS[at - 1]);
    (x - 0.5 * first / second, y - 0.25 * first * first / second)
}

/// The same from the values between the points alone, continued to both ends.
pub(super) fn least_between(value: [f64; BETWEEN.len()]) -> (f64, f64) {
    let mut all = [0.0; WITH_ENDS.len()];
    all[1..=BETWEEN.len()].copy_from_slice(&value);
    let [left, right] = ENDS.map(|end| end.iter().zip(value).map(|(part, value)| part * value).sum());
    (all[0], all[BETWEEN.len() + 1]) = (left, right);
    least(all)
}

#[cfg(test)]
mod tests {
    use super::{BETWEEN, WITH_ENDS, least, least_between};

    #[test]
    fn quadratics_have_exact_peaks_wherever_they_are() {
        for peak in [-0.3, 0.0, 0.004, 0.07, 0.5, 0.61, 0.99, 1.0, 1.4] {
            let value = |x: f64| 2.0 * (x - peak) * (x - peak) - 0.7;
            let inside = f64::clamp(peak, 0.0, 1.0);
            let (place, found) = least(WITH_ENDS.map(value));
            // Beside an end the peak may be nearer to it than the place beside it.
            let room = if inside > 0.0 && inside < BETWEEN[0] { 0.5 * BETWEEN[0] } else { 1e-9 };
            assert!((place - inside).abs() <= room, "{peak}: {place}");
            assert!((found - value(inside)).abs() <= 2.0 * room * room + 1e-12, "{peak}: {found}");
            assert!((least_between(BETWEEN.map(value)).1 - found).abs() < 1e-11, "{peak}");
        }
    }
}
