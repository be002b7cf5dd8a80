//! The parameters of a model, one by one.

use crate::robot::{JointKind, Placement};

/// One of the ten inertial parameters of a rigid body, about the origin of a frame and in its axes. L(q, v)
/// is linear in them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Inertial {
    /// Mass m (kg).
    Mass,
    /// First moment m c along x (kg m).
    MomentX,
    /// First moment m c along y (kg m).
    MomentY,
    /// First moment m c along z (kg m).
    MomentZ,
    /// Entry (x, x) of the inertia matrix about the origin (kg m^2).
    InertiaXx,
    /// Entry (y, y).
    InertiaYy,
    /// Entry (z, z).
    InertiaZz,
    /// Entries (x, y) and (y, x).
    InertiaXy,
    /// Entries (x, z) and (z, x).
    InertiaXz,
    /// Entries (y, z) and (z, y).
    InertiaYz,
}

impl Inertial {
    /// All of them, in the order of names and values.
    pub const ALL: [Self; 10] = [
        Self::Mass,
        Self::MomentX,
        Self::MomentY,
        Self::MomentZ,
        Self::InertiaXx,
        Self::InertiaYy,
        Self::InertiaZz,
        Self::InertiaXy,
        Self::InertiaXz,
        Self::InertiaYz,
    ];

    /// `mass`, `h_x` to `h_z`, `J_xx`, `J_yy`, `J_zz`, `J_xy`, `J_xz`, `J_yz`.
    pub fn name(self) -> &'static str {
        const NAMES: [&str; 10] =
            ["mass", "h_x", "h_y", "h_z", "J_xx", "J_yy", "J_zz", "J_xy", "J_xz", "J_yz"];
        NAMES[self as usize]
    }
}

/// A direction of the axes of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

impl Axis {
    /// All three.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// The unit vector.
    pub fn unit(self) -> [f64; 3] {
        [0, 1, 2].map(|k| f64::from(u8::from(k == self as u8)))
    }
}

/// The frame in which a displacement of a joint is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DisplacedIn {
    /// The joint frame of the parent (or the world): the placement becomes `J(theta) placement`.
    Parent,
    /// The joint frame itself at q = 0: the placement becomes `placement J(theta)`.
    Joint,
}

/// A displacement of a joint frame, and of all that it carries, by theta along or about an axis; theta = 0 in
/// the model.
///
/// Any geometric parameter is one of these or a constant combination of them. In a modified
/// Denavit-Hartenberg table `a` is a translation along x and `alpha` a rotation about x in the frame of the
/// parent, `d` a translation along z and `theta` a rotation about z in the joint frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Displacement {
    /// The frame of the axis.
    pub frame: DisplacedIn,
    /// Prismatic for a translation (theta in m), revolute for a rotation about an axis through the origin of
    /// the frame (theta in rad).
    pub kind: JointKind,
    /// Direction of the axis in that frame, of any length but 0.
    pub axis: [f64; 3],
}

impl Displacement {
    /// A translation along an axis.
    pub fn along(frame: DisplacedIn, axis: [f64; 3]) -> Self {
        Self { frame, kind: JointKind::Prismatic, axis }
    }

    /// A rotation about an axis through the origin of the frame.
    pub fn about(frame: DisplacedIn, axis: [f64; 3]) -> Self {
        Self { frame, kind: JointKind::Revolute, axis }
    }
}

/// A number of the model of a robot. Joints are counted from 0, in the order of
/// [`Robot::joints`](crate::robot::Robot::joints).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Parameter {
    /// An inertial parameter of the link of a joint, about the origin of the joint frame and in its axes, as
    /// in the description of the robot.
    Link {
        /// The joint.
        joint: usize,
        /// Which of the ten.
        entry: Inertial,
    },
    /// An inertial parameter of a body that is fixed to the link of a joint and adds to it, about the origin
    /// of a frame of its own.
    Payload {
        /// The joint.
        joint: usize,
        /// The frame of the body in the joint frame (m).
        placement: Placement,
        /// Which of the ten.
        entry: Inertial,
    },
    /// A component of the translation of the placement of a joint, in the axes of the parent's joint frame
    /// (m).
    Translation {
        /// The joint.
        joint: usize,
        /// Which component.
        axis: Axis,
    },
    /// A rotation of the placement of a joint about an axis of the joint frame: `R exp([theta e] x)` (rad).
    Rotation {
        /// The joint.
        joint: usize,
        /// About which axis.
        axis: Axis,
    },
    /// Another displacement of a joint frame.
    Displacement {
        /// The joint.
        joint: usize,
        /// The displacement.
        displacement: Displacement,
    },
    /// Stiffness of the spring of a joint (N m/rad, N/m).
    Stiffness {
        /// The joint.
        joint: usize,
    },
    /// Position of a joint at which its spring is at rest (rad, m).
    Rest {
        /// The joint.
        joint: usize,
    },
    /// Viscous friction of a joint (N m s/rad, N s/m).
    Viscous {
        /// The joint.
        joint: usize,
    },
    /// Limit of the smooth Coulomb friction of a joint (N m, N).
    Coulomb {
        /// The joint.
        joint: usize,
    },
    /// Transition velocity of the smooth Coulomb friction of a joint (rad/s, m/s).
    CoulombVelocity {
        /// The joint.
        joint: usize,
    },
    /// Entry (i, j) of the armature matrix, and with it (j, i) (kg m^2, kg m, kg).
    Armature {
        /// The pair; the same joint twice for its own armature.
        joints: [usize; 2],
    },
    /// A component of the acceleration of gravity in the world frame (m/s^2).
    Gravity {
        /// Which component.
        axis: Axis,
    },
}

