//! The key `robot`: a file, or a table with a file and changes of the robot in it.

use super::error::ProblemFileCause;
use super::fault::Fault;
use super::nested::triple;
use super::payloads::{PAYLOAD, payload};
use super::table::Table;
use crate::problem::Payload;
use costate::robot::{
    FrameSpec, Friction, Joint, LimitChange, LoadOptions, Placement, Robot, RobotEdit, RobotError, RobotText,
    Wrench, WrenchAxes,
};
use std::path::Path;

const ROBOT: &[&str] = &[
    "file",
    "gravity",
    "armature",
    "friction",
    "floating_base",
    "quaternions",
    "limits",
    "frame",
    "payload",
    "wrench",
    "lock",
    "reduced_to",
];
const FRICTION: &[&str] = &["viscous", "coulomb", "coulomb_velocity"];
const LIMITS: &[&str] = &["lower", "upper", "velocity", "effort"];
const FRAME: &[&str] = &["name", "parent", "placement"];
const PLACEMENT: &[&str] = &["xyz", "rpy"];
const WRENCH: &[&str] = &["frame", "moment", "force", "axes"];
const AXES: [(&str, WrenchAxes); 2] = [("local", WrenchAxes::Local), ("aligned", WrenchAxes::Aligned)];

/// A robot file, and what is changed of the robot.
pub(super) struct RobotTable {
    /// `None` where none is needed and none is named.
    pub file: Option<String>,
    /// The key of the file, and its first byte.
    file_at: (&'static str, Option<usize>),
    /// Whether the friction of the file counts: of all joints of a URDF, where it does not otherwise, or of
    /// none, whatever the file says.
    friction: Option<bool>,
    /// Whether the root link flies, and whether floating joints of the file have quaternions; what is not
    /// said is as the caller asks for.
    floating_base: Option<bool>,
    quaternions: Option<bool>,
    changes: Vec<Change>,
    payloads: Vec<Payload>,
}

/// A change with the key that asks for it.
struct Change {
    key: &'static str,
    /// First byte of what asks for it.
    start: Option<usize>,
    edit: RobotEdit,
}

/// Where the robot comes from.
#[derive(Clone, Copy)]
pub(super) enum Source {
    /// From the file that the key `robot` names.
    File,
    /// From the caller: a file that is named does not count.
    Caller,
}

/// Reads the key `robot` of the file.
pub(super) fn read(root: &Table<'_>, source: Source) -> Result<RobotTable, Fault> {
    let named = |table: &Table<'_>, key: &str, file: Option<String>| match source {
        Source::File => table.need(key, file).map(Some),
        Source::Caller => Ok(None),
    };
    if !root.has_table("robot") {
        let file = named(root, "robot", root.string("robot")?)?;
        let file_at = ("robot", root.start_of("robot"));
        return Ok(RobotTable {
            file,
            file_at,
            friction: None,
            floating_base: None,
            quaternions: None,
            changes: Vec::new(),
            payloads: Vec::new(),
        });
    }
    let table = root.need("robot", root.table("robot")?)?;
    table.only(ROBOT)?;
    let mut changes = Vec::new();
    let mut add = |key, start: Option<usize>, edit: RobotEdit| {
        changes.push(Change { key, start: start.or_else(|| table.start_of(key)), edit });
    };
    if let Some(gravity) = triple(&table, "gravity")? {
        add("gravity", None, RobotEdit::Gravity(gravity));
    }
    for (joint, armature) in table.numbers_by_name("armature")? {
        add("armature", None, RobotEdit::Armature(joint, armature));
    }
    let of_all = if table.has_table("friction") { None } else { table.flag_or_table("friction")? };
    if of_all.is_none() {
        for (joint, law) in table.tables_by_name("friction", FRICTION)? {
            add("friction", None, RobotEdit::Friction(joint, friction(&law)?));
        }
    }
    for (joint, range) in table.tables_by_name("limits", LIMITS)? {
        add("limits", None, RobotEdit::Limits(joint, limits(&range)?));
    }
    for row in table.tables("frame", FRAME)? {
        add("frame", row.start, RobotEdit::Frame(frame(&row)?));
    }
    let mut payloads = Vec::new();
    for load in table.tables("payload", PAYLOAD)? {
        let carried = payload(&load)?;
        add("payload", load.start, RobotEdit::Payload(carried.frame.clone(), carried.inertia));
        payloads.push(carried);
    }
    for row in table.tables("wrench", WRENCH)? {
        let frame = row.need("frame", row.string("frame")?)?;
        let applied = wrench(&row)?;
        if !row.has("force") && !row.has("moment") {
            let message = "has no effect without a force or a moment; give `force`, `moment` or both";
            return Err(row.fault("frame", ProblemFileCause::Conflict(message)));
        }
        add("wrench", row.start, RobotEdit::Wrench(frame, applied));
    }
    let locked = table.numbers_by_name("lock")?;
    if !locked.is_empty() {
        add("lock", None, RobotEdit::Lock(locked));
    }
    let kept = table.list("reduced_to", "a list of names of joints", super::table::string)?;
    if let Some(kept) = kept {
        add("reduced_to", None, RobotEdit::ReducedTo(kept));
    }
    let file = named(&table, "file", table.string("file")?)?;
    let of_urdf = |key: &str| match table.flag(key)? {
        Some(true) if file.as_ref().is_some_and(|file| file.ends_with(".toml")) => {
            let message = "has no effect on a robot in TOML; give its joint type = \"floating\" there";
            Err(table.fault(key, ProblemFileCause::Conflict(message)))
        }
        flag => Ok(flag),
    };
    let [floating_base, quaternions] = [of_urdf("floating_base")?, of_urdf("quaternions")?];
    let file_at = ("robot.file", table.start_of("file"));
    Ok(RobotTable { file, file_at, friction: of_all, floating_base, quaternions, changes, payloads })
}

