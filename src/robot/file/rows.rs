//! The keys of a robot in TOML.

use super::constraints::ConstraintTable;
use super::placement::PlacementNumbers;
use crate::robot::dh::DhRow;
use crate::robot::link::LinkInertia;
use nalgebra::Matrix3;
use serde::Deserialize;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RobotFile {
    pub(super) name: String,
    pub(super) gravity: Option<Spanned<[f64; 3]>>,
    #[serde(default)]
    pub(super) convention: TableConvention,
    #[serde(default, rename = "sources")]
    pub(super) _sources: Vec<String>,
    pub(super) armature: Option<Spanned<Vec<Vec<f64>>>>,
    #[serde(default, rename = "joint")]
    pub(super) joints: Vec<JointRow>,
    #[serde(default, rename = "frame")]
    pub(super) frames: Vec<FrameRow>,
    #[serde(default, rename = "wrench")]
    pub(super) wrenches: Vec<WrenchRow>,
    #[serde(default, rename = "constraint")]
    pub(super) constraints: Vec<ConstraintTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct FrameRow {
    pub(super) name: Spanned<String>,
    pub(super) parent: Option<String>,
    #[serde(default)]
    pub(super) placement: PlacementNumbers,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct WrenchRow {
    pub(super) frame: Spanned<String>,
    #[serde(default)]
    pub(super) moment: [f64; 3],
    #[serde(default)]
    pub(super) force: [f64; 3],
    #[serde(default)]
    pub(super) axes: RowAxes,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum RowAxes {
    #[default]
    Local,
    Aligned,
}

#[derive(Clone, Copy, Default, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum TableConvention {
    ModifiedDh,
    StandardDh,
    #[default]
    Placements,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct JointRow {
    pub(super) name: Spanned<String>,
    #[serde(default, rename = "type")]
    pub(super) kind: RowKind,
    pub(super) parent: Option<String>,
    pub(super) dh: Option<DhNumbers>,
    pub(super) placement: Option<PlacementNumbers>,
    pub(super) axis: Option<[f64; 3]>,
    #[serde(default)]
    pub(super) mass: f64,
    #[serde(default)]
    pub(super) com: [f64; 3],
    #[serde(default)]
    pub(super) inertia: InertiaNumbers,
    #[serde(default)]
    pub(super) inertia_about: Reference,
    #[serde(default)]
    pub(super) armature: f64,
    #[serde(default)]
    pub(super) spring: SpringNumbers,
    #[serde(default)]
    pub(super) friction: FrictionNumbers,
    #[serde(default)]
    pub(super) limits: LimitNumbers,
    pub(super) mimic: Option<MimicNumbers>,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum RowKind {
    #[default]
    Revolute,
    Prismatic,
    Floating,
    Spherical,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Reference {
    #[default]
    Com,
    Frame,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub(super) struct DhNumbers {
    pub(super) alpha: f64,
    pub(super) a: f64,
    pub(super) d: f64,
    pub(super) theta: f64,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub(super) struct InertiaNumbers {
    pub(super) xx: f64,
    pub(super) yy: f64,
    pub(super) zz: f64,
    pub(super) xy: f64,
    pub(super) xz: f64,
    pub(super) yz: f64,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub(super) struct SpringNumbers {
    pub(super) stiffness: f64,
    pub(super) rest: f64,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub(super) struct FrictionNumbers {
    pub(super) viscous: f64,
    pub(super) coulomb: f64,
    pub(super) coulomb_velocity: Option<f64>,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub(super) struct LimitNumbers {
    pub(super) lower: Option<f64>,
    pub(super) upper: Option<f64>,
    pub(super) velocity: Option<f64>,
    pub(super) effort: Option<f64>,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct MimicNumbers {
    pub(super) joint: String,
    #[serde(default = "one")]
    pub(super) ratio: f64,
    #[serde(default)]
    pub(super) offset: f64,
}

fn one() -> f64 {
    1.0
}

impl JointRow {
    pub(super) fn name(&self) -> &str {
        self.name.get_ref()
    }

    pub(super) fn dh_row(&self) -> DhRow {
        let DhNumbers { alpha, a, d, theta } = self.dh.unwrap_or_default();
        DhRow { alpha, a, d, theta }
    }

    pub(super) fn link(&self) -> LinkInertia {
        let i = &self.inertia;
        let matrix = Matrix3::new(i.xx, i.xy, i.xz, i.xy, i.yy, i.yz, i.xz, i.yz, i.zz);
        match self.inertia_about {
            Reference::Com => LinkInertia::about_com(self.mass, self.com, matrix),
            Reference::Frame => LinkInertia::about_origin(self.mass, self.com, matrix),
        }
    }
}
