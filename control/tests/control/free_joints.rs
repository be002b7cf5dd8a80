//! Motions of robots with floating and spherical joints: closed forms, what nothing can change, files.

use costate::configuration::ConfigurationSpace;
use costate::hamiltonian::Hamiltonian;
use costate::robot::{JointSpec, LinkInertia, LoadOptions, Placement, Robot};
use costate_control::{
    BoundaryState, FreeMotionError, Method, MotionLimits, Problem, ProblemError, ProblemFile, Solution,
    Solver, SolverOptions, Status, Trajectory,
};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use std::f64::consts::PI;

pub(crate) const INF: f64 = f64::INFINITY;

fn body(mass: f64, inertia: [f64; 3]) -> LinkInertia {
    LinkInertia::about_com(mass, [0.0; 3], Matrix3::from_diagonal(&Vector3::from(inertia)))
}

/// The quaternion (x, y, z, w) of a rotation vector.
pub(crate) fn turned(by: [f64; 3]) -> [f64; 4] {
    UnitQuaternion::from_scaled_axis(Vector3::from(by)).coords.into()
}

fn solve(problem: &Problem, tolerance: f64) -> Solution {
    let options = SolverOptions::default().with_tolerance(tolerance);
    let solution = Solver::new(problem, options).unwrap().solve();
    assert!(solution.motion.status.is_converged(), "{:?}", solution.motion.status);
    solution
}

/// A ball turns about one axis like a double integrator: J = 6 I^2 angle^2/T^3, the short way round. The
/// other way round is an extremal too, and dearer.
#[test]
fn a_ball_turns_about_one_axis() {
    let ball = JointSpec::spherical("ball").carrying(body(2.0, [0.5; 3]));
    let robot = Robot::builder("ball").joint(ball).gravity([0.0; 3]).build().unwrap();
    let (angle, axis) = (2.5, [1.0 / 3.0, -2.0 / 3.0, 2.0 / 3.0]);
    let from = UnitQuaternion::from_scaled_axis(Vector3::new(0.4, -0.7, 0.2));
    let to = from * UnitQuaternion::from_scaled_axis(Vector3::from(axis) * angle);
    let (from, to): ([f64; 4], [f64; 4]) = (from.coords.into(), to.coords.into());
    let problem = Problem::rest_to_rest(robot, &from, &to, 1.5)
        .with_limits(MotionLimits::none().with_torque_max(vec![INF; 3]));
    let cost = |angle: f64| 6.0 * 0.25 * angle * angle / 1.5_f64.powi(3);
    let solution = solve(&problem, 1e-8);
    let motion = &solution.motion;
    assert!((motion.cost / cost(angle) - 1.0).abs() < 1e-8, "{} {}", motion.cost, cost(angle));
    assert!(solution.end_defect < 1e-6 && motion.hamiltonian_drift < 1e-5, "{motion:?}");
    // dJ/dT = -H*, and y = -dJ/dx at the start: a turn xi of the start along the axis changes the angle.
    assert!((motion.hamiltonian / (3.0 * motion.cost / 1.5) - 1.0).abs() < 1e-5);
    let slope: f64 = solution.costate_start().y_q.iter().zip(axis).map(|(y, axis)| y * axis).sum();
    assert!((slope / (2.0 * motion.cost / angle) - 1.0).abs() < 1e-4, "{slope}");
    let both = SolverOptions::default().with_tolerance(1e-8).with_starts(2);
    let both = Solver::new(&problem, both).unwrap().solve();
    assert_eq!(both.motion.cost.to_bits(), motion.cost.to_bits());
    let other = both.starts[1].total / cost(2.0 * PI - angle);
    assert!((other - 1.0).abs() < 1e-7, "{other}");
}

/// A body with a wheel about its axis z, which nothing else drives: the motor turns both against each other.
fn wheel() -> Robot {
    let base = JointSpec::floating("base").carrying(body(10.0, [2.0, 3.0, 4.0]));
    let wheel = JointSpec::revolute("wheel").on("base").carrying(body(1.0, [0.1, 0.1, 0.2]));
    Robot::builder("wheel").joint(base).joint(wheel).gravity([0.0; 3]).build().unwrap()
}

