//! Clearances that are violated wherever the robot is, while a point of a link has a given place.

use super::Clearances;
use super::pair::{Body, Held, Other};
use costate::robot::Robot;
use nalgebra::Vector3;

impl Clearances {
    /// The clearance that is violated most, by its row, and by how much at least (m).
    ///
    /// A core of the link of the joint comes as near to the point as d, whatever the joints do. With the
    /// distance s of the place from an obstacle, negative inside, the core is not farther from it than
    /// s + d.
    pub fn violated_at(&self, robot: &Robot, held: &Held) -> Option<(usize, f64)> {
        let mut first = 0;
        let mut worst: Option<(usize, f64)> = None;
        for pair in &self.pairs {
            let row = first;
            first += self.rows_of(pair);
            let Some(near) = distance_on_link(robot, &self.bodies[pair.body], held) else { continue };
            let Some(depth) = self.distance_from(&pair.other, &held.place) else { continue };
            let by = pair.radius - depth - near;
            if worst.is_none_or(|(_, most)| by > most) {
                worst = Some((row, by));
            }
        }
        worst.filter(|&(_, by)| by > 0.0)
    }

    /// The signed distance of a place from the core of an obstacle; `None` from what moves, and where a free
    /// coordinate matters.
    fn distance_from(&self, other: &Other, place: &Vector3<f64>) -> Option<f64> {
        if let Other::HalfSpace { normal, height } = other {
            let terms = normal.iter().zip(place).filter(|(normal, _)| **normal != 0.0);
            let along: f64 = terms.map(|(normal, x)| normal * x).sum();
            return along.is_finite().then_some(along - height);
        }
        if !place.iter().all(|x| x.is_finite()) {
            return None;
        }
        match other {
            Other::Body(b) => {
                let body = &self.bodies[*b];
                body.carried.is_none().then(|| from_segment(&body.from, body.to.as_ref(), place))
            }
            Other::Box(core) => {
                let beyond = (core.axes.transpose() * (place - core.centre)).abs() - core.half;
                let outside = beyond.map(|x| x.max(0.0)).norm();
                Some(outside + beyond.max().min(0.0))
            }
            Other::HalfSpace { .. } => None,
        }
    }
}

/// The distance of the point from the core of a body; `None` if that is on another link.
fn distance_on_link(robot: &Robot, body: &Body, held: &Held) -> Option<f64> {
    let frame = robot.frames().get(body.carried.as_ref()?.frame)?;
    let placed = |x: &Vector3<f64>| frame.placement.translation + frame.placement.rotation * x;
    let to = body.to.as_ref().map(placed);
    (frame.joint == Some(held.joint)).then(|| from_segment(&placed(&body.from), to.as_ref(), &held.own))
}

/// The distance of a point from a segment, or from its first point where it has no other.
fn from_segment(from: &Vector3<f64>, to: Option<&Vector3<f64>>, x: &Vector3<f64>) -> f64 {
    let Some(to) = to else { return (x - from).norm() };
    let way = to - from;
    let part = ((x - from).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
    (x - from - way * part).norm()
}
