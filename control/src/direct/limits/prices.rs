//! What limits cost in an interval: by how much the cost falls where they give, from their multipliers.

use super::barrier::Barrier;
use crate::direct::motion::mesh::Mesh;
use crate::direct::motion::spline::Spline;
use std::ops::Range;

impl Barrier {
    /// What the cost falls by, to first order, where the limit of a side gives by 1 (its unit) in an
    /// interval: multipliers of its points, and half of those that it shares with another one.
    pub fn price(&self, mesh: &Mesh, interval: usize, side: usize) -> f64 {
        self.shares(mesh, interval, side).map(|(at, share)| share * self.multiplier[at]).sum()
    }

    /// What it costs, to first order, that the limit of a side was moved inside in an interval.
    pub fn price_of_moves(&self, mesh: &Mesh, interval: usize, side: usize) -> f64 {
        if self.moved.is_empty() {
            return 0.0;
        }
        let of = |(at, share): (usize, f64)| share * self.multiplier[at] * (-self.moved[at]).max(0.0);
        self.shares(mesh, interval, side).map(of).sum()
    }

    /// The mean place s of the multipliers of a side in these intervals, weighed by them; `None` without any.
    pub fn centre(&self, spline: &Spline, intervals: Range<usize>, side: usize) -> Option<f64> {
        let [mut sum, mut moment] = [0.0; 2];
        for (at, share) in intervals.flat_map(|k| self.shares(&spline.mesh, k, side)) {
            let part = share * self.multiplier[at];
            sum += part;
            moment += part * self.place(at, spline);
        }
        (sum > 0.0).then(|| moment / sum)
    }

    /// The entries of a side at the points and nodes of an interval, with the part of each that is its own.
    fn shares<'a>(
        &'a self,
        mesh: &'a Mesh,
        k: usize,
        side: usize,
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        // Nothing is on the other side of the first and the last node.
        let share = move |node: usize| if node == 0 || node == mesh.intervals() { 1.0 } else { 0.5 };
        let (first, count, smooth) = (mesh.first_point(k), mesh.shape.places().len(), mesh.shape.is_smooth());
        let of_point = move |j: usize| match j {
            0 if smooth && !mesh.is_end(k) => 0.5,
            j if smooth && j + 1 == count && !mesh.is_end(k + 1) => 0.5,
            _ => 1.0,
        };
        let points = (0..count).map(move |j| (self.at_point(first + j).start + side, of_point(j)));
        let nodes = if side < self.states { k..k + 2 } else { 0..0 };
        points.chain(nodes.map(move |node| (self.at_node(node).start + side, share(node))))
    }
}

#[cfg(test)]
mod tests {
    use crate::direct::interior::iterate::tests::started;
    use crate::direct::limits::side::Limited;
    use crate::direct::motion::shape::Shape;

    /// All intervals together have all multipliers, each once.
    #[test]
    fn prices_of_all_intervals_are_the_sum_of_multipliers() {
        for shape in [Shape::Quartic, Shape::Quintic] {
            let mut interior = started(shape);
            interior.move_to(vec![0.0, 0.2, 0.7, 0.8, 1.0]).unwrap();
            let mut random = fastrand::Rng::with_seed(4);
            let barrier = &mut interior.barrier;
            barrier.multiplier.fill_with(|| random.f64());
            let sides = barrier.sides().len();
            let mut sums = vec![0.0; sides];
            for at in (0..barrier.count()).filter(|&at| barrier.side_index(at).is_some_and(|i| i < sides)) {
                sums[barrier.side_index(at).unwrap()] += barrier.multiplier[at];
            }
            for (i, sum) in sums.iter().enumerate() {
                let found: f64 = (0..4).map(|k| barrier.price(&interior.spline.mesh, k, i)).sum();
                assert!((found / sum - 1.0).abs() < 1e-12, "{shape:?} {i}: {found} {sum}");
            }
        }
    }

    /// A limit that was moved costs its price times the way.
    #[test]
    fn moves_cost_what_they_take() {
        let mut interior = started(Shape::Quartic);
        let side = interior.barrier.sides().iter().position(|side| side.limited == Limited::Rate).unwrap();
        let barrier = &mut interior.barrier;
        barrier.multiplier.fill(2.0);
        barrier.move_inside(1, side, 0.25, f64::INFINITY);
        let mesh = &interior.spline.mesh;
        let costs = [0, 1, 2].map(|k| barrier.price_of_moves(mesh, k, side));
        // Multiplier 2 and way 0.25 at three points and two halves of nodes, which are of its neighbours too.
        assert_eq!(costs, [0.5, 4.0, 0.5].map(|count| count * 2.0 * 0.25));
        assert_eq!(barrier.price_of_moves(mesh, 1, side + 1), 0.0);
    }

    #[test]
    fn the_centre_of_two_multipliers_is_between_them() {
        let mut interior = started(Shape::Quartic);
        let barrier = &mut interior.barrier;
        let side = barrier.sides().iter().position(|side| side.limited == Limited::Rate).unwrap();
        barrier.multiplier.fill(0.0);
        assert_eq!(barrier.centre(&interior.spline, 0..3, side), None);
        let places = [4, 5].map(|p| barrier.at_point(p).start + side);
        (barrier.multiplier[places[0]], barrier.multiplier[places[1]]) = (3.0, 1.0);
        let [a, b] = places.map(|at| barrier.place(at, &interior.spline));
        let centre = barrier.centre(&interior.spline, 0..3, side).unwrap();
        assert!((centre - (0.75 * a + 0.25 * b)).abs() < 1e-15, "{centre} {a} {b}");
    }
}
