//! Configurations of robots with floating and spherical joints: `q (+) d`, differences, Jacobians.
//!
//! q has [`Tree::nq`] entries: for each floating joint (x, y, z, qx, qy, qz, qw), for each spherical one the
//! quaternion alone, for every other joint its position. Quaternions have length 1. Directions d have n
//! entries, in the order of v: for a floating joint (linear, angular), in the axes of the moved frame. They
//! are the left-trivialised tangent, and the conventions are those of Pinocchio:
//!
//! $$ q \oplus d = q \exp(d), \qquad q\_1 \ominus q\_0 = \log(q\_0^{-1} q\_1) $$

mod brackets;
mod exponential;
mod kinematics;
#[cfg(test)]
mod kinematics_tests;
mod quaternions;
#[cfg(test)]
pub(crate) mod samples;
#[cfg(test)]
mod tests;

pub(crate) use brackets::Brackets;
pub use kinematics::FreeKinematics;
pub use quaternions::Quaternions;

use crate::error::{EvalError, LengthError, check_length};
use crate::kernels::check_entries;
use crate::matrix::Matrix;
use crate::robot::{FreeFrame, FreeKind, Robot, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Quaternion, Vec3};
use exponential::Square;

/// The configurations of a robot and their tangent spaces; for robots without floating and spherical joints
/// they are vectors. No method but [`new`](Self::new), [`neutral`](Self::neutral) and those that return
/// matrices allocates.
///
/// ```
/// use costate::configuration::ConfigurationSpace;
/// use costate::robot::{JointSpec, LinkInertia, Robot};
///
/// let body = LinkInertia::about_com(1.0, [0.0; 3], nalgebra::Matrix3::identity());
/// let drone = Robot::builder("drone").joint(JointSpec::floating("root").carrying(body)).build()?;
/// let space = ConfigurationSpace::new(&drone);
/// let (from, mut to, mut back) = (space.neutral(), [0.0; 7], [0.0; 6]);
/// let d = [0.5, 0.0, -0.2, 0.3, 1.2, 0.0];
/// space.integrate(&from, &d, &mut to)?;
/// space.difference(&from, &to, &mut back)?;
/// assert!(d.iter().zip(back).all(|(d, back)| (d - back).abs() < 1e-15));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ConfigurationSpace {
    tree: Tree,
}

/// The derivatives of [`ConfigurationSpace::integrate`] or [`ConfigurationSpace::difference`]; n x n each.
#[derive(Clone, Debug)]
pub struct ConfigurationJacobians<S: Scalar> {
    /// By the first argument, in its tangent space.
    pub first: Matrix<S>,
    /// By the second argument: d, or q_1 in its tangent space.
    pub second: Matrix<S>,
}

