//! Robots with locked joints and payloads against the robots that they were.

use costate::derivative::largest;
use costate::kernels::KernelOne;
use costate::lagrangian::Lagrangian;
use costate::matrix::Matrix;
use costate::robot::{Frame, FrameSpec, JointSpec, LinkInertia, Placement, Robot, Tree, Wrench, WrenchAxes};
use costate_test_support::properties;
use costate_test_support::random_robot::all_cases;
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

/// All stages at (q, v).
fn kernel(robot: &Robot, q: &[f64], v: &[f64]) -> (KernelOne<f64>, f64) {
    let tree = Tree::from(robot);
    let mut kernel = KernelOne::new(&tree);
    kernel.set_position(&tree, q).unwrap();
    kernel.set_velocity(&tree, v).unwrap();
    kernel.second_order(&tree);
    let potential = kernel.potential(&tree);
    (kernel, potential)
}

/// Largest difference between `found` and rows and columns `kept` of `all`, relative to the largest entry.
fn off(found: &Matrix<f64>, all: &Matrix<f64>, kept: &[usize]) -> f64 {
    let part = nalgebra::DMatrix::from_fn(kept.len(), kept.len(), |i, j| all[(kept[i], kept[j])]);
    largest(&(found.view().to_nalgebra() - part)) / largest(all.as_slice()).max(1e-300)
}

fn part(all: &[f64], kept: &[usize]) -> Vec<f64> {
    kept.iter().map(|&k| all[k]).collect()
}

/// Pose of a frame in the world.
fn pose(robot: &Robot, frame: usize, q: &[f64]) -> Placement {
    let frame = &robot.frames()[frame];
    frame.joint.map_or(frame.placement, |joint| robot.poses(q).unwrap()[joint].then(&frame.placement))
}

