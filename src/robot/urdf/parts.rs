//! The links and joints of a URDF as they stand in it.

use crate::robot::joint::{JointKind, Limits, MimicSpec};
use crate::robot::link::{LinkInertia, Placement};
use crate::robot::warning::Warning;
use nalgebra::Vector3;
use std::collections::HashSet;

/// The joint types that can be loaded.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum JointType {
    Revolute,
    Continuous,
    Prismatic,
    Fixed,
    Floating,
    Planar,
}

impl JointType {
    pub(super) fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "revolute" => Self::Revolute,
            "continuous" => Self::Continuous,
            "prismatic" => Self::Prismatic,
            "fixed" => Self::Fixed,
            "floating" => Self::Floating,
            "planar" => Self::Planar,
            _ => return None,
        })
    }

    /// How a joint of one degree of freedom moves.
    pub(super) fn moves(self) -> Option<JointKind> {
        match self {
            Self::Revolute | Self::Continuous => Some(JointKind::Revolute),
            Self::Prismatic => Some(JointKind::Prismatic),
            Self::Fixed | Self::Floating | Self::Planar => None,
        }
    }

    /// The name of a type with several degrees of freedom.
    pub(super) fn with_several_freedoms(self) -> Option<&'static str> {
        match self {
            Self::Floating => Some("floating"),
            Self::Planar => Some("planar"),
            Self::Revolute | Self::Continuous | Self::Prismatic | Self::Fixed => None,
        }
    }
}

/// A `<link>`.
pub(super) struct Link {
    pub(super) name: String,
    /// In the frame of the link; zero without `<inertial>`.
    pub(super) inertia: LinkInertia,
    pub(super) line: usize,
}

/// A `<joint>`.
pub(super) struct SourceJoint {
    pub(super) name: String,
    pub(super) kind: JointType,
    /// Names of the links.
    pub(super) parent: String,
    pub(super) child: String,
    /// The joint frame in the frame of the parent link at q = 0.
    pub(super) placement: Placement,
    /// Not normalised.
    pub(super) axis: Vector3<f64>,
    pub(super) limits: Limits,
    /// Damping and friction, if there is `<dynamics>`.
    pub(super) dynamics: Option<[f64; 2]>,
    pub(super) mimic: Option<SourceMimic>,
    /// Position of a joint that became fixed (rad, m).
    pub(super) fixed_at: f64,
    pub(super) line: usize,
}

/// A `<mimic>`.
pub(super) struct SourceMimic {
    pub(super) spec: MimicSpec,
    pub(super) line: usize,
}

/// The joint types that can close a loop.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum LoopType {
    Fixed,
    Spherical,
    Revolute,
    Prismatic,
    Planar,
}

impl LoopType {
    pub(super) fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "fixed" => Self::Fixed,
            "spherical" => Self::Spherical,
            "revolute" | "continuous" => Self::Revolute,
            "prismatic" => Self::Prismatic,
            "planar" => Self::Planar,
            _ => return None,
        })
    }

    /// Whether its motion has an axis.
    pub(super) fn has_axis(self) -> bool {
        !matches!(self, Self::Fixed | Self::Spherical)
    }
}

/// A `<loop_joint>`, `<loop>`, `<drake:ball_constraint>` or `<coupling>`.
pub(super) struct SourceLoop {
    pub(super) name: String,
    /// Names of the predecessor, or first link, and of the successor.
    pub(super) links: [String; 2],
    pub(super) held: SourceHeld,
    pub(super) line: usize,
}

/// What a loop holds.
pub(super) enum SourceHeld {
    /// The links to each other by a joint: its frame in both links at its position 0.
    Joint {
        kind: LoopType,
        /// In the frame of the joint, not normalised.
        axis: Vector3<f64>,
        placements: Box<[Placement; 2]>,
    },
    /// The rate of the successor over that of the predecessor, both against the link where their ways to the
    /// root meet.
    Ratio(f64),
}

/// What dynamics needs of a URDF.
pub(super) struct Source {
    pub(super) name: String,
    /// Line of `<robot>`.
    pub(super) line: usize,
    pub(super) links: Vec<Link>,
    pub(super) joints: Vec<SourceJoint>,
    pub(super) loops: Vec<SourceLoop>,
    /// What is unusual about the file.
    pub(super) warnings: Vec<Warning>,
    /// The name and the line of the first xacro element, which nobody has expanded.
    pub(super) xacro: Option<(String, usize)>,
}

/// The name of the ground below a root link on a floating joint.
pub(super) const UNIVERSE: &str = "universe";

impl Source {
    /// Puts the root link on a floating joint.
    pub(super) fn set_afloat(&mut self) {
        let moved: HashSet<&str> = self.joints.iter().map(|joint| joint.child.as_str()).collect();
        let roots = self.links.iter().filter(|link| !moved.contains(link.name.as_str()));
        let Some((child, line)) = roots.map(|link| (link.name.clone(), link.line)).next() else { return };
        let parent = UNIVERSE.to_owned();
        self.links.push(Link { name: parent.clone(), inertia: LinkInertia::massless(), line });
        let joint = SourceJoint {
            name: "root_joint".to_owned(),
            kind: JointType::Floating,
            parent,
            child,
            placement: Placement::identity(),
            axis: Vector3::z(),
            limits: Limits::default(),
            dynamics: None,
            mimic: None,
            fixed_at: 0.0,
            line,
        };
        self.joints.insert(0, joint);
    }
}
