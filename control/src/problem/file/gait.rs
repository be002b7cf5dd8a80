//! The table of a gait.

use super::fault::Fault;
use super::table::{Table, number, string};
use crate::problem::file::error::ProblemFileCause;
use crate::problem::{Gait, SoleContact};
use toml::de::DeValue;

const KEYS: &[&str] = &[
    "stance",
    "swing",
    "along",
    "length",
    "friction",
    "clearance",
    "mirror",
    "sole",
    "double_support",
    "trailing",
    "sole_width",
    "flipped",
    "width",
    "symmetrise",
];

/// Reads `[gait]`: the gait, and whether its robot is replaced by the mean with its mirror image.
pub(super) fn gait(root: &Table<'_>) -> Result<Option<(Gait, bool)>, Fault> {
    let Some(table) = root.table("gait")? else { return Ok(None) };
    table.only(KEYS)?;
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
    let mut gait = Gait::new(&[], &[], &along, length);
    (gait.stance, gait.swing) = (feet("stance")?, feet("swing")?);
    gait.friction = table.number("friction")?.unwrap_or(gait.friction);
    gait.clearance = table.number("clearance")?.unwrap_or(gait.clearance);
    let pair = |value: &DeValue<'_>| -> Option<[String; 2]> {
        let DeValue::Array(entries) = value else { return None };
        let names = entries.iter().map(|entry| match entry.get_ref() {
            DeValue::String(name) => Some(name.to_string()),
            _ => None,
        });
        names.collect::<Option<Vec<_>>>()?.try_into().ok()
    };
    gait.mirror = table.list("mirror", "a list of pairs of joint names", pair)?.unwrap_or_default();
    gait.sole = table.value("sole", "a list of two numbers, x of heel and toe", two)?;
    gait.double_support = table.number("double_support")?;
    let contact = table.value("trailing", "\"toe\" or \"flat\"", contact)?;
    gait.trailing = contact.unwrap_or(gait.trailing);
    gait.sole_width = table.number("sole_width")?.unwrap_or(gait.sole_width);
    gait.width = table.number("width")?.unwrap_or(gait.width);
    gait.flipped = table.list("flipped", "a list of joint names", string)?.unwrap_or_default();
    Ok(Some((gait, table.flag("symmetrise")?.unwrap_or(false))))
}

fn contact(value: &DeValue<'_>) -> Option<SoleContact> {
    let DeValue::String(word) = value else { return None };
    match &**word {
        "toe" => Some(SoleContact::Toe),
        "flat" => Some(SoleContact::Flat),
        _ => None,
    }
}

/// Two numbers.
fn two(value: &DeValue<'_>) -> Option<[f64; 2]> {
    let DeValue::Array(entries) = value else { return None };
    let numbers = entries.iter().map(|entry| number(entry.get_ref()));
    numbers.collect::<Option<Vec<_>>>()?.try_into().ok()
}

/// Refuses what says where a step ends.
pub(super) fn refuse_ends(root: &Table<'_>) -> Result<(), Fault> {
    let message = "the start and the end of a step follow from each other; remove [end] or [gait]";
    match root.has("end") {
        true => Err(root.fault("end", ProblemFileCause::Conflict(message))),
        false => Ok(()),
    }
}
