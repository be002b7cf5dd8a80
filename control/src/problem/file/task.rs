//! The tables of tools and obstacles.

use super::error::ProblemFileCause;
use super::fault::Fault;
use super::robot::triple;
use super::table::{Table, number, string};
use crate::problem::obstacles::{BodyPairs, Collision, LinkCapsule, Obstacle, Shape};
use crate::problem::references::{JointReference, Reference, ToolReference};
use crate::problem::task::Task;
use crate::problem::tools::{self, Keep, Kept, Tool, ToolCost, ToolOrientation, ToolPose};
use costate::robot::Placement;
use nalgebra::Rotation3;
use toml::de::DeValue;

const POSE: &[&str] = &["frame", "offset", "xyz", "rpy", "rotation", "axis", "along"];
const COST: &[&str] =
    &["frame", "offset", "xyz", "rpy", "rotation", "axis", "along", "position_weight", "orientation_weight"];
/// A reference of joints, and one of a tool.
const JOINT_REFERENCE: &[&str] = &["times", "positions", "velocities", "weights"];
const TOOL_REFERENCE: &[&str] = &[
    "frame",
    "offset",
    "times",
    "positions",
    "velocities",
    "orientations",
    "position_weight",
    "orientation_weight",
];
const REFERENCE: &[&str] = &[
    "times",
    "positions",
    "velocities",
    "weights",
    "frame",
    "offset",
    "orientations",
    "position_weight",
    "orientation_weight",
];
const COLLISION: &[&str] = &["capsules", "radius", "capsule", "margin", "pairs", "except"];
const CAPSULE: &[&str] = &["name", "frame", "from", "to", "radius"];

/// What a tool can keep, with the keys of each kind.
const KEPT: [(&str, &[&str]); 7] = [
    ("plane", &["kind", "frame", "offset", "through", "normal", "distance"]),
    ("line", &["kind", "frame", "offset", "through", "along", "distance"]),
    ("box", &["kind", "frame", "offset", "min", "max"]),
    ("axis", &["kind", "frame", "offset", "axis", "along", "angle"]),
    ("orientation", &["kind", "frame", "offset", "rpy", "rotation", "angle"]),
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
    "speed",
    "acceleration",
];

/// The shapes of obstacles, with the keys of each.
const SHAPES: [(&str, &[&str]); 4] = [
    ("sphere", &["kind", "name", "xyz", "radius"]),
    ("capsule", &["kind", "name", "from", "to", "radius"]),
    ("box", &["kind", "name", "xyz", "rpy", "size"]),
    ("half_space", &["kind", "name", "xyz", "normal"]),
];
const OBSTACLE: &[&str] = &["kind", "name", "xyz", "rpy", "size", "normal", "from", "to", "radius"];

/// Reads the tables of tools and obstacles.
pub(super) fn read(root: &Table<'_>) -> Result<Task, Fault> {
    let tools_of = |name: &str| root.table(name)?.map_or(Ok(Vec::new()), |state| tools(&state));
    let (start_tools, end_tools) = (tools_of("start")?, tools_of("end")?);
    let mut tool_costs = Vec::new();
    if let Some(costs) = root.table("cost")? {
        for table in costs.tables("tool", COST)? {
            let weight = |name: &str| Ok::<_, Fault>(table.number(name)?.unwrap_or(1.0));
            let weights = [weight("position_weight")?, weight("orientation_weight")?];
            tool_costs.push(ToolCost::new(pose(&table)?, weights[0], weights[1]));
        }
    }
    let mut references = Vec::new();
    if let Some(costs) = root.table("cost")? {
        references = costs.tables("reference", REFERENCE)?.iter().map(reference).collect::<Result<_, _>>()?;
    }
    let keep = root.tables("keep", KEEP)?.iter().map(keep).collect::<Result<_, _>>()?;
    let obstacles = root.tables("obstacle", OBSTACLE)?;
    let obstacles = obstacles.iter().enumerate().map(|(k, table)| obstacle(table, k));
    let obstacles = obstacles.collect::<Result<_, _>>()?;
    let collision = root.table("collision")?.as_ref().map(collision).transpose()?;
    Ok(Task { start_tools, end_tools, keep, tool_costs, references, obstacles, collision })
}

