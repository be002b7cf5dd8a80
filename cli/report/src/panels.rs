//! The plots of a report.

use crate::entries::entries;
use crate::forces::{FORCES, forces};
use crate::limits::{self, Quantity};
use crate::motion::Motion;
use crate::numbers::short;
use crate::plot::{Curve, Group, Look, Panel, Plot};
use crate::units::{self, Units};
use crate::work::{powers, sums};
use costate::robot::{Joint, JointKind, Robot};
use costate_control::{Iteration, TrajectoryPoint};

/// Names of the plots over time.
pub const NAMES: [&str; 17] = [
    "positions",
    "rates",
    "accelerations",
    "jerks",
    "controls",
    "torque_rates",
    "powers",
    "total_power",
    "energy",
    FORCES,
    "tool_speed",
    "momenta",
    "costates_q",
    "costates_p",
    "hamiltonian",
    "mesh",
    "residuals",
];

/// Start of the name of a plot of one control; the name of its joint follows.
pub const CONTROL: &str = "control_";

/// The quantities along the motion: q, v, a, jerks, u, torque rates, powers, energy, speeds of tools, p, y_q,
/// y_p, H*, the mesh.
pub fn along_the_motion(motion: &Motion<'_>) -> Vec<Panel> {
    let (robot, samples) = (motion.robot(), &motion.samples);
    let t = &samples.t;
    let of_joints = |file: &str, title: &str, symbol: &str, unit: Units, group: Group, rows: &[Vec<f64>]| {
        let mut plot = Plot::over_time(title, symbol, group);
        plot.units = unit;
        plot.unit = units::of_robot(robot, unit);
        plot.curves = curves(robot, t, rows);
        plot.marks.clone_from(&motion.solution.motion.switches);
        (file.to_owned(), plot)
    };
    let limited =
        |(file, plot): Panel, quantity| (file, Plot { limits: limits::of_joints(motion, quantity), ..plot });
    let points = |part: fn(&TrajectoryPoint) -> &Vec<f64>| -> Vec<Vec<f64>> {
        motion.points.iter().map(|point| part(point).clone()).collect()
    };
    use Group::{Actuation, Joints, Solver};
    let mut panels = vec![
        limited(positions(motion), Quantity::Position),
        limited(of_joints("rates", "Joint rates", "v", units::RATE, Joints, &samples.v), Quantity::Rate),
        limited(
            of_joints("accelerations", "Joint accelerations", "a", units::ACCELERATION, Joints, &samples.a),
            Quantity::Acceleration,
        ),
    ];
    if let Some(rates) = &motion.rates {
        let jerks = of_joints("jerks", "Joint jerks", "da/dt", units::JERK, Joints, &rates.jerk);
        panels.push(limited(jerks, Quantity::Jerk));
    }
    let (title, symbol, unit) = name_of_controls(motion);
    let controls = of_joints("controls", &format!("{title}s u"), symbol, unit, Actuation, &samples.u);
    panels.push(limited(controls, Quantity::Control));
    if let Some(rates) = &motion.rates {
        let rates = of_joints(
            "torque_rates",
            "Torque rates",
            "d\u{3c4}/dt",
            units::EFFORT_RATE,
            Actuation,
            &rates.torque_rate,
        );
        panels.push(limited(rates, Quantity::TorqueRate));
    }
    let powers = powers(motion);
    let of_each = of_joints("powers", "Powers of the joints", "\u{3c4} v", units::POWER, Actuation, &powers);
    panels.push(limited(of_each, Quantity::Power));
    panels.extend(sums(motion, &powers));
    panels.push(forces(motion));
    panels.push(tool_speed(motion));
    let momenta = if motion.problem.gait.is_some() || !robot.constraints().is_empty() {
        "Momenta p = M v - J'd\u{3bd}/dt"
    } else {
        "Momenta p = M v"
    };
    panels.push(of_joints("momenta", momenta, "p", units::MOMENTUM, Solver, &points(|point| &point.p)));
    let y_q = points(|point| &point.y_q);
    panels.push(of_joints(
        "costates_q",
        "Costates of the positions",
        "y_q",
        units::POSITION_COSTATE,
        Solver,
        &y_q,
    ));
    let y_p = points(|point| &point.y_p);
    panels.push(of_joints(
        "costates_p",
        "Costates of the momenta",
        "y_p",
        units::MOMENTUM_COSTATE,
        Solver,
        &y_p,
    ));
    panels.push(hamiltonian(motion));
    panels.push(mesh(motion));
    panels.retain(|(_, plot)| plot.curves.iter().any(|curve| curve.points.len() > 1));
    panels
}

