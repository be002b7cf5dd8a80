//! The key `robot`: a file, or a table with a file and changes of the robot in it.

use super::document::{Fault, Table};
use super::error::ProblemFileCause;
use costate::robot::{Friction, Limits, LinkInertia, LoadOptions, Robot, RobotEdit};
use std::path::Path;

const ROBOT: &[&str] =
    &["file", "gravity", "armature", "friction", "limits", "payload", "lock", "reduced_to"];
const FRICTION: &[&str] = &["viscous", "coulomb", "coulomb_velocity"];
const LIMITS: &[&str] = &["lower", "upper", "velocity", "effort"];
const PAYLOAD: &[&str] = &["frame", "mass", "com", "inertia"];
const INERTIA: &[&str] = &["xx", "yy", "zz", "xy", "xz", "yz"];

/// A robot file, and what is changed of the robot, with the keys that say so.
pub(super) struct RobotTable {
    pub file: String,
    edits: Vec<(&'static str, RobotEdit)>,
}

/// Reads the key `robot` of the file.
pub(super) fn read(root: &Table<'_>) -> Result<RobotTable, Fault> {
    if !root.has_table("robot") {
        let file = root.need("robot", root.string("robot")?)?;
        return Ok(RobotTable { file, edits: Vec::new() });
    }
    let table = root.need("robot", root.table("robot")?)?;
    table.only(ROBOT)?;
    let mut edits = Vec::new();
    if let Some(gravity) = triple(&table, "gravity")? {
        edits.push(("gravity", RobotEdit::Gravity(gravity)));
    }
    for (joint, armature) in table.numbers_by_name("armature")? {
        edits.push(("armature", RobotEdit::Armature(joint, armature)));
    }
    for (joint, law) in table.tables_by_name("friction", FRICTION)? {
        edits.push(("friction", RobotEdit::Friction(joint, friction(&law)?)));
    }
    for (joint, range) in table.tables_by_name("limits", LIMITS)? {
        edits.push(("limits", RobotEdit::Limits(joint, limits(&range)?)));
    }
    for load in table.tables("payload", PAYLOAD)? {
        let frame = load.need("frame", load.string("frame")?)?;
        edits.push(("payload", RobotEdit::Payload(frame, payload(&load)?)));
    }
    let locked = table.numbers_by_name("lock")?;
    if !locked.is_empty() {
        edits.push(("lock", RobotEdit::Lock(locked)));
    }
    let kept = table.list("reduced_to", "a list of names of joints", super::document::string)?;
    if let Some(kept) = kept {
        edits.push(("reduced_to", RobotEdit::ReducedTo(kept)));
    }
    Ok(RobotTable { file: table.need("file", table.string("file")?)?, edits })
}

fn friction(table: &Table<'_>) -> Result<Friction, Fault> {
    Ok(Friction {
        viscous: table.number("viscous")?.unwrap_or(0.0),
        coulomb: table.number("coulomb")?.unwrap_or(0.0),
        coulomb_velocity: table.number("coulomb_velocity")?.unwrap_or(Friction::DEFAULT_COULOMB_VELOCITY),
    })
}

fn limits(table: &Table<'_>) -> Result<Limits, Fault> {
    Ok(Limits {
        lower: table.number("lower")?.unwrap_or(f64::NEG_INFINITY),
        upper: table.number("upper")?.unwrap_or(f64::INFINITY),
        velocity: table.number("velocity")?.unwrap_or(f64::INFINITY),
        effort: table.number("effort")?.unwrap_or(f64::INFINITY),
    })
}

fn payload(table: &Table<'_>) -> Result<LinkInertia, Fault> {
    let mass = table.need("mass", table.number("mass")?)?;
    let com = triple(table, "com")?.unwrap_or_default();
    let mut entries = [0.0; 6];
    if let Some(inertia) = table.table("inertia")? {
        inertia.only(INERTIA)?;
        for (entry, key) in entries.iter_mut().zip(INERTIA) {
            *entry = inertia.number(key)?.unwrap_or(0.0);
        }
    }
    Ok(LinkInertia::from_entries(mass, com, entries))
}

fn triple(table: &Table<'_>, name: &str) -> Result<Option<[f64; 3]>, Fault> {
    let Some(numbers) = table.numbers(name)? else { return Ok(None) };
    let count = numbers.len();
    let wrong = |_| {
        let found = format!("a list of {count}");
        table.fault(name, ProblemFileCause::WrongType { expected: "a list of 3 numbers", found })
    };
    <[f64; 3]>::try_from(numbers).map(Some).map_err(wrong)
}

impl RobotTable {
    /// Loads the robot file and changes the robot.
    pub fn load(&self, root: &Table<'_>, path: &Path, options: LoadOptions) -> Result<Robot, Fault> {
        let refused = |error| root.fault("robot", ProblemFileCause::Robot(error));
        if self.edits.is_empty() {
            return Robot::from_file_with(path, options).map_err(refused);
        }
        // Changes may mend what strict loading would refuse.
        let lenient = options.strict(false);
        let mut robot = Robot::from_file_with(path, lenient).map_err(refused)?;
        for (key, edit) in &self.edits {
            let table = root.need("robot", root.table("robot")?)?;
            let edited = robot.edited(std::slice::from_ref(edit), lenient);
            robot = edited.map_err(|error| table.fault(key, ProblemFileCause::Robot(error)))?;
        }
        robot.edited(&[], options).map_err(refused)
    }
}
