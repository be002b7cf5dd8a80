//! From the third derivatives of L along a direction to those of H.

use super::blocked::Blocked;
use super::conservative::Conservative;
use crate::kernels::Factor;
use crate::matrix::{Left, Matrix, Panel, Part, Source, sized};
use crate::scalar::Scalar;

/// `-E' [ A B' ; B C ] E` with `E = [ 1 0 ; -W M^-1 ]`.
///
/// A, B, C: the derivatives of L_qq, P and M along a direction. With `T = B - C W`:
///
/// ```text
/// qq = -A + W' T + B' W      pq = -M^-1 T      pp = -M^-1 C M^-1
/// ```
///
/// This takes 4.5 n^3 multiplications (qq and pp are symmetric), and its rows are independent of each other.
/// In coordinates in which M is diagonal it takes 4 n^3, fewer if joints are on different branches, but each
/// row depends on the previous one. With `U = L^-1`, `M^-1 = U D^-1 U'`, `W = U Z`:
///
/// ```text
/// C^ = U' C U      B^ = U' B      T^ = B^ - C^ Z
/// qq = -A + Z' T^ + B^' Z      pq = -U D^-1 T^      pp = -U D^-1 C^ D^-1 U'
/// ```
///
/// Packs of several lanes use the first form up to 12 joints, and products with U beyond ([`Blocked`]);
/// scalars use the second.
#[derive(Clone, Debug)]
pub(super) struct Congruence<S: Scalar> {
    b: Panel<S>,
    c: Panel<S>,
    /// T.
    t: Panel<S>,
    /// `C M^-1`.
    x: Panel<S>,
    /// The blocks of the result, with the opposite sign.
    qq: Panel<S>,
    pq: Panel<S>,
    pp: Panel<S>,
    /// The transpose of pq.
    qp: Panel<S>,
    blocked: Option<Box<Blocked<S>>>,
}

impl<S: Scalar> Congruence<S> {
    /// Buffers for a matrix with these factors.
    pub fn new(factor: &Factor<S>) -> Self {
        let n = factor.size();
        let square = || Panel::zeros(n, n);
        Self {
            b: square(),
            c: square(),
            t: square(),
            x: square(),
            qq: square(),
            pq: square(),
            pp: square(),
            qp: square(),
            blocked: Panel::<S>::for_blocks(n, || Blocked::new(factor)),
        }
    }

    /// Fills both triangles of the 2n x 2n matrix h from the changes of M, P and L_qq; `flow` must be at its
    /// second order.
    #[inline(never)]
    pub fn apply<K>(&mut self, along: [Source<'_, S>; 3], flow: &Conservative<S, K>, h: &mut Matrix<S>) {
        if Panel::<S>::ONE_LANE {
            self.by_factors(along, &flow.factor, &flow.z);
            self.fill::<0, 0>(h);
        } else if let Some(blocked) = &mut self.blocked {
            blocked.apply(along, &flow.factor, &flow.y, h);
        } else {
            let given = (&flow.inverse, &flow.w);
            sized!(S, flow.w.columns(), self.by_products(along, given, h));
        }
    }

    fn by_factors(&mut self, [m, p, l_qq]: [Source<'_, S>; 3], factor: &Factor<S>, z: &Panel<S>) {
        let Self { b, t, qq, pq, pp, qp, .. } = self;
        qq.take::<0, 0>(l_qq);
        b.take::<0, 0>(p);
        factor.first_half(b);
        pp.take::<0, 0>(m);
        factor.reduce_symmetric(pp);
        t.copy_from::<0, 0>(b);
        t.subtract_product::<0, 0>(Left::Rows(pp), z, Part::Whole);
        pq.copy_from::<0, 0>(t);
        factor.divide_by_pivots(pq);
        factor.second_half(pq);
        factor.expand_symmetric(pp);
        qq.subtract_product::<0, 0>(Left::Columns(z), t, Part::Lower);
        qq.subtract_product::<0, 0>(Left::Columns(b), z, Part::Lower);
        qq.mirror_lower::<0>();
        qp.take_transpose::<0>(pq);
    }

    fn by_products<const N: usize, const W: usize>(
        &mut self,
        [m, p, l_qq]: [Source<'_, S>; 3],
        (inverse, w): (&Panel<S>, &Panel<S>),
        h: &mut Matrix<S>,
    ) {
        let Self { b, c, t, x, qq, pq, pp, qp, .. } = self;
        for panel in [&*b, c, t, x, qq, pq, pp, qp, inverse, w] {
            panel.has_size::<N, W>();
        }
        c.take::<N, W>(m);
        b.take::<N, W>(p);
        qq.take::<N, W>(l_qq);
        t.copy_from::<N, W>(b);
        x.set_product::<N, W>(Left::Rows(c), inverse, Part::Whole);
        t.subtract_product::<N, W>(Left::Rows(c), w, Part::Whole);
        pp.set_product::<N, W>(Left::Rows(inverse), x, Part::Lower);
        pq.set_product::<N, W>(Left::Rows(inverse), t, Part::Whole);
        qq.subtract_product::<N, W>(Left::Columns(w), t, Part::Lower);
        qq.subtract_product::<N, W>(Left::Columns(b), w, Part::Lower);
        qq.mirror_lower::<W>();
        pp.mirror_lower::<W>();
        qp.take_transpose::<W>(pq);
        self.fill::<N, W>(h);
    }

    /// Copies the blocks into the matrix.
    fn fill<const N: usize, const W: usize>(&self, h: &mut Matrix<S>) {
        let n = if N > 0 { N } else { self.qq.rows() };
        for i in 0..n {
            for (row, blocks) in [(i, [&self.qq, &self.qp]), (n + i, [&self.pq, &self.pp])] {
                let (left, right) = h.row_mut(row)[..2 * n].split_at_mut(n);
                blocks[0].write_row::<W>(i, left, |entry| -entry);
                blocks[1].write_row::<W>(i, right, |entry| -entry);
            }
        }
    }
}