/// One curve for each joint.
fn curves(robot: &Robot, t: &[f64], rows: &[Vec<f64>]) -> Vec<Curve> {
    let joints = robot.independent_joints().enumerate();
    joints
        .map(|(i, joint)| Curve {
            name: joint.name.clone(),
            color: i,
            points: column(t, rows, i).collect(),
            look: Look::Line,
        })
        .collect()
}

/// q, one curve for each entry.
fn positions(motion: &Motion<'_>) -> Panel {
    let (robot, samples) = (motion.robot(), &motion.samples);
    let is_no_angle = |joint: &Joint| joint.kind == JointKind::Prismatic || joint.free.is_some();
    let angles = if robot.independent_joints().any(is_no_angle) { "positions" } else { "angles" };
    let mut plot = Plot::over_time(format!("Joint {angles}"), "q", Group::Joints);
    (plot.units, plot.unit) = (units::POSITION, units::of_positions(robot));
    plot.marks.clone_from(&motion.solution.motion.switches);
    for (i, entry) in entries(robot).into_iter().enumerate() {
        if entry.is_quaternion {
            plot.unitless.push(entry.number);
        }
        let points = column(&samples.t, &samples.q, i).collect();
        plot.curves.push(Curve { name: entry.name, color: entry.number, points, look: Look::Line });
    }
    ("positions".into(), plot)
}

/// One entry of the rows over time.
fn column<'a>(t: &'a [f64], rows: &'a [Vec<f64>], i: usize) -> impl Iterator<Item = (f64, f64)> + 'a {
    t.iter().zip(rows).filter_map(move |(&t, row)| Some((t, *row.get(i)?)))
}

/// Title, symbol and unit of the controls: torques, unless some are forces or have a gain.
fn name_of_controls(motion: &Motion<'_>) -> (&'static str, &'static str, Units) {
    if motion.problem.gain.iter().any(|&gain| gain != 1.0) {
        return ("Control", "u, before the gain", ["", ""]);
    }
    let slides = motion.robot().independent_joints().any(|joint| joint.kind == JointKind::Prismatic);
    (if slides { "Control" } else { "Torque" }, "u", units::EFFORT)
}

/// The speeds of the tools, with their limits.
fn tool_speed(motion: &Motion<'_>) -> Panel {
    let tools = crate::tools::tools(motion.problem);
    let mut plot = Plot::over_time("Tool speed", "|v|", Group::Tools);
    plot.unit = "m/s".into();
    for (k, (tool, points)) in tools.iter().zip(crate::tools::speeds(motion, &tools)).enumerate() {
        plot.curves.push(Curve { name: tool.name.clone(), color: k, points, look: Look::Line });
        plot.limits.extend(limits::of_tool(motion, k, |number, kept| {
            let limited = &motion.problem.task.keep[number].tool;
            let is_same = crate::tools::of_problem(motion.robot(), limited).as_ref() == Some(tool);
            match kept {
                costate_control::Kept::Speed { max } if is_same => Some(*max),
                _ => None,
            }
        }));
    }
    ("tool_speed".into(), plot)
}

