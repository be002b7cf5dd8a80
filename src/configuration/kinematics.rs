//! Kinematics of robots with floating and spherical joints.
//!
//! The chain of a joint has velocity `v = B nu` with the twist nu of the moved frame, in its axes, and B the
//! inverse of A (`chart.rs`), B = 1 at the centre. So Jacobians of the chain, their columns in the axes of
//! the frame, are those in the tangent space, and
//!
//! $$ \dot J = \dot J\_c + J\_c B\_q[\nu], \qquad (w \cdot x)\_{\xi \xi} = (w \cdot x)\_{qq} + (w \cdot x)\_q
//! \Phi $$

use super::ChartFrame;
use crate::error::EvalError;
use crate::kernels::check_entries;
use crate::kinematics::{CentreOfMass, Kinematics, Momentum, OrientationError, Pose, ReferenceFrame};
use crate::matrix::{Matrix, filled};
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;
use crate::spatial::Motion;
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
    frames: Vec<ChartFrame<S>>,
    /// v, and coordinates, velocities and accelerations of the chains.
    velocity: Vec<S>,
    chart: Vec<S>,
    chain: [Vec<S>; 2],
    zero: Vec<S>,
    /// Six rows and three rows, with their rates.
    six: [Matrix<S>; 2],
    three: [Matrix<S>; 2],
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
            frames: tree.free().iter().map(ChartFrame::new).collect(),
            velocity: zeros.clone(),
            chart: zeros.clone(),
            chain: [zeros.clone(), zeros.clone()],
            zero: zeros,
            six: [Matrix::zeros(6, m), Matrix::zeros(6, m)],
            three: [Matrix::zeros(3, m), Matrix::zeros(3, m)],
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
        if self.frames.is_empty() {
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
        if self.frames.is_empty() {
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
        if self.frames.is_empty() {
            return self.kinematics.set_motion(q, v, a);
        }
        let tree = self.kinematics.tree();
        tree.check_configuration(q)?;
        check_entries(tree, "v", v, tree.dof())?;
        check_entries(tree, "a", a, tree.dof())?;
        tree.chart_coordinates(q, &mut self.chart);
        let [chain_v, chain_a] = &mut self.chain;
        self.velocity.copy_from_slice(v);
        chain_v.copy_from_slice(v);
        chain_a.copy_from_slice(a);
        for frame in &mut self.frames {
            frame.set_configuration(q);
            let ((at, _), nu) = (frame.place(), frame.entries(v));
            for e in &frame.chart.rates.first {
                chain_a[at + e.row] += (nu[e.by[0]] * nu[e.column]).times(e.value);
            }
            frame.outward(chain_v);
            frame.outward(chain_a);
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
        let Self { kinematics, frames, six: [jacobian, _], .. } = self;
        let found = kinematics.jacobian(frame, axes)?;
        Ok(turned(frames, found, jacobian))
    }

    /// The derivative of J in time, 6 x n.
    ///
    /// # Errors
    /// See [`FreeKinematics`].
    pub fn jacobian_rate(&mut self, frame: usize, axes: ReferenceFrame) -> Result<&Matrix<S>, EvalError> {
        let Self { kinematics, frames, six: [jacobian, rate], velocity, .. } = self;
        if frames.is_empty() {
            return kinematics.jacobian_rate(frame, axes);
        }
        turned(frames, kinematics.jacobian(frame, axes)?, jacobian);
        turned(frames, kinematics.jacobian_rate(frame, axes)?, rate);
        spread(frames, velocity, jacobian, rate);
        Ok(rate)
    }

    /// `(w . x)_xixi` for the position x of the origin of a frame, n x n, symmetric.
    ///
    /// # Errors
    /// See [`FreeKinematics`].
    pub fn position_hessian(&mut self, frame: usize, w: &[S; 3]) -> Result<&Matrix<S>, EvalError> {
        let Self { kinematics, frames, six: [jacobian, _], square, .. } = self;
        if frames.is_empty() {
            return kinematics.position_hessian(frame, w);
        }
        turned(frames, kinematics.jacobian(frame, ReferenceFrame::LocalWorldAligned)?, jacobian);
        square.copy_from(kinematics.position_hessian(frame, w)?);
        for frame in frames {
            let (at, _) = frame.place();
            frame.turn_block(square, [0, 0], square.rows());
            for e in &frame.chart.retraction {
                let slope = (0..3).fold(S::zero(), |sum, k| sum + w[k] * jacobian[(3 + k, at + e.row)]);
                square[(at + e.column, at + e.by[0])] += slope.times(e.value);
            }
        }
        Ok(square)
    }

    /// As [`Kinematics::centre_of_mass`]; with free joints its rate of the Jacobian is that in time alone.
    ///
    /// # Errors
    /// [`EvalError::Massless`].
    pub fn centre_of_mass(&mut self) -> Result<CentreOfMass<'_, S>, EvalError> {
        let Self { kinematics, frames, three: [jacobian, rate], velocity, .. } = self;
        let found = kinematics.centre_of_mass()?;
        if frames.is_empty() {
            return Ok(found);
        }
        turned(frames, found.jacobian, jacobian);
        turned(frames, found.jacobian_rate, rate);
        spread(frames, velocity, jacobian, rate);
        Ok(CentreOfMass { jacobian, jacobian_rate: rate, ..found })
    }

    /// As [`Kinematics::momentum`].
    ///
    /// # Errors
    /// [`EvalError::Massless`].
    pub fn momentum(&mut self) -> Result<Momentum<'_, S>, EvalError> {
        let Self { kinematics, frames, six: [matrix, _], .. } = self;
        let found = kinematics.momentum()?;
        Ok(Momentum { matrix: turned(frames, found.matrix, matrix), ..found })
    }
}

/// Rows of a matrix of the chains, with columns in the axes of the moved frames.
fn turned<'a, S: Scalar>(
    frames: &[ChartFrame<S>],
    of_chains: &'a Matrix<S>,
    room: &'a mut Matrix<S>,
) -> &'a Matrix<S> {
    if frames.is_empty() {
        return of_chains;
    }
    room.copy_from(of_chains);
    for frame in frames {
        (0..room.rows()).for_each(|i| frame.inward(room.row_mut(i)));
    }
    room
}

/// Adds `J B_q[nu]` to the rate of J.
fn spread<S: Scalar>(frames: &[ChartFrame<S>], velocity: &[S], jacobian: &Matrix<S>, rate: &mut Matrix<S>) {
    for frame in frames {
        let ((at, _), nu) = (frame.place(), frame.entries(velocity));
        for e in &frame.chart.rates.first {
            let factor = nu[e.by[0]].times(e.value);
            for i in 0..rate.rows() {
                let entry = jacobian[(i, at + e.row)];
                rate[(i, at + e.column)] += entry * factor;
            }
        }
    }
}
