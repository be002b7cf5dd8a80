//! The best position of the origin of each joint frame along its axis.
//!
//! The origin may lie anywhere on a revolute axis, and anywhere at all for a prismatic joint: q, v, p and M
//! are the same. At the foot of the common normal with the next axis the placement of the next frame has a
//! translation along x and one along the next axis, nothing else (modified Denavit-Hartenberg convention),
//! and none along x if the axes intersect.

use super::joint::{Joint, JointKind};
use super::model::Robot;
use nalgebra::Vector3;

/// Axes at an angle with a smaller sine count as parallel: the foot would be too far away.
pub(super) const LEAST_SINE: f64 = 0.3;

/// New origin of each joint frame, seen from the old one, in its axes (m).
pub(super) fn origins(robot: &Robot) -> Vec<Vector3<f64>> {
    let joints = robot.joints();
    let main_children = main_children(joints);
    let feet = feet(joints, &main_children);
    let mut origins: Vec<Vector3<f64>> = Vec::with_capacity(joints.len());
    for (i, joint) in joints.iter().enumerate() {
        let parent = joint.parent.map_or(Vector3::zeros(), |p| origins[p]);
        // The origin of the parent's frame, seen from this one.
        let outer = joint.placement.rotation.tr_mul(&(parent - joint.placement.translation));
        let beside = outer - joint.axis * outer.dot(&joint.axis);
        origins.push(match joint.kind {
            JointKind::Prismatic => {
                let foot = |&next: &usize| foot(joint, &beside, &joints[next]);
                beside + joint.axis * middle(main_children[i].iter().map(foot)).unwrap_or(0.0)
            }
            JointKind::Revolute => {
                let own_foot = || {
                    let outer_axis = joint.parent.map(|p| joint.placement.rotation.tr_mul(&joints[p].axis));
                    let foot = outer_axis.and_then(|axis| nearest(&-outer, &joint.axis, &axis));
                    foot.unwrap_or_else(|| outer.dot(&joint.axis))
                };
                joint.axis * feet[i].unwrap_or_else(own_foot)
            }
        });
    }
    origins
}

/// The children with the most joints beyond them: they determine the frame of their parent. Several, as the
/// two arms of a torso, have the same say, so that the frames of a symmetric robot are symmetric.
fn main_children(joints: &[Joint]) -> Vec<Vec<usize>> {
    let mut size = vec![1; joints.len()];
    let mut main_children = vec![Vec::new(); joints.len()];
    for (j, joint) in joints.iter().enumerate().rev() {
        let Some(parent) = joint.parent else { continue };
        size[parent] += size[j];
        let largest = main_children[parent].first().map_or(0, |&other: &usize| size[other]);
        if size[j] > largest {
            main_children[parent].clear();
        }
        if size[j] >= largest {
            main_children[parent].push(j);
        }
    }
    main_children
}

/// The middle between the first and the last of some positions, if all are known.
fn middle(positions: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let positions: Vec<f64> = positions.collect::<Option<_>>()?;
    let (least, most) =
        positions.iter().fold((f64::INFINITY, -f64::INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
    let middle = if least == most { least } else { 0.5 * (least + most) };
    (!positions.is_empty()).then_some(middle)
}

/// Displacement of the frame of a revolute joint along its axis to the foot towards its main child, or to the
/// middle of the feet towards several; `None` if a foot is not determined.
fn feet(joints: &[Joint], main_children: &[Vec<usize>]) -> Vec<Option<f64>> {
    let mut feet: Vec<Option<f64>> = vec![None; joints.len()];
    for (i, joint) in joints.iter().enumerate().rev() {
        if joint.kind != JointKind::Revolute {
            continue;
        }
        let towards = |&next: &usize| {
            if joints[next].kind != JointKind::Revolute {
                return None;
            }
            let level = |foot: f64| {
                let origin = joints[next].axis * foot;
                joint
                    .axis
                    .dot(&(joints[next].placement.rotation * origin + joints[next].placement.translation))
            };
            foot(joint, &Vector3::zeros(), &joints[next]).or(feet[next].map(level))
        };
        let foot = middle(main_children[i].iter().map(towards));
        feet[i] = foot;
    }
    feet
}

/// Position along the axis of `joint`, through `origin`, of the foot of its common normal with the axis of
/// `next`.
fn foot(joint: &Joint, origin: &Vector3<f64>, next: &Joint) -> Option<f64> {
    let other = next.placement.rotation * next.axis;
    nearest(&(origin - next.placement.translation), &joint.axis, &other)
}

/// Distance from a point of a line to the point of it that is nearest to another line; `apart` is the vector
/// from a point of the other line to the first point.
fn nearest(apart: &Vector3<f64>, along: &Vector3<f64>, other: &Vector3<f64>) -> Option<f64> {
    let across = along - other * along.dot(other);
    let square = across.norm_squared();
    (square >= LEAST_SINE * LEAST_SINE).then(|| -apart.dot(&across) / square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{JointSpec, Placement, Tree};

    fn placed(x: f64) -> Placement {
        Placement::from_xyz_rpy([x, -0.4, 0.7 - x], [0.4 + x, -1.1, 2.0 * x])
    }

    #[test]
    fn chains_in_general_directions_become_denavit_hartenberg_tables() {
        let axis = [0.3, -0.5, 0.8];
        let robot = (0..5).fold(Robot::builder("chain"), |builder, i| {
            let joint =
                if i == 3 { JointSpec::prismatic("slide") } else { JointSpec::revolute(format!("j{i}")) };
            let joint = joint.placed(placed(0.3 * f64::from(i))).axis(axis).armature(1.0);
            builder.joint(if i == 0 {
                joint
            } else if i == 4 {
                joint.on("slide")
            } else {
                joint.on(format!("j{}", i - 1))
            })
        });
        let tree = Tree::from(&robot.build().unwrap());
        for joint in &tree.joints()[1..] {
            let [_, y, z] = joint.screw.translation;
            assert_eq!([y, z], [0.0; 2], "{joint:?}");
            assert!(
                joint.screw.gamma.is_none()
                    || joint.parent.is_some_and(|p| tree.joints()[p].kind == JointKind::Prismatic)
            );
        }
        assert_eq!((tree.joints()[3].screw.translation, tree.joints()[3].screw.rise), ([0.0; 3], 0.0));
        assert!(tree.joints()[3].offset != 0.0 && tree.joints()[4].screw.rise == 0.0);
    }

    #[test]
    fn parallel_axes_stand_on_one_level_and_nearly_parallel_ones_stay_where_they_are() {
        for (tilt, level) in [(0.0, true), (0.05, false)] {
            let robot = (0..4).fold(Robot::builder("planar"), |builder, i| {
                let place = Placement::from_xyz_rpy([0.5, 0.0, 0.2], [tilt, 0.0, 0.0]);
                let joint = JointSpec::revolute(format!("j{i}")).placed(place).armature(1.0);
                builder.joint(if i == 0 { joint } else { joint.on(format!("j{}", i - 1)) })
            });
            let robot = robot.build().unwrap();
            let tree = Tree::from(&robot);
            for joint in &tree.joints()[1..] {
                let [x, y, z] = joint.screw.translation;
                assert!((x.hypot(y) - 0.5).abs() < 0.02, "{joint:?}");
                assert!(if level { z == 0.0 } else { z.abs() < 0.2 }, "{joint:?}");
            }
        }
    }
}
