//! Robots: trees of revolute and prismatic joints, from code or from a file.
//!
//! A [`Robot`] is built by a [`RobotBuilder`], from a Denavit-Hartenberg table ([`dh`]), from a TOML file or
//! from a URDF ([`Robot::from_file`]; the readers are the cargo features `toml` and `urdf`, on by default).
//! [`Tree`] is the same robot in the frames that the kernels use.

mod armature;
mod builder;
mod checks;
pub mod dh;
mod error;
#[cfg(feature = "toml")]
pub mod file;
mod frames;
mod joint;
mod joint_frame;
mod link;
mod origins;
pub(crate) mod parameters;
mod poses;
mod printable;
mod read;
mod regroup;
mod tree;
#[cfg(feature = "urdf")]
pub mod urdf;
mod warning;

pub use builder::RobotBuilder;
pub use error::RobotError;
pub use joint::{Friction, Joint, JointKind, JointSpec, Limits, Spring};
pub use joint_frame::JointFrame;
pub use link::{LinkInertia, Placement};
pub use printable::{Printable, printable};
pub use read::RobotFormat;
pub use tree::Tree;
pub use warning::Warning;

use self::armature::Armature;
use nalgebra::{DMatrix, Vector3};

/// How a robot is read.
///
/// ```
/// use costate::robot::LoadOptions;
/// assert!(LoadOptions::default().strict(true).strict);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LoadOptions {
    /// Warnings that suggest a mistake become errors: [`Warning::is_refused_when_strict`].
    pub strict: bool,
    /// Load `<dynamics damping friction>` of a URDF as viscous and smooth Coulomb friction.
    pub friction: bool,
}

impl LoadOptions {
    /// Sets [`strict`](Self::strict).
    #[must_use]
    pub fn strict(self, strict: bool) -> Self {
        Self { strict, ..self }
    }

    /// Sets [`friction`](Self::friction).
    #[must_use]
    pub fn friction(self, friction: bool) -> Self {
        Self { friction, ..self }
    }
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
    armature: Armature,
    warnings: Vec<Warning>,
}

impl Robot {
    /// Starts a robot of that name, without joints and with gravity (0, 0, -9.81) m/s^2.
    pub fn builder(name: impl Into<String>) -> RobotBuilder {
        RobotBuilder::new(name)
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

    /// The armature matrix, n x n; it is made by this call, and takes 8 n^2 bytes.
    pub fn armature_matrix(&self) -> DMatrix<f64> {
        self.armature.matrix()
    }

    /// What is unusual about it.
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
    /// [`RobotError::BadGravity`] if it is not finite.
    pub fn with_gravity(&self, gravity: [f64; 3]) -> Result<Self, RobotError> {
        if gravity.iter().any(|g| !g.is_finite()) {
            return Err(RobotError::BadGravity);
        }
        Ok(Self { gravity: Vector3::from(gravity), ..self.clone() })
    }

    /// The same robot with another armature matrix, n x n.
    ///
    /// # Errors
    /// [`RobotError::BadArmature`], and [`RobotError::MovesNothing`] for a joint that needs armature and has
    /// none.
    pub fn with_armature(&self, armature: DMatrix<f64>) -> Result<Self, RobotError> {
        let n = self.len();
        if armature.shape() != (n, n) {
            let problem = format!("is {} x {}", armature.nrows(), armature.ncols());
            return Err(RobotError::BadArmature { problem, n });
        }
        let armature = Armature::from_matrix(&armature)?;
        checks::robot(&self.joints, &armature, &vec![true; n], &mut Vec::new())?;
        Ok(Self { armature, ..self.clone() })
    }
}
