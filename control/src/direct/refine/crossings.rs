//! Places inside of intervals where something narrow happens, and the cost of a motion integrated from one to
//! the next.
//!
//! A rule for whole intervals sees what happens at its points. Friction that changes its sign within a
//! thousandth of an interval is not among that. So where a motion crosses such a place ([`Narrow::places`]),
//! its cost is integrated on each panel between neighbouring places, and differs from that of the points by
//! what these miss.
//!
//! [`Narrow::places`]: crate::problem::narrow::Narrow::places

use super::between::{BETWEEN, weight};
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::distances::measure;
use crate::direct::limits::side::Side;
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::{PointDynamics, Points};
use crate::problem::narrow::{Kind, Narrow, Piece};
use costate::EvalError;

/// The places inside of all intervals.
#[derive(Clone, Debug, Default)]
pub(super) struct Crossings {
    /// The first place of each interval, and the number of all of them.
    first: Vec<usize>,
    places: Vec<f64>,
    /// Whether an interval touches the transition of a friction, from inside or from outside.
    touches: Vec<bool>,
    /// Whether intervals are divided at places: not where these are signs of powers alone, whose smoothing is
    /// wider than the intervals that jumps would leave there.
    divides: bool,
    /// The first point of each interval in `points`.
    first_point: Vec<usize>,
    points: Points,
    /// Distances to all limits at these, all of one point after those of another one.
    distance: Vec<f64>,
    room: Room,
}

/// Room for one interval.
#[derive(Clone, Debug, Default)]
pub(super) struct Room {
    q: Vec<f64>,
    tau: Vec<f64>,
    places: Vec<f64>,
}

impl Room {
    /// The places of interval `k`, and whether it touches a transition.
    pub fn find(
        &mut self,
        narrow: &Narrow,
        spline: &Spline,
        points: Option<&Points>,
        k: usize,
    ) -> (&[f64], bool) {
        let count = spline.coefficients(k, &mut self.q);
        self.tau.clear();
        if let Some(points) = points {
            self.take_torques(spline, points, k);
        }
        let piece = Piece {
            start: spline.time_at(spline.mesh.nodes[k]),
            length: spline.length(k),
            q: &self.q,
            count,
            tau: &self.tau,
        };
        narrow.places(&piece, &mut self.places);
        (&self.places, narrow.touches(&piece))
    }

    /// Quadratics through the torques at the first, middle and last point of an interval.
    fn take_torques(&mut self, spline: &Spline, points: &Points, k: usize) {
        let (places, first) = (spline.mesh.shape.places(), spline.mesh.first_point(k));
        let last = places.len() - 1;
        // The middle point is at 1/2, the others lie beside it by this.
        let (part, of) = (places[last] - 0.5, [0, last / 2, last].map(|j| points.tau(first + j)));
        for ((a, b), c) in of[0].iter().zip(of[1]).zip(of[2]) {
            let (slope, bend) = ((c - a) / (2.0 * part), (a - 2.0 * b + c) / (2.0 * part * part));
            self.tau.extend([b - 0.5 * slope + 0.25 * bend, slope - bend, bend]);
        }
    }
}

impl Crossings {
    /// Finds the places of a motion that was evaluated at its points, and evaluates it between them.
    ///
    /// # Errors
    /// A motion that cannot be evaluated there.
    pub fn evaluate<D: PointDynamics>(&mut self, interior: &mut Interior<D>) -> Result<(), EvalError> {
        let spline = &interior.spline;
        let intervals = spline.mesh.intervals();
        self.first.clear();
        self.places.clear();
        self.touches.clear();
        self.touches.resize(intervals, false);
        self.first.resize(intervals + 1, 0);
        if !interior.crossed.has_places() {
            return Ok(());
        }
        let divides = |kind: Kind| matches!(kind, Kind::Friction { .. } | Kind::Motor { .. });
        self.divides = interior.crossed.features.iter().any(|feature| divides(feature.kind));
        for k in 0..intervals {
            self.first[k] = self.places.len();
            let (places, touches) = self.room.find(&interior.crossed, spline, Some(&interior.points), k);
            self.places.extend_from_slice(places);
            self.touches[k] = touches;
        }
        self.first[intervals] = self.places.len();
        if self.places.is_empty() {
            return Ok(());
        }
        let mut count = 0;
        self.first_point.clear();
        for k in 0..intervals {
            self.first_point.push(count);
            count += BETWEEN.len() * self.panels(k).count();
        }
        self.first_point.push(count);
        let (n, ends) = (spline.dof, spline.mesh.ends());
        let phases: Vec<usize> = ends.iter().skip(1).map(|node| self.first_point[*node]).collect();
        let mut points = std::mem::take(&mut self.points);
        points.resize_values(n, interior.rows(), phases.into_iter());
        for k in 0..intervals {
            for (panel, [from, to]) in self.panels(k).enumerate() {
                for (at, place) in BETWEEN.iter().enumerate() {
                    let p = self.first_point[k] + BETWEEN.len() * panel + at;
                    let z = &mut points.z[3 * n * p..3 * n * (p + 1)];
                    interior.spline.in_interval(k, from + place * (to - from), z);
                }
            }
        }
        let evaluated = interior.model.evaluate_at(&mut points);
        self.points = points;
        evaluated
    }