/// The tools of a state.
pub(super) fn tools(state: &Table<'_>) -> Result<Vec<ToolPose>, Fault> {
    state.tables("tool", POSE)?.iter().map(pose).collect()
}

fn tool(table: &Table<'_>) -> Result<Tool, Fault> {
    let frame = table.need("frame", table.string("frame")?)?;
    Ok(Tool::new(frame).with_offset(triple(table, "offset")?.unwrap_or_default()))
}

fn pose(table: &Table<'_>) -> Result<ToolPose, Fault> {
    let axis = triple(table, "axis")?;
    let along = triple(table, "along")?;
    let conflict = |key: &str, message| Err(table.fault(key, ProblemFileCause::Conflict(message)));
    let orientation = match (rotation(table)?, axis, along) {
        (Some(_), _, Some(_)) => {
            return conflict(
                "along",
                "the orientation is given by rpy or rotation already; keep one of them",
            );
        }
        (_, Some(_), None) => {
            return conflict("axis", "needs `along`, the direction in the world that this axis shall have");
        }
        (Some(rotation), None, None) => Some(ToolOrientation::Full(rotation)),
        (None, axis, Some(along)) => Some(ToolOrientation::Axis { axis: axis.unwrap_or(Z), along }),
        (None, None, None) => None,
    };
    Ok(ToolPose { tool: tool(table)?, position: triple(table, "xyz")?, orientation })
}

/// The axis of a tool, if none is given.
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// An orientation by roll, pitch and yaw, or by three rows.
fn rotation(table: &Table<'_>) -> Result<Option<Rotation3<f64>>, Fault> {
    let rows = table.list("rotation", "three lists of three numbers", |row| match row {
        DeValue::Array(entries) => {
            let numbers: Option<Vec<f64>> = entries.iter().map(|entry| number(entry.get_ref())).collect();
            <[f64; 3]>::try_from(numbers?).ok()
        }
        _ => None,
    })?;
    match (triple(table, "rpy")?, rows) {
        (Some(_), Some(_)) => {
            let message = "the orientation is given by rpy already; keep one of the two";
            Err(table.fault("rotation", ProblemFileCause::Conflict(message)))
        }
        (Some(rpy), None) => {
            if !rpy.iter().all(|angle| angle.is_finite()) {
                return Err(table.fault("rpy", ProblemFileCause::Conflict("must be finite")));
            }
            Ok(Some(Rotation3::from_matrix_unchecked(Placement::from_xyz_rpy([0.0; 3], rpy).rotation)))
        }
        (None, Some(rows)) => {
            let wrong = "give three rows that are orthonormal and right-handed to 1e-6";
            let found = <[[f64; 3]; 3]>::try_from(rows).ok().and_then(tools::rotation);
            found.map(Some).ok_or_else(|| table.fault("rotation", ProblemFileCause::Conflict(wrong)))
        }
        (None, None) => Ok(None),
    }
}

/// The kind of a table, which must have no other keys than those of this kind.
fn kind(table: &Table<'_>, kinds: &[(&'static str, &'static [&'static str])]) -> Result<&'static str, Fault> {
    let choices: Vec<_> = kinds.iter().map(|&(kind, keys)| (kind, (kind, keys))).collect();
    let (kind, keys) = table.need("kind", table.choice("kind", &choices)?)?;
    table.only(keys)?;
    Ok(kind)
}

