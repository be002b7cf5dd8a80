//! The blocks of F_x and y'F_xx as products with the triangular matrix `U = L^-1`, limited to the entries that
//! the tree leaves.

use super::conservative::Conservative;
use crate::kernels::{Factor, KernelTwo, LagrangianHessian};
use crate::matrix::{Left, Panel, Part, Pattern, Terms, Tiles};
use crate::scalar::Scalar;

/// The products of [`Conservative::eliminate_by_blocks`].
#[derive(Clone, Debug)]
pub(super) struct Elimination {
    /// `Y = U' P`.
    pub upper: Tiles,
    /// `Y' Z`.
    pub square: Tiles,
    /// `W = U Z`.
    pub lower: Tiles,
}

/// Where the entries of the matrices are.
struct Patterns {
    /// U, with its diagonal, and U'.
    u: Pattern,
    u_across: Pattern,
    /// M, P and L_qq, their diagonals included.
    pair: Pattern,
    /// `Y = U' P`.
    y: Pattern,
}

impl Patterns {
    fn new<S: Scalar>(factor: &Factor<S>) -> Self {
        let (u, below) = (factor.inverse_pattern(), factor.pattern());
        let u_across = u.transposed();
        let pair = below.or(&below.transposed()).with_diagonal();
        let y = u_across.times(&pair);
        Self { u, u_across, pair, y }
    }
}

impl Elimination {
    pub fn new<S: Scalar>(factor: &Factor<S>) -> Self {
        let Patterns { u, u_across, pair, y } = Patterns::new(factor);
        let tiles =
            |a: &Pattern, b: &Pattern, part| Tiles::new(Panel::<S>::LANES, a, b, part, Terms::All);
        Self {
            upper: tiles(&u_across, &pair, Part::Whole),
            square: tiles(&y.transposed(), &y, Part::Lower),
            lower: tiles(&u, &y, Part::Whole),
        }
    }
}

impl<S: Scalar, K: LagrangianHessian<S>> Conservative<S, K> {
    /// `Y = U' P`, `Z = D^-1 Y`: `P' M^-1 P = Y' Z`, `W = U Z`.
    pub(super) fn eliminate_by_blocks(&mut self, tiles: &Elimination) {
        let Self { kernel, factor, inverse, p, y, z, w, reduced, .. } = self;
        factor.form_inverse::<0, 0>(inverse);
        p.read::<0>(kernel.l_vq());
        reduced.read::<0>(kernel.l_qq());
        y.set_tiles(&tiles.upper, Left::Rows(factor.upper()), p);
        z.copy_from::<0, 0>(y);
        factor.divide_by_pivots(z);
        reduced.subtract_tiles(&tiles.square, Left::Columns(y), z);
        reduced.mirror_lower::<0>();
        w.set_tiles(&tiles.lower, Left::Columns(factor.upper()), z);
    }
}

/// The products of [`Blocked::apply`].
#[derive(Clone, Debug)]
struct Products {
    /// `B^ = U' B`.
    upper: Tiles,
    /// `H = G U` of two lower triangular matrices.
    half: Tiles,
    /// `U' H`.
    whole: Tiles,
    /// `C^ Z`.
    inner: Tiles,
    /// `Z' T^`.
    outer: Tiles,
    /// `B^' Z`.
    square: Tiles,
    /// `U D^-1 T^`.
    mixed: Tiles,
    /// `H = U G` of two lower triangular matrices.
    back: Tiles,
    /// `H U'`.
    last: Tiles,
}

/// The congruence in coordinates in which M is diagonal, for packs of several lanes.
///
/// ```text
/// C^ = U' C U      B^ = U' B      T^ = B^ - C^ Z
/// qq = -A + Z' T^ + B^' Z      pq = -U D^-1 T^      pp = -U D^-1 C^ D^-1 U'
/// ```
///
/// A symmetric matrix is the sum of a lower triangular G and G'. So `U' C U` is `U' (G U)` plus its transpose,
/// which takes half of the products of a matrix that is not symmetric.
#[derive(Clone, Debug)]
pub(super) struct Blocked<S: Scalar> {
    products: Products,
    /// B, then T^.
    t: Panel<S>,
    b: Panel<S>,
    /// U.
    u: Panel<S>,
    /// G, and H and `U' H` of C.
    g: Panel<S>,
    h: Panel<S>,
    r: Panel<S>,
    /// C^, then G of the result.
    c: Panel<S>,
    /// H and `H U'` of the result. Each matrix has its own buffer: what no tile sets stays zero.
    back: Panel<S>,
    last: Panel<S>,
}

impl<S: Scalar> Blocked<S> {
    pub fn new(factor: &Factor<S>) -> Self {
        let Patterns { u, u_across, pair, y } = Patterns::new(factor);
        let tiles =
            |a: &Pattern, b: &Pattern, part| Tiles::new(Panel::<S>::LANES, a, b, part, Terms::All);
        let (whole, lower) = (Part::Whole, Part::Lower);
        let half = pair.lower();
        let h = half.times(&u);
        let r = u_across.times(&h);
        let c = r.or(&r.transposed());
        let t = c.times(&y).or(&y);
        let back = u.times(&c.lower());
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
                back: tiles(&u, &c.lower(), lower),
                last: tiles(&back, &u_across, whole),
            },
            t: square(),
            b: square(),
            u: square(),
            g: square(),
            h: square(),
            r: square(),
            c: square(),
            back: square(),
            last: square(),
        }
    }

    /// The blocks of the result with the opposite sign: qq, pq, pp.
    pub fn apply(
        &mut self,
        along: &KernelTwo<S>,
        factor: &Factor<S>,
        z: &Panel<S>,
        [qq, pq, pp]: [&mut Panel<S>; 3],
    ) {
        let Self { products, t, b, u, g, h, r, c, back, last } = self;
        let upper = factor.upper();
        u.take_transpose::<0>(upper);
        qq.read::<0>(along.l_qq());
        t.read::<0>(along.l_vq());
        b.set_tiles(&products.upper, Left::Rows(upper), t);

        g.read::<0>(along.mass_matrix());
        g.keep_half();
        h.set_tiles(&products.half, Left::Rows(g), u);
        r.set_tiles(&products.whole, Left::Rows(upper), h);
        c.add_transpose(r);

        t.copy_from::<0, 0>(b);
        t.subtract_tiles(&products.inner, Left::Rows(c), z);
        qq.subtract_tiles(&products.outer, Left::Columns(z), t);
        qq.subtract_tiles(&products.square, Left::Columns(b), z);
        qq.mirror_lower::<0>();

        factor.divide_by_pivots(t);
        pq.set_tiles(&products.mixed, Left::Columns(upper), t);

        factor.divide_by_pivots_twice(c);
        c.keep_half();
        back.set_tiles(&products.back, Left::Columns(upper), c);
        last.set_tiles(&products.last, Left::Rows(back), upper);
        pp.add_transpose(last);
    }
}
