//! F_x and mu_x block by block, limited to the entries that tree and constraints leave.

use super::kkt::Kkt;
use crate::kernels::Factor;
use crate::matrix::{Left, Matrix, Panel, Part, Pattern, Place, Terms, Tiles, Update};
use crate::scalar::Scalar;

/// Products with R of `M^-1 = R R'`, and with the factors of C, for packs of several lanes.
///
/// ```text
/// X = R'J'    C = X'X = L_c D_c L_c'    A = J M^-1 = (R X)'    G = D_c^-1/2 L_c^-1 A
/// Y = R'P    N = X'Y - (J v)_q    B = D_c^-1/2 L_c^-1 N
///
/// v_q = -(R Y - G'B)              v_p = R R' - G'G
/// F^p_q = L_qq - Y'Y + B'B        mu_x = L_c'^-1 D_c^-1/2 (B, -G)
/// ```
///
/// with `P - (mu . J)_q` and `L_qq - (mu . J v)_qq` in the places of P and L_qq.
#[derive(Clone, Debug)]
pub(super) struct Elimination<S: Scalar> {
    products: Products,
    /// Coordinates with entries in each row of J.
    columns: Vec<Vec<usize>>,
    /// J' and X, n x k.
    across: Panel<S>,
    reach: Panel<S>,
    /// C, k x k.
    schur: Panel<S>,
    /// A, k x n.
    response: Panel<S>,
    /// G and B, k x n.
    g: Panel<S>,
    b: Panel<S>,
    /// P, then L_qq, then F^p_q.
    p: Panel<S>,
    y: Panel<S>,
    /// `R Y`.
    w: Panel<S>,
    /// `-v_q` and v_p. What is inside of the tiles of the tree has a panel of its own, which stays zero
    /// outside.
    velocity: Panel<S>,
    momentum: Panel<S>,
}

/// The products of [`Elimination`].
#[derive(Clone, Debug)]
struct Products {
    reach: Tiles,
    schur: Tiles,
    response: Tiles,
    upper: Tiles,
    lower: Tiles,
    square: Tiles,
    cross: Tiles,
    /// Products of k terms.
    rank: Tiles,
    rank_lower: Tiles,
}

/// Fills a panel.
pub(super) type Fill<'a, S> = &'a dyn Fn(&mut Panel<S>);

impl<S: Scalar> Elimination<S> {
    /// For factors of M and the coordinates that enter each row.
    pub fn new(factor: &Factor<S>, columns: Vec<Vec<usize>>) -> Self {
        let (n, k) = (factor.size(), columns.len());
        // Patterns are square; what is shorter has empty rows.
        let size = n.max(k);
        let from = |rows: &[Vec<usize>]| Pattern::from_rows(size, |i| rows.get(i).map_or(&[], |row| row));
        let (u, below) = (factor.inverse_pattern().enlarged(size), factor.pattern().enlarged(size));
        let (u_across, j) = (u.transposed(), from(&columns));
        let j_across = j.transposed();
        let reach = u_across.times(&j_across);
        let reach_across = reach.transposed();
        let pair = below.or(&below.transposed()).with_diagonal_to(n).or(&j_across.times(&j));
        let y = u_across.times(&pair);
        let full = from(&vec![(0..n).collect(); k.max(1)]);
        let full_across = full.transposed();
        let tiles = |a: &Pattern, b: &Pattern, part| Tiles::new::<S>(a, b, part, Terms::All);
        let (whole, lower) = (Part::Whole, Part::Lower);
        let (other, square) = (|| Panel::zeros(size, size), || Panel::zeros(n, n));
        Self {
            products: Products {
                reach: tiles(&u_across, &j_across, whole),
                schur: tiles(&reach_across, &reach, whole),
                response: tiles(&reach_across, &u_across, whole),
                upper: tiles(&u_across, &pair, whole),
                lower: tiles(&u, &y, whole),
                square: tiles(&y.transposed(), &y, lower),
                cross: tiles(&reach_across, &y, whole),
                rank: tiles(&full_across, &full, whole),
                rank_lower: tiles(&full_across, &full, lower),
            },
            columns,
            across: other(),
            reach: other(),
            schur: other(),
            response: other(),
            g: other(),
            b: other(),
            p: square(),
            y: square(),
            w: square(),
            velocity: square(),
            momentum: square(),
        }
    }

    /// A and C, where M is factored.
    #[inline(never)]
    pub fn respond(&mut self, factor: &mut Factor<S>, jacobian: &Matrix<S>, kkt: &mut Kkt<S>) {
        let Self { products, columns, across, reach, schur, response, .. } = self;
        factor.invert();
        for (i, columns) in columns.iter().enumerate() {
            columns.iter().for_each(|&j| across.set(j, i, jacobian[(i, j)]));
        }
        reach.set_tiles(&products.reach, Left::Rows(factor.root()), across);
        schur.set_tiles(&products.schur, Left::Columns(reach), reach);
        response.set_tiles(&products.response, Left::Columns(reach), factor.root());
        kkt.take(schur, response);
    }

