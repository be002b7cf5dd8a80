//! Joints and the links they move.

use super::free::FreePart;
use super::link::{LinkInertia, Placement};
use nalgebra::Vector3;

/// The type of a joint. Every joint has one degree of freedom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Rotates about its axis; q in rad.
    Revolute,
    /// Translates along its axis; q in m.
    Prismatic,
}

impl JointKind {
    /// `"revolute"` or `"prismatic"`.
    pub fn name(self) -> &'static str {
        match self {
            JointKind::Revolute => "revolute",
            JointKind::Prismatic => "prismatic",
        }
    }
}

/// A linear joint spring: adds `1/2 stiffness (q - rest)^2` to the potential energy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spring {
    /// N m/rad or N/m.
    pub stiffness: f64,
    /// Position without force (rad or m).
    pub rest: f64,
}

/// Joint friction `D = -viscous v - coulomb tanh(v / coulomb_velocity)`.
///
/// The second term is smooth Coulomb friction. The sign function is not offered, since it has no derivative
/// at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// N m s/rad or N s/m.
    pub viscous: f64,
    /// Limit of the smooth Coulomb term (N m or N).
    pub coulomb: f64,
    /// Velocity at which the smooth Coulomb term reaches tanh(1) = 76 % of its limit (rad/s or m/s).
    pub coulomb_velocity: f64,
}

impl Friction {
    /// Transition velocity of the smooth Coulomb term unless given (rad/s or m/s).
    pub const DEFAULT_COULOMB_VELOCITY: f64 = 0.01;

    /// No friction.
    pub fn none() -> Self {
        Self { viscous: 0.0, coulomb: 0.0, coulomb_velocity: Self::DEFAULT_COULOMB_VELOCITY }
    }

    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        self.viscous == 0.0 && self.coulomb == 0.0
    }
}

impl Default for Friction {
    fn default() -> Self {
        Self::none()
    }
}

/// Limits of a joint; infinite where there is none. The dynamics does not enforce them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Smallest q (rad or m).
    pub lower: f64,
    /// Largest q (rad or m).
    pub upper: f64,
    /// Largest |v| (rad/s or m/s).
    pub velocity: f64,
    /// Largest |u| (N m or N).
    pub effort: f64,
}

impl Default for Limits {
    fn default() -> Self {
        let infinity = f64::INFINITY;
        Self { lower: -infinity, upper: infinity, velocity: infinity, effort: infinity }
    }
}

/// How a joint follows an independent one: `q = ratio q_joint + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mimic {
    /// Index of the independent joint in [`Robot::joints`](super::Robot::joints).
    pub joint: usize,
    /// Its own velocity over that of the independent joint (1, m/rad, rad/m); any sign.
    pub ratio: f64,
    /// Its own position where that of the independent joint is zero (rad, m).
    pub offset: f64,
}

/// A joint of a [`Robot`](super::Robot) and the link that it moves.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Joint {
    /// Its name, unique in the robot.
    pub name: String,
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// Index of the joint that moves the link it is attached to; `None` if it is attached to the world.
    pub parent: Option<usize>,
    /// The joint frame in the parent's joint frame (or the world) at q = 0.
    pub placement: Placement,
    /// Unit axis in the joint frame.
    pub axis: Vector3<f64>,
    /// Name of the moved link: the one in the file, or that of the joint.
    pub link: String,
    /// Inertia of the moved link, in the joint frame.
    pub inertia: LinkInertia,
    /// Spring.
    pub spring: Spring,
    /// Friction.
    pub friction: Friction,
    /// Limits; those of an independent joint are narrowed by those of the joints that mimic it.
    pub limits: Limits,
    /// How it follows an independent joint; `None` if it is independent itself, and so has an entry of q.
    pub mimic: Option<Mimic>,
    /// Which part of a floating or spherical joint it is; `None` for a joint by itself.
    pub free: Option<FreePart>,
}

impl Joint {
    /// Whether it is a part of a floating or spherical joint that others follow: it moves no link, and has no
    /// frame.
    pub(crate) fn is_inner(&self) -> bool {
        self.free.as_ref().is_some_and(|part| part.place + 1 < part.kind.dof())
    }
}

/// What a [`JointSpec`] says about the joint that it mimics.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MimicSpec {
    pub joint: String,
    pub ratio: f64,
    pub offset: f64,
}