/// L = I w + J (w + wheel') = 0, so the torque of the motor is -I w', and J = 6 I^2 angle^2/T^3.
#[test]
fn a_wheel_turns_what_floats() {
    let to = turned([0.0, 0.0, 1.2]);
    let end = [&[0.0; 3][..], &to, &[0.0]].concat();
    let problem = Problem::rest_to_rest(wheel(), &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0], &end, 2.0);
    let end = problem.end.clone().with_q_free(&[0, 1, 2, 6]);
    let solution = solve(&problem.with_end(end), 1e-8);
    let cost = 6.0 * 16.0 * 1.44 / 8.0;
    assert!((solution.motion.cost / cost - 1.0).abs() < 1e-8, "{}", solution.motion.cost);
    let last = solution.trajectory.q.last().unwrap();
    assert!((last[7] + 1.2 * 4.2 / 0.2).abs() < 1e-5, "{last:?}");
    let base = solution.trajectory.u.iter().flat_map(|u| &u[..6]).all(|u| *u == 0.0);
    assert!(base && solution.end_defect < 1e-6, "{}", solution.end_defect);
}

/// From bound to bound the turn takes the torque 4 I angle/T^2 = 4.8 N m, with the least effort 7.2 N m. With
/// 1 N m it cannot be made: the motor is named with what it would have to give. With 5 N m it can.
#[test]
fn a_motor_that_is_too_weak_is_named_with_what_it_lacks() {
    let turn = |most: f64| {
        let end = [&[0.0; 3][..], &turned([0.0, 0.0, 1.2]), &[0.0]].concat();
        let start = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        let problem = Problem::rest_to_rest(wheel(), &start, &end, 2.0)
            .with_limits(MotionLimits::none().with_torque_max([&[0.0; 6][..], &[most]].concat()));
        let end = problem.end.clone().with_q_free(&[0, 1, 2, 6]);
        Solver::new(&problem.with_end(end), SolverOptions::default().with_tolerance(1e-6)).unwrap().solve()
    };
    let solution = turn(1.0);
    assert_eq!(solution.motion.status, Status::LimitsNotKept);
    let (kind, worst) = solution.limits.violations().next().unwrap();
    assert_eq!((kind, &worst.name[..], &worst.unit[..], worst.limit.abs()), ("torque", "wheel", "N m", 1.0));
    assert!((4.8 * (1.0 - 1e-3)..4.8 * 1.08).contains(&worst.value.abs()), "{worst:?}");
    assert!((worst.excess - (worst.value.abs() - 1.0)).abs() < 1e-9, "{worst:?}");
    assert!(solution.trajectory.t.len() > 2 && !solution.motion.iterations.is_empty());
    let solution = turn(5.0);
    assert!(solution.motion.status.is_converged() && solution.limits.are_kept(), "{:?}", solution.limits);
}

/// A floating base with two links that nothing holds.
pub(crate) fn flyer(gravity: [f64; 3]) -> Robot {
    let link = LinkInertia::about_com(1.0, [0.4, 0.0, 0.1], Matrix3::identity() * 0.05);
    let trunk = LinkInertia::about_com(4.0, [0.1, -0.05, 0.0], Matrix3::from_diagonal_element(0.3));
    let at = |x: f64| Placement::from_xyz_rpy([x, 0.1, 0.2], [0.2, 0.0, 0.3]);
    let joint = |name: &str, on: &str, x: f64| JointSpec::revolute(name).on(on).placed(at(x)).carrying(link);
    Robot::builder("flyer")
        .joint(JointSpec::floating("root").placed(at(-0.3)).carrying(trunk))
        .joint(joint("a", "root", 0.2).axis([0.0, 1.0, 0.0]))
        .joint(joint("b", "a", 0.8).axis([0.0, 0.6, 0.8]))
        .gravity(gravity)
        .build()
        .unwrap()
}

