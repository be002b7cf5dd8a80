//! What is unusual about the description of a robot.

mod message;

use super::body::Body;

/// Something unusual that does not stop the computation.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// A moving link that has neither mass nor inertia, unless its joint moves another one that has some and
    /// M is regular.
    MasslessLink {
        /// The link.
        link: String,
    },
    /// Principal moments that no rigid body has.
    TriangleInequality {
        /// The link or payload.
        body: Body,
        /// Principal moments (kg m^2), rising.
        moments: [f64; 3],
    },
    /// A negative principal moment of a link. Kinematics and inverse dynamics are not concerned; what inverts
    /// M fails where it is not positive.
    NegativeMoment {
        /// The link or payload.
        body: Body,
        /// The moment (kg m^2).
        moment: f64,
        /// Whether the mass matrix is positive.
        positive: Positivity,
    },
    /// No joint moves any mass, and none has armature: M is zero. There is kinematics only.
    KinematicsOnly {
        /// The first joint.
        joint: String,
    },
    /// A joint that moves no mass and has no armature: M is singular in every pose. Kinematics and inverse
    /// dynamics are not concerned; the other derivatives need the joint locked, or with armature or a
    /// payload.
    MovesNothing {
        /// The joint.
        joint: String,
    },
    /// All mass that the last joint moves lies on its axis: M is singular in every pose.
    OnAxis {
        /// The joint.
        joint: String,
    },
    /// An element or attribute that URDF does not know, and that is therefore ignored.
    UnknownName {
        /// The element, such as `<orign>`, or the attribute, such as `xzy`; several with commas, if they
        /// stand in the same elements.
        name: String,
        /// Where it is, such as `joint 'elbow'` or `<origin> of joint 'elbow'`.
        owner: String,
        /// Line of the first one, from 1.
        line: usize,
        /// How many more there are in elements of the same kind.
        others: usize,
        /// The known name that it resembles.
        nearest: Option<&'static str>,
    },
    /// More elements and attributes that URDF does not know.
    MoreUnknownNames {
        /// How many.
        count: usize,
        /// Line of the first one, from 1.
        line: usize,
    },
    /// Revolute or prismatic joints of a URDF without `<limit>`; they are unlimited.
    WithoutLimit {
        /// The joints.
        joints: Vec<String>,
        /// Line of the first one, from 1.
        line: usize,
    },
    /// Joints of a URDF whose lower limit lies above the upper one; their positions are unlimited.
    SwappedLimits {
        /// The joints.
        joints: Vec<String>,
        /// Line of the first `<limit>`, from 1.
        line: usize,
    },
    /// Joints of a URDF with a negative limit of effort or velocity, which is taken as no limit.
    NegativeLimit {
        /// The joints.
        joints: Vec<String>,
        /// Line of the first `<limit>`, from 1.
        line: usize,
    },
    /// The root link of a URDF, which carries several moving joints, has mass, which is not used since the
    /// base is held fixed: that of a robot that walks or flies would move. Of the base of an arm it is a
    /// [`Note`](Self::Note).
    FixedBase {
        /// The root link.
        link: String,
        /// Its mass (kg).
        mass: f64,
        /// Its line, from 1.
        line: usize,
    },
    /// No position of a joint is within both its limits and those of a joint that mimics it, which are
    /// ignored.
    MimicLimits {
        /// The joint that mimics.
        joint: String,
        /// The independent joint.
        master: String,
    },
    /// A wrench acts on a frame that no joint moves, and has no effect.
    IdleWrench {
        /// The frame.
        frame: String,
    },
    /// A payload has neither mass nor inertia.
    EmptyPayload {
        /// The frame that carries it.
        frame: String,
    },
    /// A joint is locked outside its limits.
    LockedOutside {
        /// The joint.
        joint: String,
        /// Its position (rad, m).
        value: f64,
        /// Its limits (rad, m).
        limits: [f64; 2],
    },
    /// Lengths or inertias that are a thousand, or a million times too large for the mass: they may be those
    /// of millimetres.
    Millimetres {
        /// Whether inertias are too large, for the lengths; otherwise lengths for the mass.
        inertias: bool,
        /// The moving mass (kg).
        mass: f64,
        /// The farthest centre of mass or joint from the first joint (m), or the mean radius of gyration of
        /// the links (m).
        length: f64,
        /// The link.
        link: String,
    },
    /// Limits of revolute joints beyond two turns: they may be degrees.
    LargeLimits {
        /// The joints.
        joints: Vec<String>,
        /// The limit of the first one (rad).
        limit: f64,
    },
    /// Damping and friction in `<dynamics>` of a URDF that were not loaded.
    FrictionIgnored {
        /// The joints.
        joints: Vec<String>,
    },
    /// A joint of several degrees of freedom, replaced by joints of one degree of freedom each.
    Expanded {
        /// The joint.
        joint: String,
        /// `"floating"` or `"planar"`.
        kind: &'static str,
    },
    /// Anything else worth saying about the file.
    Note {
        /// The whole sentence.
        text: String,
    },
}

