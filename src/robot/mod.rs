//! Robots: trees of revolute and prismatic joints, from code or from a file.
//!
//! A [`Robot`] is built by a [`RobotBuilder`], from Denavit-Hartenberg tables ([`dh`]), from a TOML file ([`mod@file`])
//! or from a URDF ([`urdf`]). [`Tree`] is the same robot with its frames turned the way the kernels want them.

mod builder;
mod checks;
pub mod dh;
mod error;
pub mod file;
mod frames;
mod joint;
mod joint_frame;
mod link;
mod origins;
pub(crate) mod parameters;
mod poses;
mod regroup;
mod tree;
pub mod urdf;
mod warning;

pub use builder::RobotBuilder;
pub use error::RobotError;
pub use joint::{Friction, Joint, JointKind, JointSpec, Limits, Spring};
pub use joint_frame::JointFrame;
pub use link::{LinkInertia, Placement};
pub use tree::Tree;
pub use warning::Warning;

use nalgebra::{DMatrix, Vector3};
use std::path::Path;

/// How a robot is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoadOptions {
    /// Physical warnings (massless links, violated triangle inequality) become errors.
    pub strict: bool,
    /// Load `<dynamics damping friction>` of a URDF as viscous and smooth Coulomb friction.
    pub friction: bool,
}

/// A robot: a tree of one-degree-of-freedom joints with rigid links, on a base that does not move.
///
/// ```
/// use costate::robot::{JointSpec, LinkInertia, Robot};
///
/// let pendulum = Robot::builder("pendulum")
///     .joint(JointSpec::revolute("hinge").axis([0.0, 1.0, 0.0]).carrying(LinkInertia::point(1.0, [0.0, 0.0, -1.0])))
///     .build()?;
/// assert_eq!(pendulum.len(), 1);
/// # Ok::<(), costate::robot::RobotError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    name: String,
    gravity: Vector3<f64>,
    joints: Vec<Joint>,
    armature: DMatrix<f64>,
    warnings: Vec<Warning>,
}

impl Robot {
    /// Starts a robot of that name, without joints, gravity (0, 0, -9.81) m/s^2.
    pub fn builder(name: impl Into<String>) -> RobotBuilder {
        RobotBuilder::new(name)
    }

    /// Reads a `.urdf` or `.toml` file.
    ///
    /// # Errors
    /// [`RobotError::InFile`] with the path and, where it is known, the line.
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, RobotError> {
        Self::from_file_with(path, LoadOptions::default())
    }

    /// Reads a `.urdf` or `.toml` file, with options.
    ///
    /// # Errors
    /// [`RobotError::InFile`] with the path and, where it is known, the line.
    pub fn from_file_with(path: impl AsRef<Path>, options: LoadOptions) -> Result<Self, RobotError> {
        let path = path.as_ref();
        let in_file = |error| match error {
            RobotError::InFile { line, error, .. } => RobotError::InFile { path: path.into(), line, error },
            error => RobotError::InFile { path: path.into(), line: None, error: Box::new(error) },
        };
        let read: fn(&str, LoadOptions) -> Result<Self, RobotError> =
            match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
                Some("urdf") => urdf::parse,
                Some("toml") => file::parse,
                _ => return Err(in_file(RobotError::UnknownFormat)),
            };
        let bytes = std::fs::read(path)
            .map_err(|error| in_file(RobotError::Unreadable { reason: error.to_string() }))?;
        // Old URDF files have comments in other encodings; what is not UTF-8 in a name becomes a replacement character.
        read(&String::from_utf8_lossy(&bytes), options).map_err(in_file)
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of joints, n.
    #[expect(clippy::len_without_is_empty, reason = "a robot has at least one joint")]
    pub fn len(&self) -> usize {
        self.joints.len()
    }

    /// The joints, parents before children; this is the order of q, v, p and u.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Gravity acceleration in the world frame (m/s^2).
    pub fn gravity(&self) -> Vector3<f64> {
        self.gravity
    }

    /// Armature matrix, n x n: constant rotor inertia added to the mass matrix (kg m^2, kg, kg m).
    pub fn armature(&self) -> &DMatrix<f64> {
        &self.armature
    }

    /// What is odd about it.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
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
    /// [`RobotError::BadGravity`].
    pub fn with_gravity(&self, gravity: [f64; 3]) -> Result<Self, RobotError> {
        if gravity.iter().any(|g| !g.is_finite()) {
            return Err(RobotError::BadGravity);
        }
        Ok(Self { gravity: Vector3::from(gravity), ..self.clone() })
    }

    /// The same robot with another armature matrix, n x n.
    ///
    /// # Errors
    /// [`RobotError::BadArmature`], and [`RobotError::MovesNothing`] for a joint that needs armature and has none.
    pub fn with_armature(&self, armature: DMatrix<f64>) -> Result<Self, RobotError> {
        let n = self.len();
        if armature.shape() != (n, n) {
            let problem = format!("is {} x {}", armature.nrows(), armature.ncols());
            return Err(RobotError::BadArmature { problem, n });
        }
        checks::armature(&armature)?;
        checks::robot(&self.joints, &armature, &vec![true; n], &mut Vec::new())?;
        Ok(Self { armature, ..self.clone() })
    }
}
