//! What the tree of a robot without visual models says about its shape.

use costate::robot::{Joint, Robot};

/// Shorter distances count as none (m).
pub(crate) const SHORTEST: f64 = 1e-9;

/// Whether a joint is a coordinate of a base that moves freely, and not a slide: its link, and those that
/// carry it, have no mass.
pub(crate) fn moves_freely(robot: &Robot, joint: usize) -> bool {
    let Joint { inertia, parent, .. } = &robot.joints()[joint];
    inertia.mass == 0.0 && parent.is_none_or(|parent| moves_freely(robot, parent))
}

/// Whether the link of a joint carries several others that are nearer to its origin than its own centre of
/// mass, as a torso that stands on its hips: where it is, its centre of mass says.
pub(crate) fn is_trunk(robot: &Robot, joint: usize) -> bool {
    let children = || robot.joints().iter().filter(|child| child.parent == Some(joint));
    let com = robot.joints()[joint].inertia.com.norm();
    children().count() > 1 && children().all(|child| child.placement.translation.norm() < com)
}

/// The end of a link that carries no other one, or of a trunk, in the frame of its joint (m): the frame on it
/// that is farthest away, as a foot or a flange; without one its centre of mass.
pub(crate) fn end_of(robot: &Robot, joint: usize) -> [f64; 3] {
    let frames = robot.frames().iter().filter(|frame| frame.joint == Some(joint));
    let frames = frames.map(|frame| frame.placement.translation);
    let farthest = frames.max_by(|a, b| a.norm().total_cmp(&b.norm()));
    let com = robot.joints()[joint].inertia.com;
    farthest.filter(|end| end.norm() > SHORTEST).unwrap_or(com).into()
}

#[cfg(test)]
mod tests {
    use super::{end_of, is_trunk, moves_freely};
    use costate::robot::Robot;

    #[test]
    fn rabbit_has_a_free_base_and_a_trunk() {
        let rabbit = Robot::from_file("../../robots/rabbit.toml").unwrap();
        let joints = |is: fn(&Robot, usize) -> bool| -> Vec<&str> {
            let all = rabbit.joints().iter().enumerate();
            all.filter(|&(i, _)| is(&rabbit, i)).map(|(_, joint)| &*joint.name).collect()
        };
        assert_eq!(joints(moves_freely), ["base_x", "base_z"]);
        assert_eq!(joints(is_trunk), ["torso"]);
        // A foot; the head has no frame.
        assert_eq!(end_of(&rabbit, 4), [0.0, 0.0, -0.4]);
        assert_eq!(end_of(&rabbit, 2), [0.0, 0.0, 0.2]);
        let cart = Robot::from_file("../../robots/cart_pole.toml").unwrap();
        assert!(!moves_freely(&cart, 0));
        // Its hips are beside the origin of the pelvis, which carries trunk and head.
        let biped = Robot::from_file("../../robots/biped_walker.toml").unwrap();
        assert!(is_trunk(&biped, 5) && !(6..18).any(|joint| is_trunk(&biped, joint)));
        // Its hips are at both ends of the trunk.
        let quadruped = Robot::from_file("../../robots/quadruped.toml").unwrap();
        assert!(!(0..quadruped.dof()).any(|joint| is_trunk(&quadruped, joint)));
    }
}
