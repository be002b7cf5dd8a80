//! Random tasks: a pose of the tool, a level tool, a wall or a post, limits of jerks, least time.
//!
//! Nothing about a task depends on how it is solved. Both ends are drawn as positions of the joints, which
//! the task then replaces by the pose of the tool at its end: so it can be reached, and meets nothing. Where
//! the tool is kept level, the straight path between both in the joints, made level at each of its places,
//! has to stay within the ranges and on the free side of the wall: so there is a motion.

use super::robots::Arm;
use crate::problems::Failure;
use costate::kinematics::Kinematics;
use costate::robot::{Joint, LoadOptions, Robot};
use costate_control::{ProblemFile, Solver, SolverOptions};
use fastrand::Rng;
use nalgebra::{DMatrix, DVector, Vector3};
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;

/// Ends are drawn within this part of the ranges of the joints, and within half a turn.
const INSIDE: f64 = 0.9;
/// Limits of jerks are so many times those of rates (1/s^2): a joint reaches its rate in 0.2 s.
const JERK: f64 = 100.0;
/// The axis of the tool is at most so far from down where it is kept level (rad).
const LEVEL: f64 = 0.1;
/// Radius of the bodies along the links, and their distance from the wall at the nearer end (m).
const RADIUS: f64 = 0.05;
const CLEAR: f64 = 0.03;
/// Tools move by at least this (m), and are above the base by at least this (m).
const WAY: f64 = 0.3;
const HEIGHT: f64 = 0.05;
/// Edges of a post (m).
const POST: f64 = 0.08;
/// Places of the path that shows that there is a motion, and by how much joints differ between two of them
/// (rad).
const PLACES: usize = 40;
const LONGEST: f64 = 0.3;
/// Pairs of ends that are drawn before a task is given up.
const DRAWS: usize = 20_000;

/// A task as the text of a problem file.
pub struct Task {
    pub name: String,
    pub text: String,
}

/// Where a tool is.
struct Place {
    q: Vec<f64>,
    position: Vector3<f64>,
    rotation: [[f64; 3]; 3],
    /// The origins of all frames.
    origins: Vec<Vector3<f64>>,
}

/// The task of an arm with a number from 0 to 2, and this seed:
///
/// - 0: a level tool beside a wall; it may turn about its axis at the end;
/// - 1: a pose of the tool at the other side of a post;
/// - 2: a pose of a level tool beside a wall, with accelerations that begin and end at zero.
pub fn draw(arm: &Arm, folder: &Path, number: usize, seed: u64) -> Result<Task, Failure> {
    let robot = arm.robot(folder)?;
    let tool = robot.frame_index(arm.tool)?;
    let mut kinematics = Kinematics::<f64>::new(&robot);
    let name_seed = arm.name.bytes().fold(0, |sum: u64, byte| 31 * sum + u64::from(byte));
    let mut random = Rng::with_seed(1_000_003 * seed + 10_007 * name_seed + number as u64);
    let mut last = String::from("no position with a tool above the base");
    for _ in 0..DRAWS {
        let mut end = || place(&robot, &mut kinematics, tool, number != 1, &mut random);
        let (Some(from), Some(to)) = (end(), end()) else { continue };
        if (from.position - to.position).norm() < WAY {
            continue;
        }
        let azimuth = 2.0 * PI * random.f64();
        let Some(obstacle) = obstacle(number, azimuth, [&from, &to]) else { continue };
        if number != 1 && !is_connected(&robot, &mut kinematics, tool, azimuth, [&from, &to]) {
            continue;
        }
        let text = |end: &str| problem_file((arm, folder, &robot), number, &from.q, end, &obstacle);
        // The task with all that is given at both ends refuses what meets obstacles or is not level.
        let witness = text(&format!("q = {}\n", list(&to.q)));
        let fault = match ProblemFile::from_text(&witness, "", LoadOptions::default()) {
            Ok(file) => {
                Solver::new(&file.problem, SolverOptions::default()).err().map(|error| error.to_string())
            }
            Err(error) => Some(error.to_string()),
        };
        match fault {
            None => {
                let name = format!("{} {number}", arm.name);
                return Ok(Task { name, text: text(&pose(arm, number, &to)) });
            }
            Some(fault) => last = fault,
        }
    }
    Err(format!("no task {number} of {} after {DRAWS} draws: {last}", arm.name).into())
}

