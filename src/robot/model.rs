//! The robot itself.

use super::armature::Armature;
use super::checks;
use super::constraint::Constraint;
use super::error::RobotError;
use super::frame::{Frame, FrameSpec};
use super::frame_list::FrameList;
use super::free::FreeJoint;
use super::free_entries::{of_position, plain};
use super::joint::{Friction, Joint};
use super::joint_map;
use super::warning::Warning;
use super::wrench::AppliedWrench;
use crate::EvalError;
use crate::error::check_length;
use nalgebra::{DMatrix, Vector3};

/// A robot: a tree of one-degree-of-freedom joints with rigid links, on a base that does not move.
///
/// ```
/// use costate::robot::{JointSpec, LinkInertia, Robot};
///
/// let bob = LinkInertia::point(1.0, [0.0, 0.0, -1.0]);
/// let pendulum = Robot::builder("pendulum")
///     .joint(JointSpec::revolute("hinge").axis([0.0, 1.0, 0.0]).carrying(bob))
///     .build()?;
/// assert_eq!(pendulum.dof(), 1);
/// # Ok::<(), costate::robot::RobotError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    pub(super) name: String,
    pub(super) gravity: Vector3<f64>,
    pub(super) joints: Vec<Joint>,
    /// Indices of the joints that mimic no other one.
    pub(super) independent: Vec<usize>,
    pub(super) free: Vec<FreeJoint>,
    pub(super) armature: Armature,
    pub(super) frames: Vec<Frame>,
    pub(super) wrenches: Vec<AppliedWrench>,
    pub(super) constraints: Vec<Constraint>,
    pub(super) warnings: Vec<Warning>,
}

impl Robot {
    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of degrees of freedom, n: of the joints that mimic no other one.
    pub fn dof(&self) -> usize {
        self.independent_joints().len()
    }

    /// Number of entries of q: n, and one more for each floating or spherical joint.
    pub fn nq(&self) -> usize {
        self.dof() + self.free.len()
    }

    /// The floating and spherical joints. Each is a chain of several of the [`joints`](Self::joints).
    ///
    /// ```
    /// use costate::robot::{FreeKind, JointSpec, LinkInertia, Robot};
    ///
    /// let body = LinkInertia::about_com(1.0, [0.0; 3], nalgebra::Matrix3::identity());
    /// let drone = Robot::builder("drone").joint(JointSpec::floating("root").carrying(body)).build()?;
    /// assert_eq!((drone.dof(), drone.nq()), (6, 7));
    /// assert_eq!(drone.free_joints()[0].kind, FreeKind::Floating);
    /// # Ok::<(), costate::robot::RobotError>(())
    /// ```
    pub fn free_joints(&self) -> &[FreeJoint] {
        &self.free
    }

    /// For what takes joints of one degree of freedom alone.
    ///
    /// # Errors
    /// [`EvalError::FreeJoint`] with the first floating or spherical joint.
    pub fn refuse_free_joints(&self) -> Result<(), EvalError> {
        match self.free.first() {
            None => Ok(()),
            Some(free) => Err(EvalError::free_joint(&free.name, free.kind.name())),
        }
    }

    /// All joints of the tree, parents before children, with those that mimic others.
    ///
    /// The entries of q, v, p and u belong to the [`independent_joints`](Self::independent_joints).
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// The joints that mimic no other one; this is the order of q, v, p and u.
    pub fn independent_joints(&self) -> impl ExactSizeIterator<Item = &Joint> + DoubleEndedIterator + Clone {
        self.independent.iter().map(|&i| &self.joints[i])
    }

    /// Their indices in [`joints`](Self::joints), rising.
    pub fn independent_indices(&self) -> &[usize] {
        &self.independent
    }

    /// The name of the joint that an entry of q belongs to: of a floating or spherical one for each of its
    /// entries. `None` if q has no such entry.
    pub fn joint_of_position(&self, index: usize) -> Option<&str> {
        match of_position(&self.free, index) {
            Ok(free) => Some(&free.name),
            Err(coordinate) => {
                self.independent.get(coordinate).map(|&joint| self.joints[joint].name.as_str())
            }
        }
    }

    /// The indices in q and v of each joint of one degree of freedom, in their order: all but the entries of
    /// the [`free_joints`](Self::free_joints).
    ///
    /// ```
    /// use costate::robot::{JointSpec, LinkInertia, Robot};
    ///
    /// let body = LinkInertia::about_com(1.0, [0.0; 3], nalgebra::Matrix3::identity());
    /// let swinging = Robot::builder("satellite")
    ///     .joint(JointSpec::floating("base").carrying(body))
    ///     .joint(JointSpec::revolute("arm").axis([0.0, 0.0, 1.0]).on("base").carrying(body))
    ///     .build()?;
    /// assert!(swinging.plain_entries().eq([(7, 6)]));
    /// # Ok::<(), costate::robot::RobotError>(())
    /// ```
    pub fn plain_entries(&self) -> impl Iterator<Item = (usize, usize)> {
        plain(self.free.iter(), self.dof())
    }

    /// `G q + b`: the positions of all joints (rad, m), in the order of [`joints`](Self::joints). Floating
    /// and spherical joints have none: [`poses`](Self::poses) takes them.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`] unless q has n entries; [`EvalError::FreeJoint`] where a joint is floating
    /// or spherical.
    pub fn joint_positions(&self, q: &[f64]) -> Result<Vec<f64>, EvalError> {
        self.refuse_free_joints()?;
        check_length("q", q, self.dof())?;
        Ok(self.all_positions(q))
    }

