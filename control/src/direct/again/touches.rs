//! Limits that a solved motion touches for an instant: where, and what its second derivatives are there.

use crate::direct::interior::iterate::Interior;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::newton::point_terms::Touch;
use crate::numerics::lu;

/// Least ratio of multiplier and slack, both without unit, of a limit that is touched: derivatives take the
/// part r / (1 + r) of a limit with the ratio r as kept.
const TOUCHED: f64 = 0.01;
/// Most entries at which a limit is kept for certain where it is touched for an instant: at the point next to
/// it, or at those and at a node to either side. The barrier keeps others near there a little.
const MOST_ENTRIES: usize = 3;
/// Largest multiplier, without unit, of a limit that is only touched, in powers of its product mu with the
/// slack: cube roots for a limit of the state, square roots for one of the control. The slack s of one of the
/// state is a parabola in time, the multiplier mu / s has the integral `pi mu / sqrt(s)` but for its scale,
/// which moves the motion away by about s: `s^(3/2)` is about mu, and the multiplier `mu^(1/3)`. One of the
/// control moves the control at its own time: the multiplier is about s. Where a limit is kept its multiplier
/// does not depend on mu.
///
/// One of positions is kept by one entry, of the weight w in s: its impulse, w times the multiplier, moves
/// the motion by s over YIELDING, so that the multiplier is the root of `mu / (w YIELDING)`.
const ONLY_TOUCHED: f64 = 5.0;
/// By about how much an impulse moves a motion where it acts, both without unit: a beam that is clamped at
/// both ends yields in its middle by 1/192.
const YIELDING: f64 = 1.0 / 192.0;
/// By this factor the slacks of these entries grow: their limit is left to the touch.
const LEFT: f64 = 1e16;

/// An entry of a limit, and where on the mesh it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub at: usize,
    pub s: f64,
}

impl<D> Interior<D> {
    /// The entries of all limits along the motion, for each of them in the order of time; those of rows at
    /// ends alone.
    pub(super) fn entries_of_sides(&self) -> Vec<Vec<Entry>> {
        let (mesh, barrier) = (&self.spline.mesh, &self.barrier);
        let at_node = |k: usize| barrier.at_node(k).map(move |at| (at, mesh.nodes[k]));
        let at_point = |p: usize| barrier.at_point(p).map(move |at| (at, mesh.point(p).0));
        let at_gauss_point = |p: usize| barrier.at_gauss_point(p).map(move |at| (at, mesh.gauss_point(p).0));
        let mut sides = vec![Vec::new(); barrier.all_sides().count()];
        let points = (0..mesh.points()).flat_map(at_point);
        let nodes = (0..mesh.nodes.len()).flat_map(at_node);
        for (at, s) in points.chain(nodes).chain((0..mesh.gauss_points()).flat_map(at_gauss_point)) {
            if let Some(side) = barrier.side_index(at) {
                sides[side].push(Entry { at, s });
            }
        }
        sides.iter_mut().for_each(|side| side.sort_by(|a, b| a.s.total_cmp(&b.s)));
        sides.extend(barrier.at_ends().map(|at| vec![Entry { at, s: barrier.end_of(at) as f64 }]));
        sides
    }

    /// Whether derivatives take a limit as kept a little, by an entry.
    pub(super) fn is_touched(&self, at: usize) -> bool {
        self.activity(at) > TOUCHED
    }

    /// Whether a limit that is touched is kept for certain, by an entry, if others keep it with that.
    fn is_kept(&self, at: usize) -> bool {
        let [multiplier, slack] = self.without_unit(at);
        let mu = multiplier * slack;
        let is_control = self.barrier.side(at).limited.jumps(self.spline.mesh.shape);
        multiplier > ONLY_TOUCHED * if is_control { mu.sqrt() } else { mu.cbrt() }
    }

    /// The same if the entry may be the only one.
    pub(super) fn is_surely_kept(&self, at: usize) -> bool {
        let [multiplier, slack] = self.without_unit(at);
        let least = (multiplier * slack / (YIELDING * self.barrier.weight[at])).sqrt();
        let is_alone = self.is_of_positions(self.barrier.side(at));
        self.is_kept(at) && (!is_alone || multiplier > ONLY_TOUCHED * least)
    }

    /// Whether a limit can be touched for an instant: the control moves its second derivative in time, or a
    /// higher one. Rows of tasks may depend on rates.
    pub(super) fn is_of_positions(&self, side: &Side) -> bool {
        let is_smooth = self.spline.mesh.shape.is_smooth();
        let is_one = matches!(side.limited, Limited::Position | Limited::Task);
        (is_one || is_smooth && side.limited == Limited::Rate) && !side.is_equation
    }

