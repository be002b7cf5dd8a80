//! The tables of vias and of periodic motions.

use super::fault::Fault;
use super::joints::{JointName, indices, joints};
use super::payloads::{PAYLOAD, payload};
use super::table::Table;
use super::tools::tools;
use crate::problem::error::ProblemError;
use crate::problem::key::Key;
use crate::problem::{Problem, Via};

const VIA: &[&str] = &["q", "v", "q_free", "v_free", "stop", "time", "tool", "payload"];
const PERIODIC: &[&str] = &["shift"];

/// A via, before the joints of the robot are known.
pub(super) struct ViaTable {
    via: Via,
    /// `None`: no joint, or all of them where tools are given.
    q_free: Option<Vec<JointName>>,
    v_free: Vec<JointName>,
}

/// Reads `[[via]]`.
pub(super) fn vias(root: &Table<'_>) -> Result<Vec<ViaTable>, Fault> {
    root.tables("via", VIA)?.iter().map(via).collect()
}

fn via(table: &Table<'_>) -> Result<ViaTable, Fault> {
    let mut via = Via::default();
    (via.q, via.v) = (table.numbers("q")?, table.numbers("v")?);
    (via.stop, via.time) = (table.flag("stop")?.unwrap_or(false), table.number("time")?);
    via.tools = tools(table)?;
    if table.has("payload") {
        let loads = table.tables("payload", PAYLOAD)?;
        via.payload = Some(loads.iter().map(payload).collect::<Result<_, _>>()?);
    }
    Ok(ViaTable {
        via,
        q_free: joints(table, "q_free")?,
        v_free: joints(table, "v_free")?.unwrap_or_default(),
    })
}

/// Reads `[periodic]`: the shift, empty for none of any joint.
pub(super) fn periodic(root: &Table<'_>) -> Result<Option<Vec<f64>>, Fault> {
    let Some(table) = root.table("periodic")? else { return Ok(None) };
    table.only(PERIODIC)?;
    Ok(Some(table.numbers("shift")?.unwrap_or_default()))
}

impl ViaTable {
    /// The via of a problem whose robot is known.
    pub fn of(&self, problem: &Problem, number: usize) -> Result<Via, ProblemError> {
        let mut via = self.via.clone();
        let names = |name, list: &[JointName]| indices(problem, Key::via(name, number), list);
        via.q_free = match &self.q_free {
            Some(joints) => names("q_free", joints)?,
            None if via.q.is_some() && !via.tools.is_empty() => (0..problem.robot.dof()).collect(),
            None => Vec::new(),
        };
        via.v_free = names("v_free", &self.v_free)?;
        Ok(via)
    }
}
