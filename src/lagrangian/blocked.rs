//! The Jacobian of forward dynamics block by block, limited to the entries that the tree leaves.

use crate::kernels::Factor;
use crate::matrix::{Left, Matrix, Panel, Part, Pattern, Terms, Tiles, write_packs};
use crate::scalar::Scalar;

/// Products with the triangular matrix `U = L^-1` that give `a_z = [-M^-1 tau_q, -M^-1 tau_v, M^-1]`, for
/// packs of several lanes.
///
/// With `M^-1 = U D^-1 U'`, `Y = D^-1 U' tau_q` and `a_q = -U Y`. Entries of tau_q belong to pairs of joints
/// on one branch, those of U' to a joint and one beyond it. So an entry of Y is a sum over the joints that
/// are beyond one joint and on a branch with the other, an entry of a_q one over the joints on the way from
/// the base. A product with M^-1, which has entries for all pairs of joints on one joint of the base, takes
/// about twice as many products for a tree, and as many for a chain.
#[derive(Clone, Debug)]
pub(super) struct Blocked<S: Scalar> {
    /// Y.
    first: Tiles,
    /// `U Y`.
    second: Tiles,
    y: Panel<S>,
    /// `M^-1 tau_q` or `M^-1 tau_v`: what no tile sets stays zero.
    solved: Panel<S>,
}

impl<S: Scalar> Blocked<S> {
    /// For factors of this pattern.
    pub fn new(factor: &Factor<S>) -> Self {
        let (u, below, n) = (factor.inverse_pattern(), factor.pattern(), factor.size());
        let across = u.transposed();
        let pair = below.or(&below.transposed()).with_diagonal();
        let y = across.times(&pair);
        let tiles = |a: &Pattern, b: &Pattern| Tiles::new::<S>(a, b, Part::Whole, Terms::All);
        Self {
            first: tiles(&across, &pair),
            second: tiles(&u, &y),
            y: Panel::zeros(n, n),
            solved: Panel::zeros(n, n),
        }
    }

    /// Fills a_z, n x 3n, from the panels of tau_q and tau_v; M is factored.
    #[inline(never)]
    pub fn solve(&mut self, factor: &mut Factor<S>, torque: &[Panel<S>; 2], a_z: &mut Matrix<S>) {
        let Self { first, second, y, solved } = self;
        let n = y.rows();
        factor.place_inverse(a_z, (0, 2 * n));
        for (k, torque) in torque.iter().enumerate() {
            y.set_tiles(first, Left::Rows(factor.scaled_upper()), torque);
            solved.set_tiles(second, Left::Columns(factor.upper()), y);
            for i in 0..n {
                write_packs(solved.row(i), &mut a_z.row_mut(i)[k * n..(k + 1) * n], |pack| -pack);
            }
        }
    }
}
