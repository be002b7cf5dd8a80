//! `costate info`: what was read from a robot file.

use crate::report::{Table, joints};
use crate::{Outcome, RobotArguments};
use costate::robot::{Joint, Robot};
use serde_json::json;
use std::io::Write;
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// Print one JSON object and nothing else
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let robot = arguments.robot.load()?;
    let mut out = std::io::stdout().lock();
    if arguments.json {
        writeln!(out, "{}", as_json(&robot))?;
    } else {
        print(&robot, &mut out)?;
    }
    Ok(ExitCode::SUCCESS)
}

fn parent<'a>(robot: &'a Robot, joint: &Joint) -> Option<&'a str> {
    joint.parent.map(|p| robot.joints()[p].name.as_str())
}

fn as_json(robot: &Robot) -> serde_json::Value {
    let joint = |joint: &Joint| {
        json!({
            "name": joint.name,
            "type": joint.kind.name(),
            "parent": parent(robot, joint),
            "axis": joint.axis.as_slice(),
        })
    };
    json!({
        "robot": robot.name(),
        "n": robot.dof(),
        "joints": robot.joints().iter().map(joint).collect::<Vec<_>>(),
        "warnings": robot.warnings().iter().map(ToString::to_string).collect::<Vec<_>>(),
    })
}

fn print(robot: &Robot, out: &mut impl Write) -> std::io::Result<()> {
    let [gx, gy, gz]: [f64; 3] = robot.gravity().into();
    let mass: f64 = robot.joints().iter().map(|joint| joint.inertia.mass).sum();
    writeln!(
        out,
        "{}: {}, moving mass {mass:.4} kg, gravity ({gx}, {gy}, {gz}) m/s^2\n",
        robot.name(),
        joints(robot)
    )?;
    let mut table = Table::new(
        &["joint", "name", "type", "parent", "axis", "mass kg", "armature", "friction", "limits"],
        5,
    );
    for (i, joint) in robot.joints().iter().enumerate() {
        let [x, y, z]: [f64; 3] = joint.axis.into();
        let limits = joint.limits;
        let finite = |x: f64, digits: usize| if x.is_finite() { format!("{x:.digits$}") } else { "-".into() };
        table.row(vec![
            (i + 1).to_string(),
            joint.name.clone(),
            joint.kind.name().into(),
            parent(robot, joint).unwrap_or("world").into(),
            format!("({}, {}, {})", short(x), short(y), short(z)),
            format!("{:.4}", joint.inertia.mass),
            format!("{:.4}", robot.armature_entry(i, i)),
            if joint.friction.is_none() { "-".into() } else { "yes".into() },
            format!("{} .. {}", finite(limits.lower, 3), finite(limits.upper, 3)),
        ]);
    }
    write!(out, "{table}")?;
    if !robot.warnings().is_empty() {
        writeln!(out)?;
    }
    robot.warnings().iter().try_for_each(|warning| writeln!(out, "warning: {warning}"))
}

/// A component of an axis in few digits: 0, 1 and -1 as such.
fn short(x: f64) -> String {
    if x == x.round() { format!("{x:.0}") } else { format!("{x:.3}") }
}
