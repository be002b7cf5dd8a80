//! Which of two algorithms computes a quantity: decided once, when the workspace is built.
//!
//! | quantity | short chains, numbers of one lane | otherwise |
//! |---|---|---|
//! | a | M and its factors | articulated bodies, O(n) |
//! | M, tau_q, tau_v | kernels one and two in body frames | products of pairs in the axes of the world |
//!
//! Robots with mimic joints take the first column, and so does armature that couples joints, for a: the
//! joints of articulated bodies are independent. Both columns are tested against each other.

use crate::kernels::{ArticulatedBodies, KernelOne, WorldKernel};
use crate::matrix::{Matrix, Panel};
use crate::robot::Tree;
use crate::scalar::Scalar;

/// From this number of joints on, articulated bodies take less time than M and its factors: with packs of
/// several lanes, and with numbers one by one.
const ARTICULATED_FROM: [usize; 2] = [16, 20];

/// The algorithms for one tree and number type.
#[derive(Clone, Copy, Debug)]
pub(super) struct Routes {
    /// M and the derivatives of inverse dynamics in the axes of the world.
    pub derivatives: bool,
    /// Forward dynamics by articulated bodies.
    pub bodies: bool,
}

impl Routes {
    /// For the numbers S.
    pub fn of<S: Scalar>(tree: &Tree) -> Self {
        let one_lane = Panel::<S>::ONE_LANE;
        let enough = tree.dof() >= ARTICULATED_FROM[usize::from(one_lane)];
        let independent = tree.joint_map().is_none();
        Self {
            derivatives: independent && !one_lane,
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
