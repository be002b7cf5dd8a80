//! The tree of a robot: aligned frames, regrouped inertias.

use super::Tree;
use super::constraint::constraints;
use crate::robot::branches::Branches;
use crate::robot::frames::AlignedFrames;
use crate::robot::free_frame::FreeFrame;
use crate::robot::joint::JointKind;
use crate::robot::joint_frame::{JointFrame, set_reach};
use crate::robot::joint_map::JointMap;
use crate::robot::link::snap;
use crate::robot::model::Robot;
use crate::robot::regroup::regroup;
use crate::robot::tree_frame::TreeFrame;
use crate::robot::wrench::AppliedWrench;
use nalgebra::Matrix3;

impl From<&Robot> for Tree {
    fn from(robot: &Robot) -> Self {
        let n = robot.joints().len();
        let mut aligned = AlignedFrames::new(robot);
        for i in 0..n {
            aligned.place(i);
        }
        let mut subtree_mass: Vec<f64> = robot.joints().iter().map(|joint| joint.inertia.mass).collect();
        for (i, joint) in robot.joints().iter().enumerate().rev() {
            joint.parent.into_iter().for_each(|parent| subtree_mass[parent] += subtree_mass[i]);
        }
        let mut joints: Vec<_> = (0..n).map(|i| aligned.joint(i, subtree_mass[i])).collect();
        let gravity = (aligned.world * robot.gravity()).into();
        set_reach(&mut joints);
        let free: Vec<FreeFrame> = robot
            .free_joints()
            .iter()
            .map(|free| {
                let screw = &mut joints[free.turned].screw;
                // The orientation comes before all of the joint, its displacement along the axis among it.
                let [up, along] = screw.alpha.apply([0.0, std::mem::take(&mut screw.rise)]);
                screw.translation[1] += up;
                screw.translation[2] += along;
                let [aligned, _] = aligned.rotation_and_arm(free.turned);
                FreeFrame::new(free).aligned(&aligned, joints[free.turned].offset)
            })
            .collect();
        let turned: Vec<usize> = free.iter().flat_map(|free| (0..3).map(|k| free.joint.turned + k)).collect();
        let fixed_potential = regroup(&mut joints, gravity, &turned);
        let armature = robot.armature().to_vec();
        let (frames, wrenches) = (aligned.frames(), robot.wrenches().to_vec());
        let world = aligned.world.map(snap);
        let mut tree = Self {
            fixed_potential,
            wrenches,
            free,
            world,
            ..Self::from_parts(robot, joints, gravity, armature)
        };
        tree.constraints = constraints(robot, &frames, &tree.rows());
        Self { frames, ..tree }
    }
}

impl Tree {
    /// The same with these wrenches at these frames of the tree.
    pub(crate) fn under(
        self,
        frames: Vec<TreeFrame>,
        wrenches: Vec<AppliedWrench>,
        world: Matrix3<f64>,
    ) -> Self {
        Self { frames, wrenches, world, ..self }
    }

