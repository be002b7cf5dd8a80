use super::cores::CoreBox;
use super::{Body, Clearances, Other};
use crate::task::differences::{are_those_by_differences, contracted};
use crate::task::functions::{Part, PathFunction, TaskFunctions};
use crate::task::placed::{Carried, Placed};
use crate::task::row::Row;
use costate::robot::{JointSpec, LinkInertia, Placement, Robot};
use costate_test_support::properties;
use costate_test_support::proptest::prelude::*;
use costate_test_support::random_robot::{Case, all_cases};
use nalgebra::{Matrix3, Rotation3, Vector3};

type V = Vector3<f64>;

/// All rows between these bodies.
fn functions(robot: &Robot, bodies: Vec<Body>, pairs: Vec<(usize, Other)>, margin: f64) -> TaskFunctions {
    let mut functions = TaskFunctions::new(robot);
    let mut clearances = Clearances::new(bodies, functions.placed(robot));
    let mut rows = 0;
    for (body, other) in pairs {
        rows += clearances.push(body, other, None, margin, functions.placed(robot)).unwrap().0;
    }
    let row = Row::clearance(1.0, false, String::new());
    functions.push(robot, Part::Clearances(clearances), vec![row; rows]);
    functions
}

/// Spheres and capsules on the first and the last link, and every kind of obstacle, from random numbers.
fn random_functions(case: &Case, rng: &mut fastrand::Rng) -> (Robot, TaskFunctions) {
    let robot = case.robot();
    let mut point = |size: f64| V::from_fn(|_, _| size * (2.0 * rng.f64() - 1.0));
    let mut body = |joint: Option<usize>, capsule: bool| Body {
        carried: joint.map(|joint| Carried::new(&robot, 1 + joint)),
        from: point(0.5),
        to: capsule.then(|| point(0.8)),
        radius: 0.1,
    };
    let last = robot.joints().len() - 1;
    let mut bodies =
        vec![body(Some(last), false), body(Some(last), true), body(Some(0), false), body(Some(0), true)];
    bodies.extend([body(None, false), body(None, true)]);
    let axes = *Rotation3::from_scaled_axis(point(2.0)).matrix();
    let other = CoreBox { axes, centre: point(1.0), half: point(0.5).abs() + V::repeat(0.05) };
    let normal = point(1.0).normalize();
    let mut pairs = Vec::new();
    for own in 0..4 {
        pairs.extend([4, 5].map(|world| (own, Other::Body(world))));
        pairs.push((own, Other::Box(other.clone())));
        pairs.push((own, Other::HalfSpace { normal, height: -0.3 }));
    }
    for (a, b) in [(0, 2), (0, 3), (1, 2), (1, 3)] {
        if last > 0 {
            pairs.push((a, Other::Body(b)));
        }
    }
    let functions = functions(&robot, bodies, pairs, 0.02);
    (robot, functions)
}

properties! {
    24;

    /// On trees of all kinds of joints.
    #[test]
    fn derivatives_are_those_by_differences(case in all_cases(5), seed in any::<u64>()) {
        let mut rng = fastrand::Rng::with_seed(seed);
        let (robot, mut functions) = random_functions(&case, &mut rng);
        let n = robot.dof();
        for row in 0..functions.rows() {
            let mut w = vec![0.0; functions.rows()];
            w[row] = 0.5 + rng.f64();
            are_those_by_differences(&robot, &mut functions, [&case.q[..n], &vec![0.0; n]], &w)?;
        }
    }
}

/// Three prismatic joints along x, y, z: the tip is at q.
fn gantry() -> Robot {
    let body = LinkInertia::point(1.0, [0.0; 3]);
    Robot::builder("gantry")
        .joint(JointSpec::prismatic("x").axis([1.0, 0.0, 0.0]).carrying(body))
        .joint(JointSpec::prismatic("y").on("x").axis([0.0, 1.0, 0.0]).carrying(body))
        .joint(JointSpec::prismatic("z").on("y").axis([0.0, 0.0, 1.0]).carrying(body))
        .build()
        .unwrap()
}

/// A body that the gantry carries.
fn carried(robot: &Robot, to: Option<V>) -> Body {
    Body { carried: Some(Carried::new(robot, 3)), from: V::zeros(), to, radius: 0.2 }
}