    /// The places in an interval, parts of it, rising.
    pub fn of(&self, k: usize) -> &[f64] {
        match self.first.get(k..k + 2) {
            Some(&[first, next]) => &self.places[first..next],
            _ => &[],
        }
    }

    /// Whether the narrowest interval may be narrower here.
    pub fn touches(&self, k: usize) -> bool {
        self.touches.get(k).is_some_and(|touches| *touches)
    }

    /// The parts of an interval between neighbouring places.
    fn panels(&self, k: usize) -> impl Iterator<Item = [f64; 2]> + '_ {
        let places = self.of(k);
        let lefts = std::iter::once(0.0).chain(places.iter().copied());
        let rights = places.iter().copied().chain([1.0]);
        lefts.zip(rights).map(<[f64; 2]>::from).filter(move |_| !places.is_empty())
    }

    /// Measures the distances to limits between the places.
    pub fn measure(&mut self, sides: &[Side]) {
        let count = if self.places.is_empty() { 0 } else { self.points.count() };
        self.distance.clear();
        self.distance.resize(sides.len() * count, 0.0);
        if count > 0 && !sides.is_empty() {
            measure(sides, &self.points, &mut self.distance);
        }
    }

    /// Shows the part x, the weight in a mean over the interval, and the number, of each point of an interval
    /// with places.
    fn each(&self, k: usize, mut show: impl FnMut(f64, f64, usize)) {
        for (panel, [from, to]) in self.panels(k).enumerate() {
            for (at, place) in BETWEEN.iter().enumerate() {
                let p = self.first_point[k] + BETWEEN.len() * panel + at;
                show(from + place * (to - from), (to - from) * weight(at), p);
            }
        }
    }

    /// The same with the distance to a limit of so many.
    pub fn each_distance(&self, k: usize, [side, sides]: [usize; 2], mut show: impl FnMut(f64, f64, f64)) {
        self.each(k, |x, weight, p| show(x, weight, self.distance[sides * p + side]));
    }

    /// The mean of a rate of z and tau on an interval with places.
    pub fn mean(&self, k: usize, mut rate: impl FnMut(&[f64], &[f64]) -> f64) -> f64 {
        let mut sum = 0.0;
        self.each(k, |_, weight, p| sum += weight * rate(self.points.z(p), self.points.tau(p)));
        sum
    }

    /// Parts of an interval at which it is divided: its places, and graded ones beside those that are close
    /// together.
    pub fn graded(&self, k: usize) -> Vec<f64> {
        if self.divides { graded(self.of(k)) } else { Vec::new() }
    }
}

/// Places with further ones between them, so that neighbouring gaps differ by [`constants::GRADED`] at most:
/// what is narrow fades with the distance from it. No more than [`constants::MOST_GRADED`].
pub(super) fn graded(places: &[f64]) -> Vec<f64> {
    let mut all = places.to_vec();
    if places.is_empty() {
        return all;
    }
    let ends: Vec<f64> = std::iter::once(0.0).chain(places.iter().copied()).chain([1.0]).collect();
    let gap = |i: usize| ends.get(i + 1).zip(ends.get(i)).map(|(right, left)| right - left);
    for i in 0..ends.len() - 1 {
        let Some(own) = gap(i) else { continue };
        for (side, beside) in [(0, i.checked_sub(1).and_then(gap)), (1, gap(i + 1))] {
            let Some(beside) = beside else { continue };
            let mut way = constants::GRADED * beside;
            while way < 0.5 * own && all.len() < constants::MOST_GRADED {
                all.push(if side == 0 { ends[i] + way } else { ends[i + 1] - way });
                way *= constants::GRADED;
            }
        }
    }
    all.sort_by(f64::total_cmp);
    all
}

#[cfg(test)]
#[path = "crossings_tests.rs"]
mod tests;
