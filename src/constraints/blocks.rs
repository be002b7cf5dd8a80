//! Derivatives of g along a motion.
//!
//! With `C = (J'mu)_q` at hand, `(J v)_q` is the derivative of J along v, and `(mu . J v)_qq` that of C for
//! constant mu. Both are tangents of the same code, at `q (+) a v`; their own derivatives along (dq, dv, dmu)
//! are tangents of these.
//!
//! Displacements of floating and spherical joints do not commute. With N(v) of `configuration/brackets.rs`,
//!
//! $$ (J v)\_q = D\_v J + J N(v)^T, \qquad
//! (\mu \cdot J v)\_{qq} = \operatorname{sym}(D\_v C + N(v) (C + C^T)) $$

use super::Constraints;
use crate::configuration::Brackets;
use crate::matrix::{Matrix, filled};
use crate::robot::Tree;
use crate::scalar::{Scalar, Tangent};
use crate::spatial::{Quaternion, Vec3};

/// What the constraints add to the blocks of the kernels, or its derivative along a direction.
#[derive(Clone, Debug)]
pub(super) struct Blocks<S> {
    /// J, k x n.
    pub jacobian: Matrix<S>,
    /// `(J v)_q`, k x n.
    pub slope: Matrix<S>,
    /// `C = (J'mu)_q`, n x n.
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

/// The blocks at (q, v, mu).
#[derive(Clone, Debug)]
pub(super) struct Moving<S: Scalar> {
    pub rows: Constraints<Tangent<S>>,
    pub brackets: Brackets<S>,
    q: Vec<Tangent<S>>,
    mu: Vec<Tangent<S>>,
    pub blocks: Blocks<S>,
}

impl<S: Scalar> Moving<S> {
    pub fn new(tree: &Tree) -> Self {
        let rows = Constraints::from_tree(tree);
        let (n, k, zero) = (rows.dof(), rows.count(), Tangent::zero());
        let (q, mu) = (filled(zero, tree.nq()), filled(zero, k));
        Self { rows, brackets: Brackets::new(tree), q, mu, blocks: Blocks::new(n, k) }
    }

    #[inline(never)]
    pub fn place(&mut self, q: &[S], v: &[S], mu: &[S]) {
        self.place_rows(q, v);
        self.contract(v, mu);
    }

    /// J and its slope alone.
    #[inline(never)]
    pub fn place_rows(&mut self, q: &[S], v: &[S]) {
        displace(self.rows.tree(), q, v, &mut self.q);
        self.rows.place(&self.q);
        let Blocks { jacobian, slope, .. } = &mut self.blocks;
        take(self.rows.jacobian(), jacobian, |entry| entry.re);
        take(self.rows.jacobian(), slope, |entry| entry.eps);
        for e in self.brackets.of_velocity(v) {
            (0..slope.rows()).for_each(|i| slope[(i, e.row)] += e.value * jacobian[(i, e.column)]);
        }
    }

    /// The other blocks there.
    #[inline(never)]
    pub fn contract(&mut self, v: &[S], mu: &[S]) {
        self.mu.iter_mut().zip(mu).for_each(|(to, &mu)| *to = Tangent::new(mu, S::zero()));
        let (Blocks { curvature, bend, .. }, found) = (&mut self.blocks, self.rows.contract(&self.mu));
        take(found, curvature, |entry| entry.re);
        take(found, bend, |entry| entry.eps);
        for e in self.brackets.of_velocity(v) {
            for j in 0..v.len() {
                let both = curvature[(e.column, j)] + curvature[(j, e.column)];
                bend[(e.row, j)] += e.value * both;
            }
        }
        if !self.rows.tree().free().is_empty() {
            for (i, j) in (0..v.len()).flat_map(|i| (0..i).map(move |j| (i, j))) {
                let entry = (bend[(i, j)] + bend[(j, i)]).times(0.5);
                (bend[(i, j)], bend[(j, i)]) = (entry, entry);
            }
        }
    }
}

/// The derivatives of the blocks along (dq, dv, dmu).
#[derive(Clone, Debug)]
pub(super) struct Changing<S: Scalar> {
    moving: Moving<Tangent<S>>,
    q: Vec<Tangent<S>>,
    v: Vec<Tangent<S>>,
    mu: Vec<Tangent<S>>,
    pub blocks: Blocks<S>,
}

impl<S: Scalar> Changing<S> {
    pub fn new(tree: &Tree) -> Self {
        let (moving, zero) = (Moving::new(tree), Tangent::zero());
        let (n, k) = (tree.dof(), moving.mu.len());
        let (q, v, mu) = (filled(zero, tree.nq()), filled(zero, n), filled(zero, k));
        Self { moving, q, v, mu, blocks: Blocks::new(n, k) }
    }

