//! `integral of f over [a, b]`: Gauss and Kronrod's rules of 7 and 15 points, adaptive.
//!
//! f is evaluated at all points of all intervals of one level together, since one call for many times is
//! much cheaper than many calls.

/// Places of Kronrod's rule in [0, 1), symmetric, from the middle outwards (QUADPACK, `qk15`).
const PLACES: [f64; 8] = [
    0.0,
    0.207_784_955_007_898_47,
    0.405_845_151_377_397_2,
    0.586_087_235_467_691_1,
    0.741_531_185_599_394_4,
    0.864_864_423_359_769_1,
    0.949_107_912_342_758_5,
    0.991_455_371_120_812_6,
];
/// Its weights.
const KRONROD: [f64; 8] = [
    0.209_482_141_084_727_83,
    0.204_432_940_075_298_9,
    0.190_350_578_064_785_4,
    0.169_004_726_639_267_9,
    0.140_653_259_715_525_92,
    0.104_790_010_322_250_18,
    0.063_092_092_629_978_55,
    0.022_935_322_010_529_224,
];
/// Weights of Gauss's rule at every second place.
const GAUSS: [f64; 4] =
    [0.417_959_183_673_469_4, 0.381_830_050_505_118_9, 0.279_705_391_489_276_67, 0.129_484_966_168_869_7];
/// Halvings of an interval at most.
const DEPTH: usize = 24;
/// Intervals of one level at most: a function that needs more is not integrated.
const MOST: usize = 40_000;

/// The points of an interval, from left to right.
fn points(a: f64, b: f64) -> impl Iterator<Item = f64> {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    (-7_isize..=7).map(move |k| middle + half * PLACES[k.unsigned_abs()].copysign(k as f64))
}

/// Integrals of components of f over the intervals between `ends`, each component within `tolerance` of the
/// integral of its magnitude; with an estimate of the error of the first component. `None` if f cannot be
/// evaluated.
pub fn integral<const N: usize>(
    ends: &[f64],
    tolerance: f64,
    mut f: impl FnMut(&[f64]) -> Option<Vec<[f64; N]>>,
) -> Option<([f64; N], f64)> {
    let length = ends.last()? - ends.first()?;
    let mut pending: Vec<[f64; 2]> =
        ends.windows(2).filter(|pair| pair[1] > pair[0]).map(|pair| [pair[0], pair[1]]).collect();
    let (mut sum, mut error, mut size) = ([0.0; N], 0.0, 0.0_f64);
    for level in 0..=DEPTH {
        let times: Vec<f64> = pending.iter().flat_map(|&[a, b]| points(a, b)).collect();
        let values = f(&times)?;
        let mut rules = Vec::with_capacity(pending.len());
        for (&[a, b], values) in pending.iter().zip(values.chunks(15)) {
            let half = 0.5 * (b - a);
            let (mut kronrod, mut gauss) = ([0.0; N], [0.0; N]);
            for (k, value) in values.iter().enumerate() {
                let place = k.abs_diff(7);
                for i in 0..N {
                    kronrod[i] += half * KRONROD[place] * value[i];
                    if place % 2 == 0 {
                        gauss[i] += half * GAUSS[place / 2] * value[i];
                    }
                }
            }
            let largest = values.iter().fold(0.0_f64, |most, value| most.max(value[0].abs()));
            rules.push((kronrod, gauss, largest * (b - a)));
        }
        size = size.max(rules.iter().map(|rule| rule.2).sum());
        let mut next = Vec::new();
        for (&[a, b], (kronrod, gauss, largest)) in pending.iter().zip(rules) {
            let differs = (0..N).fold(0.0_f64, |most, i| most.max((kronrod[i] - gauss[i]).abs()));
            // The difference is the error of the lower rule; that of the other one is much smaller.
            let allowed = tolerance * size * (b - a) / length;
            let rounded = 1e-13 * largest;
            if differs <= allowed.max(rounded) || level == DEPTH || pending.len() > MOST {
                for i in 0..N {
                    sum[i] += kronrod[i];
                }
                error += (kronrod[0] - gauss[0]).abs();
            } else {
                let middle = 0.5 * (a + b);
                next.extend([[a, middle], [middle, b]]);
            }
        }
        if next.is_empty() {
            return Some((sum, error));
        }
        pending = next;
    }
    Some((sum, error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_22_are_exact() {
        let power = |t: &[f64]| Some(t.iter().map(|t| [t.powi(22)]).collect());
        let ([found], _) = integral(&[0.0, 1.0], 1.0, power).unwrap();
        assert!((found - 1.0 / 23.0).abs() < 1e-15, "{found}");
    }

    #[test]
    fn a_narrow_transition_between_ends_is_resolved() {
        // tanh^2 of (t - 1/3)/w: its integral from 0 to 1 in closed form. Ends stand where those of a motion
        // do.
        let (at, w) = (1.0 / 3.0, 1e-5);
        let f = |t: &[f64]| Some(t.iter().map(|t| [((t - at) / w).tanh().powi(2)]).collect());
        let inner = [-3.0, -1.0, 0.0, 1.0, 3.0].map(|level| at + level * w);
        let ends: Vec<f64> = [0.0].into_iter().chain(inner).chain([1.0]).collect();
        let ([found], _) = integral(&ends, 1e-12, f).unwrap();
        let expected = 1.0 - w * ((2.0 / 3.0 / w).tanh() + (at / w).tanh());
        // What lies beyond the outer ends of the transition may be missed.
        let missed = 2.0 * w * (1.0 - 3.0_f64.tanh());
        assert!((found - expected).abs() < missed + 1e-12, "{found} {expected}");
        // Without them all of it is.
        let ([alone], _) = integral(&[0.0, 1.0], 1e-12, f).unwrap();
        assert!((alone - expected).abs() > 1.9 * w, "{alone} {expected}");
    }
}
