//! Inertial parameters whose effect equals that of parameters of the parent are moved to the parent.
//!
//! A body that is symmetric about a revolute axis (mass m, first moment along the axis, inertia `J diag(1, 1,
//! 0)`) can be fixed to the parent without a change of L(q, v). Of the ten parameters of a link beyond a
//! revolute joint seven remain; beyond a prismatic joint, which does not rotate, four remain: the base
//! parameters (W. Khalil, J.-F. Bennis, International Journal of Robotics Research 14 (1995) 382-393). What
//! reaches the world does not move and contributes to V only.

use super::joint::JointKind;
use super::joint_frame::JointFrame;
use crate::spatial::{ConstantInertia, Inertia, Symmetric3, Vec3};

/// Fills `lumped` and `lumped_mass` of every joint; returns V (J) of what was moved to the world.
///
/// Nothing is moved across the `turned` joints, the revolute ones of floating and spherical joints: they turn
/// together, not one after the other.
pub(super) fn regroup(joints: &mut [JointFrame], gravity: [f64; 3], turned: &[usize]) -> f64 {
    let mut potential = 0.0;
    for i in (0..joints.len()).rev() {
        let joint = &mut joints[i];
        if turned.contains(&i) {
            joint.lumped_mass += joint.lumped.mass;
            let (parent, mass) = (joint.parent, joint.lumped_mass);
            parent.into_iter().for_each(|parent| joints[parent].lumped_mass += mass);
            continue;
        }
        let body = joint.lumped;
        let [xx, yy, zz, xy, xz, yz] = body.matrix;
        let [hx, hy, hz] = body.first_moment;
        let (kept, moved) = match joint.kind {
            JointKind::Revolute => (
                ConstantInertia {
                    mass: 0.0,
                    first_moment: [hx, hy, 0.0],
                    matrix: [xx - yy, 0.0, zz, xy, xz, yz],
                },
                ConstantInertia {
                    mass: body.mass,
                    first_moment: [0.0, 0.0, hz],
                    matrix: [yy, yy, 0.0, 0.0, 0.0, 0.0],
                },
            ),
            JointKind::Prismatic => (
                ConstantInertia { matrix: [0.0; 6], ..body },
                ConstantInertia { mass: 0.0, first_moment: [0.0; 3], matrix: body.matrix },
            ),
        };
        joint.lumped = kept;
        joint.lumped_mass += kept.mass;
        let moved = joint.transform(0.0).inertia_up(&moved.lift::<f64>());
        let (parent, mass) = (joint.parent, joint.lumped_mass);
        match parent {
            Some(parent) => {
                joints[parent].lumped_mass += mass;
                add(&mut joints[parent].lumped, &moved);
            }
            None => potential -= Vec3::constant(gravity).dot(moved.first_moment),
        }
    }
    potential
}

fn add(body: &mut ConstantInertia, moved: &Inertia<f64>) {
    let Inertia { mass, first_moment: h, matrix: Symmetric3 { xx, yy, zz, xy, xz, yz } } = *moved;
    body.mass += mass;
    body.first_moment.iter_mut().zip([h.x, h.y, h.z]).for_each(|(sum, h)| *sum += h);
    body.matrix.iter_mut().zip([xx, yy, zz, xy, xz, yz]).for_each(|(sum, j)| *sum += j);
}

#[cfg(test)]
mod tests {
    use crate::robot::{JointKind, JointSpec, LinkInertia, Placement, Robot, Tree};
    use nalgebra::{Matrix3, Vector3};

    /// `T = 1/2 sum of I_k v_k . v_k` by the links themselves and by the regrouped inertias.
    #[test]
    fn kinetic_energy_is_that_of_the_links() {
        let inertia = Matrix3::new(0.5, 0.02, -0.1, 0.02, 0.7, 0.05, -0.1, 0.05, 0.6);
        let body = LinkInertia::about_com(1.7, [0.2, -0.3, 0.4], inertia);
        let place = |x: f64| Placement::from_xyz_rpy([x, 0.3, -0.2], [1.0 - x, x, 2.0 * x]);
        let robot = Robot::builder("branched")
            .joint(JointSpec::revolute("a").placed(place(0.1)).carrying(body))
            .joint(JointSpec::prismatic("b").on("a").placed(place(0.5)).axis([1.0, 1.0, 0.0]).carrying(body))
            .joint(JointSpec::revolute("c").on("b").placed(place(-0.4)).carrying(body))
            .joint(JointSpec::revolute("d").on("a").placed(place(0.9)).axis([0.0, 1.0, 0.0]).carrying(body))
            .joint(JointSpec::prismatic("e").on("d").placed(place(0.2)).carrying(body));
        let tree = Tree::from(&robot.build().unwrap());
        let (q, v) = ([0.4, -0.7, 1.9, 0.3, 0.8], [0.9, 1.3, -0.6, 0.5, -1.1]);
        let mut motions = Vec::new();
        let (mut by_links, mut by_lumps) = (0.0, 0.0);
        for (i, joint) in tree.joints().iter().enumerate() {
            let still = crate::spatial::Motion::<f64>::zero();
            let mut motion = joint.transform(q[i]).motion_down(joint.parent.map_or(still, |p| motions[p]));
            match joint.kind {
                JointKind::Revolute => {
                    motion.angular.z += v[i];
                    assert_eq!(
                        (joint.lumped.mass, joint.lumped.first_moment[2], joint.lumped.matrix[1]),
                        (0.0, 0.0, 0.0)
                    );
                }
                JointKind::Prismatic => {
                    motion.linear.z += v[i];
                    assert_eq!(joint.lumped.matrix, [0.0; 6]);
                }
            }
            by_links += joint.inertia.apply(motion).dot(motion);
            by_lumps += joint.lumped.apply(motion).dot(motion);
            motions.push(motion);
        }
        assert!((by_links - by_lumps).abs() < 1e-14 * by_links, "{by_links} {by_lumps}");
        let masses: Vec<f64> = tree.joints().iter().map(|joint| joint.lumped_mass).collect();
        assert_eq!(
            masses,
            [5.1, 3.4, 0.0, 1.7, 1.7],
            "what slides keeps its mass, and that of what turns on it"
        );
        let reach = |k: usize| tree.joints()[k].reach;
        let farthest = Vector3::new(0.2, -0.3, 0.4).norm();
        assert!(reach(2) >= (1.7_f64).sqrt() * farthest * 0.3 && reach(0) > reach(3) && reach(1) > reach(2));
    }
}
