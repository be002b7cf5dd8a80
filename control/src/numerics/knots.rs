//! Cubic curves through values that are given at times.

/// A curve of so many components, a cubic between neighbouring knots.
///
/// With given slopes it is Hermite's: C1. Without them it is the spline whose second derivative is continuous
/// too, with slopes of zero at the first and the last knot. Before the first and after the last knot it holds
/// the values there.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Knots {
    width: usize,
    times: Vec<f64>,
    /// `width` numbers a knot.
    values: Vec<f64>,
    slopes: Vec<f64>,
    /// Room for the elimination.
    pivots: Vec<f64>,
}

impl Knots {
    /// Through these values, one row of `width` numbers a knot; without slopes the spline.
    pub fn new<R: AsRef<[f64]>>(width: usize, times: &[f64], values: &[R], slopes: Option<&[R]>) -> Self {
        let mut knots = Self { width, ..Self::default() };
        knots.set(times, values, slopes);
        knots
    }

    /// Takes other knots; allocates only if there are more than ever before.
    pub fn set<R: AsRef<[f64]>>(&mut self, times: &[f64], values: &[R], slopes: Option<&[R]>) {
        self.times.clear();
        self.times.extend_from_slice(times);
        for (list, rows) in [(&mut self.values, values), (&mut self.slopes, slopes.unwrap_or_default())] {
            list.clear();
            rows.iter().for_each(|row| list.extend_from_slice(row.as_ref()));
        }
        if slopes.is_none() {
            self.slopes.resize(self.values.len(), 0.0);
            self.find_slopes();
        }
    }

    /// The slopes m of the spline, from neighbouring intervals of lengths g and h that the values change by d
    /// and e on:
    ///
    /// $$ h m\_{i-1} + 2 (g + h) m\_i + g m\_{i+1} = 3 \left( \frac{h}{g} d + \frac{g}{h} e \right) $$
    fn find_slopes(&mut self) {
        let Self { width, times, values, slopes, pivots } = self;
        let (width, last) = (*width, times.len() - 1);
        pivots.clear();
        // The row of knot i is m_i + pivot m_(i+1) = slope.
        pivots.push(0.0);
        for i in 1..last {
            let (g, h) = (times[i] - times[i - 1], times[i + 1] - times[i]);
            let diagonal = 2.0 * (g + h) - h * pivots[i - 1];
            pivots.push(g / diagonal);
            for k in 0..width {
                let value = |i: usize| values[width * i + k];
                let (d, e) = (value(i) - value(i - 1), value(i + 1) - value(i));
                let right = 3.0 * (h / g * d + g / h * e);
                slopes[width * i + k] = (right - h * slopes[width * (i - 1) + k]) / diagonal;
            }
        }
        for i in (1..last).rev() {
            for k in 0..width {
                slopes[width * i + k] -= pivots[i] * slopes[width * (i + 1) + k];
            }
        }
    }

    /// Times of the knots.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Component `k` at a time, with its first and second derivative.
    pub fn at(&self, time: f64, k: usize) -> [f64; 3] {
        let (width, last) = (self.width, self.times.len() - 1);
        let held = |i: usize| [self.values[width * i + k], 0.0, 0.0];
        if time < self.times[0] {
            return held(0);
        }
        if time >= self.times[last] {
            return held(last);
        }
        let i = self.times.partition_point(|&knot| knot <= time) - 1;
        let h = self.times[i + 1] - self.times[i];
        let x = (time - self.times[i]) / h;
        let at = |list: &[f64], i: usize| list[width * i + k];
        let (from, change) = (at(&self.values, i), at(&self.values, i + 1) - at(&self.values, i));
        let (a, b) = (h * at(&self.slopes, i), h * at(&self.slopes, i + 1));
        let (square, cube) = (3.0 * change - 2.0 * a - b, a + b - 2.0 * change);
        [
            from + x * (a + x * (square + x * cube)),
            (a + x * (2.0 * square + 3.0 * x * cube)) / h,
            (2.0 * square + 6.0 * x * cube) / (h * h),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::Knots;

    #[test]
    fn a_cubic_is_reproduced_from_its_slopes() {
        let cubic = |t: f64| [1.0 - t + 0.5 * t.powi(3), -1.0 + 1.5 * t * t, 3.0 * t];
        let times = [-0.5, 0.1, 2.0];
        let values = times.map(|t| [cubic(t)[0], 2.0]);
        let slopes = times.map(|t| [cubic(t)[1], 0.0]);
        let knots = Knots::new(2, &times, &values, Some(&slopes));
        for t in [-0.5, -0.2, 0.1, 0.7, 1.99] {
            let pairs = knots.at(t, 0).into_iter().zip(cubic(t));
            assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-13), "{t}");
            assert_eq!(knots.at(t, 1), [2.0, 0.0, 0.0]);
        }
        assert_eq!(knots.at(-1.0, 0), [values[0][0], 0.0, 0.0]);
        assert_eq!(knots.at(2.0, 0), [values[2][0], 0.0, 0.0]);
    }

    #[test]
    fn a_spline_has_continuous_second_derivatives_and_rests_at_its_ends() {
        let (times, values) = ([0.0, 0.3, 1.0, 1.2, 2.0], [0.4, -1.0, 2.0, 0.3, 0.3]);
        let knots = Knots::new(1, &times, &values.map(|value| [value]), None);
        for (i, (&time, &value)) in times.iter().zip(&values).enumerate() {
            let (before, after) = (knots.at(time - 1e-9, 0), knots.at(time, 0));
            assert!((after[0] - value).abs() < 1e-14 && (before[1] - after[1]).abs() < 1e-6, "{i}");
            if i > 0 && i + 1 < times.len() {
                assert!((before[2] - after[2]).abs() < 1e-5, "{i}: {before:?} {after:?}");
            }
        }
        assert!(knots.at(0.0, 0)[1].abs() < 1e-14 && knots.at(2.0 - 1e-9, 0)[1].abs() < 1e-7);
        // One knot is a constant, two are a smooth step.
        assert_eq!(Knots::new(1, &[1.0], &[[3.0]], None).at(0.0, 0), [3.0, 0.0, 0.0]);
        let step = Knots::new(1, &[0.0, 2.0], &[[0.0], [1.0]], None).at(1.0, 0);
        assert!((step[0] - 0.5).abs() < 1e-15 && (step[1] - 0.75).abs() < 1e-15 && step[2] == 0.0);
    }
}