#[test]
fn clearances_vanish_where_surfaces_touch_and_grow_as_distances() {
    let robot = gantry();
    let fixed = |from: [f64; 3], to: Option<[f64; 3]>| Body {
        carried: None,
        from: from.into(),
        to: to.map(Into::into),
        radius: 0.3,
    };
    let wide =
        CoreBox { axes: Matrix3::identity(), centre: V::new(0.0, 0.0, -1.0), half: V::new(4.0, 3.0, 1.0) };
    let floor = Other::HalfSpace { normal: V::z(), height: -0.1 };
    // At the height where the margin of 0.05 is used up, the clearance grows with the height.
    for (to, bodies, other, height) in [
        (None, vec![fixed([0.0; 3], None)], Other::Body(1), 0.55),
        (None, vec![fixed([-1.0, 0.0, 0.0], Some([1.0, 0.0, 0.0]))], Other::Body(1), 0.55),
        (Some(V::y()), vec![fixed([-1.0, 0.5, 0.0], Some([1.0, 0.5, 0.0]))], Other::Body(1), 0.55),
        (None, vec![], Other::Box(wide.clone()), 0.25),
        (Some(V::x()), vec![], Other::Box(wide), 0.25),
        (Some(V::x()), vec![], floor, 0.15),
    ] {
        let all = [vec![carried(&robot, to)], bodies].concat();
        let name = format!("{to:?} {other:?}");
        let mut functions = functions(&robot, all, vec![(0, other)], 0.05);
        let w = vec![1.0; functions.rows()];
        let (g, jacobian, _) = contracted(&mut functions, &[0.0, 0.0, height, 0.0, 0.0, 0.0], &w);
        assert!(g.iter().all(|g| (-6e-4..1e-14).contains(g)), "{name}: {g:?}");
        for row in jacobian.chunks_exact(6) {
            let slope = V::new(row[0], row[1], row[2]) - V::z();
            assert!(slope.amax() < 3e-3, "{name}: {row:?}");
        }
    }
}

/// Where cores meet or are parallel, at corners of boxes and inside of them, everything is finite; inside a
/// box the clearance leads out.
#[test]
fn nothing_is_infinite() {
    let robot = gantry();
    let cube = CoreBox { axes: Matrix3::identity(), centre: V::zeros(), half: V::repeat(0.5) };
    let world = |to: Option<V>| Body { carried: None, from: V::zeros(), to, radius: 0.1 };
    for to in [None, Some(V::x()), Some(V::new(1.0, 1.0, 0.0))] {
        let bodies = vec![carried(&robot, to), world(None), world(Some(V::x()))];
        let pairs = vec![(0, Other::Body(1)), (0, Other::Body(2)), (0, Other::Box(cube.clone()))];
        let mut functions = functions(&robot, bodies, pairs, 0.0);
        for q in
            [[0.0; 3], [0.5, 0.0, 0.0], [0.5, 0.5, 0.5], [-1.0, 0.0, 0.0], [0.0, 0.3, 0.0], [0.5, 0.5, 0.2]]
        {
            let x = [q, [0.0; 3]].concat();
            let (g, jacobian, hessian) = contracted(&mut functions, &x, &[1.0; 3]);
            let all = || g.iter().chain(&jacobian).chain(&hessian);
            assert!(all().all(|value| value.is_finite() && value.abs() < 1e4), "{to:?} {q:?}");
        }
        let (g, jacobian, _) = contracted(&mut functions, &[0.0, 0.3, 0.0, 0.0, 0.0, 0.0], &[0.0; 3]);
        assert!(g[2] < -0.58 * 0.2 && jacobian[2 * 6 + 1] > 0.1, "{to:?}: {g:?} {jacobian:?}");
    }
}

/// Joints that carry both bodies of a pair do not change their clearance.
#[test]
fn common_joints_do_not_count() {
    let body = LinkInertia::point(1.0, [0.2, 0.0, 0.0]);
    let placed = |x| Placement::from_xyz_rpy([x, 0.0, 0.0], [0.3, 0.1, 0.0]);
    let robot = Robot::builder("tree")
        .joint(JointSpec::revolute("trunk").carrying(body))
        .joint(JointSpec::revolute("left").on("trunk").placed(placed(0.5)).carrying(body))
        .joint(JointSpec::revolute("right").on("trunk").placed(placed(-0.5)).carrying(body))
        .build()
        .unwrap();
    let arm = |frame: usize| Body {
        carried: Some(Carried::new(&robot, frame)),
        from: V::zeros(),
        to: Some(V::new(0.6, 0.1, 0.2)),
        radius: 0.05,
    };
    let mut functions = functions(&robot, vec![arm(2), arm(3)], vec![(0, Other::Body(1))], 0.0);
    let q = [0.4, 2.0, 0.9];
    let (g, jacobian, hessian) = contracted(&mut functions, &[q, [0.0; 3]].concat(), &[1.0]);
    assert!(jacobian[0] == 0.0 && (0..6).all(|j| hessian[j] == 0.0));
    let (turned, ..) = contracted(&mut functions, &[[1.4, 2.0, 0.9], [0.0; 3]].concat(), &[1.0]);
    assert!((g[0] - turned[0]).abs() < 1e-15);
    are_those_by_differences(&robot, &mut functions, [&q, &[0.0; 3]], &[1.0]).unwrap();
    let placed = Placed::new(&robot);
    let mut one = Clearances::new(vec![arm(2), arm(2)], &placed);
    assert_eq!(one.push(0, Other::Body(1), None, 0.0, &placed), None, "two bodies of one link");
}
