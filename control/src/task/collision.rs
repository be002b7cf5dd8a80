//! Which bodies keep away from what.

use super::bodies::{Link, links, segment};
use super::clearance::{Body, Clearances, CoreBox, Obstacle as Placed, Other};
use super::functions::{Part, TaskFunctions};
use super::given::{Given, direction, finite, length, positive_or_zero};
use super::payloads::{Against, bodies, loads};
use super::row::{CLEARANCE, Row};
use crate::constants::task::MOST_PAIRS;
use crate::problem::Problem;
use crate::problem::error::ProblemError;
use crate::problem::key::Key;
use crate::problem::obstacles::{BodyPairs, Obstacle, Shape};
use crate::problem::task_error::TaskError;
use crate::problem::tools;
use costate::robot::Robot;
use nalgebra::Vector3;
use std::collections::{HashMap, HashSet};

/// A sphere or capsule of the robot, or of what it carries.
struct Round {
    /// The number of the body of which it is a part.
    of: usize,
    body: Body,
    against: Against,
    /// The phases in which it is there: `None` for all.
    phases: Option<Vec<bool>>,
}

/// Adds the clearances of a problem.
pub(super) fn push(
    robot: &Robot,
    problem: &Problem,
    functions: &mut TaskFunctions,
) -> Result<(), ProblemError> {
    let task = &problem.task;
    let collision = task.collision.clone().unwrap_or_default();
    let mut own = links(robot, &collision)?;
    let whole = |(of, link): (usize, &Link)| Round {
        of,
        body: link.body.clone(),
        against: Against::All,
        phases: None,
    };
    let mut rounds: Vec<Round> = own.iter().enumerate().map(whole).collect();
    let listed = own.len();
    if task.has_collisions() {
        for load in loads(problem) {
            let parts = bodies(robot, &load)?;
            let Some((first, _)) = parts.first() else { continue };
            let named = own[listed..].iter().filter(|link| {
                let rest = link.name.strip_prefix(&first.name);
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(' '))
            });
            let number = named.count() + 1;
            let name = if number > 1 { format!("{} {number}", first.name) } else { first.name.clone() };
            let of = own.len();
            own.push(Link { name, ..first.clone() });
            rounds.extend(parts.into_iter().map(|(part, against)| {
                let phases = load.phases.clone();
                Round { of, body: part.body, against, phases }
            }));
        }
    }
    if own.is_empty() {
        let nothing = task.obstacles.is_empty() && task.collision.is_none();
        let [table, name] =
            if task.collision.is_some() { ["collision", "capsules"] } else { ["obstacle", "kind"] };
        return if nothing { Ok(()) } else { Err(TaskError::NoBodies.at(Key::entry(table, name, 0))) };
    }
    positive_or_zero(key("margin"), collision.margin)?;
    let mut bodies: Vec<Body> = rounds.iter().map(|round| round.body.clone()).collect();
    let mut others = Vec::new();
    for (entry, obstacle) in task.obstacles.iter().enumerate() {
        others.push(other(Given { table: "obstacle", entry }, &obstacle.shape, &mut bodies)?);
    }
    let names = Names::new(&own, &task.obstacles)?;
    let except: HashSet<[usize; 2]> = names.pairs(key("except"), &collision.except)?.into_iter().collect();
    few(rounds.len() * others.len())?;
    let mut pairs: Vec<Between> = Vec::new();
    for (body, round) in rounds.iter().enumerate() {
        let counts = |other: &Other| match round.against {
            Against::All => true,
            Against::HalfSpaces => matches!(other, Other::HalfSpace { .. }),
            Against::Others => !matches!(other, Other::HalfSpace { .. }),
        };
        pairs.extend(others.iter().enumerate().filter(|(_, other)| counts(other)).map(|(k, other)| {
            Between {
                names: [round.of, own.len() + k],
                body,
                other: other.clone(),
                phases: round.phases.clone(),
            }
        }));
    }
    let asked = match &collision.pairs {
        BodyPairs::None => Vec::new(),
        BodyPairs::All => all_pairs(robot, &own),
        BodyPairs::These(listed) => names.pairs(key("pairs"), listed)?,
    };
    let parts = |of: usize| {
        let all = rounds.iter().enumerate();
        all.filter(move |(_, round)| round.of == of && round.against != Against::HalfSpaces)
    };
    for [a, b] in asked {
        if a >= own.len() || b >= own.len() {
            // A pair with an obstacle, which counts anyway.
            continue;
        }
        for (body, one) in parts(a) {
            pairs.extend(parts(b).map(|(k, other)| {
                let phases = match (&one.phases, &other.phases) {
                    (Some(a), Some(b)) => Some(a.iter().zip(b).map(|(a, b)| *a && *b).collect()),
                    (some, None) | (None, some) => some.clone(),
                };
                Between { names: [a, b], body, other: Other::Body(k), phases }
            }));
        }
    }
    pairs.retain(|pair| !except.contains(&pair.names));
    few(pairs.len())?;
    // Those that are always there, then those of each set of phases.
    let mut sets: Vec<Option<Vec<bool>>> = vec![None];
    pairs.iter().for_each(|pair| {
        if !sets.contains(&pair.phases) {
            sets.push(pair.phases.clone());
        }
    });
    for phases in sets {
        let mut clearances = Clearances::new(bodies.clone(), functions.placed(robot));
        let mut rows = Vec::new();
        for pair in pairs.iter().filter(|pair| pair.phases == phases) {
            let [a, b] = pair.names.map(|k| names.of(k));
            let is_flat = matches!(pair.other, Other::HalfSpace { .. });
            let obstacle = pair.names[1].checked_sub(own.len());
            let placed = functions.placed(robot);
            match clearances.push(pair.body, pair.other.clone(), obstacle, collision.margin, placed) {
                Some((_, 0.0)) if !is_flat => {
                    let names = [a, b].map(str::to_owned);
                    return Err(TaskError::NoRadius { names }.at(key("margin")));
                }
                Some((count, radius)) => {
                    let row = Row::clearance(radius, is_flat, format!("{CLEARANCE}'{a}' from '{b}'"));
                    rows.extend(std::iter::repeat_n(row, count));
                }
                None if matches!(collision.pairs, BodyPairs::These(_)) && pair.names[1] < own.len() => {
                    let names = [a, b].map(str::to_owned);
                    return Err(TaskError::FixedPair { names }.at(key("pairs")));
                }
                // A link that only turns about its own axis, beside a floor: nothing to keep.
                None => {}
            }
        }
        if !rows.is_empty() {
            functions.push_in(robot, Part::Clearances(clearances), rows, phases);
        }
    }
    Ok(())
}

/// A body and what it keeps away from.
struct Between {
    /// Their numbers among the names.
    names: [usize; 2],
    /// The number of the sphere or capsule.
    body: usize,
    other: Other,
    phases: Option<Vec<bool>>,
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