/// A random position of the joints with the tool above the base, level if it is asked for.
fn place(
    robot: &Robot,
    kinematics: &mut Kinematics<f64>,
    tool: usize,
    is_level: bool,
    random: &mut Rng,
) -> Option<Place> {
    let ranges = ranges(robot);
    let mut q: Vec<f64> = ranges.iter().map(|[low, high]| low + (high - low) * random.f64()).collect();
    if is_level {
        q = level(kinematics, tool, q)?;
    }
    let is_inside = |(q, [low, high]): (&f64, &[f64; 2])| (low..=high).contains(&q);
    if !q.iter().zip(&ranges).all(is_inside) {
        return None;
    }
    kinematics.set_position(&q).ok()?;
    let pose = kinematics.pose(tool).ok()?;
    let origins = origins(robot, kinematics);
    let position = Vector3::from(pose.position);
    (position.z > HEIGHT).then_some(Place { q, position, rotation: pose.rotation, origins })
}

/// Where ends are drawn.
fn ranges(robot: &Robot) -> Vec<[f64; 2]> {
    let of = |joint: &Joint| [joint.limits.lower.max(-PI) * INSIDE, joint.limits.upper.min(PI) * INSIDE];
    robot.independent_joints().map(of).collect()
}

/// The origins of all frames.
fn origins(robot: &Robot, kinematics: &Kinematics<f64>) -> Vec<Vector3<f64>> {
    let origin = |frame| kinematics.pose(frame).ok().map(|pose| Vector3::from(pose.position));
    (0..robot.frames().len()).filter_map(origin).collect()
}

/// How far the nearest frame is from the wall, along its normal from the origin (m).
fn nearest(normal: Vector3<f64>, origins: &[Vector3<f64>]) -> f64 {
    origins.iter().map(|origin| normal.dot(origin)).fold(f64::INFINITY, f64::min)
}

/// Whether the level path between both ends stays within the ranges and on the free side of the wall.
fn is_connected(
    robot: &Robot,
    kinematics: &mut Kinematics<f64>,
    tool: usize,
    azimuth: f64,
    [from, to]: [&Place; 2],
) -> bool {
    let ranges = ranges(robot);
    let normal = Vector3::new(azimuth.cos(), azimuth.sin(), 0.0);
    let least = nearest(normal, &from.origins).min(nearest(normal, &to.origins)) - CLEAR;
    let mut before = from.q.clone();
    (1..=PLACES).all(|k| {
        let part = k as f64 / PLACES as f64;
        let straight = from.q.iter().zip(&to.q).map(|(from, to)| from + part * (to - from)).collect();
        let Some(q) = level(kinematics, tool, straight) else { return false };
        let is_inside = |(q, [low, high]): (&f64, &[f64; 2])| (low..=high).contains(&q);
        let is_near = q.iter().zip(&before).all(|(q, before)| (q - before).abs() < LONGEST);
        if !is_near || !q.iter().zip(&ranges).all(is_inside) || kinematics.set_position(&q).is_err() {
            return false;
        }
        before = q;
        nearest(normal, &origins(robot, kinematics)) >= least
    })
}

/// A position near q with the axis of the tool straight down: Gauss-Newton steps with differences.
fn level(kinematics: &mut Kinematics<f64>, tool: usize, mut q: Vec<f64>) -> Option<Vec<f64>> {
    const STEP: f64 = 1e-6;
    let mut off = |q: &[f64]| {
        kinematics.set_position(q).ok()?;
        let rotation = kinematics.pose(tool).ok()?.rotation;
        Some(Vector3::new(rotation[0][2], rotation[1][2], rotation[2][2] + 1.0))
    };
    for _ in 0..50 {
        let r = off(&q)?;
        if r.norm() < 1e-9 {
            return Some(q);
        }
        let mut jacobian = DMatrix::zeros(3, q.len());
        for i in 0..q.len() {
            let mut moved = q.clone();
            moved[i] += STEP;
            jacobian.set_column(i, &((off(&moved)? - r) / STEP));
        }
        let square = &jacobian * jacobian.transpose() + DMatrix::identity(3, 3) * 1e-3 * r.norm().min(1.0);
        let residual = DVector::from_column_slice(r.as_slice());
        let step = jacobian.transpose() * square.cholesky()?.solve(&residual);
        q.iter_mut().zip(step.iter()).for_each(|(q, step)| *q -= step);
    }
    None
}

