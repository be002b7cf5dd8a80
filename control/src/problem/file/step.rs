//! The table of a step.

use super::fault::Fault;
use super::table::{Table, string};
use crate::problem::Step;
use crate::problem::file::error::ProblemFileCause;
use toml::de::DeValue;

const STEP: &[&str] = &["stance", "swing", "along", "length", "friction", "clearance", "mirror"];

/// Reads `[step]`.
pub(super) fn step(root: &Table<'_>) -> Result<Option<Step>, Fault> {
    let Some(table) = root.table("step")? else { return Ok(None) };
    table.only(STEP)?;
    let feet = |key: &str| -> Result<Vec<String>, Fault> {
        match table.has_list(key) {
            true => {
                Ok(table.list(key, "the name of a frame, or a list of names", string)?.unwrap_or_default())
            }
            false => Ok(vec![table.need(key, table.string(key)?)?]),
        }
    };
    let length = table.need("length", table.number("length")?)?;
    let along = table.need("along", table.string("along")?)?;
    let mut step = Step::new(&[], &[], &along, length);
    (step.stance, step.swing) = (feet("stance")?, feet("swing")?);
    step.friction = table.number("friction")?.unwrap_or(step.friction);
    step.clearance = table.number("clearance")?.unwrap_or(step.clearance);
    let pair = |value: &DeValue<'_>| -> Option<[String; 2]> {
        let DeValue::Array(entries) = value else { return None };
        let names = entries.iter().map(|entry| match entry.get_ref() {
            DeValue::String(name) => Some(name.to_string()),
            _ => None,
        });
        names.collect::<Option<Vec<_>>>()?.try_into().ok()
    };
    step.mirror = table.list("mirror", "a list of pairs of joint names", pair)?.unwrap_or_default();
    Ok(Some(step))
}

/// Refuses what says where a step ends.
pub(super) fn refuse_ends(root: &Table<'_>) -> Result<(), Fault> {
    let message = "the start and the end of a step follow from each other; remove [end] or [step]";
    match root.has("end") {
        true => Err(root.fault("end", ProblemFileCause::Conflict(message))),
        false => Ok(()),
    }
}
