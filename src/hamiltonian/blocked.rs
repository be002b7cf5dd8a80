//! The congruence of y'F_xx as products with the triangular matrix `R = L^-1 D^-1/2`, limited to the entries
//! that the tree leaves.

use super::elimination::Patterns;
use crate::kernels::Factor;
use crate::matrix::{Left, Matrix, Panel, Part, Pattern, Place, Source, Terms, Tiles, Update};
use crate::scalar::Scalar;

/// The products of [`Blocked::apply`].
#[derive(Clone, Debug)]
struct Products {
    /// `B^ = R' B`.
    upper: Tiles,
    /// `H = G R` of two lower triangular matrices.
    half: Tiles,
    /// `R' H`.
    whole: Tiles,
    /// `C^ Y`.
    inner: Tiles,
    /// `Y' T^`.
    outer: Tiles,
    /// `B^' Y`.
    square: Tiles,
    /// `R T^`.
    mixed: Tiles,
    /// `H = G' R'` of two upper triangular matrices.
    back: Tiles,
    /// `H' R'` and `R H`.
    last: Tiles,
}

/// The congruence in coordinates in which M is the unit matrix, for packs of several lanes.
///
/// ```text
/// C^ = R' C R      B^ = R' B      T^ = B^ - C^ Y      Y = R' P
/// qq = -A + Y' T^ + B^' Y      pq = -R T^      pp = -R C^ R'
/// ```
///
/// A symmetric matrix is the sum of a lower triangular G and G'. So `R' C R` is `R' (G R)` plus its
/// transpose, which takes half of the products of a matrix that is not symmetric.
#[derive(Clone, Debug)]
pub(super) struct Blocked<S: Scalar> {
    products: Products,
    /// The changes of M, P and L_qq, where kernel two has computed them.
    along: [Panel<S>; 3],
    /// T^.
    t: Panel<S>,
    b: Panel<S>,
    /// R.
    u: Panel<S>,
    /// G, and H and `R' H` of C.
    g: Panel<S>,
    h: Panel<S>,
    r: Panel<S>,
    /// C^, then G of the result.
    c: Panel<S>,
    /// `R T^`.
    mixed: Panel<S>,
    /// H and `H' R'` of the result. Each matrix has its own buffer: what no tile sets stays zero.
    back: Panel<S>,
    last: Panel<S>,
}

impl<S: Scalar> Blocked<S> {
    pub fn new(factor: &Factor<S>) -> Self {
        let Patterns { u, u_across, pair, y } = Patterns::new(factor);
        let tiles = |a: &Pattern, b: &Pattern, part| Tiles::new::<S>(a, b, part, Terms::All);
        let (whole, lower) = (Part::Whole, Part::Lower);
        let half = pair.lower();
        let h = half.times(&u);
        let r = u_across.times(&h);
        let c = r.or(&r.transposed());
        let t = c.times(&y).or(&y);
        let back = c.lower().transposed().times(&u_across);
        // For `R H` and its transpose.
        let both = u_across.or(&back);
        let n = factor.size();
        let square = || Panel::zeros(n, n);
        Self {
            products: Products {
                upper: tiles(&u_across, &pair, whole),
                half: tiles(&half, &u, lower),
                whole: tiles(&u_across, &h, whole),
                inner: tiles(&c, &y, whole),
                outer: tiles(&y.transposed(), &t, lower),
                square: tiles(&y.transposed(), &y, lower),
                mixed: tiles(&u, &t, whole),
                back: tiles(&c.lower().transposed(), &u_across, whole),
                last: tiles(&both.transposed(), &both, lower),
            },
            along: [square(), square(), square()],
            t: square(),
            b: square(),
            u: square(),
            g: square(),
            h: square(),
            r: square(),
            c: square(),
            mixed: square(),
            back: square(),
            last: square(),
        }
    }

