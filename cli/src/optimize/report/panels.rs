//! The plots of a report.

use super::limits::{self, Quantity};
use super::motion::Motion;
use super::numbers::short;
use super::plot::{Curve, Look, Plot};
use super::svg::cut;
use super::units::{self, Units};
use costate::robot::{JointKind, Robot};
use costate_control::{Iteration, Trajectory};

/// A plot and the name of its file.
pub type Panel = (String, Plot);

/// Names of the plots over time.
pub const NAMES: [&str; 9] = [
    "positions",
    "rates",
    "accelerations",
    "controls",
    "momenta",
    "costates_q",
    "costates_p",
    "hamiltonian",
    "mesh",
];

/// Number of times at which accelerations are drawn, which may jump.
const TIMES: f64 = 600.0;

/// Start of the name of a plot of one control; the name of its joint follows.
pub const CONTROL: &str = "control_";

/// The quantities along the motion: q, v, a, u, p, y_q, y_p, H*.
pub fn along_the_motion(motion: &Motion<'_>) -> Vec<Panel> {
    let trajectory = &motion.solution.trajectory;
    let robot = &motion.problem.robot;
    let t = &trajectory.t;
    let plot = |file: &str, title: &str, symbol: &str, unit: Units, curves: Vec<Curve>| {
        let mut plot = Plot::over_time(title, format!("{symbol} ({})", units::of_robot(robot, unit)));
        plot.curves = curves;
        plot.marks.clone_from(&motion.solution.motion.switches);
        (file.to_owned(), plot)
    };
    let limited = |quantity, curves: Vec<Curve>| -> Vec<Curve> {
        limits::levels(motion, quantity, &curves).into_iter().chain(curves).collect()
    };
    let angles = if robot.independent_joints().any(|joint| joint.kind == JointKind::Prismatic) {
        "positions"
    } else {
        "angles"
    };
    let mut panels = vec![
        plot(
            "positions",
            &format!("Joint {angles}"),
            "q",
            units::POSITION,
            limited(Quantity::Position, curves(robot, t, &trajectory.q)),
        ),
        plot(
            "rates",
            "Joint rates",
            "v",
            units::RATE,
            limited(Quantity::Rate, curves(robot, t, &trajectory.v)),
        ),
    ];
    if let Some(accelerations) = accelerations(motion) {
        let curves = limited(Quantity::Acceleration, accelerations);
        panels.push(plot("accelerations", "Joint accelerations", "a", units::ACCELERATION, curves));
    }
    panels.push(controls(motion));
    panels.push(plot("momenta", "Momenta p = M v", "p", units::MOMENTUM, curves(robot, t, &trajectory.p)));
    let [y_q, y_p] = [&trajectory.y_q, &trajectory.y_p].map(|rows| curves(robot, t, rows));
    panels.push(plot("costates_q", "Costates of the positions", "y_q", units::POSITION_COSTATE, y_q));
    panels.push(plot("costates_p", "Costates of the momenta", "y_p", units::MOMENTUM_COSTATE, y_p));
    panels.push(hamiltonian(motion));
    panels.push(mesh(motion));
    panels
}

/// One curve for each joint.
fn curves(robot: &Robot, t: &[f64], rows: &[Vec<f64>]) -> Vec<Curve> {
    let joints = robot.independent_joints().enumerate();
    joints
        .map(|(i, joint)| Curve {
            name: joint.name.clone(),
            color: i,
            points: column(t, rows, i),
            look: Look::Smooth,
        })
        .collect()
}

fn column(t: &[f64], rows: &[Vec<f64>], i: usize) -> Vec<(f64, f64)> {
    t.iter().zip(rows).filter_map(|(&t, row)| Some((t, *row.get(i)?))).collect()
}

