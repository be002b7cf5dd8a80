//! Which of two algorithms computes a quantity: decided once, when the workspace is built.
//!
//! | quantity | body frames | axes of the world |
//! |---|---|---|
//! | a | M and its factors | articulated bodies, O(n), or M and its factors |
//! | M | kernel one | products of pairs of joints |
//! | tau_q, tau_v | kernels one and two | the same |
//! | (w.tau)_zz | one dual number through both | the same |
//!
//! The axes of the world take less time, but for two kinds of numbers: those that [fold
//! constants](Scalar::FOLDED), since parallel and orthogonal axes give body frames more zeros, and those that
//! carry derivatives, for which products with constants are cheap. Both take body frames for M and a, and
//! numbers that fold constants for derivatives too, unless axes have general directions and branches are not
//! short. Robots with floating or spherical joints take the axes of the world for all of these. Articulated
//! bodies serve long branches whose joints are independent: no mimic joints, no armature that couples joints.
//! Both columns are tested against each other.

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
/// Numbers of one lane with M in the axes of the world have the same threshold. Packs take 1.03 to 2.8 times
/// less time with articulated bodies on every such tree as soon as the factors are [computed block by
/// block](Panel::in_blocks), and more time for 8 to 12 joints.
const ARTICULATED_FROM: usize = 9;

/// Numbers that fold constants: from this mean number of joints on, as above, y'a_zz of robots with axes in
/// general directions takes fewer operations in the axes of the world.
///
/// Body frames take 0.87 times the operations of these for a chain of 3 joints, 1.20 for 6, 1.34 for 12.
const PAIRS_FROM: usize = 3;

/// The algorithms for one tree and number type.
#[derive(Clone, Copy, Debug)]
pub(super) struct Routes {
    /// M, tau_q, tau_v and (w.tau)_zz in the axes of the world.
    pub derivatives: bool,
    /// M and a by M there, where no derivatives are asked for.
    pub values: bool,
    /// Forward dynamics by articulated bodies.
    pub bodies: bool,
}

impl Routes {
    /// Everything in body frames, as tests compare it.
    #[cfg(test)]
    pub const BODY_FRAMES: Self = Self { derivatives: false, values: false, bodies: false };

    /// For the numbers S.
    pub fn of<S: Scalar>(tree: &Tree) -> Self {
        let one_lane = Panel::<S>::ONE_LANE;
        let long = tree.pairs() >= ARTICULATED_FROM * tree.dof();
        let enough = if one_lane { long } else { Panel::<S>::in_blocks(tree.dof()) };
        let (independent, free) = (tree.joint_map().is_none(), !tree.free().is_empty());
        Self {
            derivatives: !S::FOLDED || free,
            values: !S::FOLDED && S::ORDER == 0 || free,
            bodies: independent && enough && ArticulatedBodies::<S>::suit(tree),
        }
    }

    /// For the numbers S, where second derivatives are computed too.
    pub fn for_second_derivatives<S: Scalar>(tree: &Tree) -> Self {
        let routes = Self::of::<S>(tree);
        Self { derivatives: routes.derivatives || pairs_take_fewer(tree), ..routes }
    }

    /// Whether any of them works in the axes of the world.
    pub fn world(self) -> bool {
        self.derivatives || self.bodies
    }
}

/// Whether products of pairs take fewer operations than kernels in body frames even where operations with
/// constants are free: axes are neither parallel nor orthogonal, and branches are not short.
fn pairs_take_fewer(tree: &Tree) -> bool {
    let general = tree.joints().iter().filter(|joint| !joint.screw.alpha.is_right()).count();
    2 * general > tree.joints().len() && tree.pairs() >= PAIRS_FROM * tree.dof()
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
    use crate::codegen::Expr;
    use crate::lagrangian::{Lagrangian, LagrangianSecondOrder};
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

    /// Of y'a_zz with all it needs, where constants are folded.
    #[test]
    fn the_axes_chosen_for_recorded_code_take_about_the_fewest_operations() {
        let file = |name: &str| Robot::from_file(format!("{}/robots/{name}", env!("CARGO_MANIFEST_DIR")));
        let names = ["ur5.urdf", "panda.urdf", "biped.toml", "humanoid32.urdf", "humanoid50.urdf"];
        let mut robots: Vec<Robot> = names.map(|name| file(name).unwrap()).into();
        robots.extend([3, 6, 12, 24].map(|n| general(n, |k| k.wrapping_sub(1))));
        robots.extend([15, 63].map(|n| general(n, |k| if k == 0 { n } else { (k - 1) / 2 })));
        let mut taken = [false; 2];
        for robot in &robots {
            let (tree, n) = (Tree::from(robot), robot.dof());
            let numbers = |from: f64| (0..n).map(|i| Count::variable(from + i as f64)).collect::<Vec<_>>();
            let [q, v, u, y] = [0.3, 0.5, 0.7, 0.9].map(numbers);
            let chosen = Routes::for_second_derivatives::<Expr>(&tree).derivatives;
            let both = [false, true].map(|derivatives| {
                let routes = Routes { derivatives, values: derivatives, bodies: false };
                let mut second = LagrangianSecondOrder::<Count>::with_routes(routes, tree.clone());
                let (_, counted) = count(|| second.contract_forward_dynamics(&q, &v, &u, &y).map(drop));
                (counted.mul + counted.add) as f64
            });
            let own = both[usize::from(chosen)];
            assert!(own < 1.1 * both[0].min(both[1]), "{} of {n}: {both:?}, {chosen}", robot.name());
            taken[usize::from(chosen)] = true;
        }
        assert_eq!(taken, [true; 2]);
    }
}