/// A wall beside both ends, or a post between them; `None` if there is no room for it.
fn obstacle(number: usize, azimuth: f64, ends: [&Place; 2]) -> Option<String> {
    if number == 1 {
        let middle = 0.5 * (ends[0].position + ends[1].position);
        let height = middle.z;
        return (height > 2.0 * POST).then(|| {
            format!(
                "name = \"post\"\nkind = \"box\"\nxyz = {}\nrpy = [0.0, 0.0, {azimuth:?}]\nsize = {}\n",
                list(&[middle.x, middle.y, 0.5 * height]),
                list(&[POST, POST, height])
            )
        });
    }
    let normal = Vector3::new(azimuth.cos(), azimuth.sin(), 0.0);
    let least = ends.map(|end| nearest(normal, &end.origins)).into_iter().fold(f64::INFINITY, f64::min);
    let point = (least - RADIUS - CLEAR) * normal;
    Some(format!(
        "name = \"wall\"\nkind = \"half_space\"\nxyz = {}\nnormal = {}\n",
        list(point.as_slice()),
        list(normal.as_slice())
    ))
}

/// Where the tool shall be.
fn pose(arm: &Arm, number: usize, to: &Place) -> String {
    let mut text = format!("[end.tool]\nframe = \"{}\"\nxyz = {}\n", arm.tool, list(to.position.as_slice()));
    if number == 0 {
        text += "along = [0.0, 0.0, -1.0]\n";
    } else {
        let rows: Vec<String> = to.rotation.iter().map(|row| list(row)).collect();
        let _ = writeln!(text, "rotation = [{}]", rows.join(", "));
    }
    text
}

/// The problem file. `end` is what is given at the end.
fn problem_file(
    (arm, folder, robot): (&Arm, &Path, &Robot),
    number: usize,
    from: &[f64],
    end: &str,
    obstacle: &str,
) -> String {
    let n = robot.dof();
    let file = arm.path(folder);
    let locked: Vec<String> = arm.locked.iter().map(|joint| format!("{joint} = 0.0")).collect();
    let still = if number == 2 { format!("a = {}\n", list(&vec![0.0; n])) } else { String::new() };
    let (own, tool) = end.split_at(end.find("[end.tool]").unwrap_or(end.len()));
    let rates = robot.independent_joints().map(|joint| JERK * joint.limits.velocity);
    let mut text = format!("[robot]\nfile = \"{}\"\nlock = {{ {} }}\n", file.display(), locked.join(", "));
    let _ = write!(text, "\n[start]\nq = {}\n{still}\n[end]\n{own}{still}{tool}", list(from));
    text += "\n[time]\nfree = true\nguess = 2.0\n\n[cost]\ntime = 1.0\n";
    if number != 1 {
        let tool = arm.tool;
        let _ = write!(
            text,
            "\n[[keep]]\nkind = \"axis\"\nframe = \"{tool}\"\nalong = [0.0, 0.0, -1.0]\nangle = {LEVEL}\n"
        );
    }
    let _ = write!(text, "\n[[obstacle]]\n{obstacle}\n[collision]\ncapsules = \"auto\"\nradius = {RADIUS}\n");
    let jerks: Vec<f64> = rates.collect();
    let _ = write!(text, "\n[limits]\njerk_max = {}\nfrom_robot = true\n", list(&jerks));
    text
}

/// Numbers as TOML writes them.
fn list(numbers: &[f64]) -> String {
    format!("{numbers:?}")
}
