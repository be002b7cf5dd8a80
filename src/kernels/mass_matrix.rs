//! The mass matrix alone, where nothing else of the first stage is needed.

use super::coupling::positions;
use super::{KernelOne, WorldKernel};
use crate::error::{EvalError, check_length};
use crate::matrix::Panel;
use crate::robot::Tree;
use crate::scalar::Scalar;

/// From this mean number of joints on the way from the base to a joint on, the joint included, packs of
/// several lanes take less time for M in the axes of the world than in body frames.
///
/// Both take one scalar product for each pair of joints on a branch, but in body frames every force is turned
/// once for each joint on its way to the base. With AVX-512: 0.76 times the time for a chain of 48 joints,
/// 0.92 for one of 24, the same for humanoids of 32 and 50 joints, whose means are 4.9 and 7.5.
const WORLD_FROM: usize = 9;

impl<S: Scalar> KernelOne<S> {
    /// With what [`set_mass_matrix`](Self::set_mass_matrix) needs.
    pub(super) fn with_world_axes(mut self, tree: &Tree) -> Self {
        let long = tree.pairs() >= WORLD_FROM * tree.dof();
        if Panel::<S>::in_blocks(tree.dof()) && long && tree.joint_map().is_none() && tree.free().is_empty() {
            self.world = Some(Box::new(WorldKernel::new(tree)));
        }
        self
    }

    /// M at q (rad, m; length n), as after [`set_position`](Self::set_position), without what the second
    /// stage needs.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`]. Values are not checked here.
    pub(super) fn set_mass_matrix(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        if !Panel::<S>::ONE_LANE
            && let Some(world) = &mut self.world
        {
            check_length("q", q, tree.dof())?;
            positions(tree, q, &mut self.q);
            world.set_position(tree, q);
            world.swap_mass_matrix(&mut self.mass_matrix.all);
            world.compose(tree);
            world.swap_mass_matrix(&mut self.mass_matrix.all);
            return Ok(());
        }
        self.set_position(tree, q)
    }
}

#[cfg(test)]
mod tests {
    use crate::kernels::{Contracted, KernelOne, LagrangianHessian, Route};
    use crate::robot::Tree;
    use crate::robot::test_robot::robot;

    /// The kernel of the default route, which may compute M alone in another way.
    type Kernel = <Contracted as Route>::Hessian<f64>;

    fn compare(tree: &Tree) -> bool {
        let n = tree.dof();
        let mut alone = <Kernel as LagrangianHessian<f64>>::new(tree);
        let mut whole = KernelOne::<f64>::new(tree);
        // The second time, nothing may be left of the first.
        for from in [0.3, 1.1] {
            let q: Vec<f64> = (0..n).map(|i| (from + 1.3 * i as f64).sin()).collect();
            alone.set_mass_matrix(tree, &q).unwrap();
            whole.set_position(tree, &q).unwrap();
            let [found, expected] = [&alone, &whole].map(|kernel| kernel.mass_matrix().view().to_nalgebra());
            assert!((&found - &expected).amax() < 1e-13 * expected.amax(), "n = {n}");
            assert_eq!(found, found.transpose());
            for k in 0..n {
                let [size, of_whole] = [&alone, &whole].map(|kernel| kernel.size_of_entry(tree, k));
                assert!((size - of_whole).abs() < 1e-13 * of_whole.abs(), "n = {n}");
            }
            // The first stage is not disturbed.
            alone.set_position(tree, &q).unwrap();
            assert_eq!(alone.mass_matrix().as_slice(), whole.mass_matrix().as_slice());
        }
        assert!(alone.set_mass_matrix(tree, &vec![0.0; n + 1]).is_err());
        alone.world.is_some()
    }

    #[test]
    fn the_mass_matrix_alone_is_that_of_the_first_stage() {
        let mut elsewhere = Vec::new();
        for n in [1, 12, 13, 18, 19, 31] {
            elsewhere.push(compare(&Tree::from(&robot(n, |k| k.wrapping_sub(1), false))));
            elsewhere.push(compare(&Tree::from(&robot(
                n,
                |k| if k + 3 > n && n > 4 { n - 4 } else { k.wrapping_sub(1) },
                true,
            ))));
            elsewhere.push(compare(&Tree::from(&robot(n, |k| (k * k + 1) % (k + 2), true))));
        }
        // Both ways have been taken, unless packs have one lane.
        assert_eq!(elsewhere.contains(&true), cfg!(feature = "wide"));
        assert!(elsewhere.contains(&false));
    }
}
