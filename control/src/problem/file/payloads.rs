//! What the robot carries: masses, and bodies.

use super::fault::Fault;
use super::nested::triple;
use super::table::Table;
use crate::problem::{Payload, Shape};
use costate::robot::{LinkInertia, Placement};

/// The keys of a payload.
pub(super) const PAYLOAD: &[&str] = &["frame", "mass", "com", "inertia", "shape"];
const INERTIA: &[&str] = &["xx", "yy", "zz", "xy", "xz", "yz"];

/// A load: its frame, mass, centre of mass, inertia and body.
pub(super) fn payload(table: &Table<'_>) -> Result<Payload, Fault> {
    let frame = table.need("frame", table.string("frame")?)?;
    let mass = table.need("mass", table.number("mass")?)?;
    let com = triple(table, "com")?.unwrap_or_default();
    let mut entries = [0.0; 6];
    if let Some(inertia) = table.table("inertia")? {
        inertia.only(INERTIA)?;
        for (entry, key) in entries.iter_mut().zip(INERTIA) {
            *entry = inertia.number(key)?.unwrap_or(0.0);
        }
    }
    let load = Payload::new(frame, LinkInertia::from_entries(mass, com, entries));
    Ok(Payload { shape: body(table, com)?, ..load })
}

/// The keys of the body of a payload.
const BODY: &[&str] = &["kind", "xyz", "rpy", "size", "from", "to", "radius"];
const BODIES: [(&str, &[&str]); 3] = [
    ("sphere", &["kind", "xyz", "radius"]),
    ("capsule", &["kind", "from", "to", "radius"]),
    ("box", &["kind", "xyz", "rpy", "size"]),
];

/// The body of a payload, `shape`, in the axes of its frame; a sphere or box without `xyz` has its centre at
/// the centre of mass.
fn body(payload: &Table<'_>, com: [f64; 3]) -> Result<Option<Shape>, Fault> {
    let Some(table) = payload.table("shape")? else { return Ok(None) };
    table.only(BODY)?;
    let kind = table.kind(&BODIES)?;
    let needed = |name: &str| table.need(name, triple(&table, name)?);
    let radius = || table.need("radius", table.number("radius")?);
    let centre = triple(&table, "xyz")?.unwrap_or(com);
    Ok(Some(match kind {
        "sphere" => Shape::Sphere { centre, radius: radius()? },
        "capsule" => Shape::Capsule { from: needed("from")?, to: needed("to")?, radius: radius()? },
        _ => {
            let rpy = triple(&table, "rpy")?.unwrap_or_default();
            Shape::Box { placement: Placement::from_xyz_rpy(centre, rpy), size: needed("size")? }
        }
    }))
}
