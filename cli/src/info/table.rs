//! The joints and constraints of the robot as tables.

use super::closing::Loops;
use super::rows::{Row, mass, rows};
use crate::report::{Table, component, fixed, title};
use costate::robot::{Constraint, ConstraintKind, Limits, Mimic, Robot, printable};
use std::io::Write;

pub fn print(robot: &Robot, out: &mut impl Write) -> std::io::Result<()> {
    let [gx, gy, gz] = <[f64; 3]>::from(robot.gravity()).map(|g| g + 0.0);
    writeln!(
        out,
        "{}, moving mass {} kg, gravity ({gx}, {gy}, {gz}) m/s^2\n",
        title(robot),
        fixed(mass(robot), 4)
    )?;
    let places = places(robot);
    let header = ["name", "type", "parent", "axis", "mass (kg)", "armature", "friction"];
    let mut table = Table::new(&[places, &header].concat(), places.len() + 4);
    for row in rows(robot) {
        let joint = row.moved;
        let cells = [
            joint.name.clone(),
            row.kind().into(),
            row.parent(robot).unwrap_or("world").into(),
            row.axis().map_or_else(
                || "-".into(),
                |[x, y, z]| format!("({}, {}, {})", component(x), component(y), component(z)),
            ),
            fixed(joint.inertia.mass, 4),
            fixed(row.armature(robot), 4),
            if joint.friction.is_none() { "-".into() } else { "yes".into() },
        ];
        table.row(place(&row, places).into_iter().chain(cells).collect());
    }
    writeln!(out, "{table}")?;
    writeln!(out, "{}", limits(robot))?;
    for joint in robot.joints() {
        if let Some(mimic) = joint.mimic {
            let [of, independent] = [joint, &robot.joints()[mimic.joint]].map(|joint| printable(&joint.name));
            let Mimic { ratio, offset, .. } = mimic;
            writeln!(out, "  '{of}' mimics '{independent}': q = {ratio} q_{independent} + {offset}")?;
        }
    }
    constraints(robot, out)?;
    if !robot.free_joints().is_empty() {
        writeln!(
            out,
            "  a..b: the entries a to b - 1. A floating joint has x, y, z, qx, qy, qz, qw in q, a spherical one qx, qy, qz,\n  \
             qw; linear, then angular velocity in v, in the axes of the moved frame."
        )?;
    }
    writeln!(
        out,
        "  Revolute joints: armature in kg m^2, limits in rad, rad/s and N m; prismatic joints: in kg, m, m/s and N.\n  \
         An effort is a torque or a force; - stands for no limit."
    )
}

/// The constraints, and how many of their rows count.
fn constraints(robot: &Robot, out: &mut impl Write) -> std::io::Result<()> {
    let loops = Loops::of(robot);
    for (k, Constraint { name, kind, .. }) in robot.constraints().iter().enumerate() {
        let count = kind.rows();
        let rows = if count == 1 { "row" } else { "rows" };
        let redundant = match (&loops, kind) {
            (Loops::Closed { redundant, .. }, _) if redundant[k].is_empty() => String::new(),
            (Loops::Closed { redundant, .. }, ConstraintKind::Frames { rows, .. }) => {
                let names: Vec<&str> = redundant[k].iter().map(|row| rows[*row].name()).collect();
                format!(", {} of them redundant ({})", names.len(), names.join(", "))
            }
            (Loops::Closed { .. }, _) => ", redundant".into(),
            _ => String::new(),
        };
        writeln!(out, "  constraint '{}': {count} {rows}{redundant}", printable(name))?;
    }
    match &loops {
        Loops::Closed { rank, .. } => {
            let (n, left) = (robot.dof(), robot.dof() - rank);
            let are = if left == 1 { "is" } else { "are" };
            writeln!(
                out,
                "  Satisfied near q = 0, the constraints have rank {rank}: of {n} degrees of freedom {left} {are} left."
            )
        }
        Loops::Open(cause) => {
            writeln!(out, "  No position near q = 0 was found that satisfies the constraints: {cause}.")
        }
        Loops::Unknown => Ok(()),
    }
}

/// The columns that say where a joint is in lists: one where q and v have the same entries.
fn places(robot: &Robot) -> &'static [&'static str] {
    if robot.free_joints().is_empty() { &["index"] } else { &["q", "v"] }
}

/// Their cells.
fn place(row: &Row<'_>, places: &[&str]) -> Vec<String> {
    let [q, v] = [&row.q, &row.v].map(|entries| match entries {
        None => "-".to_owned(),
        Some(entries) if entries.len() == 1 => entries.start.to_string(),
        Some(entries) => format!("{}..{}", entries.start, entries.end),
    });
    if places.len() == 1 { vec![v] } else { vec![q, v] }
}

/// The limits of all joints.
fn limits(robot: &Robot) -> Table {
    let places = places(robot);
    let header = ["name", "lower limit", "upper limit", "rate limit", "effort limit"];
    let mut table = Table::new(&[places, &header].concat(), places.len() + 1);
    let limit = |x: f64| if x.is_finite() { fixed(x, 3) } else { "-".into() };
    for row in rows(robot) {
        let Limits { lower, upper, velocity, effort, .. } = row.moved.limits;
        let numbers = [lower, upper, velocity, effort].map(limit);
        let first = place(&row, places).into_iter().chain([row.moved.name.clone()]);
        table.row(first.chain(numbers).collect());
    }
    table
}
