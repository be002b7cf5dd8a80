//! The numerical kernels: the Hessian of the Lagrangian and the factorisation of the mass matrix.

mod arguments;
mod blocked;
mod blocks;
mod congruence;
mod corner;
mod coupling;
mod dissipation;
mod factor;
mod factor_tiles;
mod hessian;
mod inverse;
mod joint_positions;
mod mass_matrix;
mod pass;
mod position;
mod reach;
mod route;
mod solve_blocks;
mod triangle;
mod two;
mod two_pairs;
mod velocity;
mod world;

pub(crate) use arguments::{check, check_entries};
pub(crate) use coupling::{Coupled, Spread, positions, rates, size_of_sum};
pub(crate) use dissipation::friction_of;
pub use dissipation::{FrictionDerivatives, friction};
pub use factor::Factor;
pub(crate) use position::{along_joint, unit_momentum};
pub use route::{Contracted, LagrangianHessian, Route};
pub use two::KernelTwo;
pub(crate) use world::{
    ArticulatedBodies, HessianChange, Sums, TorqueContraction, TorqueHessian, WorldKernel,
};

use crate::matrix::{Matrix, filled};
use crate::robot::{JointKind, Tree};
use crate::scalar::{Pack, Scalar};
use crate::spatial::{Force, Inertia, JointPosition, Motion, Symmetric3, Vec3};
use blocks::Blocks;
use reach::reach_of_joint;

/// Kernel one: value, gradient and Hessian of the Lagrangian `L(q, v) = 1/2 v' M v - V`, contracted first.
///
/// Three stages, each building on the one before:
/// [`set_position`](KernelOne::set_position) gives M and the potential,
/// [`set_velocity`](KernelOne::set_velocity) gives p = L_v and L_q,
/// [`second_order`](KernelOne::second_order) gives P = L_vq and L_qq.
///
/// With `psi_i = v_i x S_i`, `gamma_i = a_g x S_i`, `F_j = IC_j S_j`, `G_j = IC_j psi_j + S_j x* H_j`, every
/// entry for a pair `i <= j` in tree order is one scalar product (pairs on different branches are zero):
///
/// $$ M\_{ij} = S\_i \cdot F\_j, \qquad P\_{ij} = S\_i \cdot G\_j, \qquad P\_{ji} = \psi\_i \cdot F\_j,
/// \qquad L\_{qq,ij} = \psi\_i \cdot G\_j + \gamma\_i \cdot F\_j $$
///
/// $$ p\_i = S\_i \cdot H\_i, \qquad L\_{q,i} = H\_i \cdot \psi\_i + F\_i \cdot a\_g $$
///
/// All is computed in body frames with the joint axis along z, where S is a unit vector and most products
/// vanish; `docs/frames.md` compares this with one common frame. The F_j and G_j beyond a joint are
/// transformed together. For a joint on the fixed base, its S and gamma are transformed outward instead.
/// Armature is added to M and p, springs to L_q and L_qq. All of this is of the N joints of the tree; where
/// some mimic others, rows and columns are summed into those of the n coordinates at the end of each stage.
///
/// q has [`Tree::nq`] entries; derivatives by the position of a floating or spherical joint are those by the
/// coordinates of its chain ([`Robot::free_joints`](crate::robot::Robot::free_joints)), at zero.
#[derive(Clone, Debug)]
pub struct KernelOne<S: Scalar> {
    bodies: Vec<Body<S>>,
    blocks: Blocks,
    /// F_j in frame i, for every pair `i <= j` on a branch, except pairs of a base joint i with other joints.
    carried: Vec<Force<S::Pack>>,
    /// G_j in frame i, likewise.
    rates: Vec<Force<S::Pack>>,
    /// Positions and velocities of all joints.
    q: Vec<S>,
    v: Vec<S>,
    /// Coordinates of the chains of floating and spherical joints; empty where there are none.
    chart: Vec<S>,
    mass_matrix: Coupled<Matrix<S>>,
    momentum: Coupled<Vec<S>>,
    l_q: Coupled<Vec<S>>,
    l_vq: Coupled<Matrix<S>>,
    l_qq: Coupled<Matrix<S>>,
    /// What computes M alone, where that takes less time than the first stage.
    world: Option<Box<WorldKernel<S>>>,
}