    /// Fills both triangles of the 2n x 2n matrix.
    pub fn apply(
        &mut self,
        [m, p, l_qq]: [Source<'_, S>; 3],
        factor: &Factor<S>,
        y: &Panel<S>,
        result: &mut Matrix<S>,
    ) {
        let Self { products, along, t, b, u, g, h, r, c, mixed, back, last } = self;
        let [of_m, of_p, of_l_qq] = along;
        let (m, p, l_qq) = (of_m.of(m), of_p.of(p), of_l_qq.of(l_qq));
        let (upper, n) = (factor.root(), y.rows());
        u.take_transpose::<0>(upper);
        b.set_tiles(&products.upper, Left::Columns(u), p);

        g.copy_from::<0, 0>(m);
        g.keep_half();
        h.set_tiles(&products.half, Left::Rows(g), u);
        r.set_tiles(&products.whole, Left::Columns(u), h);
        c.add_transpose(r);

        t.copy_from::<0, 0>(b);
        t.subtract_tiles(&products.inner, Left::Columns(c), y);
        g.copy_from::<0, 0>(l_qq);
        g.subtract_tiles(&products.square, Left::Columns(b), y);
        let qq = Place::symmetric((0, 0), true);
        result.place_tiles(qq, &products.outer, (Left::Columns(y), t), (g, Update::Subtract));

        let pq = Place { at: (n, 0), across: (0, n), minus: [true; 2] };
        result.place_tiles(pq, &products.mixed, (Left::Columns(upper), t), (mixed, Update::Set));

        c.keep_half();
        back.set_tiles(&products.back, Left::Columns(c), upper);
        last.set_tiles(&products.last, Left::Columns(back), upper);
        let pp = Place::symmetric((n, n), true);
        result.place_tiles(pp, &products.last, (Left::Columns(upper), back), (last, Update::Add));
    }
}

#[cfg(test)]
mod tests {
    use crate::hamiltonian::{DualPass, FullHessian, HamiltonianSecondOrder};
    use crate::matrix::Block;
    use crate::robot::Robot;
    use crate::robot::test_robot::robot;

    fn compare(robot: &Robot) {
        let n = robot.dof();
        let numbers =
            |count: usize, from: f64| (0..count).map(|i| (from + 1.3 * i as f64).sin()).collect::<Vec<_>>();
        let equal = |found: Block<'_, f64>, expected: Block<'_, f64>| {
            let (found, expected) = (found.to_nalgebra(), expected.to_nalgebra());
            assert!((&found - &expected).amax() < 1e-11 * expected.amax(), "n = {n}");
        };
        let mut blocks = HamiltonianSecondOrder::<f64>::new(robot);
        let mut duals = DualPass::<f64>::new(robot);
        // The second time, nothing may be left of the first.
        for from in [0.3, 1.1] {
            let (q, p, u, y) = (numbers(n, from), numbers(n, 0.5), numbers(n, 0.7), numbers(2 * n, 0.9));
            let expected = duals.contract(&q, &p, &u, &y).unwrap();
            let found = blocks.contract(&q, &p, &u, &y).unwrap();
            equal(found.linearisation().matrix(), expected.linearisation().matrix());
            equal(found.matrix(), expected.matrix());
            assert_eq!(found.matrix().to_nalgebra(), found.matrix().to_nalgebra().transpose());
            let reduced = found.linearisation().qp().to_nalgebra();
            assert_eq!(reduced, reduced.transpose());
        }
        let (q, p, y) = (numbers(n, 1.1), numbers(n, 0.5), numbers(2 * n, 0.9));
        let mut contracted = crate::matrix::Matrix::zeros(2 * n, 2 * n);
        let mut full = FullHessian::<f64>::new(robot);
        full.hessian_tensor(&q, &p).unwrap().contract(&y, &mut contracted).unwrap();
        let found = blocks.contract(&q, &p, &vec![0.0; n], &y).unwrap();
        equal(contracted.view(), found.matrix());
    }

    #[test]
    fn blocks_give_the_derivatives_of_a_dual_pass() {
        for n in [13, 18, 23] {
            compare(&robot(n, |k| k.wrapping_sub(1), false));
            compare(&robot(n, |k| k / 2 + k % 3, false));
            compare(&robot(n, |k| (k * k + 1) % (k + 2), true));
        }
    }
}
