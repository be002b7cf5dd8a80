//! The robot as a stick figure: points in the world frame and lines between them.

use crate::entries::is_floating;
use crate::shape::{SHORTEST, end_of, is_trunk, moves_freely};
use crate::soles::Sole;
use costate::EvalError;
use costate::configuration::ConfigurationSpace;
use costate::robot::{JointKind, Placement, Robot};
use costate_control::Trajectory;

/// x, y, z in the world frame (m).
pub type Point = [f64; 3];

/// The meaning of a line of the figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part {
    /// From the origin of the world frame to a joint on the base.
    Base,
    /// Between two joints, or from the last joint to the end of its link, or along the edge of a sole.
    Link,
    /// The displacement of a prismatic joint, but for those of a base that moves freely.
    Slide,
}

impl Part {
    pub fn name(self) -> &'static str {
        match self {
            Self::Base => "base",
            Self::Link => "link",
            Self::Slide => "slide",
        }
    }
}

/// Point 0 is the origin of the world frame. Point 1 + 2 i is the origin of the frame of joint i at q = 0 of
/// this joint, point 2 + 2 i its origin at the actual position; for a revolute joint both are the same. The
/// ends of the links without a child follow, and of trunks; then the corners of soles.
pub struct Skeleton<'a> {
    robot: &'a Robot,
    space: ConfigurationSpace,
    leaves: Vec<usize>,
    soles: &'a [Sole],
    /// Two points and the meaning of the line between them.
    pub lines: Vec<(usize, usize, Part)>,
    /// The points whose path is drawn: one for each link without a child, and for each trunk.
    pub tips: Vec<usize>,
}

/// The point of joint i before its displacement.
fn placed(i: usize) -> usize {
    1 + 2 * i
}

/// The point of joint i after its displacement.
pub fn moved(i: usize) -> usize {
    2 + 2 * i
}

impl<'a> Skeleton<'a> {
    pub fn new(robot: &'a Robot, soles: &'a [Sole]) -> Self {
        let n = robot.joints().len();
        let carries = |i: usize| robot.joints().iter().any(|joint| joint.parent == Some(i));
        let leaves: Vec<usize> = (0..n).filter(|&i| !carries(i) || is_trunk(robot, i)).collect();
        let mut lines = Vec::new();
        for (i, joint) in robot.joints().iter().enumerate() {
            let length = joint.placement.translation.norm();
            let (from, part) = joint.parent.map_or((0, Part::Base), |parent| (moved(parent), Part::Link));
            // Nothing holds what floats.
            if length > SHORTEST && !is_floating(joint) {
                lines.push((from, placed(i), part));
            }
            if joint.kind == JointKind::Prismatic && !moves_freely(robot, i) {
                lines.push((placed(i), moved(i), Part::Slide));
            }
        }
        let mut tips = Vec::new();
        for (k, &leaf) in leaves.iter().enumerate() {
            let tip = 1 + 2 * n + k;
            let has_length = end_of(robot, leaf).iter().any(|part| part.abs() > SHORTEST);
            tips.push(if has_length { tip } else { moved(leaf) });
            if has_length {
                lines.push((moved(leaf), tip, Part::Link));
            }
        }
        let mut first = 1 + 2 * n + leaves.len();
        for sole in soles {
            let corners = sole.outline().len();
            // Around; heel and toe have one line.
            let edges = if corners > 2 { corners } else { 1 };
            lines.extend((0..edges).map(|k| (first + k, first + (k + 1) % corners, Part::Link)));
            first += corners;
        }
        Self { robot, space: ConfigurationSpace::new(robot), leaves, soles, lines, tips }
    }

    /// All points at q (rad, m); quaternions may have any length but 0.
    pub fn points(&self, q: &[f64]) -> Result<Vec<Point>, EvalError> {
        let mut q = q.to_vec();
        self.space.normalize(&mut q)?;
        let poses = self.robot.poses(&q)?;
        let joints = self.robot.joints();
        let mut points = vec![[0.0; 3]; 1 + 2 * joints.len() + self.leaves.len()];
        for (i, (joint, pose)) in joints.iter().zip(&poses).enumerate() {
            let frame = joint.parent.map_or(joint.placement, |p| poses[p].then(&joint.placement));
            points[placed(i)] = frame.translation.into();
            points[moved(i)] = pose.translation.into();
        }
        for (k, &leaf) in self.leaves.iter().enumerate() {
            let end = Placement::from_xyz_rpy(end_of(self.robot, leaf), [0.0; 3]);
            points[1 + 2 * joints.len() + k] = poses[leaf].then(&end).translation.into();
        }
        for sole in self.soles {
            points.extend(sole.outline().into_iter().map(|corner| {
                let corner = Placement::from_xyz_rpy(corner, [0.0; 3]);
                Point::from(poses[sole.joint].then(&corner).translation)
            }));
        }
        Ok(points)
    }
}

/// The points of the figure at `count` times from start to end; poses that are not finite are omitted.
pub fn film(skeleton: &Skeleton<'_>, motion: &Trajectory, count: usize) -> Vec<Vec<Point>> {
    let [first, .., last] = motion.t[..] else {
        return motion.q.iter().filter_map(|q| skeleton.points(q).ok()).collect();
    };
    let time = |k: usize| first + (last - first) * k as f64 / (count - 1) as f64;
    let point = |k: usize| motion.at(time(k).clamp(first, last));
    let frames = (0..count).filter_map(point).filter_map(|point| skeleton.points(&point.q).ok());
    frames.filter(|points| points.iter().flatten().all(|x| x.is_finite())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use costate::robot::{JointSpec, LinkInertia};

    #[test]
    fn a_cart_with_a_pole_has_a_slide_and_a_link() {
        let cart =
            JointSpec::prismatic("cart").axis([1.0, 0.0, 0.0]).carrying(LinkInertia::point(1.0, [0.0; 3]));
        let pole = JointSpec::revolute("pole").on("cart").axis([0.0, 1.0, 0.0]);
        let pole = pole.carrying(LinkInertia::point(1.0, [0.0, 0.0, 0.5]));
        let lift = Placement::from_xyz_rpy([0.0, 0.0, 0.2], [0.0; 3]);
        let robot = Robot::builder("cart pole").joint(cart).joint(pole.placed(lift)).build().unwrap();
        let skeleton = Skeleton::new(&robot, &[]);
        let parts: Vec<_> = skeleton.lines.iter().map(|line| line.2).collect();
        assert_eq!(parts, [Part::Slide, Part::Link, Part::Link]);
        let points = skeleton.points(&[0.7, std::f64::consts::FRAC_PI_2]).unwrap();
        let expected =
            [[0.0; 3], [0.0; 3], [0.7, 0.0, 0.0], [0.7, 0.0, 0.2], [0.7, 0.0, 0.2], [1.2, 0.0, 0.2]];
        for (point, expected) in points.iter().zip(&expected) {
            assert!(point.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{points:?}");
        }
        assert_eq!(skeleton.tips, [5]);
    }
}