    /// From given constants of the joints of this robot; V of what does not move is zero, and the tree has
    /// neither frames nor wrenches.
    pub(crate) fn from_parts(
        robot: &Robot,
        joints: Vec<JointFrame>,
        gravity: [f64; 3],
        armature: Vec<(usize, usize, f64)>,
    ) -> Self {
        let parents: Vec<_> = robot.joints().iter().map(|joint| joint.parent).collect();
        let branches = Branches::new(&parents);
        let those = |has: fn(&JointFrame) -> bool| -> Vec<usize> {
            (0..joints.len()).filter(|&i| has(&joints[i])).collect()
        };
        let with_spring = those(|joint| joint.spring.stiffness != 0.0);
        let mut with_friction = those(|joint| !joint.friction.is_none());
        let on_one_branch = (0..parents.len()).flat_map(|i| branches.subtree(i).iter().map(move |&k| (k, i)));
        let joint_map =
            JointMap::new(robot.joints(), on_one_branch.chain(armature.iter().map(|&(i, j, _)| (i, j))));
        if let Some(map) = &joint_map {
            with_friction.iter_mut().for_each(|joint| *joint = map.rows()[*joint].coordinate);
            with_friction.sort_unstable();
            with_friction.dedup();
        }
        let (revolute, prismatic) = (0..joints.len()).partition(|&i| joints[i].kind == JointKind::Revolute);
        Self {
            slides: branches.marked(|i| joints[i].kind == JointKind::Prismatic),
            revolute,
            prismatic,
            with_spring,
            with_friction,
            names: robot.independent_joints().map(|joint| joint.name.clone()).collect(),
            joint_map,
            joints,
            gravity,
            fixed_potential: 0.0,
            armature,
            branches,
            frames: Vec::new(),
            wrenches: Vec::new(),
            constraints: Vec::new(),
            free: robot.free_joints().iter().map(FreeFrame::new).collect(),
            world: Matrix3::identity(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::frames::about_z;
    use crate::robot::{JointSpec, LinkInertia, Placement};
    use nalgebra::{Matrix3, Vector3};

    /// Position of each aligned frame in the aligned world at q, by 4 x 4 products.
    fn positions(tree: &Tree, q: &[f64]) -> Vec<(Matrix3<f64>, Vector3<f64>)> {
        let mut frames: Vec<(Matrix3<f64>, Vector3<f64>)> = Vec::new();
        for (joint, q) in tree.joints().iter().zip(q) {
            let (outer, origin) = joint.parent.map_or((Matrix3::identity(), Vector3::zeros()), |p| frames[p]);
            let [s, c] = joint.screw.alpha.sin_cos();
            let rx = Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c);
            let rz = about_z(joint.screw.gamma.map_or([0.0, 1.0], |gamma| gamma.sin_cos()));
            let (turn, slide) = match joint.kind {
                JointKind::Revolute => {
                    (about_z([(q + joint.offset).sin(), (q + joint.offset).cos()]), joint.screw.rise)
                }
                JointKind::Prismatic => (Matrix3::identity(), q + joint.offset),
            };
            let local = rz * (Vector3::from(joint.screw.translation) + rx * Vector3::new(0.0, 0.0, slide));
            frames.push((outer * rz * rx * turn, origin + outer * local));
        }
        frames
    }

    #[test]
    fn aligned_frames_put_every_centre_of_mass_where_it_was() {
        let placed = |x, r: [f64; 3]| Placement::from_xyz_rpy([x, -0.2, 0.4], r);
        let link = LinkInertia::about_com(2.0, [0.1, 0.2, -0.3], Matrix3::identity());
        let half_turn = [std::f64::consts::PI, 0.0, 0.0];
        let robot = Robot::builder("branched")
            .joint(
                JointSpec::revolute("a")
                    .axis([1.0, -2.0, 0.5])
                    .placed(placed(0.1, [0.3, 1.0, -2.0]))
                    .carrying(link),
            )
            .joint(
                JointSpec::prismatic("b")
                    .on("a")
                    .axis([0.0, -1.0, 0.0])
                    .placed(placed(0.2, [0.0; 3]))
                    .carrying(link),
            )
            .joint(JointSpec::revolute("c").on("b").placed(placed(0.3, [-1.0, 0.2, 0.1])).carrying(link))
            .joint(
                JointSpec::revolute("d")
                    .on("a")
                    .axis([0.0, 0.0, -1.0])
                    .placed(placed(0.4, half_turn))
                    .carrying(link),
            )
            .joint(
                JointSpec::revolute("e")
                    .on("d")
                    .axis([0.0, 0.0, 1.0])
                    .placed(placed(0.5, [0.0; 3]))
                    .carrying(link),
            )
            .joint(
                JointSpec::revolute("f")
                    .on("d")
                    .axis([1.0, 0.0, 0.0])
                    .placed(placed(0.6, [0.0, 0.0, 9.0]))
                    .carrying(link),
            )
            .build()
            .unwrap();
        let tree = Tree::from(&robot);
        assert_eq!((tree.subtree(0), tree.subtree(3)), (&[0, 1, 2, 3, 4, 5][..], &[3, 4, 5][..]));
        assert_eq!((tree.pairs(), tree.joints()[0].subtree_mass), (6 + 2 + 1 + 3 + 1 + 1, 12.0));
        let q = [0.7, -0.4, 2.0, -1.1, 0.0, 30.0];
        let ours = positions(&tree, &q);
        let world = tree.gravity();
        let mut frames: Vec<Placement> = Vec::new();
        for (i, joint) in robot.joints().iter().enumerate() {
            let moved = match joint.kind {
                JointKind::Revolute => Placement {
                    rotation: *nalgebra::Rotation3::from_axis_angle(
                        &nalgebra::Unit::new_normalize(joint.axis),
                        q[i],
                    )
                    .matrix(),
                    translation: Vector3::zeros(),
                },
                JointKind::Prismatic => {
                    Placement { rotation: Matrix3::identity(), translation: joint.axis * q[i] }
                }
            };
            let outer = joint.parent.map_or(Placement::identity(), |p| frames[p]);
            frames.push(outer.then(&joint.placement).then(&moved));
            let expected = frames[i].rotation * link.com + frames[i].translation;
            let h = Vector3::from(tree.joints()[i].inertia.first_moment) / 2.0;
            let found = ours[i].0 * h + ours[i].1;
            assert!((found.norm() - expected.norm()).abs() < 1e-14, "joint {i}");
            let height = -found.dot(&Vector3::from(world)) / 9.81;
            assert!((height - expected.z).abs() < 1e-14, "height of joint {i}");
        }
    }
}