    /// At (q, v, mu), along (dq, dv, dmu).
    #[inline(never)]
    pub fn place(&mut self, [q, v, mu]: [&[S]; 3], [dq, dv, dmu]: [&[S]; 3]) {
        displace(self.moving.rows.tree(), q, dq, &mut self.q);
        pair(v, dv, &mut self.v);
        pair(mu, dmu, &mut self.mu);
        self.moving.place(&self.q, &self.v, &self.mu);
        let (from, to) = (&self.moving.blocks, &mut self.blocks);
        take(&from.jacobian, &mut to.jacobian, |entry| entry.eps);
        take(&from.slope, &mut to.slope, |entry| entry.eps);
        take(&from.curvature, &mut to.curvature, |entry| entry.eps);
        take(&from.bend, &mut to.bend, |entry| entry.eps);
    }
}

/// Numbers with their derivatives.
pub(super) fn pair<S: Scalar>(values: &[S], along: &[S], to: &mut [Tangent<S>]) {
    let both = values.iter().zip(along);
    to.iter_mut().zip(both).for_each(|(to, (&value, &along))| *to = Tangent::new(value, along));
}

/// `q (+) a d`, nq, of which the derivative by a is carried.
pub(super) fn displace<S: Scalar>(tree: &Tree, q: &[S], d: &[S], to: &mut [Tangent<S>]) {
    to.iter_mut().zip(q).for_each(|(to, &q)| *to = Tangent::new(q, S::zero()));
    let along = |i: usize| Tangent::new(S::zero(), d[i]);
    tree.plain_entries().for_each(|(at, i)| to[at] += along(i));
    for free in tree.free() {
        let (from, at) = (free.quaternion(to), free.joint.coordinate);
        let vector = |k: usize| Vec3::new(along(at + k), along(at + k + 1), along(at + k + 2));
        let slides = free.joint.kind.slides();
        let turn = Quaternion { vector: vector(slides).times(0.5), scalar: Tangent::one() };
        to[free.quaternion_entries()].copy_from_slice(&from.then_after(turn).to_array());
        if slides > 0 {
            let by = from.rotation().apply(vector(0)).to_array();
            (0..3).for_each(|k| to[free.joint.position + k] += by[k]);
        }
    }
}

/// Copies a part of all entries.
pub(super) fn take<T: Scalar, S: Scalar>(from: &Matrix<T>, to: &mut Matrix<S>, part: impl Fn(T) -> S) {
    for i in 0..to.rows() {
        to.row_mut(i).iter_mut().zip(from.row(i)).for_each(|(to, &from)| *to = part(from));
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
            let jacobian = judge.rows.jacobian().as_slice().iter();
            for (found, expected) in changing.blocks.jacobian.as_slice().iter().zip(jacobian) {
                assert!((found - expected.re.eps).abs() < 1e-11, "{}: J", robot.name());
            }
            close(&changing.blocks.slope, &judge.blocks.slope, "(J v)_q");
            close(&changing.blocks.curvature, &judge.blocks.curvature, "(mu . J)_q");
            close(&changing.blocks.bend, &judge.blocks.bend, "(mu . J v)_qq");
        }
    }
}
