//! What the tree of a robot without visual models says about its shape.

use costate::robot::{Joint, LinkInertia, Robot};

/// Shorter distances count as none (m).
pub(crate) const SHORTEST: f64 = 1e-9;

/// Whether a joint is a coordinate of a base that moves freely, and not a slide: its link, and those that
/// carry it, have no mass.
/// So is a part of a floating or spherical joint, wherever that is.
pub(crate) fn moves_freely(robot: &Robot, joint: usize) -> bool {
    robot.joints()[joint].free.is_some() || is_massless_base(robot, joint)
}

fn is_massless_base(robot: &Robot, joint: usize) -> bool {
    let Joint { inertia, parent, .. } = &robot.joints()[joint];
    inertia.mass == 0.0 && parent.is_none_or(|parent| is_massless_base(robot, parent))
}

/// Edges of the uniform box along the axes of its frame that has mass and moments of inertia of a link (m);
/// `None` for points and rods.
pub(crate) fn equal_box(inertia: &LinkInertia) -> Option<[f64; 3]> {
    let moments = [0, 1, 2].map(|k| inertia.inertia[(k, k)]);
    let sum: f64 = moments.iter().sum();
    // I_xx = m (b^2 + c^2)/12, so a^2 = 6 (I_yy + I_zz - I_xx)/m.
    let edges = moments.map(|moment| (6.0 * (sum - 2.0 * moment) / inertia.mass).sqrt());
    edges.iter().all(|edge| edge.is_finite() && *edge > SHORTEST).then_some(edges)
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
    use super::{end_of, equal_box, is_trunk, moves_freely};
    use costate::robot::{LinkInertia, Robot};

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

    #[test]
    fn bodies_have_the_edges_of_their_boxes() {
        let [a, b, c] = [0.3_f64, 0.7, 1.1];
        let mut inertia = LinkInertia::point(5.0, [0.1, 0.0, 0.0]);
        assert_eq!(equal_box(&inertia), None);
        for (k, [p, q]) in [[b, c], [c, a], [a, b]].into_iter().enumerate() {
            inertia.inertia[(k, k)] = 5.0 * (p * p + q * q) / 12.0;
        }
        let edges = equal_box(&inertia).unwrap();
        assert!(edges.iter().zip([a, b, c]).all(|(found, edge)| (found - edge).abs() < 1e-14), "{edges:?}");
    }
}
