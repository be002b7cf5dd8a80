//! Robots in TOML.
//!
//! ```toml
//! name = "arm"
//! gravity = [0.0, 0.0, -9.81]            # m/s^2 in the world frame; this is the default
//! convention = "modified-dh"             # or "standard-dh" or "placements" (the default)
//! sources = ["where the figures come from"]
//! armature = [[1.0, 0.1], [0.1, 2.0]]    # constant, symmetric; added to that of the joints
//!
//! [[joint]]
//! name = "shoulder"
//! type = "revolute"                      # the default, "prismatic", "floating" or "spherical"
//! parent = "world"                       # or a joint; default: the joint before, "world" for the first
//! dh = { alpha = 0.0, a = 0.0, d = 0.0, theta = 0.0 }           # rad and m; absent numbers are 0
//! mass = 17.4                            # kg
//! com = [0.068, 0.006, -0.016]           # m, in the link frame
//! inertia = { xx = 0.13, yy = 0.524, zz = 0.539, xy = 0.0, xz = 0.0, yz = 0.0 }   # kg m^2
//! inertia_about = "com"                  # the default, or "frame": the origin of the link frame
//! armature = 4.71                        # rotor inertia seen at the joint, kg m^2 (prismatic: kg)
//! spring = { stiffness = 10.0, rest = 0.0 }
//! friction = { viscous = 0.1, coulomb = 0.5, coulomb_velocity = 0.01 }
//! limits = { lower = -3.1, upper = 3.1, velocity = 2.0, effort = 97.6 }
//! mimic = { joint = "elbow", ratio = -1.0, offset = 0.0 }       # q = ratio q_elbow + offset; default: none
//!
//! [[joint]]
//! name = "elbow"
//! dh = { a = 0.4318 }
//! mass = 4.8
//!
//! [[frame]]
//! name = "tool"
//! parent = "elbow"                       # a joint or an earlier frame; default: "world"
//! placement = { xyz = [0, 0, 0.1], rpy = [0, 0, 0] }   # in the (link) frame of the parent
//!
//! [[wrench]]
//! frame = "tool"                         # a frame or a joint
//! force = [0.0, 0.0, -20.0]              # N, at the origin of the frame; default: none
//! moment = [0.0, 0.0, 0.0]               # N m; default: none
//! axes = "aligned"                       # with the world; "local" (the default) turns with the link
//!
//! [[constraint]]                         # closes a loop, see `docs/constraints.md`
//! name = "rocker_pivot"
//! type = "rows"                          # the default, "pinned", "rigid", "distance" or "coupling"
//! frame = "tool"                         # a frame or a joint
//! to = "world"                           # another one, from which it is seen; default: "world"
//! placement = { xyz = [0, 0, 0], rpy = [0, 0, 0] }              # in `frame`; default: none
//! to_placement = { xyz = [1.3, 0, 0], rpy = [0, 0, 0] }         # in `to`; default: none
//! rows = ["x", "y"]                      # of "x", "y", "z", "turn_x", "turn_y", "turn_z"
//! # type "distance": length = 0.8 (m)
//! # type "coupling": joints = { elbow = 1.0, shoulder = -2.0 }, constant = 0.0 (the default)
//! ```
//!
//! With `convention = "placements"`, `placement = { xyz = [0, 0, 0], rpy = [0, 0, 0] }` (the joint frame in
//! the parent's joint frame at q = 0, fixed-axis roll, pitch, yaw) and `axis = [0, 0, 1]` replace `dh`, and
//! the link frame is the joint frame. Unknown keys are errors. A text may have 4 MiB.

mod attached;
mod constraints;
mod explain;
mod placement;
mod rows;
mod size;

use self::rows::{JointRow, RobotFile, RowKind, TableConvention};
use super::dh::{self, Convention};
use super::error::RobotError;
use super::format::RobotFormat;
use super::frame::{FrameKind, FrameSpec};
use super::joint::{Friction, JointSpec, Limits, Spring};
use super::link::Placement;
use super::model::Robot;
use super::options::LoadOptions;
use super::printable::printable;
use nalgebra::DMatrix;
use std::collections::HashMap;

