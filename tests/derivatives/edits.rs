//! Robots with locked joints and payloads against the robots that they were.

use costate::derivative::largest;
use costate::kernels::KernelOne;
use costate::lagrangian::Lagrangian;
use costate::matrix::Matrix;
use costate::robot::{Frame, FrameSpec, JointSpec, LinkInertia, Placement, Robot, Tree, Wrench, WrenchAxes};
use costate::scalar::{Count, Scalar};
use costate_test_support::properties;
use costate_test_support::random_robot::all_cases;
use costate_test_support::reach::Reach;
use costate_test_support::rounding::{bound, close, lift, of_joints, size, terms};
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

/// All stages at (q, v), and the potential.
fn kernel<S: Scalar>(robot: &Robot, q: &[S], v: &[S]) -> (KernelOne<S>, S) {
    let tree = Tree::from(robot);
    let mut kernel = KernelOne::new(&tree);
    kernel.set_position(&tree, q).unwrap();
    kernel.set_velocity(&tree, v).unwrap();
    kernel.second_order(&tree);
    let potential = kernel.potential(&tree);
    (kernel, potential)
}

/// How far rounding takes M, p, L_q, P, L_qq and V of two robots apart that move alike: the bounds of both.
///
/// Constants of one that make terms zero are rounded in the other: terms that cancel there are of the size of
/// M and of the largest forces, times velocities in p and P, times positions in V.
fn rounding(robots: [(&Robot, &[f64], &[f64]); 2]) -> [f64; 6] {
    let of = robots.map(|(robot, q, v)| {
        let (kernel, potential) = kernel::<Count>(robot, &lift(q), &lift(v));
        let squares =
            [kernel.mass_matrix(), kernel.l_vq(), kernel.l_qq()].map(|matrix| bound(matrix.as_slice()));
        let rows = [kernel.momentum(), kernel.l_q()].map(bound);
        let m = size(kernel.mass_matrix().as_slice());
        let force = m + size(kernel.l_q()) + size(kernel.l_qq().as_slice()) + 1.0;
        let (speed, far) = (1.0 + largest(v), 1.0 + largest(q));
        let [of_m, of_force] = [m, force].map(|size| of_joints(robot, size));
        [
            squares[0] + of_m,
            rows[0] + of_force * speed,
            rows[1] + of_force,
            squares[1] + of_force * speed,
            squares[2] + of_force,
            bound(&[potential]) + of_force * far,
        ]
    });
    std::array::from_fn(|k| of[0][k] + of[1][k])
}

/// Rows and columns `kept` of a square matrix, row by row.
fn square(all: &Matrix<f64>, kept: &[usize]) -> Vec<f64> {
    kept.iter().flat_map(|&i| kept.iter().map(move |&j| all[(i, j)])).collect()
}

fn part(all: &[f64], kept: &[usize]) -> Vec<f64> {
    kept.iter().map(|&k| all[k]).collect()
}

/// Pose of a frame in the world.
fn pose(robot: &Robot, frame: usize, q: &[f64]) -> Placement {
    let frame = &robot.frames()[frame];
    frame.joint.map_or(frame.placement, |joint| robot.poses(q).unwrap()[joint].then(&frame.placement))
}

/// How much more constants are rounded by so many locked joints, while bounds start from one rounding each:
/// by the square root of the number of roundings, which are independent.
///
/// A locked joint adds 13 to a rotation or translation: products with the placement and with its motion (4
/// each), and the motion (sines and cosines 2, products 2, a sum). An inertia is turned from both sides, so
/// that it takes these twice, and 16 more: products (3 each), displaced products (5), a sum of links (5).
fn of_locked(joints: usize) -> f64 {
    (16.0 + 26.0 * joints as f64).sqrt()
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
        let more = of_locked(robot.joints().len() - locked.joints().len());
        let [of_m, of_p, of_l_q, of_l_vq, of_l_qq, of_v] =
            rounding([(&robot, &case.q, &v), (&locked, &q_kept, &v_kept)]).map(|bound| more * bound);
        close("M", one.mass_matrix().as_slice(), &square(all.mass_matrix(), &kept), of_m)?;
        close("p", one.momentum(), &part(all.momentum(), &kept), of_p)?;
        close("L_q", one.l_q(), &part(all.l_q(), &kept), of_l_q)?;
        close("P", one.l_vq().as_slice(), &square(all.l_vq(), &kept), of_l_vq)?;
        close("L_qq", one.l_qq().as_slice(), &square(all.l_qq(), &kept), of_l_qq)?;
        // With friction and the wrench, where the held joints do not accelerate either; what cancels is of
        // the size of the forces in L_qq.
        let tau = |robot: &Robot, q: &[f64], v: &[f64]| {
            let rounded = Lagrangian::<Count>::new(robot)
                .inverse_dynamics(&lift(q), &lift(v), &lift(&vec![0.0; q.len()])).unwrap().to_vec();
            let tau = Lagrangian::<f64>::new(robot).inverse_dynamics(q, v, &vec![0.0; q.len()]).unwrap().to_vec();
            (tau, bound(&rounded))
        };
        let ((tau_all, of_all), (tau_kept, of_kept)) = (tau(&robot, &case.q, &v), tau(&locked, &q_kept, &v_kept));
        close("tau", &tau_kept, &part(&tau_all, &kept), more * (of_all + of_kept) + of_l_qq)?;
        let there: Vec<f64> = (0..n).map(|k| if choice[k] { elsewhere[k] } else { case.q[k] }).collect();
        let ((_, moved_all), (_, moved_one)) = (kernel(&robot, &there, &v), kernel(&locked, &part(&there, &kept), &v_kept));
        let [.., of_moved] = rounding([(&robot, &there, &v), (&locked, &part(&there, &kept), &v_kept)]);
        // V of the held joints is left out: four potentials are subtracted.
        let bound = of_v + more * of_moved + terms(1, &[v_all, v_one, moved_all, moved_one]);
        close("V", &[moved_all - v_all], &[moved_one - v_one], bound)?;
        let reach = Reach::of_case(&robot, &case).position(0);
        for (frame, old) in robot.frames().iter().enumerate() {
            let same = |new: &Frame| new.name == old.name && new.kind == old.kind;
            let now = locked.frames().iter().position(same).unwrap();
            let (before, after) = (pose(&robot, frame, &case.q), pose(&locked, now, &q_kept));
            close(&old.name, after.rotation.as_slice(), before.rotation.as_slice(), reach)?;
            close(&old.name, after.translation.as_slice(), before.translation.as_slice(), reach)?;
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
        let [of_m, .., of_l_qq, of_v] = rounding([(&loaded, &case.q, &case.v), (&held, &case.q, &case.v)]);
        close("M", one.mass_matrix().as_slice(), &square(other.mass_matrix(), &every), of_locked(1) * of_m)?;
        close("L_qq", one.l_qq().as_slice(), &square(other.l_qq(), &every), of_locked(1) * of_l_qq)?;
        close("V", &[v_one], &[v_other], of_locked(1) * of_v)?;
    }
}
