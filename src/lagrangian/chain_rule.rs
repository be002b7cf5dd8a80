//! The contracted Hessian of forward dynamics from that of inverse dynamics.

use super::Lagrangian;
use crate::kernels::{Factor, TorqueHessian};
use crate::matrix::{Left, Matrix, Panel, Part, Pattern, Terms, Tiles, sized, write_packs};
use crate::scalar::Scalar;

/// Products of `y'a_zz = -Z' (w.tau)_zz Z`, for `w = M^-1 y` and Z with the rows (1, 0, 0), (0, 1, 0), a_z.
///
/// Only those with the block `B = (w.tau)_aq` are not trivial. With `M^-1 = R R'` and `T_c = (M^-1 tau_c)' B`
/// for c = q, v
///
/// ```text
/// (q, q): T_q + T_q' - (w.tau)_qq     (v, q): T_v - (w.tau)_vq     (v, v): -(w.tau)_vv     (u, q): -M^-1 B
/// ```
///
/// Block by block, `T_c = Y_c' Y_B` and `M^-1 B = R Y_B` with `Y = R' tau_c` from the Jacobian and `Y_B = R'
/// B`: these have entries for pairs of joints on one branch alone.
#[derive(Clone, Debug)]
pub(super) struct ChainRule<S: Scalar> {
    /// `T_q`, `T_v`, each less the block of `w.tau` in the end.
    moved: [Panel<S>; 2],
    /// `M^-1 B`.
    solved: Panel<S>,
    /// A transpose, or the sum of one.
    across: Panel<S>,
    blocked: Option<Box<Blocked<S>>>,
}

#[derive(Clone, Debug)]
struct Blocked<S: Scalar> {
    /// Y_B, `Y_c' Y_B` and `R Y_B`.
    first: Tiles,
    moved: Tiles,
    solved: Tiles,
    y: Panel<S>,
}

impl<S: Scalar> ChainRule<S> {
    /// For factors of this pattern.
    #[inline(never)]
    pub fn new(factor: &Factor<S>) -> Self {
        let n = factor.size();
        let panel = Panel::zeros(n, n);
        let blocked = Panel::<S>::for_blocks(n, || {
            let (u, below) = (factor.inverse_pattern(), factor.pattern());
            let across = u.transposed();
            let pair = below.or(&below.transposed()).with_diagonal();
            let y = across.times(&pair);
            let tiles = |a: &Pattern, b: &Pattern| Tiles::new::<S>(a, b, Part::Whole, Terms::All);
            Blocked {
                first: tiles(&across, &pair),
                moved: tiles(&y.transposed(), &y),
                solved: tiles(&u, &y),
                y: panel.clone(),
            }
        });
        Self { moved: [panel.clone(), panel.clone()], solved: panel.clone(), across: panel, blocked }
    }

    /// Fills `y'a_xx`, 2n x 2n, and `y'a_uq`, n x n, where a_z was computed last.
    #[inline(never)]
    pub fn transform(
        &mut self,
        first: &mut Lagrangian<S>,
        hessian: &TorqueHessian<S>,
        (xx, uq): (&mut Matrix<S>, &mut Matrix<S>),
    ) {
        let Self { moved, solved, across, blocked } = self;
        let n = uq.rows();
        match (blocked, &first.blocked) {
            (Some(own), Some(of_jacobian)) if !Panel::<S>::ONE_LANE => {
                let Blocked { first: tiles, moved: of_moved, solved: of_solved, y } = &mut **own;
                let root = first.factor.root();
                y.set_tiles(tiles, Left::Rows(root), &hessian.aq);
                for (moved, y_c) in moved.iter_mut().zip(of_jacobian.between()) {
                    moved.set_tiles(of_moved, Left::Columns(y_c), y);
                }
                solved.set_tiles(of_solved, Left::Columns(root), y);
            }
            _ => {
                for (moved, by) in moved.iter_mut().zip(&first.solved) {
                    sized!(S, n, moved.set_product(Left::Columns(by), &hessian.aq, Part::Whole));
                }
                sized!(S, n, solved.set_product(Left::Rows(&first.inverse), &hessian.aq, Part::Whole));
            }
        }
        let [in_q, in_v] = moved;
        across.add_transpose(in_q);
        across.subtract(&hessian.qq);
        in_v.subtract(&hessian.vq);
        for i in 0..n {
            write_packs(across.row(i), &mut xx.row_mut(i)[..n], |pack| pack);
            let (by_q, by_v) = xx.row_mut(n + i).split_at_mut(n);
            write_packs(in_v.row(i), by_q, |pack| pack);
            write_packs(hessian.vv.row(i), by_v, |pack| -pack);
            write_packs(solved.row(i), uq.row_mut(i), |pack| -pack);
        }
        across.take_transpose::<0>(in_v);
        (0..n).for_each(|i| write_packs(across.row(i), &mut xx.row_mut(i)[n..], |pack| pack));
    }

    /// Writes the Hessian of `w.tau`, 3n x 3n.
    #[inline(never)]
    pub fn write_torque_hessian(&mut self, hessian: &TorqueHessian<S>, to: &mut Matrix<S>) {
        let (n, TorqueHessian { qq, vv, vq, aq }) = (to.rows() / 3, hessian);
        for (block, below) in [vq, aq].into_iter().enumerate() {
            let start = (block + 1) * n;
            self.across.take_transpose::<0>(below);
            for i in 0..n {
                write_packs(self.across.row(i), &mut to.row_mut(i)[start..start + n], |pack| pack);
                write_packs(below.row(i), &mut to.row_mut(start + i)[..n], |pack| pack);
            }
        }
        for i in 0..n {
            write_packs(qq.row(i), &mut to.row_mut(i)[..n], |pack| pack);
            write_packs(vv.row(i), &mut to.row_mut(n + i)[n..2 * n], |pack| pack);
        }
    }
}
