use super::super::differences::{are_those_by_differences, contracted};
use super::super::functions::{Part, PathFunction, TaskFunctions};
use super::super::row::Row;
use super::*;
use costate::robot::{FrameSpec, Placement, Robot};
use costate_test_support::properties;
use costate_test_support::proptest::prelude::*;
use costate_test_support::random_robot::{Case, all_cases};

/// A random robot with a frame in general position on its last link.
fn robot(case: &Case) -> (Robot, Carried) {
    let on_last = Placement::from_xyz_rpy([0.3, -0.2, 0.5], [0.4, -1.0, 2.0]);
    let tool = FrameSpec::new("tool").on(format!("j{}", case.parts.len() - 1)).placed(on_last);
    let robot = case.robot().with_frame(tool).unwrap();
    let carried = Carried::new(&robot, robot.frame_index("tool").unwrap());
    (robot, carried)
}

fn functions(robot: &Robot, tool: &Carried, quantity: Quantity) -> TaskFunctions {
    let mut functions = TaskFunctions::new(robot);
    let rows = (0..quantity.rows()).map(|_| Row::equal(0.0, 1.0, "m", String::new())).collect::<Vec<_>>();
    functions.push(robot, Part::Tool(ToolFunction { tool: tool.clone(), quantity }), rows);
    functions
}

fn unit(a: [f64; 3]) -> Vector3<f64> {
    Vector3::from(a).normalize()
}

fn quantities() -> Vec<Quantity> {
    let (axis, along) = (unit([0.3, -0.5, 1.0]), unit([1.0, 0.2, -0.4]));
    let desired = Rotation3::from_scaled_axis(Vector3::new(0.7, -0.4, 1.1));
    let projector = Matrix3::identity() - along * along.transpose();
    vec![
        Quantity::Position(vec![Vector3::x(), along, Vector3::z()]),
        Quantity::Distance { from: Vector3::new(0.3, 0.1, -0.2), projector, radius: 0.2 },
        Quantity::Orientation(desired),
        Quantity::direction(axis, along),
        Quantity::yaw(0.8),
        Quantity::leaning(axis, along, 0.3),
        Quantity::turned(&desired, 0.4),
        Quantity::Speed(0.5),
    ]
}

properties! {
    24;

    /// On trees of all kinds of joints, mimic joints among them.
    #[test]
    fn derivatives_are_those_by_differences(case in all_cases(5)) {
        let (robot, tool) = robot(&case);
        let n = robot.dof();
        let w = [case.u[0], case.y[0], 0.7];
        let (q, v) = (&case.q[..n], &case.v[..n]);
        for quantity in quantities() {
            let mut functions = functions(&robot, &tool, quantity.clone());
            let w = &w[..functions.rows()];
            are_those_by_differences(&robot, &mut functions, [q, v], w).map_err(|error| match error {
                TestCaseError::Fail(why) => TestCaseError::fail(format!("{quantity:?}: {why}")),
                other => other,
            })?;
        }
    }
}

/// Rows of all quantities at a pose that fulfils them.
#[test]
fn functions_have_their_meaning() {
    let arm = Robot::from_file("../robots/ur5.urdf").unwrap();
    let tool = Carried::new(&arm, arm.frame_index("tool0").unwrap());
    let (q, v) = ([0.3, -1.2, 0.8, 0.1, 0.5, 0.2], [0.1, -0.2, 0.3, 0.4, -0.5, 0.6]);
    let mut placed = Placed::new(&arm);
    placed.place(&q, &v).unwrap();
    let (rotation, x) = placed.frame(tool.frame).unwrap();
    let value = |quantity: Quantity| {
        let mut functions = functions(&arm, &tool, quantity);
        let mut g = vec![f64::NAN; functions.rows()];
        functions.values(&q, &v, &mut g).unwrap();
        g
    };
    let (axis, turn) = (unit([0.2, 0.5, -0.3]), 0.3);
    let along = rotation * axis;
    let desired = Rotation3::from_matrix_unchecked(rotation);
    // Turned by a known angle about an axis that is normal to it.
    let normal = along.cross(&Vector3::x()).normalize();
    let turned = Rotation3::from_scaled_axis(normal * turn);
    let g = value(Quantity::direction(axis, turned * along));
    assert!((g[0].hypot(g[1]) - turn).abs() < 1e-14, "{g:?}");
    let zero = value(Quantity::direction(axis, along));
    assert!(zero.iter().all(|g| g.abs() < 1e-14), "{zero:?}");
    for limit in [0.1_f64, 0.3, 2.0] {
        let expected = (1.0 - turn.cos()) / limit.sin();
        let leaning = value(Quantity::leaning(axis, turned * along, limit))[0];
        let all = value(Quantity::turned(&(turned * desired), limit))[0];
        assert!((leaning - expected).abs() < 1e-14 && (all - expected).abs() < 1e-14, "{leaning} {all}");
    }
    let line = Matrix3::identity() - along * along.transpose();
    let from = x + along * 0.7 + normal * 0.2;
    let near = value(Quantity::Distance { from, projector: line, radius: 0.2 })[0];
    assert!((near - 0.1).abs() < 1e-15, "{near}");
    let velocity = placed.kinematics.twist(tool.frame, ReferenceFrame::LocalWorldAligned).unwrap().linear;
    let speed = velocity.dot(velocity).sqrt();
    // That of x of the tool, seen from above: turned about z, it is larger by the angle.
    let x = rotation * Vector3::x();
    let yaw = x.y.atan2(x.x);
    for angle in [-1.2, 0.0, 2.0] {
        assert!((value(Quantity::yaw(yaw - angle))[0] - angle).abs() < 1e-14);
    }
    assert!((value(Quantity::Speed(speed))[0] - 0.5 * speed).abs() < 1e-15);
}

