//! The bodies that links carry.

use super::clearance::Body;
use super::given::{Given, finite, frame_of, length, positive_or_zero};
use super::placed::Carried;
use crate::constants::task::SHORTEST_LINK;
use crate::problem::error::ProblemError;
use crate::problem::key::Key;
use crate::problem::obstacles::{Collision, LinkCapsule};
use costate::robot::Robot;
use nalgebra::Vector3;

/// A body with its name.
#[derive(Clone, Debug)]
pub(super) struct Link {
    pub name: String,
    /// The joint that moves it; `None` for one that is fixed to the world.
    pub joint: Option<usize>,
    pub body: Body,
}

/// Bodies that are listed, then those along the links.
pub(super) fn links(robot: &Robot, collision: &Collision) -> Result<Vec<Link>, ProblemError> {
    let mut links = Vec::new();
    for (entry, capsule) in collision.capsules.iter().enumerate() {
        links.push(listed(robot, Given { table: "collision.capsule", entry }, capsule)?);
    }
    if let Some(radius) = collision.along_links {
        length(Key::entry("collision", "radius", 0), radius)?;
        (0..robot.joints().len()).for_each(|joint| lay_along(robot, joint, radius, &mut links));
    }
    Ok(links)
}

fn listed(robot: &Robot, at: Given, capsule: &LinkCapsule) -> Result<Link, ProblemError> {
    let frame = frame_of(robot, at.key("frame"), &capsule.frame)?;
    finite(at.key("from"), &capsule.from)?;
    positive_or_zero(at.key("radius"), capsule.radius)?;
    let from = Vector3::from(capsule.from);
    if let Some(to) = &capsule.to {
        finite(at.key("to"), to)?;
    }
    Ok(Link {
        name: capsule.name.clone(),
        joint: robot.frames()[frame].joint,
        body: Body {
            carried: Some(Carried::new(robot, frame)),
            from,
            to: segment(&from, capsule.to.map(Vector3::from)),
            radius: capsule.radius,
        },
    })
}

/// The end of a segment, unless it is so short that it is a point.
pub(super) fn segment(from: &Vector3<f64>, to: Option<Vector3<f64>>) -> Option<Vector3<f64>> {
    to.filter(|to| (to - from).norm() > SHORTEST_LINK)
}

/// Capsules from a joint to those beyond it, or to the farthest frame of a last link; a sphere if there is
/// none. A link whose joints all meet in one point gets nothing.
fn lay_along(robot: &Robot, joint: usize, radius: f64, links: &mut Vec<Link>) {
    let children = robot.joints().iter().filter(|child| child.parent == Some(joint));
    let mut ends: Vec<Vector3<f64>> = children.map(|child| child.placement.translation).collect();
    let is_last = ends.is_empty();
    if is_last {
        let on_link = robot.frames().iter().filter(|frame| frame.joint == Some(joint));
        let farther = |a: Vector3<f64>, b: Vector3<f64>| if b.norm() > a.norm() { b } else { a };
        ends.push(on_link.map(|frame| frame.placement.translation).fold(Vector3::zeros(), farther));
    }
    let mut laid: Vec<Option<Vector3<f64>>> = Vec::new();
    for end in ends {
        let to = segment(&Vector3::zeros(), Some(end));
        if (to.is_some() || is_last) && !laid.contains(&to) {
            laid.push(to);
        }
    }
    // A part inside of a floating or spherical joint has no frame, and no link along it.
    let Some(frame) = robot.frame_of_joint(joint) else { return };
    let name = &robot.joints()[joint].link;
    links.extend(laid.into_iter().enumerate().map(|(k, to)| Link {
        name: if k == 0 { name.clone() } else { format!("{name} {}", k + 1) },
        joint: Some(joint),
        body: Body { carried: Some(Carried::new(robot, frame)), from: Vector3::zeros(), to, radius },
    }));
}

#[cfg(test)]
#[path = "bodies_tests.rs"]
mod tests;
