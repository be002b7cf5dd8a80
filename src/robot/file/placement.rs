//! Placements in TOML.

use crate::robot::link::Placement;
use serde::Deserialize;

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub(super) struct PlacementNumbers {
    pub(super) xyz: [f64; 3],
    pub(super) rpy: [f64; 3],
}

impl PlacementNumbers {
    pub(super) fn placement(self) -> Placement {
        Placement::from_xyz_rpy(self.xyz, self.rpy)
    }
}
