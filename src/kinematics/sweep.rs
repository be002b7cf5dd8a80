//! Poses, velocities and accelerations of the links, from the base outward.

use super::Kinematics;
use super::body::Body;
use crate::kernels::{positions, rates};
use crate::robot::JointKind;
use crate::scalar::Scalar;
use crate::spatial::{JointPosition, Vec3};

/// A link on another one: the joint, the rows of its rotation, and its origin seen from that of the other.
struct Posed<S> {
    joint: JointPosition<S>,
    rows: [Vec3<S>; 3],
    arm: Vec3<S>,
}

impl<S: Scalar> Kinematics<S> {
    /// All links at (q, v, a), n each:
    ///
    /// ```text
    /// R_i = R_p R_pi(q_i)               o_i = o_p + r              r = R_p r_pi(q_i)
    /// w_i = w_p + z v                   o_i' = o_p' + w_p x r (+ z v)
    /// w_i' = w_p' + (w_p x z) v + z a   o_i'' = o_p'' + w_p' x r + w_p x (o_i' - o_p') (+ (w_p x z) v + z a)
    /// ```
    ///
    /// with the terms of z in one of the two columns: the left for a revolute joint, the right for a
    /// prismatic one.
    #[inline(never)]
    pub(super) fn place(&mut self, q: &[S], v: &[S], a: &[S]) {
        let Self { tree, all: [all_q, all_v, all_a], .. } = self;
        positions(tree, q, all_q);
        rates(tree, v, all_v);
        rates(tree, a, all_a);
        let world = Body { rows: self.world_axes(), ..Body::still() };
        for (i, joint) in self.tree.joints().iter().enumerate() {
            let parent = joint.parent.map_or(world, |p| self.bodies[p]);
            let Posed { joint: at, rows, arm } = self.posed(i, &parent.rows);
            let mut body = Body { joint: at, rows, position: parent.position + arm, ..parent };
            let axis = body.axis();
            let (rate, rate_of_rate) = (axis.scaled(self.all[1][i]), axis.scaled(self.all[2][i]));
            let turned = parent.angular.cross(rate) + rate_of_rate;
            let carried = parent.angular.cross(arm);
            body.linear = parent.linear + carried;
            match joint.kind {
                JointKind::Revolute => {
                    body.angular = parent.angular + rate;
                    body.angular_rate = parent.angular_rate + turned;
                    body.linear_rate = parent.linear_rate + parent.angular.cross(carried);
                }
                JointKind::Prismatic => {
                    body.linear = body.linear + rate;
                    body.linear_rate = parent.linear_rate + parent.angular.cross(carried + rate) + turned;
                }
            }
            body.linear_rate = body.linear_rate + parent.angular_rate.cross(arm);
            self.bodies[i] = body;
        }
    }

    /// Poses of these links alone, parents before children, at the coordinates q (n).
    pub(super) fn pose_links(&mut self, q: &[S], links: &[usize]) {
        positions(&self.tree, q, &mut self.all[0]);
        let world = self.world_axes();
        for &i in links {
            // No copies of whole bodies.
            let parent = self.tree.joints()[i].parent.map(|p| &self.bodies[p]);
            let Posed { joint, rows, arm } = self.posed(i, parent.map_or(&world, |parent| &parent.rows));
            let position = parent.map_or(arm, |parent| parent.position + arm);
            let body = &mut self.bodies[i];
            (body.joint, body.rows, body.position) = (joint, rows, position);
        }
    }

    /// Link i on a link with these axes.
    #[inline(always)]
    fn posed(&self, i: usize, [x, y, z]: &[Vec3<S>; 3]) -> Posed<S> {
        let joint = &self.tree.joints()[i];
        let oriented = self.orientations.iter().find(|(turned, _)| *turned == i);
        let transform = match oriented {
            None => joint.transform(self.all[0][i]),
            Some(&(_, orientation)) => joint.transform_at(JointPosition::Oriented(orientation)),
        };
        let (x, along_x) = transform.vector_down_with_arm(*x);
        let (y, along_y) = transform.vector_down_with_arm(*y);
        let (z, along_z) = transform.vector_down_with_arm(*z);
        Posed { joint: transform.joint, rows: [x, y, z], arm: Vec3::new(along_x, along_y, along_z) }
    }

    /// The axes of the world of the robot, seen from the aligned world.
    fn world_axes(&self) -> [Vec3<S>; 3] {
        let world = self.tree.world_rotation();
        [0, 1, 2].map(|axis| Vec3::constant(world.column(axis).into_owned().into()))
    }
}