    /// Hands the limits that the motion touches for an instant to the equations of its derivatives. The
    /// motion is not solved any further afterwards.
    pub(super) fn take_touches(&mut self) {
        self.system.touches.clear();
        for side in self.entries_of_sides() {
            let is_touched = |entry: &Entry| self.is_touched(entry.at);
            let is_kept = |entry: &Entry| is_touched(entry) && self.is_kept(entry.at);
            let (mut first, mut found) = (0, Vec::new());
            for run in side.chunk_by(|a, b| is_touched(a) == is_touched(b)) {
                let own = first..first + run.len();
                first = own.end;
                let [Some(from), Some(to)] = [run.iter().position(is_kept), run.iter().rposition(is_kept)]
                else {
                    continue;
                };
                let (from, to) = (own.start + from, own.start + to);
                let is_sure = run.iter().any(|entry| self.is_surely_kept(entry.at));
                if is_sure && to - from < MOST_ENTRIES && from > 0 && to + 1 < side.len() {
                    found.extend(self.touch(&side[from - 1..=to + 1], run).map(|touch| (touch, own)));
                }
            }
            for (touch, own) in found {
                side[own].iter().for_each(|entry| self.barrier.slack[entry.at] *= LEFT);
                self.system.touches.push(touch);
            }
        }
    }

    /// What is touched between the first and the last one of some entries; `all` are those that the
    /// barrier keeps near there.
    fn touch(&self, entries: &[Entry], all: &[Entry]) -> Option<Touch> {
        let (spline, barrier) = (&self.spline, &self.barrier);
        let (mesh, n) = (&spline.mesh, spline.dof);
        let side = barrier.side(entries[0].at);
        if !self.is_of_positions(side) || entries.iter().any(|entry| !barrier.is_on(entry.at)) {
            return None;
        }
        let distances: Vec<[f64; 2]> =
            entries.iter().map(|entry| [spline.time_at(entry.s), barrier.distance[entry.at]]).collect();
        let (time, second) = vertex(&distances)?;
        let after = distances.iter().position(|[t, _]| *t > time).filter(|after| *after > 0)?;
        let (k, x) = mesh.place(spline.place_of(time));
        let mut rows = [vec![0.0; 3 * n], vec![0.0; 3 * n]];
        match side.limited {
            Limited::Task => {
                let [a, b] = [after - 1, after].map(|i| self.gradient(entries[i].at));
                let rate = 1.0 / (distances[after][0] - distances[after - 1][0]);
                let part = rate * (time - distances[after - 1][0]);
                let by_rates = a[n..].iter().chain(&b[n..]);
                if by_rates.copied().any(|entry| entry != 0.0) {
                    return None;
                }
                for i in 0..n {
                    rows[0][i] = (1.0 - part) * a[i] + part * b[i];
                    rows[1][i] = rate * (b[i] - a[i]);
                    rows[1][n + i] = rows[0][i];
                }
            }
            _ => {
                rows[0][side.index(n)] = 1.0;
                rows[1][side.index(n) + n] = 1.0;
            }
        }
        let sum = |of: &dyn Fn(usize) -> f64| all.iter().map(|entry| of(entry.at)).sum::<f64>();
        let curvatures = [sum(&|at| barrier.curvature(at)), sum(&|at| barrier.multiplier[at]) / second];
        Some(Touch { k, x, rows, curvatures })
    }

    /// The gradient in (q, v) of the row of a task at the point of an entry.
    fn gradient(&self, at: usize) -> &[f64] {
        let (sides, n) = (self.barrier.sides().len(), self.spline.dof);
        &self.points.g_x(at / sides)[2 * n * self.barrier.side(at).joint..][..2 * n]
    }
}

/// The time of the least value of the parabola that is nearest to these values at these times, and its second
/// derivative; `None` where it has none between them.
fn vertex(values: &[[f64; 2]]) -> Option<(f64, f64)> {
    let (from, to) = (values.first()?[0], values.last()?[0]);
    let (mut left, mut right, mut exchanges) = ([0.0; 9], [0.0; 3], [0; 3]);
    for [time, value] in values {
        let x = (time - from) / (to - from);
        let powers = [1.0, x, x * x];
        for i in 0..3 {
            (0..3).for_each(|j| left[3 * i + j] += powers[i] * powers[j]);
            right[i] += powers[i] * value;
        }
    }
    if !lu::eliminate(&mut left, 3, 3, &mut exchanges) {
        return None;
    }
    lu::solve(&left, 3, &exchanges, &mut right, 1);
    let [_, slope, square] = right;
    let x = -0.5 * slope / square;
    (square > 0.0 && x > 0.0 && x < 1.0)
        .then(|| (from + x * (to - from), 2.0 * square / ((to - from) * (to - from))))
}

#[cfg(test)]
mod tests {
    use super::vertex;

    #[test]
    fn a_parabola_has_its_vertex() {
        let at = |t: f64| [t, 0.25 + 1.5 * (t - 2.1) * (t - 2.1)];
        let (time, second) = vertex(&[at(1.9), at(2.0), at(2.2), at(2.25)]).unwrap();
        assert!((time - 2.1).abs() < 1e-12 && (second - 3.0).abs() < 1e-10);
        assert_eq!(vertex(&[at(2.2), at(2.3), at(2.4)]), None);
        assert_eq!(vertex(&[[0.0, 0.0], [1.0, 1.0], [2.0, 1.5]]), None);
    }
}
