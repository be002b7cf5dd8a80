//! Limits that are kept everywhere in an interval, not only at its points.

use super::barrier::Barrier;
use super::side::Side;
use crate::direct::motion::shape::{PLACES, POINTS};
use crate::numerics::lagrange::{slopes, values};

/// The coefficients of the quadratic with these values at Gauss's points of an interval, in Bernstein's
/// basis,
///
/// $$ f(x) = b\_0 (1 - x)^2 + 2 b\_1 x (1 - x) + b\_2 x^2 $$
///
/// a row for each of them. The basis is positive on [0, 1] and its sum is one, so the quadratic is within all
/// limits that its coefficients are within (the property of the convex hull; G. Farin, Curves and surfaces
/// for CAGD, 5th edition, 2002, chapter 4). A constant has itself as its coefficients: along a limit they
/// cost nothing.
pub(crate) const COEFFICIENTS: [[f64; POINTS]; POINTS] = {
    let (left, slope, right) = (values(&PLACES, 0.0), slopes(&PLACES, 0.0), values(&PLACES, 1.0));
    let mut middle = left;
    let mut j = 0;
    while j < POINTS {
        middle[j] += 0.5 * slope[j];
        j += 1;
    }
    [left, middle, right]
};

impl Barrier {
    /// Whether the entries of a side in each interval are those of the coefficients of the quadratic through
    /// its values at Gauss's points, rather than of these values.
    #[inline(always)]
    pub fn is_hull(&self, side: usize) -> bool {
        self.hulls.get(side).is_some_and(|is_hull| *is_hull)
    }

    /// Whether any are.
    pub fn has_hulls(&self) -> bool {
        !self.hulls.is_empty()
    }

    /// Limits the coefficients of a side on this mesh and later ones: one of what may jump at nodes. Whether
    /// its values were limited before.
    pub fn take_hull(&mut self, side: usize) -> bool {
        let count = self.all_sides().count();
        self.hulls.resize(count, false);
        !std::mem::replace(&mut self.hulls[side], true)
    }

    /// Limits values at points alone, for the entries of the next mesh.
    pub fn drop_hulls(&mut self) {
        self.hulls.clear();
    }

    /// The entries of a side in an interval: at its points, those of jerks and rates of torques at Gauss's.
    #[inline(always)]
    pub fn in_interval(&self, k: usize, side: usize) -> [usize; POINTS] {
        let (first, stride) = match side.checked_sub(self.sides.len()) {
            None => (side, self.sides.len()),
            Some(rate) => (self.first_of_rates() + rate, self.rates.len()),
        };
        std::array::from_fn(|j| first + stride * (POINTS * k + j))
    }

    /// Turns what entries have at points into what they have as coefficients, where they are such.
    pub fn take_coefficients(&self, entries: &mut [f64]) {
        for side in (0..self.hulls.len()).filter(|&side| self.hulls[side]) {
            for k in 0..self.intervals() {
                let at = self.in_interval(k, side);
                let values = at.map(|at| entries[at]);
                for (at, factors) in at.into_iter().zip(COEFFICIENTS) {
                    entries[at] = factors.iter().zip(values).map(|(factor, value)| factor * value).sum();
                }
            }
        }
    }

    /// What the entries of a side in interval `k` add to the derivative by its value at point `j`, if they
    /// add `of` to that by themselves.
    #[inline(never)]
    pub fn by_value(&self, (k, j): (usize, usize), side: usize, of: impl Fn(usize) -> f64) -> f64 {
        let entries = self.in_interval(k, side).into_iter().zip(COEFFICIENTS);
        entries.map(|(at, factors)| factors[j] * of(at)).sum()
    }

    /// The density of the multipliers of a limit whose coefficients are limited, at point `j` of interval
    /// `k`: those of this side less those of the other one. The quadratic through these values has the
    /// integral with every quadratic that the multipliers give it.
    pub fn net_density(&self, (k, j): (usize, usize), side: usize) -> f64 {
        let own = self.numbered(side);
        let same = |other: &&Side| (other.limited, other.joint) == (own.limited, own.joint);
        let first = self.all_sides().take_while(|other| !same(other)).count();
        let all = first..first + self.all_sides().filter(same).count();
        let weight = self.weight[self.in_interval(k, side)[j]];
        let part = |other: usize| {
            let sign = own.sign * self.numbered(other).sign;
            sign * self.by_value((k, j), other, |at| self.multiplier[at])
        };
        all.map(part).sum::<f64>() / weight
    }
}

#[cfg(test)]
mod tests {
    use super::{COEFFICIENTS, PLACES};

    #[test]
    fn coefficients_of_quadratics() {
        let [a, b, c] = [0.7, -1.9, 2.3];
        let values = PLACES.map(|x| a + b * x + c * x * x);
        let found = COEFFICIENTS.map(|row| row.iter().zip(values).map(|(f, y)| f * y).sum::<f64>());
        let expected = [a, a + 0.5 * b, a + b + c];
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
    }
}