    /// F_x without friction and mu_x, after [`respond`](Self::respond), from P, L_qq, and `(J v)_q`.
    #[inline(never)]
    pub fn place(
        &mut self,
        (factor, kkt): (&mut Factor<S>, &Kkt<S>),
        [take_p, take_l_qq]: [Fill<'_, S>; 2],
        slope: &Matrix<S>,
        [f_x, mu_x]: [&mut Matrix<S>; 2],
    ) {
        let Self { products, reach, response, g, b, p, y, w, velocity, momentum, .. } = self;
        let (n, k) = (y.rows(), mu_x.rows());
        take_p(p);
        y.set_tiles(&products.upper, Left::Rows(factor.root()), p);
        // The rows of the last call have entries outside of these tiles.
        (0..k).for_each(|i| b.row_mut(i).fill(S::Pack::zero()));
        b.set_tiles(&products.cross, Left::Columns(reach), y);
        for i in 0..k {
            b.subtract_row(i, slope.row(i));
            g.row_mut(i).copy_from_slice(response.row(i));
        }
        [&mut *g, &mut *b].into_iter().for_each(|rows| kkt.first_half(rows));

        let update = Update::SubtractFrom(factor.inverse_by_blocks());
        momentum.update_tiles(&products.rank_lower, Left::Columns(g), g, update);
        w.set_tiles(&products.lower, Left::Columns(factor.root()), y);
        velocity.update_tiles(&products.rank, Left::Columns(g), b, Update::SubtractFrom(w));
        take_l_qq(p);
        p.subtract_tiles(&products.square, Left::Columns(y), y);
        p.update_tiles(&products.rank_lower, Left::Columns(b), b, Update::Add);
        f_x.place_panel(Place::symmetric((0, n), false), &products.rank_lower, momentum);
        let by_position = Place { at: (0, 0), across: (n, n), minus: [true, false] };
        f_x.place_panel(by_position, &products.rank, velocity);
        f_x.place_panel(Place::symmetric((n, 0), false), &products.rank_lower, p);

        [&mut *g, &mut *b].into_iter().for_each(|rows| kkt.second_half(rows));
        for i in 0..k {
            let (in_q, in_p) = mu_x.row_mut(i).split_at_mut(n);
            b.write_row::<0>(i, in_q, |pack| pack);
            g.write_row::<0>(i, in_p, |pack| -pack);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::free_samples::{quadruped, standing};
    use crate::constraints::ConstrainedHamiltonian;
    use crate::matrix::Panel;
    use crate::robot::test_robot::robot;
    use crate::robot::{ConstraintSpec, Robot, Tree};

    /// Blocks and columns, at two states one after the other: nothing may be left of the first.
    fn compare(robot: &Robot) {
        let (n, nq) = (robot.dof(), Tree::from(robot).nq());
        let numbers =
            |count: usize, from: f64| (0..count).map(|i| (from + 1.3 * i as f64).sin()).collect::<Vec<_>>();
        let mut blocks = ConstrainedHamiltonian::<f64>::new(robot);
        let mut columns = ConstrainedHamiltonian::<f64>::new(robot);
        assert_eq!(blocks.elimination.is_some(), Panel::<f64>::in_blocks(n));
        columns.elimination = None;
        if nq == n {
            columns.kernel.world = None;
        }
        for from in [0.3, 1.1] {
            let mut q = numbers(nq, from);
            if nq > n {
                let length = q[3..7].iter().map(|x| x * x).sum::<f64>().sqrt();
                q[3..7].iter_mut().for_each(|x| *x /= length);
            }
            let (p, u) = (numbers(n, 0.5 * from), numbers(n, 0.7));
            let found = blocks.linearise(&q, &p, &u).unwrap();
            let expected = columns.linearise(&q, &p, &u).unwrap();
            for (found, expected) in [(found.matrix(), expected.matrix()), (found.mu_x(), expected.mu_x())] {
                let (found, expected) = (found.to_nalgebra(), expected.to_nalgebra());
                let error = (&found - &expected).amax();
                assert!(error < 1e-10 * expected.amax(), "{}, n = {n}: {error}", robot.name());
            }
            let lambda = found.lambda().iter().zip(expected.lambda());
            let size = expected.lambda().iter().fold(1.0, |most: f64, x| most.max(x.abs()));
            assert!(lambda.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) < 1e-10 * size);
            assert_eq!(blocks.counted(), columns.counted());
        }
    }

    #[test]
    fn blocks_give_the_derivatives_of_columns() {
        compare(&standing(quadruped(true), &["lf", "rh"]));
        compare(&standing(quadruped(false), &["lf", "rf", "lh"]));
        for n in [13, 17, 22] {
            // Two branches, and trees that the constraints join.
            let loops = |robot: Robot, twice: bool| {
                let last = format!("j{}", n - 1);
                let pin = |name: &str| ConstraintSpec::pinned(name, &last, "j5");
                let robot = robot.with_constraint(pin("pin")).unwrap();
                let gear = ConstraintSpec::coupling("gear", &[("j2", 1.0), (&last, -0.7)], 0.1);
                let robot = robot.with_constraint(gear).unwrap();
                if twice { robot.with_constraint(pin("again")).unwrap() } else { robot }
            };
            compare(&loops(robot(n, |k| k.wrapping_sub(2), false), false));
            compare(&loops(robot(n, |k| (k * k + 1) % (k + 2), true), true));
            compare(&loops(robot(n, |k| k / 2 + k % 3, false), true));
        }
        // More rows than joints.
        let welds = |robot: Robot, count: usize| {
            (0..count).fold(robot, |robot, k| {
                let spec = ConstraintSpec::rigid(format!("weld{k}"), &format!("j{}", 12 - k), "world");
                robot.with_constraint(spec).unwrap()
            })
        };
        compare(&welds(robot(13, |k| k.wrapping_sub(1), false), 3));
    }
}
