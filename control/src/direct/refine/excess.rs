//! By how much each limit is exceeded inside of each interval.

use super::between::BETWEEN;
use super::peak::least_between;
use crate::constants::direct as constants;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::motion::spline::Spline;

/// Largest violations between points.
#[derive(Clone, Debug, Default)]
pub(super) struct Excess {
    sides: usize,
    /// For each interval those of all sides, in parts of their ranges; 0 for none.
    over: Vec<f64>,
    /// Where they are, in parts of the interval.
    places: Vec<f64>,
    /// q, v, a at the ends of an interval, and at the places between.
    states: Vec<f64>,
}

impl Excess {
    /// Takes the distances at all places between the points. Of positions and rates the peaks between these
    /// places count, by the cubic through values and slopes at two neighbouring places: exact for rates where
    /// accelerations jump, which are polynomials of degree three, and close for all else. Rows of tasks, and
    /// what may be largest at the ends of an interval, are continued to these, with peaks by parabolas.
    pub fn measure(&mut self, spline: &Spline, sides: &[Side], distance: &[f64]) {
        self.sides = sides.len();
        self.over.clear();
        self.over.resize(sides.len() * spline.mesh.intervals(), 0.0);
        self.places.resize(self.over.len(), 0.0);
        let states = sides.iter().take_while(|side| side.limited < Limited::Acceleration).count();
        for k in 0..spline.mesh.intervals() {
            let places = distance.chunks_exact(sides.len()).skip(BETWEEN.len() * k).take(BETWEEN.len());
            for (distances, place) in places.zip(BETWEEN) {
                for (i, (side, &distance)) in sides.iter().zip(distances).enumerate() {
                    self.take(k, i, side.violation(distance), place);
                }
            }
            let jumps = !spline.mesh.shape.is_smooth();
            let is_continued = |side: &Side| {
                let is_row = jumps && side.limited == Limited::Task && !side.is_equation;
                side.limited.is_largest_at_ends() || is_row
            };
            for (i, side) in sides.iter().enumerate().filter(|(_, side)| is_continued(side)) {
                let value = |at: usize| distance[sides.len() * (BETWEEN.len() * k + at) + i];
                // Where bodies pass through each other, distances have kinks.
                if side.limited != Limited::Task || self.of(k, i) <= constants::MOST_MOVED {
                    let (place, least) = least_between(std::array::from_fn(value));
                    self.take(k, i, side.violation(least), place);
                }
            }
            if states > 0 {
                self.add_peaks(k, spline, &sides[..states]);
            }
        }
    }

    /// Looks for peaks of positions and rates in interval `k`.
    fn add_peaks(&mut self, k: usize, spline: &Spline, sides: &[Side]) {
        let (n, length) = (spline.dof, spline.length(k));
        self.states.resize(6 * n, 0.0);
        let mut states = std::mem::take(&mut self.states);
        let (mut before, mut after) = states.split_at_mut(3 * n);
        spline.in_interval(k, 0.0, before);
        let mut from = 0.0;
        for to in BETWEEN.into_iter().chain([1.0]) {
            spline.in_interval(k, to, after);
            for (i, side) in sides.iter().enumerate() {
                let at = side.index(n);
                let of = |z: &[f64]| {
                    [side.sign * (z[at] - side.bound), side.sign * length * (to - from) * z[at + n]]
                };
                if let Some((x, least)) = least_of_cubic(of(before), of(after)) {
                    self.take(k, i, side.violation(least), from + x * (to - from));
                }
            }
            std::mem::swap(&mut before, &mut after);
            from = to;
        }
        self.states = states;
    }

    /// Takes what a side is exceeded by at a place of an interval, if it is the most there.
    fn take(&mut self, interval: usize, side: usize, over: f64, place: f64) {
        let at = self.sides * interval + side;
        if over > self.over[at] {
            (self.over[at], self.places[at]) = (over, place);
        }
    }

    /// That of a side in an interval.
    pub fn of(&self, interval: usize, side: usize) -> f64 {
        self.over[self.sides * interval + side]
    }

    /// Where a side is exceeded most in an interval, if it is: the part of the interval to the left.
    pub fn place(&self, interval: usize, side: usize) -> Option<f64> {
        let at = self.sides * interval + side;
        (self.over[at] > 0.0).then_some(self.places[at])
    }
}

