//! Adaptive quadrature with Gauss's seven and Kronrod's fifteen points.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Kronrod's points on [-1, 1] that are not negative, from the outermost to the centre; every second one
/// belongs to Gauss's rule.
const PLACES: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];
/// Their weights in Kronrod's rule.
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_56,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_89,
    0.209_482_141_084_727_82,
];
/// Those of every second one in Gauss's rule.
const GAUSS: [f64; 4] =
    [0.129_484_966_168_869_7, 0.279_705_391_489_276_64, 0.381_830_050_505_118_9, 0.417_959_183_673_469_4];
/// Evaluations for one segment.
const POINTS: usize = 15;
/// Rounding of a sum of 15 terms, relative to the integral of magnitudes.
const ROUNDING: f64 = 50.0 * f64::EPSILON;

/// An integral with its estimated error.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Integral {
    /// The integral.
    pub value: f64,
    /// That over the segments of each interval.
    pub parts: Vec<f64>,
    /// Estimate of its error.
    pub error: f64,
    /// Number of evaluations.
    pub evaluations: usize,
}

/// A part of an interval.
#[derive(Clone, Copy, Debug)]
struct Segment {
    interval: usize,
    ends: [f64; 2],
    value: f64,
    error: f64,
}

impl PartialEq for Segment {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Segment {}

impl PartialOrd for Segment {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Segment {
    fn cmp(&self, other: &Self) -> Ordering {
        self.error.total_cmp(&other.error)
    }
}

/// The integral of `f(interval, x)` over all segments, each `(interval, [from, to])`, to the larger one of an
/// absolute and a relative tolerance: the segment with the largest error is halved until the sum of all
/// errors is small enough, for at most `most` evaluations.
///
/// The error of a segment is that of QUADPACK (R. Piessens and others, 1983): with K - G the difference of
/// both rules and S the integral of `|f - mean|`, $S \min(1, (200 |K - G| / S)^{3/2})$.
///
/// # Errors
/// Those of f.
pub(crate) fn integrate<E>(
    segments: impl Iterator<Item = (usize, [f64; 2])>,
    [absolute, relative]: [f64; 2],
    most: usize,
    mut f: impl FnMut(usize, f64) -> Result<f64, E>,
) -> Result<Integral, E> {
    let mut heap = BinaryHeap::<Segment>::new();
    let mut found = Integral::default();
    for (interval, ends) in segments.filter(|(_, [from, to])| to > from) {
        let segment = measure(interval, ends, &mut f)?;
        found.evaluations += POINTS;
        found.parts.resize(found.parts.len().max(interval + 1), 0.0);
        heap.push(segment);
    }
    loop {
        found.value = heap.iter().map(|segment| segment.value).sum();
        found.error = heap.iter().map(|segment| segment.error).sum();
        let is_done = found.error <= absolute.max(relative * found.value.abs());
        if is_done || !found.error.is_finite() || found.evaluations >= most {
            heap.iter().for_each(|segment| found.parts[segment.interval] += segment.value);
            return Ok(found);
        }
        // As many as hold nine tenths of the error, so that sums are not added up for each of them.
        let mut left = 0.9 * found.error;
        let mut halves = Vec::new();
        while left > 0.0 && found.evaluations < most {
            let Some(Segment { interval, ends: [from, to], error, .. }) = heap.pop() else { break };
            left -= error;
            let middle = 0.5 * (from + to);
            for ends in [[from, middle], [middle, to]] {
                halves.push(measure(interval, ends, &mut f)?);
                found.evaluations += POINTS;
            }
        }
        heap.extend(halves);
    }
}

fn measure<E>(
    interval: usize,
    [from, to]: [f64; 2],
    f: &mut impl FnMut(usize, f64) -> Result<f64, E>,
) -> Result<Segment, E> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut kronrod, mut gauss) = (0.0, 0.0);
    let mut values = [0.0; POINTS];
    let mut weights = [0.0; POINTS];
    for (j, place) in PLACES.iter().enumerate() {
        for (at, side) in
            [(j, -1.0), (POINTS - 1 - j, 1.0)].into_iter().take(if *place == 0.0 { 1 } else { 2 })
        {
            let value = f(interval, middle + side * place * half)?;
            (values[at], weights[at]) = (value, KRONROD[j]);
            kronrod += KRONROD[j] * value;
            if j % 2 == 1 {
                gauss += GAUSS[j / 2] * value;
            }
        }
    }
    let sum = |of: &dyn Fn(f64) -> f64| -> f64 { values.iter().zip(weights).map(|(y, w)| w * of(*y)).sum() };
    let spread = sum(&|y| (y - 0.5 * kronrod).abs());
    let difference = (kronrod - gauss).abs();
    let mut error = difference;
    if spread > 0.0 && difference > 0.0 {
        error = spread * (200.0 * difference / spread).powf(1.5).min(1.0);
    }
    let error = error.max(ROUNDING * sum(&f64::abs));
    Ok(Segment { interval, ends: [from, to], value: half * kronrod, error: half * error })
}