impl Parameter {
    /// The component of gravity of that name.
    pub(super) fn gravity_named(name: &str) -> Option<Self> {
        Axis::ALL.into_iter().map(|axis| Self::Gravity { axis }).find(|one| one.entry_name() == name)
    }

    /// Whether tau(q, v, a) is linear in it, jointly with all other parameters of which this is true.
    ///
    /// True for inertial parameters of links and payloads, stiffness, viscous friction, Coulomb limits and
    /// armature. Gravity and the rest of a spring occur in products with those; geometric parameters and the
    /// transition velocity of friction enter nonlinearly.
    pub fn is_linear(&self) -> bool {
        matches!(
            self,
            Self::Link { .. }
                | Self::Payload { .. }
                | Self::Stiffness { .. }
                | Self::Viscous { .. }
                | Self::Coulomb { .. }
                | Self::Armature { .. }
        )
    }

    /// The joint, or the pair of joints, that it belongs to.
    pub(super) fn joints(&self) -> [Option<usize>; 2] {
        match *self {
            Self::Gravity { .. } => [None, None],
            Self::Armature { joints: [i, j] } => [Some(i), Some(j)],
            Self::Link { joint, .. }
            | Self::Payload { joint, .. }
            | Self::Translation { joint, .. }
            | Self::Rotation { joint, .. }
            | Self::Displacement { joint, .. }
            | Self::Stiffness { joint }
            | Self::Rest { joint }
            | Self::Viscous { joint }
            | Self::Coulomb { joint }
            | Self::CoulombVelocity { joint } => [Some(joint), None],
        }
    }

    /// What follows the joint in its name.
    pub(super) fn entry_name(&self) -> &'static str {
        const TRANSLATIONS: [&str; 3] = ["x", "y", "z"];
        const ROTATIONS: [&str; 3] = ["rotation_x", "rotation_y", "rotation_z"];
        const GRAVITY: [&str; 3] = ["gravity_x", "gravity_y", "gravity_z"];
        match self {
            Self::Link { entry, .. } | Self::Payload { entry, .. } => entry.name(),
            Self::Translation { axis, .. } => TRANSLATIONS[*axis as usize],
            Self::Rotation { axis, .. } => ROTATIONS[*axis as usize],
            Self::Displacement { .. } => "displacement",
            Self::Stiffness { .. } => "stiffness",
            Self::Rest { .. } => "rest",
            Self::Viscous { .. } => "viscous",
            Self::Coulomb { .. } => "coulomb",
            Self::CoulombVelocity { .. } => "coulomb_velocity",
            Self::Armature { .. } => "armature",
            Self::Gravity { axis } => GRAVITY[*axis as usize],
        }
    }

    /// All parameters of one joint that have a name of their own.
    pub(super) fn of_joint(joint: usize) -> impl Iterator<Item = Self> {
        let link = Inertial::ALL.into_iter().map(move |entry| Self::Link { joint, entry });
        let translation = Axis::ALL.into_iter().map(move |axis| Self::Translation { joint, axis });
        let rotation = Axis::ALL.into_iter().map(move |axis| Self::Rotation { joint, axis });
        let own = [
            Self::Stiffness { joint },
            Self::Rest { joint },
            Self::Viscous { joint },
            Self::Coulomb { joint },
            Self::CoulombVelocity { joint },
            Self::Armature { joints: [joint; 2] },
        ];
        link.chain(translation).chain(rotation).chain(own)
    }
}