/// Quantities of one joint, in its frame.
#[derive(Clone, Copy, Debug)]
struct Body<S> {
    position: JointPosition<S>,
    gravity: Vec3<S>,
    /// Inertia of the composite body, IC.
    composite: Inertia<S>,
    velocity: Motion<S>,
    /// H.
    momentum: Force<S>,
    /// S and gamma of the parent in this frame, if the parent is a joint on the fixed base.
    root: RootAxis<S>,
}

/// S and gamma of a joint on the fixed base, in the frame of a joint on its link.
#[derive(Clone, Copy, Debug)]
struct RootAxis<S> {
    /// S.
    motion: Motion<S>,
    /// The linear part of `gamma = a_g x S`; its angular part is zero.
    gravity: Vec3<S>,
}

impl<S: Scalar> Body<S> {
    fn at_rest(position: JointPosition<S>) -> Self {
        Self {
            position,
            gravity: Vec3::zero(),
            composite: Inertia { mass: 0.0, first_moment: Vec3::zero(), matrix: Symmetric3::zero() },
            velocity: Motion::zero(),
            momentum: Force::zero(),
            root: RootAxis { motion: Motion::zero(), gravity: Vec3::zero() },
        }
    }
}

impl<S: Scalar> RootAxis<S> {
    /// The same value in every lane.
    #[inline(always)]
    fn splat<P: Pack<S>>(&self) -> RootAxis<P> {
        RootAxis { motion: self.motion.splat(), gravity: self.gravity.splat() }
    }
}

impl<S: Scalar> KernelOne<S> {
    /// Buffers for a tree.
    #[inline(never)]
    pub fn new(tree: &Tree) -> Self {
        let n = tree.joints().len();
        let blocks = Blocks::new(tree, <S::Pack as Pack<S>>::LANES);
        Self {
            bodies: tree.joints().iter().map(|joint| Body::at_rest(joint.position(S::zero()))).collect(),
            carried: filled(Force::zero(), blocks.len()),
            rates: filled(Force::zero(), blocks.len()),
            blocks,
            q: filled(S::zero(), n),
            v: filled(S::zero(), n),
            chart: filled(S::zero(), if tree.free().is_empty() { 0 } else { tree.dof() }),
            mass_matrix: Coupled::square(tree),
            momentum: Coupled::row(tree),
            l_q: Coupled::row(tree),
            l_vq: Coupled::square(tree),
            l_qq: Coupled::square(tree),
            world: None,
        }
    }

    /// Mass matrix M, armature included, n x n, symmetric (kg m^2, kg m, kg).
    pub fn mass_matrix(&self) -> &Matrix<S> {
        self.mass_matrix.get()
    }

    /// The scale of the rounding error of `M_kk`. For a revolute joint it is the largest inertia of the
    /// composite body about any axis through the joint origin, since M_kk may result from a rotation of it.
    pub fn size_of_entry(&self, tree: &Tree, k: usize) -> S {
        size_of_sum(tree, k, |joint| {
            size_of_joint(tree, joint, &self.q, self.mass_matrix.all[(joint, joint)])
        })
    }

    /// Conjugate momentum p = M v, n.
    pub fn momentum(&self) -> &[S] {
        self.momentum.get()
    }

    /// `L_q = 1/2 v' M,q v - V,q` at fixed v, n.
    pub fn l_q(&self) -> &[S] {
        self.l_q.get()
    }

    /// `P = d(M v)/dq` at fixed v, n x n: `P_ij = sum_l M_il,j v_l` (21a).
    pub fn l_vq(&self) -> &Matrix<S> {
        self.l_vq.get()
    }

    /// `L_qq = 1/2 v' M,ij v - V,ij`, n x n, symmetric (21c).
    pub fn l_qq(&self) -> &Matrix<S> {
        self.l_qq.get()
    }
}

/// See [`KernelOne::size_of_entry`]: for the entry `M_kk` of joint k of all joints, at their positions.
#[inline]
fn size_of_joint<S: Scalar>(tree: &Tree, k: usize, q: &[S], entry: S) -> S {
    if tree.joints()[k].kind == JointKind::Prismatic {
        return entry;
    }
    let reach = reach_of_joint(tree, k, q);
    entry + (reach * reach).times(2.0)
}