/// Both formulas of the angle over its sine, and their derivatives, agree where one takes over from the
/// other, and nothing is infinite at a half turn.
#[test]
fn the_angle_over_its_sine_is_smooth() {
    let closed = |c: f64| {
        let square = 1.0 - c * c;
        let f = c.acos() / square.sqrt();
        let slope = (c * f - 1.0) / square;
        [f, slope, (3.0 * c * slope + f) / square]
    };
    for c in [0.9 + 1e-9, 0.95, 0.99] {
        for (series, closed) in angle_over_sine(c, 1.0 - c * c).into_iter().zip(closed(c)) {
            assert!((series - closed).abs() < 1e-11, "{c}: {series} {closed}");
        }
    }
    assert_eq!(angle_over_sine(1.0, 0.0), [1.0, -1.0 / 3.0, 4.0 / 15.0]);
    assert!(angle_over_sine(1.0 + 1e-15, 0.0)[0].is_finite());
    let arm = Robot::from_file("../robots/pendulum.toml").unwrap();
    let tool = Carried::new(&arm, 1);
    let mut placed = Placed::new(&arm);
    placed.place(&[0.4], &[0.0]).unwrap();
    let a = placed.frame(1).unwrap().0 * Vector3::x();
    let mut functions = functions(&arm, &tool, Quantity::direction(Vector3::x(), -a));
    for off in [1e-3, 1e-6, 1e-9] {
        let (g, ..) = contracted(&mut functions, &[0.4 + off, 0.0], &[1.0, 1.0]);
        let angle = g[0].hypot(g[1]);
        assert!((angle - (std::f64::consts::PI - off)).abs() < 1e-6, "{angle}: not small near opposite");
    }
    let (g, jacobian, hessian) = contracted(&mut functions, &[0.4, 0.0], &[1.0, 1.0]);
    assert!(g.iter().chain(&jacobian).chain(&hessian).all(|entry| entry.is_finite()), "{g:?} {jacobian:?}");
}

/// States that are not finite are refused; angles of many turns are those of the rest.
#[test]
fn edges_of_the_states_are_refused_or_exact() {
    let arm = Robot::from_file("../robots/ur5.urdf").unwrap();
    let tool = Carried::new(&arm, arm.frame_index("tool0").unwrap());
    for quantity in quantities() {
        let mut functions = functions(&arm, &tool, quantity);
        let mut g = vec![0.0; functions.rows()];
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(functions.values(&[0.0, 0.0, bad, 0.0, 0.0, 0.0], &[0.0; 6], &mut g).is_err());
        }
        assert!(functions.values(&[0.0; 5], &[0.0; 6], &mut g).is_err());
        let (q, turns) = ([0.3, -1.2, 0.8, 0.1, 0.5, 0.2], 1e6 * std::f64::consts::TAU);
        let w = vec![1.0; g.len()];
        let near = contracted(&mut functions, &[q, [0.1; 6]].concat(), &w);
        let far = contracted(&mut functions, &[q.map(|q| q + turns), [0.1; 6]].concat(), &w);
        for (near, far) in [(near.0, far.0), (near.1, far.1), (near.2, far.2)] {
            assert!(
                near.iter().zip(&far).all(|(a, b)| (a - b).abs() < 1e-7 * a.abs().max(1.0)),
                "{near:?} {far:?}"
            );
        }
    }
}