    /// `G q + b` of n coordinates.
    pub(super) fn all_positions(&self, coordinates: &[f64]) -> Vec<f64> {
        match joint_map::rows(&self.joints) {
            None => coordinates.to_vec(),
            Some(rows) => rows.iter().map(|row| row.position(coordinates)).collect(),
        }
    }

    /// Gravity acceleration in the world frame (m/s^2).
    pub fn gravity(&self) -> Vector3<f64> {
        self.gravity
    }

    /// Entries `(i, j, A_ij)`, i >= j, of the armature matrix that are not zero, row by row: constant rotor
    /// inertia that is added to the mass matrix (kg m^2, kg, kg m).
    pub fn armature(&self) -> &[(usize, usize, f64)] {
        self.armature.entries()
    }

    /// Entry `A_ij` of the armature matrix (kg m^2, kg, kg m), `i` and `j` from 0; `A_ii` is the armature of
    /// joint `i`.
    pub fn armature_entry(&self, i: usize, j: usize) -> f64 {
        self.armature.entry(i, j)
    }

    /// The armature matrix, one row for each of the [`joints`](Self::joints); it is made by this call, and
    /// takes 8 bytes for each entry.
    pub fn armature_matrix(&self) -> DMatrix<f64> {
        self.armature.matrix()
    }

    /// The frames: the world, then those of the joints, of links and of merged joints, and added ones. A
    /// floating or spherical joint has one frame: that of its last part, which moves the link.
    ///
    /// ```
    /// use costate::robot::{FrameSpec, Placement, Robot};
    ///
    /// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
    /// let arm = Robot::from_file("robots/ur5.urdf")?;
    /// let tip = Placement::from_xyz_rpy([0.0, 0.0, 0.12], [0.0; 3]);
    /// let arm = arm.with_frame(FrameSpec::new("tip").on("tool0").placed(tip))?;
    /// assert_eq!(arm.frame("tip")?.joint, Some(5));
    /// let error = arm.frame("tol0").unwrap_err();
    /// assert!(error.to_string().contains("'tool0'"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// The position of the frame of joint `i` in [`frames`](Self::frames); `None` for a part of a floating or
    /// spherical joint that is not its last one.
    pub fn frame_of_joint(&self, i: usize) -> Option<usize> {
        let has_frame = |joint: &&Joint| !joint.is_inner();
        let before = self.joints.get(..i)?.iter().filter(has_frame).count();
        self.joints.get(i).filter(has_frame).map(|_| 1 + before)
    }

    /// The frame of this name: of an added frame, else of a link, else of a joint, else the world.
    ///
    /// A link and a joint can have the same name; `joint:NAME` and `link:NAME` tell them apart. A link or
    /// joint of a file whose whole name is that text comes first; added frames cannot have such a name.
    ///
    /// # Errors
    /// [`RobotError::UnknownFrame`], with the names that resemble it.
    pub fn frame(&self, name: &str) -> Result<&Frame, RobotError> {
        FrameList::find(&self.frames, name)
    }

    /// The position of the frame of this name in [`frames`](Self::frames), found as by
    /// [`frame`](Self::frame).
    ///
    /// # Errors
    /// [`RobotError::UnknownFrame`], with the names that resemble it.
    pub fn frame_index(&self, name: &str) -> Result<usize, RobotError> {
        let frame = self.frame(name)?;
        Ok(self.frames.iter().position(|other| std::ptr::eq(other, frame)).unwrap_or_default())
    }

    /// The same robot with one more frame.
    ///
    /// # Errors
    /// [`RobotError::UnknownFrame`] for the frame that it is placed in, [`RobotError::DuplicateName`],
    /// [`RobotError::BadName`], [`RobotError::BadFramePlacement`].
    pub fn with_frame(&self, frame: FrameSpec) -> Result<Self, RobotError> {
        self.clone().with_frames(std::iter::once(frame)).map_err(|(_, error)| error)
    }

    /// The same robot with these frames, each of which may be placed in one before it.
    ///
    /// # Errors
    /// As [`with_frame`](Self::with_frame), with the position of the frame.
    pub(super) fn with_frames(
        self,
        specs: impl Iterator<Item = FrameSpec>,
    ) -> Result<Self, (usize, RobotError)> {
        let mut frames = FrameList::from(self.frames);
        for (k, spec) in specs.enumerate() {
            frames.add(spec).map_err(|error| (k, error))?;
        }
        Ok(Self { frames: frames.into_frames(), ..self })
    }

    /// What is unusual about it.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Adds a warning, once.
    pub(super) fn add_warning(&mut self, warning: Warning) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    /// The same robot with D = 0.
    pub fn without_friction(&self) -> Self {
        let mut robot = self.clone();
        robot.joints.iter_mut().for_each(|joint| joint.friction = Friction::none());
        robot
    }

    /// The same robot under another gravity (m/s^2).
    ///
    /// # Errors
    /// [`RobotError::BadGravity`] if it is not finite, or larger than 1e75.
    pub fn with_gravity(&self, gravity: [f64; 3]) -> Result<Self, RobotError> {
        checks::gravity(&gravity)?;
        Ok(Self { gravity: Vector3::from(gravity), ..self.clone() })
    }

    /// The same robot with another armature matrix: one row for each of the [`joints`](Self::joints).
    ///
    /// # Errors
    /// [`RobotError::BadArmature`].
    pub fn with_armature(&self, armature: DMatrix<f64>) -> Result<Self, RobotError> {
        let n = self.joints.len();
        if armature.shape() != (n, n) {
            let problem = format!("is {} x {}", armature.nrows(), armature.ncols());
            return Err(RobotError::BadArmature { problem, n });
        }
        let armature = Armature::from_matrix(&armature)?;
        Ok(Self { armature, ..self.clone() }.checked(self, Vec::new()))
    }
}