#[cfg(test)]
mod tests {
    use super::integrate;
    use std::convert::Infallible;

    fn of(ends: [f64; 2], f: impl Fn(f64) -> f64) -> super::Integral {
        integrate([(0, ends)].into_iter(), [0.0, 1e-12], 100_000, |_, x| Ok::<_, Infallible>(f(x))).unwrap()
    }

    #[test]
    fn polynomials_up_to_degree_13_take_one_segment() {
        // Both rules integrate them exactly.
        let found = of([-0.5, 2.0], |x| x.powi(13) - 3.0 * x.powi(5));
        let exact = |x: f64| x.powi(14) / 14.0 - 0.5 * x.powi(6);
        assert_eq!(found.evaluations, 15);
        assert!((found.value / (exact(2.0) - exact(-0.5)) - 1.0).abs() < 1e-13, "{found:?}");
    }

    /// A step of tanh, squared, that is a thousandth of the interval wide, the error within its estimate.
    #[test]
    fn a_narrow_transition_is_resolved() {
        let width = 1e-3;
        let at = |x: f64| (1.0 + ((x - 0.37) / width).tanh()).powi(2);
        // The integral of (1 + tanh y)^2 is 2 y + 2 log cosh y - tanh y.
        let of_y =
            |y: f64| 2.0 * y + 2.0 * (y.abs() + (-2.0 * y.abs()).exp().ln_1p() - 2_f64.ln()) - y.tanh();
        let exact = width * (of_y(0.63 / width) - of_y(-0.37 / width));
        let found = of([0.0, 1.0], at);
        assert!((found.value - exact).abs() <= found.error.max(1e-12), "{found:?} {exact}");
        assert!(found.error < 1e-11 && found.evaluations < 2000, "{found:?}");
    }

    /// The integrals of x over the three segments of two intervals.
    #[test]
    fn each_interval_has_its_part() {
        let segments = [(0, [0.0, 1.0]), (2, [1.0, 2.0]), (2, [2.0, 4.0])];
        let found =
            integrate(segments.into_iter(), [0.0, 1e-12], 1000, |_, x| Ok::<_, Infallible>(x)).unwrap();
        let expected = [0.5, 0.0, 7.5];
        assert_eq!(found.parts.len(), 3);
        assert!(found.parts.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
    }

    #[test]
    fn the_work_is_bounded() {
        let found = integrate([(0, [0.0, 1.0])].into_iter(), [0.0, 1e-15], 300, |_, x| {
            Ok::<_, Infallible>((1e4 * x).sin())
        })
        .unwrap();
        // The last two halves begin before 300.
        assert!((300..300 + 2 * 15).contains(&found.evaluations) && found.error > 1e-3, "{found:?}");
    }
}