/// Description of one joint, for [`RobotBuilder::joint`](super::RobotBuilder::joint).
///
/// Starts as a joint attached to the world, its frame at the origin, axis z, with a massless link.
#[derive(Clone, Debug, PartialEq)]
#[must_use = "a description does nothing until it is given to a builder"]
pub struct JointSpec {
    pub(crate) name: String,
    pub(crate) kind: JointKind,
    pub(crate) parent: Option<String>,
    pub(crate) placement: Placement,
    pub(crate) axis: Vector3<f64>,
    pub(crate) link: Option<String>,
    pub(crate) inertia: LinkInertia,
    pub(crate) armature: f64,
    pub(crate) spring: Spring,
    pub(crate) friction: Friction,
    pub(crate) limits: Limits,
    pub(crate) mimic: Option<MimicSpec>,
    /// The link is massless on purpose (one of the joints that a floating or planar joint became).
    pub(crate) virtual_link: bool,
    pub(crate) free: Option<FreePart>,
}

impl JointSpec {
    /// A revolute joint.
    pub fn revolute(name: impl Into<String>) -> Self {
        Self::new(name.into(), JointKind::Revolute)
    }

    /// A prismatic joint.
    pub fn prismatic(name: impl Into<String>) -> Self {
        Self::new(name.into(), JointKind::Prismatic)
    }

    pub(crate) fn new(name: String, kind: JointKind) -> Self {
        Self {
            name,
            kind,
            parent: None,
            placement: Placement::identity(),
            axis: Vector3::z(),
            link: None,
            inertia: LinkInertia::massless(),
            armature: 0.0,
            spring: Spring::default(),
            friction: Friction::none(),
            limits: Limits::default(),
            mimic: None,
            virtual_link: false,
            free: None,
        }
    }

    /// Attaches the joint to the link that the joint `parent` moves.
    pub fn on(mut self, parent: impl Into<String>) -> Self {
        self.parent = Some(parent.into());
        self
    }

    /// The joint frame in the parent's joint frame (or the world) at q = 0.
    pub fn placed(mut self, placement: Placement) -> Self {
        self.placement = placement;
        self
    }

    /// Direction of the axis in the joint frame; any length but 0.
    pub fn axis(mut self, axis: [f64; 3]) -> Self {
        self.axis = Vector3::from(axis);
        self
    }

    /// Inertia of the moved link, in the joint frame.
    pub fn carrying(mut self, inertia: LinkInertia) -> Self {
        self.inertia = inertia;
        self
    }

    /// Name of the moved link, for messages; the joint's name unless set.
    pub fn link(mut self, name: impl Into<String>) -> Self {
        self.link = Some(name.into());
        self
    }

    pub(crate) fn link_name(&self) -> &str {
        self.link.as_deref().unwrap_or(&self.name)
    }

    /// Rotor inertia seen at the joint, gear ratio squared included (kg m^2, or kg for a prismatic joint).
    pub fn armature(mut self, armature: f64) -> Self {
        self.armature = armature;
        self
    }

    /// Joint spring.
    pub fn spring(mut self, spring: Spring) -> Self {
        self.spring = spring;
        self
    }

    /// Joint friction.
    pub fn friction(mut self, friction: Friction) -> Self {
        self.friction = friction;
        self
    }

    /// Makes it follow another joint, `q = ratio q_joint + offset` (ratio of any sign; offset in rad or m).
    ///
    /// The other joint may mimic a third one, and may be added later. A robot has one coordinate for each
    /// joint that mimics none.
    ///
    /// ```
    /// use costate::robot::{JointSpec, LinkInertia, Robot};
    ///
    /// let finger = |name: &str, side: f64| {
    ///     JointSpec::prismatic(name).axis([0.0, side, 0.0]).carrying(LinkInertia::point(0.1, [0.0; 3]))
    /// };
    /// let gripper = Robot::builder("gripper")
    ///     .joint(finger("left", 1.0))
    ///     .joint(finger("right", -1.0).mimicking("left", 1.0, 0.0))
    ///     .build()?;
    /// assert_eq!((gripper.joints().len(), gripper.dof()), (2, 1));
    /// # Ok::<(), costate::robot::RobotError>(())
    /// ```
    pub fn mimicking(mut self, joint: impl Into<String>, ratio: f64, offset: f64) -> Self {
        self.mimic = Some(MimicSpec { joint: joint.into(), ratio, offset });
        self
    }

    /// Limits.
    pub fn limits(mut self, limits: Limits) -> Self {
        self.limits = limits;
        self
    }
}
