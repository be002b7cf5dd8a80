//! The tables of what a motion does beside its ends: what tools keep, costs of tools, references, obstacles.

use super::error::ProblemFileCause;
use super::fault::Fault;
use super::nested::triple;
use super::obstacles::obstacles;
use super::references::references;
use super::table::Table;
use super::tools::{Z, pose, rotation, tool, tools};
use crate::problem::task::Task;
use crate::problem::tools::{Keep, Kept, ToolCost};

const COST: &[&str] = &[
    "frame",
    "offset",
    "xyz",
    "rpy",
    "rotation",
    "quaternion",
    "axis",
    "along",
    "yaw",
    "position_weight",
    "orientation_weight",
];
/// What a tool can keep, with the keys of each kind.
const KEPT: [(&str, &[&str]); 7] = [
    ("plane", &["kind", "frame", "offset", "through", "normal", "distance"]),
    ("line", &["kind", "frame", "offset", "through", "along", "distance"]),
    ("box", &["kind", "frame", "offset", "min", "max"]),
    ("axis", &["kind", "frame", "offset", "axis", "along", "angle"]),
    ("orientation", &["kind", "frame", "offset", "rpy", "rotation", "quaternion", "angle"]),
    ("speed", &["kind", "frame", "offset", "speed"]),
    ("acceleration", &["kind", "frame", "offset", "acceleration"]),
];
const KEEP: &[&str] = &[
    "kind",
    "frame",
    "offset",
    "through",
    "normal",
    "along",
    "distance",
    "min",
    "max",
    "axis",
    "angle",
    "rpy",
    "rotation",
    "quaternion",
    "speed",
    "acceleration",
];

/// Reads the tables of tools and obstacles.
pub(super) fn read(root: &Table<'_>) -> Result<Task, Fault> {
    let tools_of = |name: &str| root.table(name)?.map_or(Ok(Vec::new()), |state| tools(&state));
    let (start_tools, end_tools) = (tools_of("start")?, tools_of("end")?);
    let mut tool_costs = Vec::new();
    if let Some(costs) = root.table("cost")? {
        for table in costs.tables("tool", COST)? {
            let pose = pose(&table)?;
            let weight = |name: &str, is_given: bool, message| match table.number(name)? {
                Some(weight) if weight > 0.0 && !is_given => {
                    Err(table.fault(name, ProblemFileCause::Conflict(message)))
                }
                weight => Ok(weight.unwrap_or(1.0)),
            };
            let position = weight(
                "position_weight",
                pose.position.is_some(),
                "weighs nothing without a position; give xyz, or remove it",
            )?;
            let orientation = weight(
                "orientation_weight",
                pose.orientation.is_some(),
                "weighs nothing without an orientation; give rpy, rotation, quaternion, along or yaw, or remove it",
            )?;
            tool_costs.push(ToolCost::new(pose, position, orientation));
        }
    }
    let references = root.table("cost")?.map_or(Ok(Vec::new()), |costs| references(&costs))?;
    let keep = root.tables("keep", KEEP)?.iter().map(keep).collect::<Result<_, _>>()?;
    let (obstacles, collision) = obstacles(root)?;
    Ok(Task {
        start_tools,
        end_tools,
        keep,
        tool_costs,
        references,
        obstacles,
        collision,
        payloads: Vec::new(),
    })
}

fn keep(table: &Table<'_>) -> Result<Keep, Fault> {
    let kind = table.kind(&KEPT)?;
    let needed = |name: &str| table.need(name, triple(table, name)?);
    let tolerance = |name: &str| Ok::<_, Fault>(table.number(name)?.unwrap_or(0.0));
    let infinite = |name: &str, none: f64| Ok::<_, Fault>(triple(table, name)?.unwrap_or([none; 3]));
    let kept = match kind {
        "plane" => {
            let (through, normal) = (needed("through")?, needed("normal")?);
            Kept::Plane { through, normal, distance: tolerance("distance")? }
        }
        "line" => Kept::Line {
            through: needed("through")?,
            along: needed("along")?,
            distance: tolerance("distance")?,
        },
        "box" => Kept::Box { min: infinite("min", f64::NEG_INFINITY)?, max: infinite("max", f64::INFINITY)? },
        "axis" => Kept::Axis {
            axis: triple(table, "axis")?.unwrap_or(Z),
            along: needed("along")?,
            angle: tolerance("angle")?,
        },
        "orientation" => {
            let rotation = table.need("rpy", rotation(table)?)?;
            Kept::Orientation { rotation, angle: tolerance("angle")? }
        }
        "speed" => Kept::Speed { max: table.need("speed", table.number("speed")?)? },
        _ => Kept::Acceleration { max: table.need("acceleration", table.number("acceleration")?)? },
    };
    Ok(Keep::new(tool(table)?, kept))
}
