//! Constraints of a robot in TOML.

use super::placement::PlacementNumbers;
use crate::robot::constraint::{ConstraintRow, ConstraintSpec};
use crate::robot::error::RobotError;
use crate::robot::printable::printable;
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct ConstraintTable {
    pub(super) name: Spanned<String>,
    #[serde(rename = "type")]
    kind: Option<TableKind>,
    frame: Option<String>,
    to: Option<String>,
    placement: Option<PlacementNumbers>,
    to_placement: Option<PlacementNumbers>,
    rows: Option<Vec<TableRow>>,
    length: Option<f64>,
    joints: Option<BTreeMap<String, f64>>,
    constant: Option<f64>,
}

#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
enum TableKind {
    Rows,
    Pinned,
    Rigid,
    Distance,
    Coupling,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum TableRow {
    X,
    Y,
    Z,
    TurnX,
    TurnY,
    TurnZ,
}

impl TableKind {
    fn name(self) -> &'static str {
        match self {
            Self::Rows => "rows",
            Self::Pinned => "pinned",
            Self::Rigid => "rigid",
            Self::Distance => "distance",
            Self::Coupling => "coupling",
        }
    }

    /// The keys that it needs, then those that it may have, besides `name` and `type`.
    fn keys(self) -> [&'static [&'static str]; 2] {
        let may = &["to", "placement", "to_placement"];
        match self {
            Self::Rows => [&["frame", "rows"], may],
            Self::Pinned | Self::Rigid => [&["frame"], may],
            Self::Distance => [&["frame", "length"], may],
            Self::Coupling => [&["joints"], &["constant"]],
        }
    }
}

impl TableRow {
    fn row(self) -> ConstraintRow {
        match self {
            Self::X => ConstraintRow::X,
            Self::Y => ConstraintRow::Y,
            Self::Z => ConstraintRow::Z,
            Self::TurnX => ConstraintRow::TurnX,
            Self::TurnY => ConstraintRow::TurnY,
            Self::TurnZ => ConstraintRow::TurnZ,
        }
    }
}

impl ConstraintTable {
    /// # Errors
    /// [`RobotError::Malformed`] for keys that its type needs or does not have.
    pub(super) fn spec(&self) -> Result<ConstraintSpec, RobotError> {
        let kind = self.kind.unwrap_or(TableKind::Rows);
        let [needed, allowed] = kind.keys();
        let given = [
            ("frame", self.frame.is_some()),
            ("to", self.to.is_some()),
            ("placement", self.placement.is_some()),
            ("to_placement", self.to_placement.is_some()),
            ("rows", self.rows.is_some()),
            ("length", self.length.is_some()),
            ("joints", self.joints.is_some()),
            ("constant", self.constant.is_some()),
        ];
        for (key, given) in given {
            let problem = match given {
                false if needed.contains(&key) => "needs the key",
                true if !needed.contains(&key) && !allowed.contains(&key) => "does not take the key",
                _ => continue,
            };
            let (name, kind) = (printable(self.name.get_ref()), kind.name());
            let message = format!("constraint '{name}' of type \"{kind}\" {problem} `{key}`");
            return Err(RobotError::malformed(message));
        }
        let name = self.name.get_ref().as_str();
        let world = || "world".to_owned();
        let (frame, to) = (self.frame.clone().unwrap_or_else(world), self.to.clone().unwrap_or_else(world));
        let spec = match kind {
            TableKind::Rows => {
                let rows: Vec<_> = self.rows.iter().flatten().map(|row| row.row()).collect();
                ConstraintSpec::rows(name, &frame, &to, &rows)
            }
            TableKind::Pinned => ConstraintSpec::pinned(name, &frame, &to),
            TableKind::Rigid => ConstraintSpec::rigid(name, &frame, &to),
            TableKind::Distance => {
                ConstraintSpec::distance(name, &frame, &to, self.length.unwrap_or_default())
            }
            TableKind::Coupling => {
                let terms = self.joints.iter().flatten();
                let terms: Vec<_> = terms.map(|(joint, &factor)| (joint.as_str(), factor)).collect();
                ConstraintSpec::coupling(name, &terms, self.constant.unwrap_or_default())
            }
        };
        let placed = |numbers: Option<PlacementNumbers>| numbers.unwrap_or_default().placement();
        Ok(spec.placed(placed(self.placement)).to_placed(placed(self.to_placement)))
    }
}
