//! Which bodies keep away from what.

use super::bodies::{Link, links, segment};
use super::clearance::{Body, Clearances, CoreBox, Obstacle as Placed, Other};
use super::functions::{Part, TaskFunctions};
use super::given::{Given, direction, finite, length, positive_or_zero};
use super::row::Row;
use crate::constants::task::MOST_PAIRS;
use crate::problem::error::ProblemError;
use crate::problem::key::Key;
use crate::problem::obstacles::{BodyPairs, Obstacle, Shape};
use crate::problem::task::Task;
use crate::problem::task_error::TaskError;
use crate::problem::tools;
use costate::robot::Robot;
use nalgebra::Vector3;
use std::collections::{HashMap, HashSet};

/// Adds the clearances of a task.
pub(super) fn push(robot: &Robot, task: &Task, functions: &mut TaskFunctions) -> Result<(), ProblemError> {
    let collision = task.collision.clone().unwrap_or_default();
    let own = links(robot, &collision)?;
    if own.is_empty() {
        let nothing = task.obstacles.is_empty() && task.collision.is_none();
        let [table, name] =
            if task.collision.is_some() { ["collision", "capsules"] } else { ["obstacle", "kind"] };
        return if nothing { Ok(()) } else { Err(TaskError::NoBodies.at(Key::entry(table, name, 0))) };
    }
    positive_or_zero(key("margin"), collision.margin)?;
    let mut bodies: Vec<Body> = own.iter().map(|link| link.body.clone()).collect();
    let mut others = Vec::new();
    for (entry, obstacle) in task.obstacles.iter().enumerate() {
        others.push(other(Given { table: "obstacle", entry }, &obstacle.shape, &mut bodies)?);
    }
    let names = Names::new(&own, &task.obstacles)?;
    let except: HashSet<[usize; 2]> = names.pairs(key("except"), &collision.except)?.into_iter().collect();
    few(own.len() * others.len())?;
    let mut pairs = Vec::new();
    for body in 0..own.len() {
        pairs.extend(others.iter().enumerate().map(|(k, other)| ([body, own.len() + k], other.clone())));
    }
    let listed = match &collision.pairs {
        BodyPairs::None => Vec::new(),
        BodyPairs::All => all_pairs(robot, &own),
        BodyPairs::These(listed) => names.pairs(key("pairs"), listed)?,
    };
    for [a, b] in listed {
        if a >= own.len() || b >= own.len() {
            // A pair with an obstacle, which counts anyway.
            continue;
        }
        pairs.push(([a, b], Other::Body(b)));
    }
    pairs.retain(|(pair, _)| !except.contains(pair));
    few(pairs.len())?;
    let mut clearances = Clearances::new(bodies, functions.placed(robot));
    let mut rows = Vec::new();
    for (pair, other) in pairs {
        let [a, b] = pair.map(|k| names.of(k));
        let is_flat = matches!(other, Other::HalfSpace { .. });
        let obstacle = pair[1].checked_sub(own.len());
        match clearances.push(pair[0], other, obstacle, collision.margin, functions.placed(robot)) {
            Some((_, 0.0)) if !is_flat => {
                let names = [a, b].map(str::to_owned);
                return Err(TaskError::NoRadius { names }.at(key("margin")));
            }
            Some((count, radius)) => {
                let row = Row::clearance(radius, is_flat, format!("clearance of '{a}' from '{b}'"));
                rows.extend(std::iter::repeat_n(row, count));
            }
            None if matches!(collision.pairs, BodyPairs::These(_)) && pair[1] < own.len() => {
                let names = [a, b].map(str::to_owned);
                return Err(TaskError::FixedPair { names }.at(key("pairs")));
            }
            // A link that only turns about its own axis, beside a floor: nothing to keep.
            None => {}
        }
    }
    if !rows.is_empty() {
        functions.push(robot, Part::Clearances(clearances), rows);
    }
    Ok(())
}

fn key(name: &'static str) -> Key {
    Key::entry("collision", name, 0)
}

/// Not more pairs than there may be.
fn few(found: usize) -> Result<(), ProblemError> {
    if found <= MOST_PAIRS {
        Ok(())
    } else {
        Err(TaskError::TooMany { found, most: MOST_PAIRS }.at(key("pairs")))
    }
}

/// An obstacle; spheres and capsules join the bodies.
fn other(at: Given, shape: &Shape, bodies: &mut Vec<Body>) -> Result<Other, ProblemError> {
    Ok(match in_world(at, shape)? {
        Placed::Body(body) => {
            bodies.push(body);
            Other::Body(bodies.len() - 1)
        }
        Placed::Box(core) => Other::Box(core),
        Placed::HalfSpace { normal, height } => Other::HalfSpace { normal, height },
    })
}

