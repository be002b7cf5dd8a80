//! Derivatives of g along a motion.
//!
//! With `(mu . g)_qq` at hand, `(J v)_q` is the derivative of J along v, and `(mu . J v)_qq` that of `(mu .
//! g)_qq` for constant mu. Both are tangents of the same code. Their own derivatives along (dq, dv, dmu) are
//! tangents of tangents: with q + a v + b dq + a b dv and mu + b dmu, the coefficients of b and a b.

use super::Constraints;
use crate::matrix::{Matrix, filled};
use crate::robot::Tree;
use crate::scalar::{Scalar, Tangent};

/// What the constraints add to the blocks of the kernels, or its derivative along a direction.
#[derive(Clone, Debug)]
pub(super) struct Blocks<S> {
    /// J, k x n.
    pub jacobian: Matrix<S>,
    /// `(J v)_q`, k x n.
    pub slope: Matrix<S>,
    /// `(mu . J)_q = (mu . g)_qq`, n x n.
    pub curvature: Matrix<S>,
    /// `(mu . J v)_qq`, n x n.
    pub bend: Matrix<S>,
}

impl<S: Scalar> Blocks<S> {
    fn new(n: usize, k: usize) -> Self {
        let (wide, square) = (Matrix::zeros(k, n), Matrix::zeros(n, n));
        Self { jacobian: wide.clone(), slope: wide, curvature: square.clone(), bend: square }
    }
}

/// A position with derivatives: constant orientations, and coordinates of the chains of joints that move.
#[derive(Clone, Debug)]
pub(super) struct ChartPoint<S, T> {
    still: Vec<S>,
    /// nq entries, if there are quaternions among them.
    pub q: Vec<T>,
    /// n entries.
    pub chart: Vec<T>,
}

impl<S: Scalar, T: Scalar> ChartPoint<S, T> {
    pub fn new(tree: &Tree) -> Self {
        let nq = if tree.free().is_empty() { 0 } else { tree.nq() };
        Self {
            still: filled(S::zero(), tree.dof()),
            q: filled(T::zero(), nq),
            chart: filled(T::zero(), tree.dof()),
        }
    }

    /// With the entries of q and of the chart made by these functions.
    pub fn set(
        &mut self,
        rows: &Constraints<T>,
        q: &[S],
        constant: impl Fn(S) -> T,
        moving: impl Fn(S, usize) -> T,
    ) {
        rows.tree().chart_coordinates(q, &mut self.still);
        self.q.iter_mut().zip(q).for_each(|(to, &q)| *to = constant(q));
        self.chart.iter_mut().zip(&self.still).enumerate().for_each(|(i, (to, &q))| *to = moving(q, i));
    }
}

/// The blocks at (q, v, mu).
#[derive(Clone, Debug)]
pub(super) struct Moving<S: Scalar> {
    rows: Constraints<Tangent<S>>,
    at: ChartPoint<S, Tangent<S>>,
    mu: Vec<Tangent<S>>,
    pub blocks: Blocks<S>,
}

impl<S: Scalar> Moving<S> {
    pub fn new(tree: &Tree) -> Self {
        let rows = Constraints::from_tree(tree);
        let (n, k, zero) = (rows.dof(), rows.count(), Tangent::zero());
        Self { rows, at: ChartPoint::new(tree), mu: filled(zero, k), blocks: Blocks::new(n, k) }
    }

    #[inline(never)]
    pub fn place(&mut self, q: &[S], v: &[S], mu: &[S]) {
        self.at.set(
            &self.rows,
            q,
            |value| Tangent::new(value, S::zero()),
            |value, i| Tangent::new(value, v[i]),
        );
        self.mu.iter_mut().zip(mu).for_each(|(to, &mu)| *to = Tangent::new(mu, S::zero()));
        self.rows.place_chart(&self.at.q, &self.at.chart);
        self.rows.contract(&self.mu);
        let Blocks { jacobian, slope, curvature, bend } = &mut self.blocks;
        take_rows(
            0..self.rows.count(),
            self.rows.chart_jacobian(),
            |entry| [entry.re, entry.eps],
            [jacobian, slope],
        );
        let some = self.rows.coordinates().iter().copied();
        take_rows(some, self.rows.contracted(), |entry| [entry.re, entry.eps], [curvature, bend]);
    }
}

/// The derivatives of the blocks along (dq, dv, dmu).
#[derive(Clone, Debug)]
pub(super) struct Changing<S: Scalar> {
    rows: Constraints<Tangent<Tangent<S>>>,
    at: ChartPoint<S, Tangent<Tangent<S>>>,
    mu: Vec<Tangent<Tangent<S>>>,
    pub blocks: Blocks<S>,
}

impl<S: Scalar> Changing<S> {
    pub fn new(tree: &Tree) -> Self {
        let rows = Constraints::from_tree(tree);
        let (n, k, zero) = (rows.dof(), rows.count(), Scalar::zero());
        Self { rows, at: ChartPoint::new(tree), mu: filled(zero, k), blocks: Blocks::new(n, k) }
    }

