//! The tables of obstacles and of the bodies that keep away from them.

use super::error::ProblemFileCause;
use super::fault::Fault;
use super::nested::triple;
use super::table::{Table, string};
use crate::problem::obstacles::{BodyPairs, Collision, LinkCapsule, Obstacle, Shape};
use crate::problem::task::Task;
use costate::robot::Placement;
use toml::de::DeValue;

const COLLISION: &[&str] = &["capsules", "radius", "capsule", "margin", "pairs", "except"];
/// Where bodies come from beside those that are listed.
#[derive(Clone, Copy, PartialEq)]
enum Capsules {
    AlongLinks,
    OfUrdf,
}
const CAPSULES: [(&str, Capsules); 2] = [("auto", Capsules::AlongLinks), ("urdf", Capsules::OfUrdf)];
const CAPSULE: &[&str] = &["name", "frame", "from", "to", "radius"];

/// The shapes of obstacles, with the keys of each.
const SHAPES: [(&str, &[&str]); 4] = [
    ("sphere", &["kind", "name", "xyz", "radius"]),
    ("capsule", &["kind", "name", "from", "to", "radius"]),
    ("box", &["kind", "name", "xyz", "rpy", "size"]),
    ("half_space", &["kind", "name", "xyz", "normal"]),
];
const OBSTACLE: &[&str] = &["kind", "name", "xyz", "rpy", "size", "normal", "from", "to", "radius"];

/// Reads `[[obstacle]]` and `[collision]`.
pub(super) fn obstacles(root: &Table<'_>) -> Result<(Vec<Obstacle>, Option<Collision>), Fault> {
    let obstacles = root.tables("obstacle", OBSTACLE)?;
    let obstacles = obstacles.iter().enumerate().map(|(k, table)| obstacle(table, k));
    let obstacles = obstacles.collect::<Result<_, _>>()?;
    Ok((obstacles, root.table("collision")?.as_ref().map(collision).transpose()?))
}

/// The obstacle of this number, from 0.
pub(super) fn obstacle(table: &Table<'_>, number: usize) -> Result<Obstacle, Fault> {
    let name = table.string("name")?.unwrap_or_else(|| format!("obstacle {}", number + 1));
    Ok(Obstacle::new(name, shape(table)?))
}

fn shape(table: &Table<'_>) -> Result<Shape, Fault> {
    let kind = table.kind(&SHAPES)?;
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
    let auto = table.choice("capsules", &CAPSULES)? == Some(Capsules::AlongLinks);
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

/// Whether the bodies are those of a URDF, which is read apart.
pub(super) fn asks_for_urdf(root: &Table<'_>) -> Result<bool, Fault> {
    let Some(table) = root.table("collision")? else { return Ok(false) };
    Ok(table.choice("capsules", &CAPSULES)? == Some(Capsules::OfUrdf))
}

/// Adds the bodies of the text of a URDF, if there is one.
pub(super) fn add_urdf(root: &Table<'_>, urdf: Option<&str>, task: &mut Task) -> Result<(), Fault> {
    let refuse = |cause| match root.table("collision") {
        Ok(Some(table)) => table.fault("capsules", cause),
        _ => cause.into(),
    };
    let message = "the robot was not read from a URDF; list its bodies as [[collision.capsule]]";
    let urdf = urdf.ok_or_else(|| refuse(ProblemFileCause::Conflict(message)))?;
    let collision = task.collision.take().unwrap_or_default().with_urdf(urdf);
    task.collision = Some(collision.map_err(|error| refuse(ProblemFileCause::Other(error.into())))?);
    Ok(())
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
