//! Robots: trees of revolute, prismatic, floating and spherical joints, from code or from a file.
//!
//! A [`Robot`] is built by a [`RobotBuilder`], from a Denavit-Hartenberg table ([`dh`]), from a TOML file or
//! from a URDF ([`Robot::from_file`]; the readers are the cargo features `toml` and `urdf`, on by default).
//! [`Tree`] is the same robot in the frames that the kernels use.

mod armature;
mod body;
mod branches;
mod builder;
mod checks;
mod constraint;
pub mod dh;
mod edit;
mod error;
#[cfg(feature = "toml")]
pub mod file;
mod format;
mod frame;
mod frame_list;
mod frames;
mod free;
mod free_entries;
mod free_frame;
mod free_parts;
mod joint;
mod joint_frame;
mod joint_map;
mod link;
mod mimic;
mod model;
mod nearest;
mod options;
mod origins;
pub(crate) mod parameters;
mod pattern;
mod poses;
mod positive;
mod printable;
mod range;
mod read;
mod regroup;
mod still_joints;
#[cfg(test)]
pub(crate) mod test_robot;
mod tree;
mod tree_frame;
#[cfg(feature = "urdf")]
pub mod urdf;
mod warning;
mod with_constraint;
mod with_wrench;
mod wrench;

pub use body::Body;
pub(crate) use branches::Branches;
pub use builder::RobotBuilder;
pub use constraint::{Constraint, ConstraintFrame, ConstraintKind, ConstraintRow, ConstraintSpec};
pub use edit::{LargestChange, LimitChange, RobotEdit, SymmetryChange};
pub use error::{LoopProblem, RobotError};
pub use format::RobotFormat;
pub use frame::{Frame, FrameKind, FrameSpec};
pub use free::{FreeJoint, FreeKind, FreePart};
pub(crate) use free_entries::UNIT;
pub(crate) use free_frame::FreeFrame;
pub use joint::{Friction, Joint, JointKind, JointSpec, Limits, Mimic, Spring};
pub use joint_frame::JointFrame;
pub(crate) use joint_map::{JointMap, Row, scaled};
pub use link::{LinkInertia, Placement};
pub use model::Robot;
pub(crate) use nearest::resembling;
pub use options::LoadOptions;
pub(crate) use printable::list as list_names;
pub use printable::{Printable, escape_hidden, printable, printable_number};
pub use read::RobotText;
pub(crate) use still_joints::{Site, StillJoint, WithStillJoints};
pub use tree::Tree;
pub(crate) use tree::TreeConstraintKind;
pub use tree_frame::TreeFrame;
pub use warning::{Positivity, Warning};
pub use wrench::{AppliedWrench, Wrench, WrenchAxes};
