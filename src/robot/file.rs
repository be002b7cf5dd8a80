//! Robots in TOML.
//!
//! ```toml
//! name = "arm"
//! gravity = [0.0, 0.0, -9.81]            # m/s^2 in the world frame; this is the default
//! convention = "modified-dh"             # or "standard-dh" or "placements" (the default)
//! sources = ["where the figures come from"]
//! armature = [[1.0, 0.1], [0.1, 2.0]]    # full constant symmetric matrix, added to the joints' own armature
//!
//! [[joint]]
//! name = "shoulder"
//! type = "revolute"                      # the default, or "prismatic"
//! parent = "world"                       # or the name of a joint; default: the joint before, "world" for the first
//! dh = { alpha = 0.0, a = 0.0, d = 0.0, theta = 0.0 }           # rad and m; absent numbers are 0
//! mass = 17.4                            # kg
//! com = [0.068, 0.006, -0.016]           # m, in the link frame
//! inertia = { xx = 0.13, yy = 0.524, zz = 0.539, xy = 0.0, xz = 0.0, yz = 0.0 }   # entries of the matrix, kg m^2
//! inertia_about = "com"                  # the default, or "frame": the origin of the link frame
//! armature = 4.71                        # rotor inertia seen at the joint, kg m^2 (kg for a prismatic joint)
//! spring = { stiffness = 10.0, rest = 0.0 }
//! friction = { viscous = 0.1, coulomb = 0.5, coulomb_velocity = 0.01 }
//! limits = { lower = -3.1, upper = 3.1, velocity = 2.0, effort = 97.6 }
//!
//! [[joint]]
//! name = "elbow"
//! dh = { a = 0.4318 }
//! mass = 4.8
//! ```
//!
//! With `convention = "placements"`, `placement = { xyz = [0, 0, 0], rpy = [0, 0, 0] }` (the joint frame in the
//! parent's joint frame at q = 0, fixed-axis roll, pitch, yaw) and `axis = [0, 0, 1]` stand in place of `dh`, and the
//! link frame is the joint frame. Unknown keys are errors.

use super::dh::{self, Convention, DhRow};
use super::error::RobotError;
use super::joint::{Friction, JointKind, JointSpec, Limits, Spring};
use super::link::{LinkInertia, Placement};
use super::{LoadOptions, Robot};
use nalgebra::{DMatrix, Matrix3};
use serde::Deserialize;
use std::path::PathBuf;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RobotFile {
    name: String,
    gravity: Option<Spanned<[f64; 3]>>,
    #[serde(default)]
    convention: TableConvention,
    #[serde(default, rename = "sources")]
    _sources: Vec<String>,
    armature: Option<Spanned<Vec<Vec<f64>>>>,
    #[serde(default, rename = "joint")]
    joints: Vec<JointRow>,
}