/// Reads a robot from TOML text.
///
/// # Errors
/// [`RobotError::InFile`] with an empty path and, where it is known, the line. In it:
/// [`RobotError::TooLong`], [`RobotError::Malformed`] for what is not TOML and for unknown, missing or
/// misplaced keys, and the errors of [`RobotBuilder::build`](super::RobotBuilder::build).
pub fn parse(text: &str, options: LoadOptions) -> Result<Robot, RobotError> {
    let most = RobotFormat::Toml.most_bytes();
    if text.len() > most {
        return Err(RobotError::TooLong { most });
    }
    RobotFormat::Toml.check_text(text)?;
    size::check(text)?;
    let file: RobotFile = toml::from_str(text).map_err(|error| explain::refusal(error, text))?;
    let line_of = |offset: usize| explain::line(text, offset);
    let line_of_joint = |name: &str| {
        let row = file.joints.iter().rev().find(|row| row.name() == name);
        row.map(|row| line_of(row.name.span().start))
    };
    let located = |error: RobotError| {
        let line = match &error {
            RobotError::BadArmature { .. } => {
                file.armature.as_ref().map(|matrix| line_of(matrix.span().start))
            }
            RobotError::BadGravity => file.gravity.as_ref().map(|gravity| line_of(gravity.span().start)),
            error => error.culprit().and_then(line_of_joint),
        };
        error.at(line)
    };
    let mut builder = Robot::builder(&file.name).options(options);
    if let Some(gravity) = &file.gravity {
        builder = builder.gravity(*gravity.get_ref());
    }
    // Of several rows with the same name the first; the builder refuses the others.
    let mut row_of = HashMap::with_capacity(file.joints.len());
    file.joints.iter().for_each(|row| {
        row_of.entry(row.name()).or_insert(row);
    });
    let mut before = None;
    for row in &file.joints {
        let parent = row.parent.as_deref().or(before).filter(|&parent| parent != "world");
        let parent_row = parent.and_then(|parent| row_of.get(parent).copied());
        let spec = row.spec(file.convention, parent, parent_row);
        builder = builder.joint(spec.map_err(|error| error.at(line_of(row.name.span().start)))?);
        if file.convention == TableConvention::StandardDh {
            // A joint of a standard table moves the far frame of its link, in which masses are given.
            let far = row.dh_row().far_frame();
            builder = builder.frame(FrameSpec::described(row.name(), FrameKind::Link, Some(row.name()), far));
        }
        before = Some(row.name());
    }
    if let Some(rows) = &file.armature {
        builder =
            builder.armature_matrix(armature_matrix(rows.get_ref(), file.joints.len()).map_err(located)?);
    }
    let robot = builder.build().map_err(located)?;
    attached::attach(robot, &file, text, options)
}

fn armature_matrix(rows: &[Vec<f64>], n: usize) -> Result<DMatrix<f64>, RobotError> {
    match rows.iter().find(|row| row.len() != rows.len()) {
        Some(row) => {
            let count = |n: usize, what| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
            let problem =
                format!("has {} and a row of {}", count(rows.len(), "row"), count(row.len(), "number"));
            Err(RobotError::BadArmature { problem, n })
        }
        None => Ok(DMatrix::from_fn(rows.len(), rows.len(), |i, j| rows[i][j])),
    }
}

impl JointRow {
    fn spec(
        &self,
        convention: TableConvention,
        parent: Option<&str>,
        parent_row: Option<&JointRow>,
    ) -> Result<JointSpec, RobotError> {
        let name = self.name();
        if name == "world" {
            let message = "a joint is called 'world', the name of the base; give it another name";
            return Err(RobotError::malformed(message));
        }
        let friction = &self.friction;
        let infinity = f64::INFINITY;
        let spec = match self.kind {
            RowKind::Revolute => JointSpec::revolute(name),
            RowKind::Prismatic => JointSpec::prismatic(name),
            RowKind::Floating => JointSpec::floating(name),
            RowKind::Spherical => JointSpec::spherical(name),
        };
        let mut spec = spec
            .carrying(self.link())
            .armature(self.armature)
            .spring(Spring { stiffness: self.spring.stiffness, rest: self.spring.rest })
            .friction(Friction {
                viscous: friction.viscous,
                coulomb: friction.coulomb,
                coulomb_velocity: friction.coulomb_velocity.unwrap_or(Friction::DEFAULT_COULOMB_VELOCITY),
            })
            .limits(Limits {
                lower: self.limits.lower.unwrap_or(-infinity),
                upper: self.limits.upper.unwrap_or(infinity),
                velocity: self.limits.velocity.unwrap_or(infinity),
                effort: self.limits.effort.unwrap_or(infinity),
            });
        if let Some(parent) = parent {
            spec = spec.on(parent);
        }
        if let Some(mimic) = &self.mimic {
            spec = spec.mimicking(&mimic.joint, mimic.ratio, mimic.offset);
        }
        let misplaced = |key, convention| {
            let name = printable(name);
            let message =
                format!("joint '{name}' has the key `{key}`, which needs convention = \"{convention}\"");
            RobotError::malformed(message)
        };
        let convention = match convention {
            TableConvention::Placements if self.dh.is_some() => return Err(misplaced("dh", "modified-dh")),
            TableConvention::Placements => {
                let placement = self.placement.unwrap_or_default();
                let spec = spec.placed(Placement::from_xyz_rpy(placement.xyz, placement.rpy));
                return Ok(spec.axis(self.axis.unwrap_or([0.0, 0.0, 1.0])));
            }
            _ if self.placement.is_some() => return Err(misplaced("placement", "placements")),
            _ if self.axis.is_some() => return Err(misplaced("axis", "placements")),
            TableConvention::ModifiedDh => Convention::Modified,
            TableConvention::StandardDh => Convention::Standard,
        };
        let parent_numbers = parent_row.map(JointRow::dh_row);
        Ok(dh::place(spec, convention, &self.dh_row(), parent_numbers.as_ref()))
    }
}