/// Links move, and the base follows as its momentum says: in free fall too. Torques stay within their limits.
#[test]
fn what_nothing_drives_keeps_its_momentum() {
    let down = [0.5, -1.0, -3.0];
    for (gravity, rate, time) in [([0.0; 3], 0.0, 3.0), (down, 0.1, 1.0), (down, 0.0, 3.0)] {
        let robot = flyer(gravity);
        let start = [&[0.2, -0.1, 0.4][..], &turned([0.3, 0.5, -0.2]), &[0.0, 0.5]].concat();
        let end = [&[0.0; 3][..], &turned([0.0, 0.0, 0.0]), &[1.5, -0.8]].concat();
        let v = [rate; 8];
        let none = BoundaryState::fixed(&end, &[0.0; 8]);
        let none = none.with_q_free(&[0, 1, 2, 3, 4, 5]);
        let end = if gravity == [0.0; 3] { none } else { none.with_v_free(&[0, 1, 2, 3, 4, 5, 6, 7]) };
        let limits = MotionLimits::none().with_torque_max([&[0.0; 6][..], &[4.0, 4.0]].concat());
        let problem = Problem::rest_to_rest(robot.clone(), &start, &end.q, time)
            .with_start(BoundaryState::fixed(&start, &v))
            .with_end(end)
            .with_limits(limits);
        let solution = solve(&problem, 1e-6);
        let trajectory = &solution.trajectory;
        assert!(solution.end_defect < 1e-4, "{}", solution.end_defect);
        let torque = solution.limits.torque.as_ref().unwrap();
        assert!(torque.at_points == 0.0 && solution.limits.are_kept(), "{torque:?}");
        // The spatial momentum changes by gravity alone.
        let stand = robot.joints()[0].placement.rotation;
        let fall = stand.transpose() * Vector3::from(gravity);
        let momentum = |k: usize| {
            let (q, p) = (&trajectory.q[k], &trajectory.p[k]);
            let turn = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(q[6], q[3], q[4], q[5]));
            turn * Vector3::new(p[0], p[1], p[2]) - fall * (6.0 * trajectory.t[k])
        };
        let last = trajectory.t.len() - 1;
        assert!((momentum(last) - momentum(0)).amax() < 1e-4, "{}", momentum(last) - momentum(0));
        // Rows are those of the motion: unit quaternions, p = M v, nq positions and n rates.
        let space = ConfigurationSpace::new(&robot);
        let mut model = Hamiltonian::<f64>::new(&robot);
        for k in 0..=last {
            space.check(&trajectory.q[k]).unwrap();
            let p = model.momentum(&trajectory.q[k], &trajectory.v[k]).unwrap();
            assert!(p.iter().zip(&trajectory.p[k]).all(|(a, b)| (a - b).abs() < 1e-9));
        }
        assert_eq!([trajectory.q[0].len(), trajectory.v[0].len(), trajectory.y_q[0].len()], [9, 8, 8]);
    }
}

#[test]
fn what_is_saved_is_read_again() {
    let to = turned([0.3, 0.0, 1.2]);
    let end = [&[0.1, 0.0, 0.2][..], &to, &[0.4]].concat();
    let problem = Problem::rest_to_rest(wheel(), &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0], &end, 2.0);
    let problem = problem.with_limits(MotionLimits::none().with_torque_max(vec![INF; 7]));
    let solution = solve(&problem, 1e-6);
    let text = solution.to_json().unwrap();
    let read = Solution::from_json(&text).unwrap();
    assert_eq!(read.trajectory.free_joints, solution.trajectory.free_joints);
    assert_eq!(
        (read.trajectory.q, &read.trajectory.v),
        (solution.trajectory.q.clone(), &solution.trajectory.v)
    );
    let start = Trajectory::from_json(&text, &problem.robot).unwrap();
    let again = Solver::new(&problem, SolverOptions::default().with_tolerance(1e-6))
        .unwrap()
        .with_start(&start)
        .unwrap()
        .solve();
    assert!((again.motion.cost / solution.motion.cost - 1.0).abs() < 1e-5);
    let broken = text.replace("\"position\":0", "\"position\":3");
    assert!(Solution::from_json(&broken).unwrap_err().to_string().contains("free_joints"));
    // Samples move as their velocities say.
    let samples = solution.sample(&problem, 200.0).unwrap();
    let space = ConfigurationSpace::new(&problem.robot);
    for (k, pair) in samples.q.windows(2).enumerate() {
        space.check(&pair[1]).unwrap();
        let mut d = vec![0.0; 7];
        space.difference(&pair[0], &pair[1], &mut d).unwrap();
        for (i, moved) in d.iter().enumerate() {
            let mean = 0.5 * (samples.v[k][i] + samples.v[k + 1][i]);
            assert!((moved * 200.0 - mean).abs() < 2e-3, "{k} {i}: {} {mean}", moved * 200.0);
        }
    }
    let csv = samples.to_csv(&solution.robot.joints);
    let columns: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    assert_eq!(
        (columns.len(), columns[1], columns[4], columns[8]),
        (1 + 8 + 4 * 7, "q_base_x", "q_base_qx", "q_wheel")
    );
    assert!(csv.lines().all(|line| line.split(',').count() == columns.len()));
    // At the start nothing moves yet: u is the torque, and the acceleration follows from it.
    let mut model = Hamiltonian::<f64>::new(&problem.robot);
    let force = model.mass_matrix(&samples.q[0]).unwrap().view().to_nalgebra()
        * nalgebra::DVector::from_column_slice(&samples.a[0]);
    assert!(force.iter().zip(&samples.tau[0]).all(|(a, b)| (a - b).abs() < 1e-9));
}

