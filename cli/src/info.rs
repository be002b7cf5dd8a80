//! `costate info`: the robot that was read from a file.

use crate::arguments::RobotArguments;
use crate::report::{Table, fixed, title};
use crate::{Outcome, terminal};
use costate::robot::{
    AppliedWrench, Constraint, Frame, FrameKind, Joint, Limits, Mimic, Robot, WrenchAxes, printable,
};
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
    /// List the frames too: links, joints and others that `costate eval` knows by name; and wrenches at them
    #[arg(long)]
    frames: bool,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let robot = arguments.robot.load_any_and_warn()?;
    if arguments.json {
        writeln!(std::io::stdout().lock(), "{}", as_json(&robot, arguments.frames))?;
    } else {
        print(&robot, &mut terminal::stdout())?;
        if arguments.frames {
            print_frames(&robot, &mut terminal::stdout())?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn parent<'a>(robot: &'a Robot, joint: &Joint) -> Option<&'a str> {
    joint.parent.map(|p| robot.joints()[p].name.as_str())
}

/// Place of joint `i` in q; none if it mimics another one.
fn index(robot: &Robot, i: usize) -> Option<usize> {
    robot.independent_indices().binary_search(&i).ok()
}

/// The mass of all moving links (kg).
fn mass(robot: &Robot) -> f64 {
    robot.joints().iter().map(|joint| joint.inertia.mass).sum()
}

/// Infinite limits are null.
fn as_json(robot: &Robot, with_frames: bool) -> Value {
    let joint = |(i, joint): (usize, &Joint)| {
        let (link, limits) = (&joint.inertia, joint.limits);
        json!({
            "index": index(robot, i),
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
    let mut value = json!({
        "robot": robot.name(),
        "n": robot.dof(),
        "gravity": robot.gravity().as_slice(),
        "mass": mass(robot),
        "joints": robot.joints().iter().enumerate().map(joint).collect::<Vec<_>>(),
        "armature_couplings": couplings(robot),
        "warnings": robot.warnings().iter().map(ToString::to_string).collect::<Vec<_>>(),
    });
    if let (false, Value::Object(fields)) = (robot.constraints().is_empty(), &mut value) {
        let one =
            |constraint: &Constraint| json!({ "name": constraint.name, "rows": constraint.kind.rows() });
        fields.insert("constraints".into(), robot.constraints().iter().map(one).collect());
    }
    if let (true, Value::Object(fields)) = (with_frames, &mut value) {
        fields.insert(
            "frames".into(),
            robot.frames().iter().map(|frame| frame_as_json(robot, frame)).collect(),
        );
        fields.insert(
            "wrenches".into(),
            robot.wrenches().iter().map(|one| wrench_as_json(robot, one)).collect(),
        );
    }
    value
}

fn wrench_as_json(robot: &Robot, applied: &AppliedWrench) -> Value {
    let AppliedWrench { frame, wrench, .. } = applied;
    json!({
        "frame": robot.frames()[*frame].name,
        "axes": axes(wrench.axes),
        "force": wrench.force,
        "moment": wrench.moment,
    })
}

fn axes(axes: WrenchAxes) -> &'static str {
    match axes {
        WrenchAxes::Local => "local",
        WrenchAxes::Aligned => "aligned",
    }
}

/// The joint that moves a frame; none for the world.
fn carrier<'a>(robot: &'a Robot, frame: &Frame) -> Option<&'a str> {
    frame.joint.map(|i| robot.joints()[i].name.as_str())
}

fn kind(frame: &Frame) -> &'static str {
    match frame.kind {
        FrameKind::World => "world",
        FrameKind::Joint => "joint",
        FrameKind::Link => "link",
        FrameKind::Added => "added",
    }
}

fn frame_as_json(robot: &Robot, frame: &Frame) -> Value {
    json!({
        "name": frame.name,
        "kind": kind(frame),
        "joint": carrier(robot, frame),
        "placement": {
            "xyz": frame.placement.translation.as_slice(),
            "rotation": rows(&frame.placement.rotation),
        },
    })
}

fn print_frames(robot: &Robot, out: &mut impl Write) -> std::io::Result<()> {
    let mut table = Table::new(&["index", "frame", "kind", "moved by", "position in its joint frame"], 5);
    for (k, frame) in robot.frames().iter().enumerate() {
        let [x, y, z]: [f64; 3] = frame.placement.translation.into();
        table.row(vec![
            k.to_string(),
            frame.name.clone(),
            kind(frame).into(),
            carrier(robot, frame).unwrap_or("-").into(),
            format!("({}, {}, {})", short(x), short(y), short(z)),
        ]);
    }
    writeln!(out, "\n{table}")?;
    if robot.wrenches().is_empty() {
        return Ok(());
    }
    let mut table = Table::new(&["index", "wrench at", "axes", "force (N)", "moment (N m)"], 5);
    for (k, AppliedWrench { frame, wrench, .. }) in robot.wrenches().iter().enumerate() {
        let three = |[x, y, z]: [f64; 3]| format!("({}, {}, {})", short(x), short(y), short(z));
        table.row(vec![
            k.to_string(),
            robot.frames()[*frame].name.clone(),
            axes(wrench.axes).into(),
            three(wrench.force),
            three(wrench.moment),
        ]);
    }
    writeln!(out, "{table}")
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
    let header = ["index", "name", "type", "parent", "axis", "mass (kg)", "armature", "friction"];
    let mut table = Table::new(&header, 5);
    for (i, joint) in robot.joints().iter().enumerate() {
        let [x, y, z]: [f64; 3] = joint.axis.into();
        table.row(vec![
            index(robot, i).map_or_else(|| "-".into(), |index| index.to_string()),
            joint.name.clone(),
            joint.kind.name().into(),
            parent(robot, joint).unwrap_or("world").into(),
            format!("({}, {}, {})", short(x), short(y), short(z)),
            fixed(joint.inertia.mass, 4),
            fixed(robot.armature_entry(i, i), 4),
            if joint.friction.is_none() { "-".into() } else { "yes".into() },
        ]);
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
    for Constraint { name, kind, .. } in robot.constraints() {
        writeln!(out, "  constraint '{}': {} rows", printable(name), kind.rows())?;
    }
    writeln!(
        out,
        "  Revolute joints: armature in kg m^2, limits in rad, rad/s and N m; prismatic joints: in kg, m, m/s and N.\n  \
         An effort is a torque or a force; - stands for no limit."
    )
}

/// The limits of all joints.
fn limits(robot: &Robot) -> Table {
    let header = ["index", "name", "lower limit", "upper limit", "rate limit", "effort limit"];
    let mut table = Table::new(&header, 2);
    let limit = |x: f64| if x.is_finite() { fixed(x, 3) } else { "-".into() };
    for (i, joint) in robot.joints().iter().enumerate() {
        let Limits { lower, upper, velocity, effort, .. } = joint.limits;
        let index = index(robot, i).map_or_else(|| "-".into(), |index| index.to_string());
        let numbers = [lower, upper, velocity, effort].map(limit);
        table.row([index, joint.name.clone()].into_iter().chain(numbers).collect());
    }
    table
}

/// A component of an axis: whole numbers without decimals.
fn short(x: f64) -> String {
    fixed(x, if x == x.round() { 0 } else { 3 })
}
