use super::{Feature, Kind, Narrow, Piece};
use crate::problem::{JointReference, MotionLimits, Objective, Obstacle, Problem, Shape, Task};
use costate::robot::{Friction, JointSpec, LinkInertia, Robot, Spring};
use nalgebra::Matrix3;

fn joint(name: &str) -> JointSpec {
    JointSpec::revolute(name).carrying(LinkInertia::about_com(1.0, [0.0; 3], 0.5 * Matrix3::identity()))
}

fn robot() -> Robot {
    let rubs = |coulomb_velocity| Friction { viscous: 0.0, coulomb: 2.0, coulomb_velocity };
    Robot::builder("narrow")
        .joint(joint("a").friction(rubs(0.02)))
        .joint(joint("b").spring(Spring { stiffness: 200.0, rest: 0.0 }))
        .joint(joint("c").mimicking("a", -4.0, 0.0).friction(rubs(0.02)))
        .build()
        .unwrap()
}

fn problem() -> Problem {
    let limits = MotionLimits {
        corner_speed: Some(vec![1.0, 1.5]),
        no_load_speed: Some(vec![2.0, 3.0]),
        ..MotionLimits::none()
    };
    let limits = MotionLimits { torque_max: Some(vec![5.0; 2]), ..limits };
    let reference = JointReference::new(vec![0.2, 0.3, 0.7], vec![vec![0.0, 0.0]; 3], vec![1.0, 0.0]);
    let unused = JointReference::new(vec![0.25], vec![vec![0.0, 0.0]], vec![0.0, 0.0]);
    let task = Task::default()
        .with_reference(reference)
        .with_reference(unused)
        .with_obstacle(Obstacle::new("wire", Shape::Sphere { centre: [9.0; 3], radius: 1e-3 }));
    Problem::rest_to_rest(robot(), &[0.0, 0.0], &[1.0, 1.0], 1.0)
        .with_cost(Objective::new(0.0, vec![1.0; 2]).with_energy(vec![0.0, 2.0]).with_energy_smoothing(0.1))
        .with_limits(limits)
        .with_task(task)
}

/// Each kind is listed with its joint, place and width.
#[test]
fn all_kinds_are_listed() {
    let features = Narrow::of(&problem()).features;
    let of = |wanted: &dyn Fn(Kind) -> bool| -> Vec<[f64; 2]> {
        features.iter().filter(|found| wanted(found.kind)).map(|found| [found.place, found.width]).collect()
    };
    // A joint that mimics is at 0.02 rad/s where its leader is at 0.005 rad/s.
    assert_eq!(of(&|kind| kind == Kind::Friction { joint: 0 }), [[0.0, 0.02], [0.0, 0.005]]);
    let knots = of(&|kind| kind == Kind::Knot { reference: 0 });
    assert!(knots.len() == 3 && (knots[1][1] - 0.1).abs() < 1e-15 && (knots[2][1] - 0.4).abs() < 1e-15);
    assert!(of(&|kind| kind == Kind::Knot { reference: 1 }).is_empty(), "a reference that costs nothing");
    assert_eq!(
        of(&|kind| kind == Kind::Motor { joint: 1 }),
        [[1.5, 0.0], [-1.5, 0.0], [3.0, 0.0], [-3.0, 0.0]]
    );
    assert_eq!(of(&|kind| kind == Kind::Energy { joint: 1 }), [[0.0, 0.1]]);
    let springs = of(&|kind| kind == Kind::Spring { joint: 1 });
    assert!(springs.len() == 1 && (springs[0][1] - 0.05).abs() < 1e-12, "sqrt(0.5/200): {springs:?}");
    assert_eq!(of(&|kind| kind == Kind::Obstacle { obstacle: 0 }), [[0.0, 1e-3]]);
    assert_eq!(Narrow::of(&problem()).times(), [0.2, 0.3, 0.7]);
}

fn places(kind: Kind, place: f64, width: f64, piece: &Piece<'_>) -> Vec<f64> {
    let mut places = vec![7.0];
    Narrow { features: vec![Feature { kind, place, width }] }.places(piece, &mut places);
    places
}

fn close(found: &[f64], expected: &[f64]) {
    let same =
        found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12);
    assert!(same, "{found:?} {expected:?}");
}

/// q = (2 x - 1)^2 in 2 s turns back at x = 1/2 with v = 2 (2 x - 1).
#[test]
fn places_are_crossings_of_the_polynomial() {
    let piece = Piece { start: 0.5, length: 2.0, q: &[1.0, -4.0, 4.0], count: 3, tau: &[] };
    let friction = Kind::Friction { joint: 0 };
    close(&places(friction, 0.0, 1e-3, &piece), &[0.5 - 7.5e-4, 0.5, 0.5 + 7.5e-4]);
    // The transition is wider than the interval, yet friction is not linear in it.
    close(&places(friction, 0.0, 1.0, &piece), &[0.5]);
    assert!(places(friction, 0.0, 5.0, &piece).is_empty(), "within the transition");
    let motor = Kind::Motor { joint: 0 };
    close(&places(motor, 1.0, 0.0, &piece), &[0.75]);
    let knot = Kind::Knot { reference: 0 };
    close(&places(knot, 0.9, 0.1, &piece), &[0.2]);
    assert!(places(knot, 0.5, 0.1, &piece).is_empty() && places(knot, 2.6, 0.1, &piece).is_empty());
    // The torque 1 - 4 x changes its sign at 1/4: p = v tau, of which 3 s = 0.003 W are an eighth of that
    // part in x.
    let pushed = Piece { tau: &[1.0, -4.0, 0.0], ..piece };
    let found = places(Kind::Energy { joint: 0 }, 0.0, 1e-3, &pushed);
    assert!(
        found.len() == 6 && (found[1] - 0.25).abs() < 1e-12 && (found[4] - 0.5).abs() < 1e-12,
        "{found:?}"
    );
    assert!(places(Kind::Spring { joint: 0 }, 0.0, 1e-3, &piece).is_empty());
}

#[test]
fn a_joint_at_rest_crosses_nothing() {
    let piece = Piece { start: 0.0, length: 1.0, q: &[1.0, 1e-17, -1e-17], count: 3, tau: &[] };
    assert!(places(Kind::Friction { joint: 0 }, 0.0, 0.01, &piece).is_empty());
    let still = Piece { q: &[1.0, 0.0, 0.0], ..piece };
    assert!(places(Kind::Friction { joint: 0 }, 0.0, 0.01, &still).is_empty());
}
