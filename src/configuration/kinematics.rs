//! Kinematics of robots with floating and spherical joints.

use super::{Brackets, tangent};
use crate::error::EvalError;
use crate::kernels::check_entries;
use crate::kinematics::{CentreOfMass, Kinematics, Momentum, OrientationError, Pose, ReferenceFrame};
use crate::matrix::{Matrix, add_scaled, filled};
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Motion, Vec3};
use nalgebra::Rotation3;

/// Poses, twists, accelerations and Jacobians of frames, the centre of mass and momentum, with positions
/// in the configuration space and Jacobians in its tangent space; no call allocates.
///
/// It takes robots with floating and spherical joints: q has nq entries, v, a and columns of Jacobians n,
/// those of such joints in the axes of the moved frame. For other robots it is [`Kinematics`], which has more
/// second derivatives. [`set_position`](Self::set_position), [`set_state`](Self::set_state) or
/// [`set_motion`](Self::set_motion) place the robot, before the others are called. Methods that take a frame
/// can fail with [`EvalError::NoFrame`].
///
/// ```
/// use costate::configuration::FreeKinematics;
/// use costate::kinematics::ReferenceFrame;
/// use costate::robot::{JointSpec, LinkInertia, Robot};
///
/// let body = LinkInertia::about_com(1.0, [0.0; 3], nalgebra::Matrix3::identity());
/// let drone = Robot::builder("drone").joint(JointSpec::floating("root").carrying(body)).build()?;
/// let (root, mut kinematics) = (drone.frame_index("root")?, FreeKinematics::<f64>::new(&drone));
/// // A quarter turn about z: the x axis of the body is the y axis of the world.
/// let half = 0.5_f64.sqrt();
/// kinematics.set_state(&[1.0, 2.0, 3.0, 0.0, 0.0, half, half], &[5.0, 0.0, 0.0, 0.0, 0.0, 0.0])?;
/// assert_eq!(kinematics.pose(root)?.position, [1.0, 2.0, 3.0]);
/// let twist = kinematics.twist(root, ReferenceFrame::LocalWorldAligned)?;
/// assert!((twist.linear.y - 5.0).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FreeKinematics<S: Scalar> {
    kinematics: Kinematics<S>,
    brackets: Brackets<S>,
    /// Coordinates, velocities and accelerations of the chains.
    chart: Vec<S>,
    chain: [Vec<S>; 2],
    zero: Vec<S>,
    slope: Vec<S>,
    square: Matrix<S>,
}