properties! {
    128;

    /// `L(q, v)` with some q held and some v = 0; V up to a constant, which the potential at another place
    /// shows.
    #[test]
    fn locked_joints_are_rows_and_columns_less(
        case in all_cases(9),
        choice in prop::collection::vec(any::<bool>(), 9),
        elsewhere in prop::collection::vec(-2.0..2.0, 9),
    ) {
        let (robot, n) = (case.robot(), case.n());
        let pull = Wrench { moment: [1.0, -2.0, 0.5], force: [3.0, 0.7, -4.0], axes: WrenchAxes::Aligned };
        let robot = robot.with_wrench(&format!("j{}", case.parts.len() - 1), pull).unwrap();
        let kept: Vec<usize> = (0..n).filter(|&k| choice[k]).collect();
        prop_assume!(!kept.is_empty());
        let names: Vec<&str> = robot.independent_joints().map(|joint| joint.name.as_str()).collect();
        let held: Vec<(&str, f64)> =
            (0..n).filter(|&k| !choice[k]).map(|k| (names[k], case.q[k])).collect();
        // A massless link that stays the last of a branch moves nothing.
        let Ok(locked) = robot.lock(&held) else { return Ok(()) };
        prop_assert_eq!(locked.dof(), kept.len());
        let v: Vec<f64> = (0..n).map(|k| if choice[k] { case.v[k] } else { 0.0 }).collect();
        let (all, v_all) = kernel(&robot, &case.q, &v);
        let (q_kept, v_kept) = (part(&case.q, &kept), part(&case.v, &kept));
        let (one, v_one) = kernel(&locked, &q_kept, &v_kept);
        prop_assert!(off(one.mass_matrix(), all.mass_matrix(), &kept) <= 1e-13);
        let largest_of = |values: &[f64]| largest(values).max(1.0);
        let close = |found: &[f64], expected: &[f64], size: f64| {
            found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-12 * size)
        };
        let force = largest_of(all.l_q()) + largest_of(all.l_qq().as_slice()) + largest_of(all.mass_matrix().as_slice());
        prop_assert!(close(one.momentum(), &part(all.momentum(), &kept), force));
        prop_assert!(close(one.l_q(), &part(all.l_q(), &kept), force));
        for (found, all) in [(one.l_vq(), all.l_vq()), (one.l_qq(), all.l_qq())] {
            prop_assert!(off(found, all, &kept) * largest(all.as_slice()) <= 1e-12 * force);
        }
        // With friction and the wrench, where the held joints do not accelerate either.
        let tau = |robot: &Robot, q: &[f64], v: &[f64]| {
            Lagrangian::<f64>::new(robot).inverse_dynamics(q, v, &vec![0.0; q.len()]).unwrap().to_vec()
        };
        let (tau_all, tau_kept) = (tau(&robot, &case.q, &v), tau(&locked, &q_kept, &v_kept));
        prop_assert!(close(&tau_kept, &part(&tau_all, &kept), force + largest_of(&tau_all)));
        let there: Vec<f64> = (0..n).map(|k| if choice[k] { elsewhere[k] } else { case.q[k] }).collect();
        let ((_, moved_all), (_, moved_one)) = (kernel(&robot, &there, &v), kernel(&locked, &part(&there, &kept), &v_kept));
        let weight = force * (1.0 + largest(&there) + largest(&case.q));
        prop_assert!(((moved_all - v_all) - (moved_one - v_one)).abs() <= 1e-11 * weight, "V");
        for (frame, old) in robot.frames().iter().enumerate() {
            let same = |new: &Frame| new.name == old.name && new.kind == old.kind;
            let now = locked.frames().iter().position(same).unwrap();
            let (before, after) = (pose(&robot, frame, &case.q), pose(&locked, now, &q_kept));
            prop_assert!((before.rotation - after.rotation).amax() <= 1e-13);
            prop_assert!((before.translation - after.translation).amax() <= 1e-12 * (1.0 + before.translation.norm()));
        }
        // After the world come the frames of the joints, one each.
        for (i, (joint, frame)) in locked.joints().iter().zip(&locked.frames()[1..]).enumerate() {
            prop_assert!(frame.joint == Some(i) && frame.name == joint.name && frame.placement == Placement::identity());
        }
        let reduced = robot.reduced_to(&kept.iter().map(|&k| names[k]).collect::<Vec<_>>(), &case.q).unwrap();
        prop_assert_eq!(reduced.joints(), locked.joints());
    }

    /// A payload is a link on a locked joint.
    #[test]
    fn a_payload_is_a_link_that_does_not_move(
        case in all_cases(7),
        carrier in 0..100_usize,
        place in prop::array::uniform6(-1.0..1.0),
        mass in 0.1..5.0_f64,
    ) {
        let robot = case.robot();
        let carrier = robot.joints()[carrier % robot.joints().len()].name.clone();
        let [x, y, z, a, b, c] = place;
        let place = Placement::from_xyz_rpy([x, y, z], [a, b, c]);
        let load = LinkInertia::about_com(mass, [0.1, -0.2, 0.3], Matrix3::from_diagonal(&Vector3::new(0.1, 0.2, 0.25)));
        let loaded = robot.with_frame(FrameSpec::new("tool").on(carrier.as_str()).placed(place)).unwrap();
        let loaded = loaded.with_payload("tool", &load).unwrap();

        let builder = case.specs().into_iter().fold(Robot::builder("held").gravity(case.gravity), |b, spec| b.joint(spec));
        let held = builder.joint(JointSpec::revolute("held").on(carrier).placed(place).carrying(load)).build().unwrap();
        let held = held.with_armature({
            let n = robot.joints().len();
            let mut armature = nalgebra::DMatrix::zeros(n + 1, n + 1);
            armature.view_mut((0, 0), (n, n)).copy_from(&robot.armature_matrix());
            armature
        }).unwrap();
        let held = held.lock(&[("held", 0.0)]).unwrap();
        let ((one, v_one), (other, v_other)) = (kernel(&loaded, &case.q, &case.v), kernel(&held, &case.q, &case.v));
        let every: Vec<usize> = (0..case.n()).collect();
        prop_assert!(off(one.mass_matrix(), other.mass_matrix(), &every) <= 1e-13);
        prop_assert!(off(one.l_qq(), other.l_qq(), &every) <= 1e-12);
        prop_assert!((v_one - v_other).abs() <= 1e-12 * (1.0 + v_other.abs()));
    }
}