/// One plot for each control with its limits; none for at most two joints.
pub fn control_by_control(motion: &Motion<'_>) -> Vec<Panel> {
    let robot = motion.robot();
    if robot.dof() <= 2 {
        return Vec::new();
    }
    let names = file_names(robot);
    let limits = limits::of_joints(motion, Quantity::Control);
    let (title, symbol, unit) = name_of_controls(motion);
    let panel = |(i, curve): (usize, Curve)| {
        let joint = &robot.joints()[robot.independent_indices()[i]];
        let mut plot = Plot::over_time(format!("{title} {}", joint.name), symbol, Group::Actuation);
        plot.unit = units::of_joint(joint.kind, unit).into();
        plot.is_small = true;
        plot.limits = limits.iter().filter(|limit| limit.color == i).cloned().collect();
        plot.curves.push(curve);
        plot.marks.clone_from(&motion.solution.motion.switches);
        (format!("{CONTROL}{}", names[i]), plot)
    };
    curves(robot, &motion.samples.t, &motion.samples.u).into_iter().enumerate().map(panel).collect()
}

/// Names of the joints with letters, digits, `-` and `_` only; the index from 0 follows where two of them are
/// the same in lower case.
fn file_names(robot: &Robot) -> Vec<String> {
    let safe = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
    let names: Vec<String> =
        robot.independent_joints().map(|joint| joint.name.chars().take(60).map(safe).collect()).collect();
    let is_unique = |name: &str| names.iter().filter(|other| other.eq_ignore_ascii_case(name)).count() == 1;
    let distinct = |(i, name): (usize, &String)| match is_unique(name) {
        true => name.clone(),
        false => format!("{name}_{i}"),
    };
    names.iter().enumerate().map(distinct).collect()
}

/// H* minus its mean.
fn hamiltonian(motion: &Motion<'_>) -> Panel {
    let solution = motion.solution;
    let mean = solution.motion.hamiltonian;
    let title = format!("H* minus its mean, {}", short(mean, 8));
    let mut plot = Plot::over_time(title, "H* - mean", Group::Solver);
    plot.unit = "cost/s".into();
    let values = &solution.trajectory.hamiltonian;
    let points = solution.trajectory.t.iter().zip(values).map(|(&t, h)| (t, h - mean)).collect();
    plot.curves.push(Curve { name: "H* - mean".into(), color: 0, points, look: Look::Smooth });
    ("hamiltonian".into(), plot)
}

/// The distance between the nodes.
fn mesh(motion: &Motion<'_>) -> Panel {
    let t = &motion.solution.trajectory.t;
    let title = format!("Mesh: distance between {} nodes", t.len());
    let mut plot = Plot::over_time(title, "to the next node", Group::Solver);
    plot.unit = "s".into();
    plot.logarithmic = true;
    let steps = t.windows(2).filter(|pair| pair[0] < pair[1]);
    let steps = steps.flat_map(|pair| [pair[0], pair[1]].map(|t| (t, pair[1] - pair[0])));
    plot.curves.push(Curve { name: "distance".into(), color: 0, points: steps.collect(), look: Look::Line });
    plot.marks.clone_from(&motion.solution.motion.switches);
    ("mesh".into(), plot)
}

/// The residual of each iteration, one curve for each phase and mesh.
pub fn residuals(iterations: &[Iteration]) -> Vec<Panel> {
    if iterations.is_empty() {
        return Vec::new();
    }
    let mut plot = Plot::over_time("Newton's method", "residual", Group::Solver);
    plot.x_label = "iteration, over all phases";
    plot.over_time = false;
    plot.logarithmic = true;
    let mut last = None;
    for (k, iteration) in iterations.iter().enumerate() {
        let now = (iteration.phase.to_string(), iteration.nodes);
        if last.as_ref() != Some(&now) {
            let (name, color) = (format!("{}, {}", now.0, now.1), plot.curves.len());
            plot.curves.push(Curve { name, color, points: Vec::new(), look: Look::Dotted });
        }
        last = Some(now);
        if let Some(curve) = plot.curves.last_mut() {
            curve.points.push((k as f64 + 1.0, iteration.residual));
        }
    }
    vec![("residuals".into(), plot)]
}