impl<S: Scalar> FreeKinematics<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(Tree::from(robot))
    }

    /// As [`new`](Self::new), from an existing [`Tree`].
    pub fn from_tree(tree: Tree) -> Self {
        let (n, zero) = (tree.dof(), S::zero());
        let zeros = filled(zero, n);
        // What only free joints need.
        let m = if tree.free().is_empty() { 0 } else { n };
        Self {
            brackets: Brackets::new(&tree),
            chart: zeros.clone(),
            chain: [zeros.clone(), zeros.clone()],
            zero: zeros.clone(),
            slope: zeros,
            square: Matrix::zeros(m, m),
            kinematics: Kinematics::from_tree(tree),
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.kinematics.dof()
    }

    /// Number of entries of q.
    pub fn nq(&self) -> usize {
        self.kinematics.tree().nq()
    }

    /// Places the robot at q (rad, m; length nq), at rest.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`], [`EvalError::NonFinite`], [`EvalError::NotUnit`].
    pub fn set_position(&mut self, q: &[S]) -> Result<(), EvalError> {
        if self.kinematics.tree().free().is_empty() {
            return self.kinematics.set_position(q);
        }
        let zero = std::mem::take(&mut self.zero);
        let outcome = self.set_motion(q, &zero, &zero);
        self.zero = zero;
        outcome
    }

    /// Places the robot at q, v (rad/s, m/s; length n), with a = 0: every acceleration is then the bias
    /// `Jdot v`.
    ///
    /// # Errors
    /// As [`set_position`](Self::set_position).
    pub fn set_state(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        if self.kinematics.tree().free().is_empty() {
            return self.kinematics.set_state(q, v);
        }
        let zero = std::mem::take(&mut self.zero);
        let outcome = self.set_motion(q, v, &zero);
        self.zero = zero;
        outcome
    }

    /// Places the robot at q, v, a (rad/s^2, m/s^2; length n), a the rate of v.
    ///
    /// # Errors
    /// As [`set_position`](Self::set_position).
    pub fn set_motion(&mut self, q: &[S], v: &[S], a: &[S]) -> Result<(), EvalError> {
        if self.kinematics.tree().free().is_empty() {
            return self.kinematics.set_motion(q, v, a);
        }
        let tree = self.kinematics.tree();
        tree.check_configuration(q)?;
        check_entries(tree, "v", v, tree.dof())?;
        check_entries(tree, "a", a, tree.dof())?;
        tree.chart_coordinates(q, &mut self.chart);
        let [chain_v, chain_a] = &mut self.chain;
        chain_v.copy_from_slice(v);
        chain_a.copy_from_slice(a);
        for free in tree.free() {
            // Slides along the axes of the parent, then angles (x, y, z), at zero: the accelerations of these
            // with what their rates add.
            let ((linear, w), (of_linear, of_angular)) = (tangent(free, v), tangent(free, a));
            let (at, slides, rotation) =
                (free.joint.coordinate, free.joint.kind.slides(), free.quaternion(q).rotation());
            let of_angles = of_angular + Vec3::new(-(w.y * w.z), w.x * w.z, -(w.x * w.y));
            chain_a[at + slides..at + slides + 3].copy_from_slice(&of_angles.to_array());
            if slides > 0 {
                let turned = [linear, of_linear + w.cross(linear)].map(|own| rotation.apply(own).to_array());
                chain_v[at..at + 3].copy_from_slice(&turned[0]);
                chain_a[at..at + 3].copy_from_slice(&turned[1]);
            }
        }
        self.kinematics.place_moving_chart(q, &self.chart, [chain_v, chain_a]);
        Ok(())
    }

    /// As [`Kinematics::pose`].
    ///
    /// # Errors
    /// See [`FreeKinematics`].
    pub fn pose(&self, frame: usize) -> Result<Pose<S>, EvalError> {
        self.kinematics.pose(frame)
    }

    /// As [`Kinematics::twist`].
    ///
    /// # Errors
    /// See [`FreeKinematics`].
    pub fn twist(&self, frame: usize, axes: ReferenceFrame) -> Result<Motion<S>, EvalError> {
        self.kinematics.twist(frame, axes)
    }

    /// As [`Kinematics::orientation_error`].
    ///
    /// # Errors
    /// See [`FreeKinematics`].
    pub fn orientation_error(
        &self,
        frame: usize,
        desired: &Rotation3<f64>,
    ) -> Result<OrientationError<S>, EvalError> {
        self.kinematics.orientation_error(frame, desired)
    }

    /// As [`Kinematics::acceleration`].
    ///
    /// # Errors
    /// See [`FreeKinematics`].
    pub fn acceleration(&self, frame: usize, axes: ReferenceFrame) -> Result<Motion<S>, EvalError> {
        self.kinematics.acceleration(frame, axes)
    }

    /// The Jacobian J, 6 x n: rows of the angular velocity, then of the linear one. `V = J v`.
    ///
    /// # Errors
    /// See [`FreeKinematics`].
    pub fn jacobian(&mut self, frame: usize, axes: ReferenceFrame) -> Result<&Matrix<S>, EvalError> {
        self.kinematics.jacobian(frame, axes)
    }

    /// The derivative of J in time, 6 x n.
    ///
    /// # Errors
    /// See [`FreeKinematics`].
    pub fn jacobian_rate(&mut self, frame: usize, axes: ReferenceFrame) -> Result<&Matrix<S>, EvalError> {
        self.kinematics.jacobian_rate(frame, axes)
    }

    /// `(w . x)_xixi` for the position x of the origin of a frame, n x n, symmetric.
    ///
    /// # Errors
    /// See [`FreeKinematics`].
    pub fn position_hessian(&mut self, frame: usize, w: &[S; 3]) -> Result<&Matrix<S>, EvalError> {
        let Self { kinematics, brackets, slope, square, .. } = self;
        if kinematics.tree().free().is_empty() {
            return kinematics.position_hessian(frame, w);
        }
        let jacobian = kinematics.jacobian(frame, ReferenceFrame::LocalWorldAligned)?;
        slope.fill(S::zero());
        (0..3).for_each(|k| add_scaled(slope, w[k], jacobian.row(3 + k)));
        square.copy_from(kinematics.position_hessian(frame, w)?);
        // Chains of joints give the derivative along the joint that is nearer to the base, of the other.
        for e in brackets.of_momentum(slope).iter().filter(|e| e.row < e.column) {
            square[(e.row, e.column)] += e.value.times(0.5);
            square[(e.column, e.row)] += e.value.times(0.5);
        }
        Ok(square)
    }

    /// As [`Kinematics::centre_of_mass`]; with free joints its rate of the Jacobian is that in time alone.
    ///
    /// # Errors
    /// [`EvalError::Massless`].
    pub fn centre_of_mass(&mut self) -> Result<CentreOfMass<'_, S>, EvalError> {
        self.kinematics.centre_of_mass()
    }

    /// As [`Kinematics::momentum`].
    ///
    /// # Errors
    /// [`EvalError::Massless`].
    pub fn momentum(&mut self) -> Result<Momentum<'_, S>, EvalError> {
        self.kinematics.momentum()
    }
}
