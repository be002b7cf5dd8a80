//! Derivatives of motions by numbers of tools, obstacles and motors, against solving again.

use crate::motion_derivative::differences;
use crate::solved::solved;
use costate::robot::Robot;
use costate_control::{
    Collision, Keep, Kept, LinkCapsule, MotionLimits, MotionParameter, Obstacle, Problem, Resolve,
    ResolveError, Shape, Task, Tool,
};

/// The two-link arm turns with a stretched elbow, in 1 s.
fn arm(limits: MotionLimits) -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0, 0.2], &[1.5, 0.2], 1.0).with_limits(limits)
}

/// Its tip keeps something.
fn keeping(kept: Kept) -> Problem {
    let tip = Tool::new("elbow").with_offset([1.0, 0.0, 0.0]);
    arm(MotionLimits::none()).with_task(Task::default().with_keep(Keep::new(tip, kept)))
}

/// Compares cost, states and torques; all of them, and the cost more closely.
fn check(name: &str, parameter: &MotionParameter, problem: impl Fn(f64) -> Problem, step: f64) {
    let (mut motion, _) = solved(&problem(0.0), 24, 1e-11);
    let cost = motion.derivative_by(parameter).unwrap().unwrap().cost;
    assert!(cost.abs() > 1e-2, "{name}: the limit is active: {cost}");
    let found = differences(&problem(0.0), parameter, |_, step| problem(step), (24, 1e-11, step));
    assert!(found[0] < 1e-4 && found[1] < 1e-4, "{name}: {found:?}");
    assert!(found[2] < 1e-2 && found[3] < 2e-2, "{name}: {found:?}");
}

#[test]
fn what_tools_keep_changes_motions_as_solving_again_says() {
    let keep = MotionParameter::KeepMax(0);
    check("speed", &keep, |step| keeping(Kept::Speed { max: 3.8 + step }), 1e-4);
    check("acceleration", &keep, |step| keeping(Kept::Acceleration { max: 17.0 + step }), 1e-4);
    // Both ends are near the plane, and the motion without limits folds the arm in between.
    let tip = free_tip();
    let most = (tip[0] + tip[1] - 2.2).abs() / 2.0_f64.sqrt() - 0.05;
    let plane = |distance: f64| Kept::Plane { through: [1.1, 1.1, 0.0], normal: [1.0, 1.0, 0.0], distance };
    check("plane", &keep, |step| keeping(plane(most + step)), 1e-5);
}

/// Where the tip is in the middle of the motion without limits.
fn free_tip() -> [f64; 2] {
    let (free, _) = solved(&arm(MotionLimits::none()), 24, 1e-9);
    let mut z = [0.0; 6];
    free.state_at(0.5, &mut z).unwrap();
    [z[0].cos() + (z[0] + z[1]).cos(), z[0].sin() + (z[0] + z[1]).sin()]
}

/// A ball so far beyond the way of the tip.
fn past_a_ball(radius: f64, margin: f64) -> Problem {
    let tip = free_tip();
    let part = 1.0 + 0.12 / tip[0].hypot(tip[1]);
    let ball = Shape::Sphere { centre: [part * tip[0], part * tip[1], 0.0], radius };
    let body = LinkCapsule::sphere("elbow", 0.05).with_from([1.0, 0.0, 0.0]);
    let task = Task::default()
        .with_obstacle(Obstacle::new("ball", ball))
        .with_collision(Collision::of(vec![body]).with_margin(margin));
    arm(MotionLimits::none()).with_task(task)
}

#[test]
fn obstacles_change_motions_as_solving_again_says() {
    check("radius", &MotionParameter::ObstacleRadius(0), |step| past_a_ball(0.1 + step, 0.0), 1e-5);
    check("margin", &MotionParameter::CollisionMargin, |step| past_a_ball(0.08, 0.02 + step), 1e-5);
}

#[test]
fn motors_change_motions_as_solving_again_says() {
    let motors = |corner: f64, no_load: f64, torque: f64| {
        let limits = MotionLimits::none().with_torque_max(vec![20.0, torque]);
        let mut problem = arm(limits.with_torque_speed(vec![3.0, corner], vec![8.0, no_load]));
        (problem.start.q, problem.end.q) = (vec![0.0; 2], vec![std::f64::consts::FRAC_PI_2; 2]);
        problem
    };
    let of = MotionParameter::CornerSpeed(1);
    check("corner", &of, |step| motors(4.0 + step, 12.0, 28.0), 1e-4);
    let of = MotionParameter::NoLoadSpeed(1);
    check("no load", &of, |step| motors(4.0, 12.0 + step, 28.0), 1e-4);
    let of = MotionParameter::TorqueMax(1);
    check("torque", &of, |step| motors(4.0, 12.0, 28.0 + step), 1e-4);
}

#[test]
fn what_has_no_number_is_refused() {
    let open = Kept::Box { min: [-9.0; 3], max: [9.0; 3] };
    let mut motion = solved(&keeping(open), 12, 1e-6).0;
    let refused = |motion: &mut Resolve, of: MotionParameter, table: &'static str, entry: usize| {
        assert_eq!(motion.derivative_by(&of), Err(ResolveError::NoNumber { table, entry }));
    };
    refused(&mut motion, MotionParameter::KeepMax(0), "keep", 0);
    refused(&mut motion, MotionParameter::KeepMax(3), "keep", 3);
    refused(&mut motion, MotionParameter::ObstacleRadius(0), "obstacle", 0);
    refused(&mut motion, MotionParameter::CollisionMargin, "collision", 0);
    assert_eq!(motion.set_limit(&MotionParameter::CollisionMargin, 1.0), Err(ResolveError::NotALimit));
    refused(&mut motion, MotionParameter::CornerSpeed(0), "limits", 0);
    assert_eq!(motion.set_limit(&MotionParameter::CornerSpeed(0), 1.0), Err(ResolveError::NotALimit));
}