impl ConfigurationSpace {
    /// That of a robot.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(Tree::from(robot))
    }

    /// As [`new`](Self::new), from an existing [`Tree`].
    pub fn from_tree(tree: Tree) -> Self {
        Self { tree }
    }

    /// Number of entries of q.
    pub fn nq(&self) -> usize {
        self.tree.nq()
    }

    /// Number of entries of d and v.
    pub fn dof(&self) -> usize {
        self.tree.dof()
    }

    /// All positions zero, all rotations the identity.
    pub fn neutral(&self) -> Vec<f64> {
        let mut q = vec![0.0; self.nq()];
        for free in self.tree.free() {
            q[free.joint.quaternion() + 3] = 1.0;
        }
        q
    }

    /// `q` has nq finite entries, and its quaternions have length 1: the squared length differs from 1 by
    /// less than 1e-9.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`], [`EvalError::NonFinite`], [`EvalError::NotUnit`].
    pub fn check<S: Scalar>(&self, q: &[S]) -> Result<(), EvalError> {
        self.tree.check_configuration(q)
    }

    /// Divides the quaternions of q by their lengths; none may be zero.
    ///
    /// # Errors
    /// [`LengthError`] unless q has nq entries.
    pub fn normalize<S: Scalar>(&self, q: &mut [S]) -> Result<(), LengthError> {
        LengthError::check("q", self.nq(), q.len())?;
        for free in self.tree.free() {
            let unit = free.quaternion(q).unit();
            q[free.quaternion_entries()].copy_from_slice(&unit.to_array());
        }
        Ok(())
    }

    /// `moved = q (+) d`: n entries of d (m, rad), nq of the others.
    ///
    /// # Errors
    /// Those of [`check`](Self::check), of any argument.
    pub fn integrate<S: Scalar>(&self, q: &[S], d: &[S], moved: &mut [S]) -> Result<(), EvalError> {
        self.check(q)?;
        check_entries(&self.tree, "d", d, self.dof())?;
        check_length("moved", moved, self.nq())?;
        self.tree.plain_entries().for_each(|(at, i)| moved[at] = q[at] + d[i]);
        for free in self.tree.free() {
            let (rho, theta) = tangent(free, d);
            let from = free.quaternion(q);
            let to = from.then_after(exponential::quaternion(theta));
            // One step of Newton's method to length 1 removes what rounding adds.
            let scale = (-to.square()).plus(3.0).times(0.5);
            let entries = to.to_array().map(|entry| entry * scale);
            moved[free.quaternion_entries()].copy_from_slice(&entries);
            if free.joint.kind == FreeKind::Floating {
                let by = from.rotation().apply(exponential::displacement(theta, rho)).to_array();
                (0..3).for_each(|k| moved[free.joint.position + k] = q[free.joint.position + k] + by[k]);
            }
        }
        Ok(())
    }

    /// `d = q_1 (-) q_0`, the direction of least angle with `q_1 = q_0 (+) d`: nq entries of q_0 and q_1, n
    /// of d (m, rad). At a half turn one of two is given.
    ///
    /// # Errors
    /// Those of [`check`](Self::check), of any argument.
    pub fn difference<S: Scalar>(&self, from: &[S], to: &[S], d: &mut [S]) -> Result<(), EvalError> {
        self.check(from)?;
        self.check(to)?;
        check_length("d", d, self.dof())?;
        self.tree.plain_entries().for_each(|(at, i)| d[i] = to[at] - from[at]);
        for free in self.tree.free() {
            let at = free.joint.coordinate;
            let start = free.quaternion(from);
            let theta = exponential::logarithm(start.conjugate().then_after(free.quaternion(to)));
            d[at + free.joint.kind.slides()..at + free.joint.kind.dof()].copy_from_slice(&theta.to_array());
            if free.joint.kind == FreeKind::Floating {
                let apart = [0, 1, 2].map(|k| to[free.joint.position + k] - from[free.joint.position + k]);
                let seen = start.rotation().undo(Vec3::from(apart));
                d[at..at + 3].copy_from_slice(&exponential::displacement_back(theta, seen).to_array());
            }
        }
        Ok(())
    }

    /// Derivatives of `q (+) d` by q and d, all in tangent spaces: `Ad(exp(-d))` and the right Jacobian
    /// `J_r(d)`; they do not depend on q.
    ///
    /// # Errors
    /// As [`integrate`](Self::integrate).
    pub fn integrate_jacobians<S: Scalar>(&self, d: &[S]) -> Result<ConfigurationJacobians<S>, EvalError> {
        check_entries(&self.tree, "d", d, self.dof())?;
        let (mut first, mut second) = (self.identity(), self.identity());
        for free in self.tree.free() {
            let (rho, theta) = tangent(free, d);
            fill(free, &mut first, &adjoint_back(rho, theta));
            fill(free, &mut second, &exponential::right_jacobian(rho, theta));
        }
        Ok(ConfigurationJacobians { first, second })
    }

    /// Derivatives of `q_1 (-) q_0` by q_0 and q_1, in their tangent spaces: `-J_r(-d)^-1` and `J_r(d)^-1`.
    ///
    /// # Errors
    /// As [`difference`](Self::difference).
    pub fn difference_jacobians<S: Scalar>(
        &self,
        from: &[S],
        to: &[S],
    ) -> Result<ConfigurationJacobians<S>, EvalError> {
        let mut d = vec![S::zero(); self.dof()];
        self.difference(from, to, &mut d)?;
        let (mut first, mut second) = (self.identity(), self.identity());
        for free in self.tree.free() {
            let (rho, theta) = tangent(free, &d);
            fill(free, &mut first, &exponential::inverse_right_jacobian(-rho, -theta));
            fill(free, &mut second, &exponential::inverse_right_jacobian(rho, theta));
        }
        for i in 0..self.dof() {
            first.row_mut(i).iter_mut().for_each(|entry| *entry = -*entry);
        }
        Ok(ConfigurationJacobians { first, second })
    }

    fn identity<S: Scalar>(&self) -> Matrix<S> {
        let mut matrix = Matrix::zeros(self.dof(), self.dof());
        (0..self.dof()).for_each(|i| matrix[(i, i)] = S::one());
        matrix
    }
}

/// Displacement and rotation vector of a joint in a direction.
fn tangent<S: Scalar>(free: &FreeFrame, d: &[S]) -> (Vec3<S>, Vec3<S>) {
    let at = free.joint.coordinate;
    let vector = |k: usize| Vec3::new(d[at + k], d[at + k + 1], d[at + k + 2]);
    match free.joint.kind {
        FreeKind::Floating => (vector(0), vector(3)),
        FreeKind::Spherical => (Vec3::zero(), vector(0)),
    }
}

/// `Ad(exp(-d))`: with exp(d) = (r, R), R' on the diagonal and `-R' [r]` beside it.
fn adjoint_back<S: Scalar>(rho: Vec3<S>, theta: Vec3<S>) -> [Square<S>; 2] {
    let turn: Quaternion<S> = exponential::quaternion(-theta);
    let back = turn.rotation().rows.map(Vec3::to_array);
    let arm = exponential::cross_matrix(-exponential::displacement(theta, rho));
    [back, exponential::product(&back, &arm)]
}

/// Puts the diagonal block of angles, which is that of displacements too, and the block between them.
fn fill<S: Scalar>(free: &FreeFrame, matrix: &mut Matrix<S>, [diagonal, corner]: &[Square<S>; 2]) {
    let at = free.joint.coordinate;
    let angles = at + free.joint.kind.slides();
    for (i, (diagonal, corner)) in diagonal.iter().zip(corner).enumerate() {
        matrix.row_mut(angles + i)[angles..angles + 3].copy_from_slice(diagonal);
        if free.joint.kind == FreeKind::Floating {
            matrix.row_mut(at + i)[at..at + 3].copy_from_slice(diagonal);
            matrix.row_mut(at + i)[angles..angles + 3].copy_from_slice(corner);
        }
    }
}
