//! Which of two algorithms computes a quantity: decided once, when the workspace is built.
//!
//! | quantity | short branches, numbers of one lane | otherwise |
//! |---|---|---|
//! | a | M and its factors | articulated bodies, O(n) |
//! | M, tau_q, tau_v | kernels one and two in body frames | products of pairs in the axes of the world |
//!
//! For a, robots with mimic joints take the first column, and so does armature that couples joints: the
//! joints of articulated bodies are independent. Robots with floating or spherical joints take the second
//! column for all but a: fewer operations for any numbers. Their second derivatives of inverse dynamics are
//! products of pairs too, those of other robots one dual number through kernels one and two. Both columns are
//! tested against each other.

use crate::kernels::{ArticulatedBodies, KernelOne, WorldKernel};
use crate::matrix::{Matrix, Panel};
use crate::robot::Tree;
use crate::scalar::Scalar;

/// Numbers of one lane: from this mean number of joints on the way from the base to a joint on, the joint
/// included, articulated bodies take fewer operations than M and its factors.
///
/// Operations of articulated bodies grow with n, those of M with the pairs of joints on one branch, those of
/// its factors faster. With axes in general directions and constants folded, the two are equal at means of 6
/// to 7, for chains, bushes and binary trees alike. M in body frames gains from parallel and orthogonal axes,
/// articulated bodies in the axes of the world do not: with them, humanoids of means 4.9 and 7.5 take 1.7 and
/// 1.3 times the operations.
///
/// Packs of several lanes take 1.03 to 2.8 times less time with articulated bodies on every such tree as soon
/// as the factors are [computed block by block](Panel::in_blocks), and more time for 8 to 12 joints.
const ARTICULATED_FROM: usize = 9;

/// The algorithms for one tree and number type.
#[derive(Clone, Copy, Debug)]
pub(super) struct Routes {
    /// M and the derivatives of inverse dynamics in the axes of the world.
    pub derivatives: bool,
    /// Forward dynamics by articulated bodies.
    pub bodies: bool,
    /// The second derivatives of inverse dynamics in the axes of the world.
    pub contraction: bool,
}

impl Routes {
    /// For the numbers S.
    pub fn of<S: Scalar>(tree: &Tree) -> Self {
        let one_lane = Panel::<S>::ONE_LANE;
        let long = tree.pairs() >= ARTICULATED_FROM * tree.dof();
        let enough = if one_lane { long } else { Panel::<S>::in_blocks(tree.dof()) };
        let independent = tree.joint_map().is_none();
        Self {
            derivatives: !one_lane || !tree.free().is_empty(),
            contraction: !tree.free().is_empty(),
            bodies: independent && enough && ArticulatedBodies::<S>::suit(tree),
        }
    }

    /// Whether any of them works in the axes of the world.
    pub fn world(self) -> bool {
        self.derivatives || self.bodies
    }
}

/// M, where it was computed last.
pub(super) fn current_mass_matrix<'a, S: Scalar>(
    routes: Routes,
    kernel: &'a KernelOne<S>,
    world: Option<&'a WorldKernel<S>>,
) -> &'a Matrix<S> {
    match world {
        Some(world) if routes.derivatives => world.mass_matrix(),
        _ => kernel.mass_matrix(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lagrangian::Lagrangian;
    use crate::robot::{JointSpec, LinkInertia, Placement, Robot};
    use crate::scalar::{Count, count};
    use nalgebra::Matrix3;

    /// Axes and inertias in general directions; joint k stands on joint `parent(k)`, if that is below k.
    fn general(n: usize, parent: impl Fn(usize) -> usize) -> Robot {
        let mut builder = Robot::builder("tree");
        for k in 0..n {
            let x = k as f64;
            let numbers = |from: f64| [0, 1, 2].map(|i| (from + x + 1.3 * f64::from(i)).sin());
            let spread = Matrix3::from_columns(
                &[numbers(0.1), numbers(0.7), numbers(1.9)].map(nalgebra::Vector3::from),
            );
            let inertia = (spread * spread.transpose() + Matrix3::identity()) * 0.05;
            let joint = JointSpec::revolute(format!("j{k}"))
                .axis(numbers(0.4))
                .placed(Placement::from_xyz_rpy(numbers(0.9), numbers(1.1)))
                .carrying(LinkInertia::about_com(1.5, numbers(1.5), inertia));
            let on = parent(k);
            builder = builder.joint(if on < k { joint.on(format!("j{on}")) } else { joint });
        }
        builder.build().unwrap()
    }

    /// Operations of a by M and its factors, and by articulated bodies, and which of them is chosen.
    fn operations(robot: &Robot) -> ([u64; 2], bool) {
        let (tree, n) = (Tree::from(robot), robot.dof());
        let numbers = |from: f64| (0..n).map(|i| Count::variable(from + i as f64)).collect::<Vec<_>>();
        let (q, v, u) = (numbers(0.3), numbers(0.5), numbers(0.7));
        let mut lagrangian = Lagrangian::<Count>::new(robot);
        let chosen = lagrangian.bodies.is_some();
        let both = [false, true].map(|bodies| {
            lagrangian.bodies = bodies.then(|| ArticulatedBodies::new(&tree));
            lagrangian.world = bodies.then(|| WorldKernel::new(&tree));
            let (_, operations) = count(|| lagrangian.forward_dynamics(&q, &v, &u).map(drop));
            operations.mul + operations.add
        });
        (both, chosen)
    }

    #[test]
    fn the_algorithm_chosen_takes_about_the_fewest_operations() {
        let file = |name: &str| Robot::from_file(format!("{}/robots/{name}", env!("CARGO_MANIFEST_DIR")));
        let mut robots: Vec<Robot> = ["ur5.urdf", "biped.toml", "humanoid32.urdf", "humanoid50.urdf"]
            .map(|name| file(name).unwrap())
            .into();
        robots.extend([6, 12, 16, 17, 24, 32].map(|n| general(n, |k| k.wrapping_sub(1))));
        // Bushes of four branches on a trunk of four joints, and binary trees.
        robots.extend([5, 8, 12].map(|length| {
            general(4 + 4 * length, |k| if k > 4 && (k - 4) % length == 0 { 3 } else { k.wrapping_sub(1) })
        }));
        robots.extend([15, 63].map(|n| general(n, |k| if k == 0 { n } else { (k - 1) / 2 })));
        let mut taken = [false; 2];
        for robot in &robots {
            let (operations, chosen) = operations(robot);
            let best = operations[0].min(operations[1]) as f64;
            let own = operations[usize::from(chosen)] as f64;
            assert!(own < 1.3 * best, "{} of {}: {operations:?}, {chosen}", robot.name(), robot.dof());
            taken[usize::from(chosen)] = true;
        }
        assert_eq!(taken, [true; 2]);
    }
}