/// The place of the least value inside of [0, 1], and this value, of the cubic with these values and slopes
/// at both ends, if it falls at the first one and rises at the second.
fn least_of_cubic([left, falls]: [f64; 2], [right, rises]: [f64; 2]) -> Option<(f64, f64)> {
    if falls >= 0.0 || rises <= 0.0 {
        return None;
    }
    let second = 3.0 * (right - left) - 2.0 * falls - rises;
    let third = 2.0 * (left - right) + falls + rises;
    // falls + 2 second x + 3 third x^2 = 0, where this derivative rises.
    let x = -falls / (second + (second * second - 3.0 * third * falls).max(0.0).sqrt());
    Some((x, left + x * (falls + x * (second + x * third))))
}

#[cfg(test)]
mod tests {
    use super::{Excess, least_of_cubic};
    use crate::direct::limits::side::{Limited, Side};
    use crate::direct::motion::mesh::Mesh;
    use crate::direct::motion::shape::Shape;
    use crate::direct::motion::spline::Spline;

    #[test]
    fn the_least_value_of_a_cubic() {
        // (x - 0.3)^2 (x + 2) has its minimum 0 at 0.3.
        let value = |x: f64| (x - 0.3).powi(2) * (x + 2.0);
        let slope = |x: f64| 2.0 * (x - 0.3) * (x + 2.0) + (x - 0.3).powi(2);
        let found = least_of_cubic([value(0.0), slope(0.0)], [value(1.0), slope(1.0)]);
        let (place, least) = found.unwrap();
        assert!((place - 0.3).abs() < 1e-12 && least.abs() < 1e-15, "{found:?}");
        let parabola = least_of_cubic([0.16, -0.8], [0.36, 1.2]);
        let (place, least) = parabola.unwrap();
        assert!((place - 0.4).abs() < 1e-12 && least.abs() < 1e-15, "{parabola:?}");
        assert_eq!(least_of_cubic([0.0, 1.0], [1.0, 1.0]), None);
        assert_eq!(least_of_cubic([1.0, -1.0], [0.0, -1.0]), None);
    }

    /// The largest violations of a fine sampling are found from eight places.
    #[test]
    fn peaks_between_the_places_are_found() {
        let mut random = fastrand::Rng::with_seed(7);
        for shape in [Shape::Quartic, Shape::Quintic] {
            let mesh = Mesh::new(vec![0.0, 0.3, 0.7, 1.0], shape);
            let unknowns = (0..Spline::size(2, 3, shape)).map(|_| random.f64() - 0.5).collect();
            let spline = Spline { dof: 2, mesh, unknowns, times: vec![1.3], ..Spline::default() };
            let sides: Vec<Side> = [Limited::Position, Limited::Rate]
                .into_iter()
                .flat_map(|limited| (0..2).flat_map(move |joint| Side::pair(limited, joint, -1e-3, 1e-3)))
                .collect();
            let mut z = [0.0; 6];
            let mut sample = |k: usize, x: f64| -> Vec<f64> {
                spline.in_interval(k, x, &mut z);
                sides.iter().map(|side| side.sign * (z[side.index(2)] - side.bound)).collect()
            };
            let places = (0..3).flat_map(|k| super::BETWEEN.map(|x| (k, x)));
            let distance: Vec<f64> = places.flat_map(|(k, x)| sample(k, x)).collect();
            let mut excess = Excess::default();
            excess.measure(&spline, &sides, &distance);
            let mut inside = 0;
            for (k, i) in (0..3).flat_map(|k| (0..sides.len()).map(move |i| (k, i))) {
                let samples = (1..2000).map(|j| f64::from(j) / 2000.0);
                let samples = samples.map(|x| (sides[i].violation(sample(k, x)[i]), x));
                let (most, x) = samples.fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
                // The largest value may be at a node, which is looked at itself.
                if x > super::BETWEEN[0] && x < super::BETWEEN[7] {
                    let found = excess.of(k, i);
                    assert!((found / most - 1.0).abs() < 2e-3, "{shape:?} {k} {i}: {found} {most}");
                    let place = excess.place(k, i).unwrap();
                    assert!((place - x).abs() < 0.02, "{shape:?} {k} {i}: {place} {x}");
                    inside += 1;
                }
            }
            assert!(inside > 3, "{inside}");
        }
    }
}
