//! The Jacobian of forward dynamics block by block, limited to the entries that the tree leaves.

use crate::kernels::Factor;
use crate::matrix::{Left, Matrix, Panel, Part, Pattern, Terms, Tiles, write_packs};
use crate::scalar::Scalar;

/// Products with the triangular matrix `R = L^-1 D^-1/2` that give
/// `a_z = [-M^-1 tau_q, -M^-1 tau_v, M^-1]`, for packs of several lanes.
///
/// With `M^-1 = R R'`, `Y = R' tau_q` and `a_q = -R Y`. Entries of tau_q belong to pairs of joints on one
/// branch, those of R' to a joint and one beyond it. So an entry of Y is a sum over the joints that
/// are beyond one joint and on a branch with the other, an entry of a_q one over the joints on the way from
/// the base. A product with M^-1, which has entries for all pairs of joints on one joint of the base, takes
/// about twice as many products for a tree, and as many for a chain.
#[derive(Clone, Debug)]
pub(super) struct Blocked<S: Scalar> {
    /// Y, for tau_q and tau_v.
    first: Tiles,
    /// `R Y`.
    second: Tiles,
    y: [Panel<S>; 2],
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
            y: [Panel::zeros(n, n), Panel::zeros(n, n)],
            solved: Panel::zeros(n, n),
        }
    }

    /// Y of the Jacobian computed last.
    pub fn between(&self) -> &[Panel<S>; 2] {
        &self.y
    }

    /// Fills a_z, n x 3n, from the panels of tau_q and tau_v; M is factored.
    #[inline(never)]
    pub fn solve(&mut self, factor: &mut Factor<S>, torque: &[Panel<S>; 2], a_z: &mut Matrix<S>) {
        let Self { first, second, y, solved } = self;
        let n = a_z.rows();
        factor.place_inverse(a_z, (0, 2 * n));
        for (k, (torque, y)) in torque.iter().zip(y).enumerate() {
            y.set_tiles(first, Left::Rows(factor.root()), torque);
            solved.set_tiles(second, Left::Columns(factor.root()), y);
            for i in 0..n {
                write_packs(solved.row(i), &mut a_z.row_mut(i)[k * n..(k + 1) * n], |pack| -pack);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::lagrangian::Lagrangian;
    use crate::robot::{Robot, test_robot::robot};

    fn compare(robot: &Robot) {
        let n = robot.dof();
        let numbers = |from: f64| (0..n).map(|i| (from + 1.3 * i as f64).sin()).collect::<Vec<f64>>();
        let mut lagrangian = Lagrangian::<f64>::new(robot);
        // The second time, nothing may be left of the first.
        for from in [0.3, 1.1] {
            let (q, v, u) = (numbers(from), numbers(0.5 * from), numbers(0.7));
            let found = lagrangian.linearise_forward_dynamics(&q, &v, &u).unwrap();
            let (a, a_z) = (found.acceleration().to_vec(), found.matrix().to_nalgebra());
            let torque = lagrangian.linearise_inverse_dynamics(&q, &v, &a).unwrap();
            let dense = |m: &crate::matrix::Matrix<f64>| m.view().to_nalgebra();
            let (tau_q, tau_v, m) = (dense(torque.tau_q), dense(torque.tau_v), dense(torque.tau_a));
            let tau = torque.tau.iter().zip(&u).fold(0.0, |most: f64, (tau, u)| most.max((tau - u).abs()));
            assert!(tau < 1e-11 * n as f64, "n = {n}: {tau}");
            let inverse = m.try_inverse().unwrap();
            for (k, expected) in [-&inverse * &tau_q, -&inverse * &tau_v, inverse].iter().enumerate() {
                let error = (a_z.columns(k * n, n) - expected).amax();
                assert!(error < 1e-10 * expected.amax(), "n = {n}, block {k}: {error}");
            }
            // The same derivatives of inverse dynamics by kernels one and two.
            lagrangian.kernel.set_position(&lagrangian.tree, &q).unwrap();
            lagrangian.differentiate_torque_by_kernels(&q, &v).unwrap();
            for (of_kernels, of_pairs) in [(&lagrangian.tau_q, tau_q), (&lagrangian.tau_v, tau_v)] {
                assert!((dense(of_kernels) - &of_pairs).amax() < 1e-11 * of_pairs.amax(), "n = {n}");
            }
        }
    }

    #[test]
    fn blocks_give_the_jacobian_of_forward_dynamics_of_any_tree() {
        for n in [12, 13, 16, 18, 23, 31] {
            compare(&robot(n, |k| k.wrapping_sub(1), false));
            compare(&robot(n, |k| k / 2 + k % 3, false));
            // Not in the order of the branches.
            compare(&robot(n, |k| k.wrapping_sub(3), false));
            compare(&robot(n, |k| (k * k + 1) % (k + 2), true));
        }
    }
}