/// Title and axis of the controls: torques, unless some are forces or have a gain.
fn names_of_controls(motion: &Motion<'_>, unit: &str) -> (&'static str, String) {
    if motion.problem.gain.iter().any(|&gain| gain != 1.0) {
        return ("Control", "u, before the gain".into());
    }
    let slides = motion.problem.robot.independent_joints().any(|joint| joint.kind == JointKind::Prismatic);
    (if slides { "Control" } else { "Torque" }, format!("u ({unit})"))
}

/// Accelerations, straight from time to time; none where the dynamics cannot be evaluated.
fn accelerations(motion: &Motion<'_>) -> Option<Vec<Curve>> {
    let samples = motion.solution.sample(motion.problem, TIMES / motion.solution.motion.final_time).ok()?;
    let curves = curves(&motion.problem.robot, &samples.t, &samples.a);
    Some(curves.into_iter().map(|curve| Curve { look: Look::Line, ..curve }).collect())
}

/// All controls with their limits.
fn controls(motion: &Motion<'_>) -> Panel {
    let robot = &motion.problem.robot;
    let (title, label) = names_of_controls(motion, &units::of_robot(robot, units::EFFORT));
    let mut plot = Plot::over_time(format!("{title}s u"), label);
    let Trajectory { t, u, .. } = &motion.solution.trajectory;
    let curves = curves(robot, t, u);
    plot.curves = limits::levels(motion, Quantity::Control, &curves).into_iter().chain(curves).collect();
    plot.marks.clone_from(&motion.solution.motion.switches);
    ("controls".into(), plot)
}

/// One plot for each control with its limits; none for at most two joints.
pub fn control_by_control(motion: &Motion<'_>) -> Vec<Panel> {
    let robot = &motion.problem.robot;
    if robot.dof() <= 2 {
        return Vec::new();
    }
    let Trajectory { t, u, .. } = &motion.solution.trajectory;
    let names = file_names(robot);
    let panel = |(i, curve): (usize, Curve)| {
        let joint = &robot.joints()[robot.independent_indices()[i]];
        let (title, label) = names_of_controls(motion, units::of_joint(joint.kind, units::EFFORT));
        let mut plot = Plot::over_time(format!("{title} {}", cut(&joint.name, 30)), label).small();
        let curve = [curve];
        plot.curves = limits::levels(motion, Quantity::Control, &curve).into_iter().chain(curve).collect();
        plot.marks.clone_from(&motion.solution.motion.switches);
        (format!("{CONTROL}{}", names[i]), plot)
    };
    curves(robot, t, u).into_iter().enumerate().map(panel).collect()
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
    let mut plot = Plot::over_time(format!("H* minus its mean, {}", short(mean, 8)), "H* - mean (cost/s)");
    let values = &solution.trajectory.hamiltonian;
    let points = solution.trajectory.t.iter().zip(values).map(|(&t, h)| (t, h - mean)).collect();
    plot.curves.push(Curve { name: "H* - mean".into(), color: 0, points, look: Look::Smooth });
    ("hamiltonian".into(), plot)
}

/// The distance between the nodes.
fn mesh(motion: &Motion<'_>) -> Panel {
    let t = &motion.solution.trajectory.t;
    let mut plot =
        Plot::over_time(format!("Mesh: distance between {} nodes", t.len()), "to the next node (s)");
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
    let mut plot = Plot::over_time("Newton's method", "residual");
    plot.x_label = "iteration, over all phases";
    plot.over_time = false;
    plot.logarithmic = true;
    let mut last = None;
    for (k, iteration) in iterations.iter().enumerate() {
        let now = (iteration.phase.to_string(), iteration.nodes);
        if last.as_ref() != Some(&now) {
            let name = format!("{}, {}", now.0, now.1);
            plot.curves.push(Curve {
                name,
                color: plot.curves.len(),
                points: Vec::new(),
                look: Look::Dotted,
            });
        }
        last = Some(now);
        if let Some(curve) = plot.curves.last_mut() {
            curve.points.push((k as f64 + 1.0, iteration.residual));
        }
    }
    vec![("residuals".into(), plot)]
}
