//! The tools whose paths are drawn: those that the problem names, or else the ends of the last links.

use crate::motion::Motion;
use crate::shape::SHORTEST;
use costate::configuration::FreeKinematics;
use costate::kinematics::ReferenceFrame;
use costate::robot::{Frame, FrameKind, Placement, Robot};
use costate_control::{Problem, Reference, Tool};

/// A point that is fixed to a link, with axes.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolFrame {
    pub name: String,
    /// The joint that moves it.
    pub joint: Option<usize>,
    /// In the frame of that joint, or in the world.
    pub placement: Placement,
}

/// The tools of the problem in the order in which it names them; without any, one for each last link.
pub fn tools(problem: &Problem) -> Vec<ToolFrame> {
    let task = &problem.task;
    let poses = task.end_tools.iter().chain(&task.start_tools);
    let poses = poses.chain(problem.vias.iter().flat_map(|via| &via.tools)).map(|pose| &pose.tool);
    let kept = task.keep.iter().map(|keep| &keep.tool);
    let costs = task.tool_costs.iter().map(|cost| &cost.pose.tool);
    let references = task.references.iter().filter_map(|reference| match reference {
        Reference::Tool(reference) => Some(&reference.tool),
        _ => None,
    });
    let mut tools: Vec<ToolFrame> = Vec::new();
    for tool in poses.chain(kept).chain(costs).chain(references) {
        let Some(found) = of_problem(&problem.robot, tool) else { continue };
        if !tools.contains(&found) {
            tools.push(found);
        }
    }
    if tools.is_empty() { ends(&problem.robot) } else { tools }
}

/// A tool of a problem; `None` if the robot does not have its frame.
pub fn of_problem(robot: &Robot, tool: &Tool) -> Option<ToolFrame> {
    let frame = robot.frame(&tool.frame).ok()?;
    let offset = Placement::from_xyz_rpy(tool.offset, [0.0; 3]);
    let has_offset = tool.offset != [0.0; 3];
    let offset_name =
        format!("{} + ({})", tool.frame, tool.offset.map(|x| crate::numbers::short(x, 3)).join(", "));
    Some(ToolFrame {
        name: if has_offset { offset_name } else { tool.frame.clone() },
        joint: frame.joint,
        placement: frame.placement.then(&offset),
    })
}

/// The farthest frames of the links without a child, or else other frames than those of joint and link, or
/// else the centres of mass.
fn ends(robot: &Robot) -> Vec<ToolFrame> {
    let joints = robot.joints();
    let is_last = |&i: &usize| !joints.iter().any(|joint| joint.parent == Some(i));
    let end = |i: usize| {
        let on_link = || robot.frames().iter().filter(|frame| frame.joint == Some(i));
        let away = |frame: &Frame| frame.placement.translation.norm();
        let farthest =
            on_link().filter(|frame| away(frame) > SHORTEST).max_by(|a, b| away(a).total_cmp(&away(b)));
        if let Some(frame) = farthest {
            return ToolFrame { name: frame.name.clone(), joint: Some(i), placement: frame.placement };
        }
        let com = joints[i].inertia.com;
        let tool = |name: String, placement| ToolFrame { name, joint: Some(i), placement };
        match on_link().find(|frame| frame.name != joints[i].link && frame.name != joints[i].name) {
            Some(frame) => tool(frame.name.clone(), frame.placement),
            _ if com.norm() > SHORTEST => {
                let placement = Placement { translation: com, ..Placement::identity() };
                tool(format!("centre of mass of {}", joints[i].link), placement)
            }
            None => tool(joints[i].link.clone(), Placement::identity()),
        }
    };
    (0..joints.len()).filter(is_last).map(end).collect()
}

/// The speed of each tool (m/s) at the times of a motion; rows are tools.
pub fn speeds(motion: &Motion<'_>, tools: &[ToolFrame]) -> Vec<Vec<(f64, f64)>> {
    let mut kinematics = FreeKinematics::<f64>::new(motion.robot());
    let mut rows = vec![Vec::with_capacity(motion.points.len()); tools.len()];
    let frames: Vec<Option<usize>> = tools.iter().map(|tool| frame_of(motion.robot(), tool.joint?)).collect();
    for point in &motion.points {
        if kinematics.set_state(&point.q, &point.v).is_err() {
            continue;
        }
        for ((tool, frame), row) in tools.iter().zip(&frames).zip(&mut rows) {
            let speed = frame.map_or(Some(0.0), |frame| speed(&kinematics, frame, &tool.placement));
            row.extend(speed.map(|speed| (point.t, speed)));
        }
    }
    rows
}

/// The number of the frame of a joint: what follows inside a floating or spherical joint has none.
fn frame_of(robot: &Robot, joint: usize) -> Option<usize> {
    let name = &robot.joints()[joint].name;
    robot.frames().iter().position(|frame| frame.kind == FrameKind::Joint && frame.name == *name)
}

/// `|v + omega x R r|` of a point r of a frame (m/s).
fn speed(kinematics: &FreeKinematics<f64>, frame: usize, placement: &Placement) -> Option<f64> {
    let twist = kinematics.twist(frame, ReferenceFrame::LocalWorldAligned).ok()?;
    let pose = kinematics.pose(frame).ok()?;
    let r = placement.translation;
    let arm = pose.rotation.map(|[x, y, z]| x * r.x + y * r.y + z * r.z);
    let ([v, omega], [x, y, z]) = ([twist.linear, twist.angular].map(|vector| vector.to_array()), arm);
    let turned = [omega[1] * z - omega[2] * y, omega[2] * x - omega[0] * z, omega[0] * y - omega[1] * x];
    Some(v.iter().zip(turned).map(|(v, turned)| (v + turned).powi(2)).sum::<f64>().sqrt())
}
