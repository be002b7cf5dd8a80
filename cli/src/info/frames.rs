//! The frames of the robot and the wrenches at them.

use crate::report::{Table, component};
use costate::robot::{AppliedWrench, Frame, FrameKind, Robot, WrenchAxes};
use std::io::Write;

/// The joint that moves a frame; none for the world.
pub fn carrier<'a>(robot: &'a Robot, frame: &Frame) -> Option<&'a str> {
    frame.joint.map(|i| robot.joints()[i].name.as_str())
}

pub fn kind(frame: &Frame) -> &'static str {
    match frame.kind {
        FrameKind::World => "world",
        FrameKind::Joint => "joint",
        FrameKind::Link => "link",
        FrameKind::Added => "added",
    }
}

pub fn axes(axes: WrenchAxes) -> &'static str {
    match axes {
        WrenchAxes::Local => "local",
        WrenchAxes::Aligned => "aligned",
    }
}

pub fn print(robot: &Robot, out: &mut impl Write) -> std::io::Result<()> {
    let mut table = Table::new(&["index", "frame", "kind", "moved by", "position in its joint frame"], 5);
    for (k, frame) in robot.frames().iter().enumerate() {
        let [x, y, z]: [f64; 3] = frame.placement.translation.into();
        table.row(vec![
            k.to_string(),
            frame.name.clone(),
            kind(frame).into(),
            carrier(robot, frame).unwrap_or("-").into(),
            format!("({}, {}, {})", component(x), component(y), component(z)),
        ]);
    }
    writeln!(out, "\n{table}")?;
    if robot.wrenches().is_empty() {
        return Ok(());
    }
    let mut table = Table::new(&["index", "wrench at", "axes", "force (N)", "moment (N m)"], 5);
    for (k, AppliedWrench { frame, wrench, .. }) in robot.wrenches().iter().enumerate() {
        let three = |[x, y, z]: [f64; 3]| format!("({}, {}, {})", component(x), component(y), component(z));
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