    /// At (q, v, mu), along (dq, dv, dmu).
    #[inline(never)]
    pub fn place(&mut self, [q, v, mu]: [&[S]; 3], [dq, dv, dmu]: [&[S]; 3]) {
        let still = Tangent::new(S::zero(), S::zero());
        let moving = |value, i: usize| Tangent::new(Tangent::new(value, v[i]), Tangent::new(dq[i], dv[i]));
        self.at.set(&self.rows, q, |value| Tangent::new(Tangent::new(value, S::zero()), still), moving);
        for (i, to) in self.mu.iter_mut().enumerate() {
            *to = Tangent::new(Tangent::new(mu[i], S::zero()), Tangent::new(dmu[i], S::zero()));
        }
        self.rows.place_chart(&self.at.q, &self.at.chart);
        self.rows.contract(&self.mu);
        let Blocks { jacobian, slope, curvature, bend } = &mut self.blocks;
        take_rows(
            0..self.rows.count(),
            self.rows.chart_jacobian(),
            |entry| [entry.eps.re, entry.eps.eps],
            [jacobian, slope],
        );
        let some = self.rows.coordinates().iter().copied();
        take_rows(some, self.rows.contracted(), |entry| [entry.eps.re, entry.eps.eps], [curvature, bend]);
    }
}

/// Copies two parts of every entry of some rows.
fn take_rows<T: Scalar, S: Scalar>(
    some: impl Iterator<Item = usize>,
    from: &Matrix<T>,
    parts: impl Fn(T) -> [S; 2],
    to: [&mut Matrix<S>; 2],
) {
    let [first, second] = to;
    for i in some {
        let to = first.row_mut(i).iter_mut().zip(second.row_mut(i));
        for (&entry, (first, second)) in from.row(i).iter().zip(to) {
            [*first, *second] = parts(entry);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::{looped, state};
    use super::*;
    use num_dual::{Dual64, HyperDual64};

    /// `J v` by a dual number, of hyper-dual numbers: derivatives of `mu . J v` by nested numbers of num-dual
    /// alone.
    #[test]
    fn blocks_are_those_of_nested_dual_numbers() {
        type Nested = num_dual::HyperDual<Dual64>;
        for robot in looped() {
            let (n, tree) = (robot.dof(), Tree::from(&robot));
            let [q, v, mu, _] = state(n);
            let mut moving = Moving::<f64>::new(&tree);
            let mu: Vec<f64> = mu.iter().cycle().take(moving.mu.len()).copied().collect();
            moving.place(&q, &v, &mu);
            let mut judge = Constraints::<Nested>::new(&robot);
            let mut plain = Constraints::<HyperDual64>::new(&robot);
            for i in 0..n {
                for j in 0..=i {
                    let one = |on: bool| Dual64::from_re(f64::from(u8::from(on)));
                    let seeds: Vec<Nested> = (0..n)
                        .map(|l| Nested::new(Dual64::new(q[l], v[l]), one(l == i), one(l == j), one(false)))
                        .collect();
                    judge.set_position(&seeds).unwrap();
                    let g = judge.values();
                    for (r, g) in g.iter().enumerate() {
                        let slope = moving.blocks.slope[(r, i)];
                        assert!((g.eps1.eps - slope).abs() < 1e-12, "{}: (J v)_q {r} {i}", robot.name());
                    }
                    let expected: f64 = g.iter().zip(&mu).map(|(g, mu)| g.eps1eps2.eps * mu).sum();
                    let found = moving.blocks.bend[(i, j)];
                    assert!((found - expected).abs() < 1e-12, "{}: {i} {j}", robot.name());
                    let expected: f64 = g.iter().zip(&mu).map(|(g, mu)| g.eps1eps2.re * mu).sum();
                    assert!((moving.blocks.curvature[(i, j)] - expected).abs() < 1e-12);
                }
            }
            // Without a direction there is no change.
            plain.set_position(&q.iter().map(|&q| HyperDual64::from_re(q)).collect::<Vec<_>>()).unwrap();
            assert!(plain.values().iter().all(|g| g.eps1 == 0.0 && g.eps1eps2 == 0.0));
        }
    }

    #[test]
    fn changes_are_those_of_dual_numbers() {
        for robot in looped() {
            let (n, tree) = (robot.dof(), Tree::from(&robot));
            let [q, v, mu, y] = state(n);
            let mut changing = Changing::<f64>::new(&tree);
            let k = changing.mu.len();
            let cycle = |x: &[f64], from: usize, count: usize| -> Vec<f64> {
                x.iter().cycle().skip(from).take(count).copied().collect()
            };
            let (mu, dmu) = (cycle(&mu, 0, k), cycle(&y, 1, k));
            let (dq, dv) = y.split_at(n);
            changing.place([&q, &v, &mu], [dq, dv, &dmu]);
            let along = |x: &[f64], dx: &[f64]| -> Vec<Dual64> {
                x.iter().zip(dx).map(|(&x, &dx)| Dual64::new(x, dx)).collect()
            };
            let mut judge = Moving::<Dual64>::new(&tree);
            judge.place(&along(&q, dq), &along(&v, dv), &along(&mu, &dmu));
            let close = |found: &Matrix<f64>, expected: &Matrix<Dual64>, what: &str| {
                for (found, expected) in found.as_slice().iter().zip(expected.as_slice()) {
                    assert!((found - expected.eps).abs() < 1e-11, "{}: {what}", robot.name());
                }
            };
            close(&changing.blocks.jacobian, &judge.blocks.jacobian, "J");
            close(&changing.blocks.slope, &judge.blocks.slope, "(J v)_q");
            close(&changing.blocks.curvature, &judge.blocks.curvature, "(mu . J)_q");
            close(&changing.blocks.bend, &judge.blocks.bend, "(mu . J v)_qq");
        }
    }
}