/// A pendulum on a ball joint without a motor, wheels on the bob: its moment of momentum about the vertical
/// stays, which is one of the three that rest asks for.
#[test]
fn gravity_keeps_one_momentum_of_a_ball_joint() {
    let bob = LinkInertia::about_com(1.0, [0.0, 0.0, -0.5], Matrix3::identity() * 0.05);
    let flywheel = |name: &str, axis: [f64; 3]| {
        let at = Placement::from_xyz_rpy([0.0, 0.0, -0.5], [0.0; 3]);
        JointSpec::revolute(name).on("ball").axis(axis).placed(at).carrying(body(0.1, [0.02; 3]))
    };
    let robot = Robot::builder("pendulum")
        .joint(JointSpec::spherical("ball").carrying(bob))
        .joint(flywheel("x", [1.0, 0.0, 0.0]))
        .joint(flywheel("y", [0.0, 1.0, 0.0]))
        .build()
        .unwrap();
    let start = [&turned([0.0; 3])[..], &[0.0, 0.0]].concat();
    let end = [&turned([0.1, 0.2, 0.0])[..], &[0.0, 0.0]].concat();
    let end = BoundaryState::fixed(&end, &[0.0; 5]).with_q_free(&[2, 3, 4]).with_v_free(&[3, 4]);
    let problem = Problem::rest_to_rest(robot, &start, &end.q, 1.0);
    // The turn about the axis of the bob, which the wheels do not reach, is left free.
    let error = problem.clone().with_end(end).check_for(Method::Direct).unwrap_err();
    assert!(
        matches!(error, ProblemError::Free { cause: FreeMotionError::RatesNeedPositions { .. } }),
        "{error}"
    );
    let end = [&turned([0.1, 0.2, 0.0])[..], &[0.0, 0.0]].concat();
    let end = BoundaryState::fixed(&end, &[0.0; 5]).with_q_free(&[2, 3, 4]);
    let end = end.with_v_free(&[0, 1, 2, 3, 4]);
    let solution = solve(&problem.with_end(end), 1e-6);
    let last = solution.trajectory.q.last().unwrap();
    let up = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(last[3], last[0], last[1], last[2]));
    let expected = UnitQuaternion::from_scaled_axis(Vector3::new(0.1, 0.2, 0.0)) * Vector3::z();
    assert!((up * Vector3::z() - expected).amax() < 1e-5 && solution.end_defect < 1e-4);
}

#[test]
fn a_satellite_folds_its_arm_out() {
    let file = ProblemFile::read("../examples/problems/satellite_arm.toml", LoadOptions::default()).unwrap();
    let solution = Solver::new(&file.problem, file.options.clone()).unwrap().solve();
    assert!(solution.motion.status.is_converged(), "{:?}", solution.motion.status);
    assert!(solution.end_defect < 1e-4 && solution.limits.are_kept(), "{}", solution.end_defect);
    // A quarter turn is far from singular for the quaternion, and the centre of mass stays.
    let robot = &file.problem.robot;
    let mut model = Hamiltonian::<f64>::new(robot);
    let mut centre = |q: &[f64]| {
        let inertia = model.mass_matrix(q).unwrap();
        let arm = Vector3::new(inertia[(1, 5)], inertia[(2, 3)], inertia[(0, 4)]) / inertia[(0, 0)];
        let turn = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(q[6], q[3], q[4], q[5]));
        Vector3::new(q[0], q[1], q[2]) + turn * arm
    };
    let first = centre(&solution.trajectory.q[0]);
    let away = solution.trajectory.q.iter().map(|q| (centre(q) - first).amax()).fold(0.0, f64::max);
    assert!(away < 1e-5, "{away}");
}