/// A shape whose numbers are checked; allocates for errors alone.
fn in_world(at: Given, shape: &Shape) -> Result<Placed, ProblemError> {
    let round = |from: &[f64; 3], to: Option<&[f64; 3]>, radius: f64| {
        let from = Vector3::from(*from);
        let to = segment(&from, to.map(|to| Vector3::from(*to)));
        Placed::Body(Body { carried: None, from, to, radius })
    };
    Ok(match shape {
        Shape::Sphere { centre, radius } => {
            finite(at.key("xyz"), centre)?;
            length(at.key("radius"), *radius)?;
            round(centre, None, *radius)
        }
        Shape::Capsule { from, to, radius } => {
            finite(at.key("from"), from)?;
            finite(at.key("to"), to)?;
            length(at.key("radius"), *radius)?;
            round(from, Some(to), *radius)
        }
        Shape::Box { placement, size } => {
            finite(at.key("xyz"), placement.translation.as_slice())?;
            size.iter().try_for_each(|&size| length(at.key("size"), size))?;
            let rows = [0, 1, 2].map(|i| [0, 1, 2].map(|j| placement.rotation[(i, j)]));
            let axes = tools::rotation(rows).ok_or_else(|| TaskError::NotARotation.at(at.key("rpy")))?;
            let half = Vector3::from(*size) * 0.5;
            Placed::Box(CoreBox { axes: axes.into_inner(), centre: placement.translation, half })
        }
        Shape::HalfSpace { through, normal } => {
            finite(at.key("xyz"), through)?;
            let normal = direction(at.key("normal"), *normal)?;
            Placed::HalfSpace { normal, height: normal.dot(&Vector3::from(*through)) }
        }
    })
}

/// Moves obstacle `entry` of a task.
///
/// # Errors
/// The cause: numbers out of range, another shape or size.
pub(crate) fn move_obstacle(
    functions: &mut TaskFunctions,
    entry: usize,
    shape: &Shape,
) -> Result<(), TaskError> {
    match in_world(Given { table: "obstacle", entry }, shape) {
        Ok(to) if functions.move_obstacle(entry, &to) => Ok(()),
        Ok(_) => Err(TaskError::OtherShape),
        Err(ProblemError::Task { cause, .. }) => Err(cause),
        // What is wrong with a shape is wrong with the task.
        Err(_) => Err(TaskError::NotFinite),
    }
}

/// The names of bodies, then of obstacles.
struct Names {
    names: Vec<String>,
    numbers: HashMap<String, usize>,
}

impl Names {
    fn new(own: &[Link], obstacles: &[Obstacle]) -> Result<Self, ProblemError> {
        let (mut names, mut numbers) = (Vec::new(), HashMap::new());
        let all = own.iter().map(|link| (&link.name, "collision.capsule"));
        for (name, table) in all.chain(obstacles.iter().map(|obstacle| (&obstacle.name, "obstacle"))) {
            let number = names.len();
            if numbers.insert(name.clone(), number).is_some() {
                let entry = if table == "obstacle" { number - own.len() } else { number };
                let error = TaskError::DuplicateName { name: name.clone() };
                return Err(error.at(Key::entry(table, "name", entry)));
            }
            names.push(name.clone());
        }
        Ok(Self { names, numbers })
    }

    fn of(&self, k: usize) -> &str {
        &self.names[k]
    }

    /// Pairs by their numbers, the smaller one first.
    fn pairs(&self, key: Key, pairs: &[[String; 2]]) -> Result<Vec<[usize; 2]>, ProblemError> {
        let number = |name: &String| {
            self.numbers.get(name).copied().ok_or_else(|| {
                TaskError::UnknownBody { name: name.clone(), known: self.names.clone() }.at(key)
            })
        };
        let pair = |[a, b]: &[String; 2]| {
            let (a, b) = (number(a)?, number(b)?);
            if a == b {
                let names = [a, b].map(|k| self.names[k].clone());
                return Err(TaskError::FixedPair { names }.at(key));
            }
            Ok([a.min(b), a.max(b)])
        };
        pairs.iter().map(pair).collect()
    }
}

/// All pairs on links that are no neighbours: between neighbours there is no link with a body of its own.
fn all_pairs(robot: &Robot, own: &[Link]) -> Vec<[usize; 2]> {
    let joints = robot.joints();
    let mut has_body = vec![false; joints.len()];
    own.iter().filter_map(|link| link.joint).for_each(|joint| has_body[joint] = true);
    // The nearest link with a body that carries each link; parents come before children.
    let mut inner: Vec<Option<usize>> = Vec::with_capacity(joints.len());
    for joint in joints {
        inner.push(
            joint.parent.and_then(|parent| if has_body[parent] { Some(parent) } else { inner[parent] }),
        );
    }
    let carries = |a: Option<usize>, b: Option<usize>| b.is_some_and(|b| inner[b] == a);
    let near = |a, b| a == b || carries(a, b) || carries(b, a);
    let pairs = (0..own.len()).flat_map(|a| (a + 1..own.len()).map(move |b| [a, b]));
    pairs.filter(|&[a, b]| !near(own[a].joint, own[b].joint)).collect()
}

#[cfg(test)]
#[path = "collision_tests.rs"]
mod tests;