#[derive(Clone, Copy, Default, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum TableConvention {
    ModifiedDh,
    StandardDh,
    #[default]
    Placements,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JointRow {
    name: Spanned<String>,
    #[serde(default, rename = "type")]
    kind: RowKind,
    parent: Option<String>,
    dh: Option<DhNumbers>,
    placement: Option<PlacementNumbers>,
    axis: Option<[f64; 3]>,
    #[serde(default)]
    mass: f64,
    #[serde(default)]
    com: [f64; 3],
    #[serde(default)]
    inertia: InertiaNumbers,
    #[serde(default)]
    inertia_about: Reference,
    #[serde(default)]
    armature: f64,
    #[serde(default)]
    spring: SpringNumbers,
    #[serde(default)]
    friction: FrictionNumbers,
    #[serde(default)]
    limits: LimitNumbers,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum RowKind {
    #[default]
    Revolute,
    Prismatic,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Reference {
    #[default]
    Com,
    Frame,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct DhNumbers {
    alpha: f64,
    a: f64,
    d: f64,
    theta: f64,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct PlacementNumbers {
    xyz: [f64; 3],
    rpy: [f64; 3],
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct InertiaNumbers {
    xx: f64,
    yy: f64,
    zz: f64,
    xy: f64,
    xz: f64,
    yz: f64,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct SpringNumbers {
    stiffness: f64,
    rest: f64,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct FrictionNumbers {
    viscous: f64,
    coulomb: f64,
    coulomb_velocity: Option<f64>,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct LimitNumbers {
    lower: Option<f64>,
    upper: Option<f64>,
    velocity: Option<f64>,
    effort: Option<f64>,
}

/// Reads a robot from TOML text.
///
/// # Errors
/// [`RobotError::InFile`] without a path, with the line where it is known.
pub fn parse(text: &str, options: LoadOptions) -> Result<Robot, RobotError> {
    let line_of = |offset: usize| 1 + text.bytes().take(offset).filter(|&byte| byte == b'\n').count();
    let at = |line: Option<usize>, error| RobotError::InFile {
        path: PathBuf::new(),
        line,
        error: Box::new(error),
    };
    let file: RobotFile = toml::from_str(text).map_err(|error| {
        let line = error.span().map(|span| line_of(span.start));
        let remedy = if error.message().starts_with("missing field") { "; add it" } else { "" };
        at(line, RobotError::Malformed { message: format!("{}{remedy}", error.message().trim_end()) })
    })?;
    let line_of_joint = |name: &str| {
        let row = file.joints.iter().rev().find(|row| row.name.get_ref() == name);
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
        at(line, error)
    };
    let mut builder = Robot::builder(&file.name).options(options);
    if let Some(gravity) = &file.gravity {
        builder = builder.gravity(*gravity.get_ref());
    }
    for (index, row) in file.joints.iter().enumerate() {
        builder = builder
            .joint(row.spec(index, &file).map_err(|error| at(line_of_joint(row.name.get_ref()), error))?);
    }
    if let Some(rows) = &file.armature {
        builder =
            builder.armature_matrix(armature_matrix(rows.get_ref(), file.joints.len()).map_err(located)?);
    }
    builder.build().map_err(located)
}

fn armature_matrix(rows: &[Vec<f64>], n: usize) -> Result<DMatrix<f64>, RobotError> {
    match rows.iter().find(|row| row.len() != rows.len()) {
        Some(row) => {
            let problem = format!("has {} rows and a row of {} numbers", rows.len(), row.len());
            Err(RobotError::BadArmature { problem, n })
        }
        None => Ok(DMatrix::from_fn(rows.len(), rows.len(), |i, j| rows[i][j])),
    }
}

impl JointRow {
    fn spec(&self, index: usize, file: &RobotFile) -> Result<JointSpec, RobotError> {
        let name = self.name.get_ref();
        if name == "world" {
            let message = "a joint is called 'world', which stands for the base; give it another name".into();
            return Err(RobotError::Malformed { message });
        }
        let kind = match self.kind {
            RowKind::Revolute => JointKind::Revolute,
            RowKind::Prismatic => JointKind::Prismatic,
        };
        let friction = &self.friction;
        let infinity = f64::INFINITY;
        let mut spec = JointSpec::new(name.clone(), kind)
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
        let before = index.checked_sub(1).and_then(|i| file.joints.get(i));
        let parent = self.parent.as_deref().or(before.map(|row| row.name.get_ref().as_str()));
        let parent = parent.filter(|&parent| parent != "world");
        if let Some(parent) = parent {
            spec = spec.on(parent);
        }
        let misplaced = |key, convention| RobotError::Malformed {
            message: format!(
                "joint '{name}' has the key `{key}`, which goes with convention = \"{convention}\""
            ),
        };
        let convention = match file.convention {
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
        let parent_row = file.joints.iter().find(|row| Some(row.name.get_ref().as_str()) == parent);
        let parent_numbers = parent_row.map(JointRow::dh_row);
        Ok(dh::place(spec, convention, &self.dh_row(), parent_numbers.as_ref()))
    }

    fn dh_row(&self) -> DhRow {
        let DhNumbers { alpha, a, d, theta } = self.dh.unwrap_or_default();
        DhRow { alpha, a, d, theta }
    }

    fn link(&self) -> LinkInertia {
        let i = &self.inertia;
        let matrix = Matrix3::new(i.xx, i.xy, i.xz, i.xy, i.yy, i.yz, i.xz, i.yz, i.zz);
        match self.inertia_about {
            Reference::Com => LinkInertia::about_com(self.mass, self.com, matrix),
            Reference::Frame => LinkInertia::about_origin(self.mass, self.com, matrix),
        }
    }
}