fn friction(table: &Table<'_>) -> Result<Friction, Fault> {
    Ok(Friction {
        viscous: table.number("viscous")?.unwrap_or(0.0),
        coulomb: table.number("coulomb")?.unwrap_or(0.0),
        coulomb_velocity: table.number("coulomb_velocity")?.unwrap_or(Friction::DEFAULT_COULOMB_VELOCITY),
    })
}

fn limits(table: &Table<'_>) -> Result<LimitChange, Fault> {
    Ok(LimitChange {
        lower: table.number("lower")?,
        upper: table.number("upper")?,
        velocity: table.number("velocity")?,
        effort: table.number("effort")?,
    })
}

fn frame(table: &Table<'_>) -> Result<FrameSpec, Fault> {
    let mut spec = FrameSpec::new(table.need("name", table.string("name")?)?);
    if let Some(parent) = table.string("parent")? {
        spec = spec.on(parent);
    }
    let Some(placement) = table.table("placement")? else { return Ok(spec) };
    placement.only(PLACEMENT)?;
    let [xyz, rpy] = [triple(&placement, "xyz")?, triple(&placement, "rpy")?].map(Option::unwrap_or_default);
    Ok(spec.placed(Placement::from_xyz_rpy(xyz, rpy)))
}

fn wrench(table: &Table<'_>) -> Result<Wrench, Fault> {
    Ok(Wrench {
        moment: triple(table, "moment")?.unwrap_or_default(),
        force: triple(table, "force")?.unwrap_or_default(),
        axes: table.choice("axes", &AXES)?.unwrap_or_default(),
    })
}

impl RobotTable {
    /// The error of the robot file.
    fn refused(&self, root: &Table<'_>, error: RobotError) -> Fault {
        let (key, start) = self.file_at;
        let line = start.map(|start| root.line_at(start));
        Fault { line, key: Some(key.into()), cause: Box::new(ProblemFileCause::Robot(error)) }
    }

    /// The text of the robot file.
    pub fn text(&self, root: &Table<'_>, path: &Path) -> Result<RobotText, Fault> {
        RobotText::from_file(path).map_err(|error| self.refused(root, error))
    }

    /// The options with what the file says.
    pub fn options(&self, options: LoadOptions) -> LoadOptions {
        let options = self.friction.map_or(options, |friction| options.friction(friction));
        let options = self.floating_base.map_or(options, |flies| options.floating_base(flies));
        self.quaternions.map_or(options, |has_them| options.quaternions(has_them))
    }

    /// Loads the robot file and changes the robot.
    pub fn load(&self, root: &Table<'_>, path: &Path, options: LoadOptions) -> Result<Robot, Fault> {
        let refused = |error| self.refused(root, error);
        let options = self.options(options);
        if self.changes.is_empty() && self.friction != Some(false) {
            return Robot::from_file_with(path, options).map_err(refused);
        }
        // Changes may mend what strict loading would refuse.
        let lenient = options.strict(false);
        let robot = Robot::from_file_with(path, lenient).map_err(refused)?;
        let robot = self.changed(root, &robot, lenient)?;
        robot.edited(&[], options).map_err(refused)
    }

    /// The bodies of `[[robot.payload]]`.
    pub fn payloads(&self) -> &[Payload] {
        &self.payloads
    }

    /// A robot with the changes.
    pub fn changed(&self, root: &Table<'_>, robot: &Robot, options: LoadOptions) -> Result<Robot, Fault> {
        let mut edits: Vec<RobotEdit> = Vec::new();
        if self.friction == Some(false) {
            let off = |joint: &Joint| RobotEdit::Friction(joint.name.clone(), Friction::default());
            edits.extend(robot.joints().iter().map(off));
        }
        let first_change = edits.len();
        edits.extend(self.changes.iter().map(|change| change.edit.clone()));
        robot.edited(&edits, options).map_err(|error| {
            // The first change that cannot be made.
            let fails = |end: usize| robot.edited(&edits[..end], options).is_err();
            let change = first(edits.len().saturating_sub(1), |k| fails(k + 1));
            let change = change.checked_sub(first_change).and_then(|change| self.changes.get(change));
            Fault {
                line: change.and_then(|change| change.start).map(|start| root.line_at(start)),
                key: Some(change.map_or("robot".into(), |change| format!("robot.{}", change.key))),
                cause: Box::new(ProblemFileCause::Robot(error)),
            }
        })
    }
}

/// The least number for which it is true, if that is so from there on; at most `last`.
fn first(last: usize, holds: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, last);
    while low < high {
        let middle = low.midpoint(high);
        if holds(middle) { high = middle } else { low = middle + 1 }
    }
    low
}