fn keep(table: &Table<'_>) -> Result<Keep, Fault> {
    let kind = kind(table, &KEPT)?;
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

/// A reference of a tool if it has a frame, else one of joints.
pub(super) fn reference(table: &Table<'_>) -> Result<Reference, Fault> {
    table.only(REFERENCE)?;
    let times = table.need("times", table.numbers("times")?)?;
    if !table.has("frame") {
        table.only(JOINT_REFERENCE)?;
        let rows =
            |name: &str| table.list(name, "a list of lists of numbers, one list for each time", numbers);
        let positions = table.need("positions", rows("positions")?)?;
        let weights = table.need("weights", table.numbers("weights")?)?;
        let velocities = rows("velocities")?;
        return Ok(Reference::Joints(JointReference { times, positions, velocities, weights }));
    }
    table.only(TOOL_REFERENCE)?;
    let triples = |name: &str| {
        let read = |value: &DeValue<'_>| <[f64; 3]>::try_from(numbers(value)?).ok();
        table.list(name, "a list of lists of three numbers, one list for each time", read)
    };
    let weight = |name: &str| Ok::<_, Fault>(table.number(name)?.unwrap_or(1.0));
    let turn = |rpy| Rotation3::from_matrix_unchecked(Placement::from_xyz_rpy([0.0; 3], rpy).rotation);
    let orientations = triples("orientations")?.map(|list| list.into_iter().map(turn).collect());
    Ok(Reference::Tool(ToolReference {
        tool: tool(table)?,
        times,
        positions: triples("positions")?,
        velocities: triples("velocities")?,
        orientations,
        position_weight: weight("position_weight")?,
        orientation_weight: weight("orientation_weight")?,
    }))
}

/// A list of numbers.
fn numbers(value: &DeValue<'_>) -> Option<Vec<f64>> {
    let DeValue::Array(entries) = value else { return None };
    entries.iter().map(|entry| number(entry.get_ref())).collect()
}

/// The obstacle of this number, from 0.
pub(super) fn obstacle(table: &Table<'_>, number: usize) -> Result<Obstacle, Fault> {
    let name = table.string("name")?.unwrap_or_else(|| format!("obstacle {}", number + 1));
    Ok(Obstacle::new(name, shape(table)?))
}

fn shape(table: &Table<'_>) -> Result<Shape, Fault> {
    let kind = kind(table, &SHAPES)?;
    let needed = |name: &str| table.need(name, triple(table, name)?);
    let radius = || table.need("radius", table.number("radius")?);
    Ok(match kind {
        "sphere" => Shape::Sphere { centre: needed("xyz")?, radius: radius()? },
        "capsule" => Shape::Capsule { from: needed("from")?, to: needed("to")?, radius: radius()? },
        "box" => {
            let rpy = triple(table, "rpy")?.unwrap_or_default();
            Shape::Box { placement: Placement::from_xyz_rpy(needed("xyz")?, rpy), size: needed("size")? }
        }
        _ => Shape::HalfSpace { through: needed("xyz")?, normal: needed("normal")? },
    })
}

fn collision(table: &Table<'_>) -> Result<Collision, Fault> {
    table.only(COLLISION)?;
    let auto = table.choice("capsules", &[("auto", ())])?.is_some();
    let along_links = match (auto, table.number("radius")?) {
        (true, radius) => Some(table.need("radius", radius)?),
        (false, None) => None,
        (false, Some(_)) => {
            let message = "only for `capsules = \"auto\"`; the capsules that are listed have their own";
            return Err(table.fault("radius", ProblemFileCause::Conflict(message)));
        }
    };
    let capsules = table.tables("capsule", CAPSULE)?.iter().map(capsule).collect::<Result<_, _>>()?;
    let pairs = |name: &str| table.list(name, "a list of pairs of names, as [[\"a\", \"b\"]]", pair);
    let asked = if table.has_string("pairs") {
        table.choice("pairs", &[("all", ())])?.map_or(BodyPairs::None, |()| BodyPairs::All)
    } else {
        pairs("pairs")?.map_or(BodyPairs::None, BodyPairs::These)
    };
    Ok(Collision {
        capsules,
        along_links,
        margin: table.number("margin")?.unwrap_or(0.0),
        pairs: asked,
        except: pairs("except")?.unwrap_or_default(),
    })
}

fn capsule(table: &Table<'_>) -> Result<LinkCapsule, Fault> {
    let frame = table.need("frame", table.string("frame")?)?;
    Ok(LinkCapsule {
        name: table.string("name")?.unwrap_or_else(|| frame.clone()),
        frame,
        from: triple(table, "from")?.unwrap_or_default(),
        to: triple(table, "to")?,
        radius: table.need("radius", table.number("radius")?)?,
    })
}

fn pair(value: &DeValue<'_>) -> Option<[String; 2]> {
    let DeValue::Array(names) = value else { return None };
    let names: Option<Vec<String>> = names.iter().map(|name| string(name.get_ref())).collect();
    <[String; 2]>::try_from(names?).ok()
}
