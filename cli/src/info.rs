//! `costate info`: the robot that was read from a file.

use crate::arguments::RobotArguments;
use crate::report::{Table, fixed, title};
use crate::{Outcome, terminal};
use costate::robot::{Joint, Mimic, Robot, printable};
use serde_json::{Value, json};
use std::io::Write;
use std::ops::Index;
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let robot = arguments.robot.load_and_warn()?;
    if arguments.json {
        writeln!(std::io::stdout().lock(), "{}", as_json(&robot))?;
    } else {
        print(&robot, &mut terminal::stdout())?;
    }
    Ok(ExitCode::SUCCESS)
}

fn parent<'a>(robot: &'a Robot, joint: &Joint) -> Option<&'a str> {
    joint.parent.map(|p| robot.joints()[p].name.as_str())
}

/// The mass of all moving links (kg).
fn mass(robot: &Robot) -> f64 {
    robot.joints().iter().map(|joint| joint.inertia.mass).sum()
}

/// Infinite limits are null.
fn as_json(robot: &Robot) -> Value {
    let joint = |(i, joint): (usize, &Joint)| {
        let (link, limits) = (&joint.inertia, joint.limits);
        json!({
            "index": i,
            "name": joint.name,
            "type": joint.kind.name(),
            "parent": parent(robot, joint),
            "axis": joint.axis.as_slice(),
            "placement": {
                "xyz": joint.placement.translation.as_slice(),
                "rotation": rows(&joint.placement.rotation),
            },
            "link": joint.link,
            "mass": link.mass,
            "com": link.com.as_slice(),
            "inertia": rows(&link.inertia),
            "mimic": joint.mimic.map(|mimic| {
                json!({ "joint": robot.joints()[mimic.joint].name, "ratio": mimic.ratio, "offset": mimic.offset })
            }),
            "armature": robot.armature_entry(i, i),
            "spring": { "stiffness": joint.spring.stiffness, "rest": joint.spring.rest },
            "friction": {
                "viscous": joint.friction.viscous,
                "coulomb": joint.friction.coulomb,
                "coulomb_velocity": joint.friction.coulomb_velocity,
            },
            "limits": {
                "lower": limits.lower, "upper": limits.upper, "velocity": limits.velocity, "effort": limits.effort,
            },
        })
    };
    json!({
        "robot": robot.name(),
        "n": robot.dof(),
        "gravity": robot.gravity().as_slice(),
        "mass": mass(robot),
        "joints": robot.joints().iter().enumerate().map(joint).collect::<Vec<_>>(),
        "armature_couplings": couplings(robot),
        "warnings": robot.warnings().iter().map(ToString::to_string).collect::<Vec<_>>(),
    })
}

/// A 3 x 3 matrix as nested arrays.
fn rows(matrix: &impl Index<(usize, usize), Output = f64>) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| matrix[(i, j)]))
}

/// The entries of the armature matrix above its diagonal that are not zero.
fn couplings(robot: &Robot) -> Vec<Value> {
    let joints = robot.joints();
    let above = robot.armature().iter().filter(|(i, j, _)| i > j);
    above
        .map(|&(j, i, entry)| json!({ "joints": [joints[i].name, joints[j].name], "armature": entry }))
        .collect()
}

fn print(robot: &Robot, out: &mut impl Write) -> std::io::Result<()> {
    let [gx, gy, gz] = <[f64; 3]>::from(robot.gravity()).map(|g| g + 0.0);
    writeln!(
        out,
        "{}, moving mass {} kg, gravity ({gx}, {gy}, {gz}) m/s^2\n",
        title(robot),
        fixed(mass(robot), 4)
    )?;
    let header = ["index", "name", "type", "parent", "axis", "mass", "armature", "friction", "limits"];
    let mut table = Table::new(&header, 5);
    for (i, joint) in robot.joints().iter().enumerate() {
        let [x, y, z]: [f64; 3] = joint.axis.into();
        let limit = |x: f64| if x.is_finite() { fixed(x, 3) } else { "-".into() };
        table.row(vec![
            i.to_string(),
            joint.name.clone(),
            joint.kind.name().into(),
            parent(robot, joint).unwrap_or("world").into(),
            format!("({}, {}, {})", short(x), short(y), short(z)),
            fixed(joint.inertia.mass, 4),
            fixed(robot.armature_entry(i, i), 4),
            if joint.friction.is_none() { "-".into() } else { "yes".into() },
            format!("{} .. {}", limit(joint.limits.lower), limit(joint.limits.upper)),
        ]);
    }
    writeln!(out, "{table}")?;
    for joint in robot.joints() {
        if let Some(mimic) = joint.mimic {
            let [of, independent] = [joint, &robot.joints()[mimic.joint]].map(|joint| printable(&joint.name));
            let Mimic { ratio, offset, .. } = mimic;
            writeln!(out, "  '{of}' mimics '{independent}': q = {ratio} q_{independent} + {offset}")?;
        }
    }
    writeln!(
        out,
        "  Mass in kg; revolute joints: limits in rad, armature in kg m^2; prismatic joints: in m and kg."
    )
}

/// A component of an axis: whole numbers without decimals.
fn short(x: f64) -> String {
    fixed(x, if x == x.round() { 0 } else { 3 })
}