/// Whether the mass matrix of a robot with a negative principal moment is positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Positivity {
    /// At eight positions within the limits.
    WhereTried,
    /// Not at one of these positions.
    Violated,
    /// Unknown: the robot has too many joints for M to be tried when it is read.
    Untried,
}

impl Warning {
    /// What a warning about a negative moment says of M.
    pub(super) fn positivity_mut(&mut self) -> Option<&mut Positivity> {
        match self {
            Self::NegativeMoment { positive, .. } => Some(positive),
            _ => None,
        }
    }

    /// Whether it says that the principal moments of this body are impossible.
    pub(super) fn is_about_moments_of(&self, of: &Body) -> bool {
        matches!(self, Self::NegativeMoment { body, .. } | Self::TriangleInequality { body, .. } if body == of)
    }

    /// Whether it says what was done, and suggests no mistake.
    pub fn is_note(&self) -> bool {
        !self.is_refused_when_strict()
    }

    /// Whether it suggests a mistake in the file; strict loading refuses these.
    pub fn is_refused_when_strict(&self) -> bool {
        !matches!(self, Self::FrictionIgnored { .. } | Self::Expanded { .. } | Self::Note { .. })
    }

    /// What is left of it for the joints that a robot has: lists of joints without others; `None` for
    /// nothing.
    pub(super) fn about(self, is_joint: impl Fn(&str) -> bool) -> Option<Self> {
        match self {
            Self::MimicLimits { ref joint, ref master } => {
                (is_joint(joint) && is_joint(master)).then_some(self)
            }
            mut warning => {
                let Some(joints) = warning.joints_mut() else { return Some(warning) };
                joints.retain(|joint| is_joint(joint));
                let some = !joints.is_empty();
                some.then_some(warning)
            }
        }
    }

    /// What is left of it where the limits of a joint are given anew; `None` for nothing.
    pub(super) fn without_limits_of(self, name: &str) -> Option<Self> {
        match self {
            Self::FrictionIgnored { .. } => Some(self),
            Self::MimicLimits { ref master, .. } if master == name => None,
            warning => warning.about(|joint| joint != name),
        }
    }

    /// The joints of a warning about several.
    fn joints_mut(&mut self) -> Option<&mut Vec<String>> {
        match self {
            Self::WithoutLimit { joints, .. }
            | Self::SwappedLimits { joints, .. }
            | Self::NegativeLimit { joints, .. }
            | Self::LargeLimits { joints, .. }
            | Self::FrictionIgnored { joints } => Some(joints),
            _ => None,
        }
    }

    /// The line of the file that it is about, from 1, where one is known.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::UnknownName { line, .. }
            | Self::MoreUnknownNames { line, .. }
            | Self::WithoutLimit { line, .. }
            | Self::SwappedLimits { line, .. }
            | Self::NegativeLimit { line, .. }
            | Self::FixedBase { line, .. } => Some(*line),
            _ => None,
        }
    }
}
