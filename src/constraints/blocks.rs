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
    /// J, k x n; of the derivatives alone, not of the blocks themselves.
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
    v: Vec<S>,
    pub blocks: Blocks<S>,
}

impl<S: Scalar> Moving<S> {
    pub fn new(tree: &Tree) -> Self {
        let rows = Constraints::from_tree(tree);
        let (n, k, zero) = (rows.dof(), rows.count(), Tangent::zero());
        let (at, mu, v) = (ChartPoint::new(tree), filled(zero, k), filled(S::zero(), n));
        Self { rows, at, mu, v, blocks: Blocks::new(n, k) }
    }

    /// The same with displacements of floating joints along the axes of the moved frames, where these rows
    /// were placed last.
    pub fn place_in_own_axes(&mut self, q: &[S], v: &[S], mu: &[S], rows: &Constraints<S>) {
        self.v.copy_from_slice(v);
        let mut outward = std::mem::take(&mut self.v);
        rows.frames().iter().for_each(|frame| frame.outward(&mut outward));
        self.place(q, &outward, mu);
        self.v = outward;
        let Blocks { slope, curvature, bend, .. } = &mut self.blocks;
        for frame in rows.frames() {
            let (at, _) = frame.place();
            (0..slope.rows()).for_each(|i| frame.inward(slope.row_mut(i)));
            [&mut *curvature, &mut *bend].into_iter().for_each(|matrix| frame.turn_symmetric(matrix, &[at]));
        }
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
        let Blocks { slope, curvature, bend, .. } = &mut self.blocks;
        let (of_rows, some) = (0..self.rows.count(), self.rows.coordinates());
        for i in of_rows {
            let (from, to) = (self.rows.chart_jacobian().row(i), slope.row_mut(i));
            some.iter().for_each(|&j| to[j] = from[j].eps);
        }
        let both = [curvature, bend];
        take_entries(some.iter().copied(), some, self.rows.contracted(), |entry| [entry.re, entry.eps], both);
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
        let (of_rows, some) = (0..self.rows.count(), self.rows.coordinates());
        let (of_j, of_hessian) = (self.rows.chart_jacobian(), self.rows.contracted());
        let parts = |entry: Tangent<Tangent<S>>| [entry.eps.re, entry.eps.eps];
        take_entries(of_rows, some, of_j, parts, [jacobian, slope]);
        take_entries(some.iter().copied(), some, of_hessian, parts, [curvature, bend]);
    }
}

/// Copies two parts of the entries in some rows and columns.
fn take_entries<T: Scalar, S: Scalar>(
    rows: impl Iterator<Item = usize>,
    columns: &[usize],
    from: &Matrix<T>,
    parts: impl Fn(T) -> [S; 2],
    [first, second]: [&mut Matrix<S>; 2],
) {
    for i in rows {
        let (from, first, second) = (from.row(i), first.row_mut(i), second.row_mut(i));
        for &j in columns {
            [first[j], second[j]] = parts(from[j]);
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
            let jacobian = judge.rows.chart_jacobian().as_slice().iter();
            for (found, expected) in changing.blocks.jacobian.as_slice().iter().zip(jacobian) {
                assert!((found - expected.re.eps).abs() < 1e-11, "{}: J", robot.name());
            }
            close(&changing.blocks.slope, &judge.blocks.slope, "(J v)_q");
            close(&changing.blocks.curvature, &judge.blocks.curvature, "(mu . J)_q");
            close(&changing.blocks.bend, &judge.blocks.bend, "(mu . J v)_qq");
        }
    }
}
