//! A mass matrix that is singular up to rounding is the same error as by the generic code, for every
//! quantity.

use costate::EvalError;
use costate::codegen::{Coordinates, ProgramOptions, Quantity, robot_program};
use costate::robot::{JointSpec, LinkInertia, Placement, Robot, file};
use costate_jit::{Compiled, JitQuantity};
use fastrand::Rng;
use nalgebra::Matrix3;

/// Three revolute axes through one point; M is singular where the second is at a right angle.
fn gimbal() -> Robot {
    let text = "name = 'gimbal'\n\
        [[joint]]\nname = 'z'\naxis = [0.0, 0.0, 1.0]\n\
        [[joint]]\nname = 'y'\naxis = [0.0, 1.0, 0.0]\n\
        [[joint]]\nname = 'x'\naxis = [1.0, 0.0, 0.0]\nmass = 1.0\ninertia = { xx = 0.2, yy = 0.3, zz = 0.4 }\n";
    file::parse(text, Default::default()).unwrap()
}

/// A chain of revolute joints in general directions that carries these links.
fn chain(name: &str, links: &[LinkInertia]) -> Robot {
    let mut rng = Rng::with_seed(8);
    let mut builder = Robot::builder(name);
    for (i, link) in links.iter().enumerate() {
        let [xyz, rpy]: [[f64; 3]; 2] = std::array::from_fn(|_| std::array::from_fn(|_| rng.f64() - 0.5));
        let placed = Placement::from_xyz_rpy(xyz, rpy.map(|angle| 5.0 * angle));
        let mut joint = JointSpec::revolute(format!("j{i}")).placed(placed).carrying(*link);
        if i > 0 {
            joint = joint.on(format!("j{}", i - 1));
        }
        builder = builder.joint(joint);
    }
    builder.build().unwrap()
}

fn body() -> LinkInertia {
    LinkInertia::about_com(1.3, [0.1, -0.2, 0.15], Matrix3::from_diagonal(&[0.03, 0.04, 0.05].into()))
}

/// Every quantity that there is, compiled and by the generic code.
fn both(robot: &Robot) -> Vec<(Quantity, Coordinates, [JitQuantity; 2])> {
    let all = [Coordinates::Hamiltonian, Coordinates::Lagrangian].into_iter();
    let all = all.flat_map(|coordinates| Quantity::ALL.map(|quantity| (quantity, coordinates)));
    let make = |(quantity, coordinates)| {
        let machine = JitQuantity::new(robot, quantity, coordinates).ok()?;
        Some((
            quantity,
            coordinates,
            [machine, JitQuantity::with_limit(robot, quantity, coordinates, 0).unwrap()],
        ))
    };
    all.filter_map(make).collect()
}

/// Compares both for each of the positions; how many of those quantities that invert M were refused, and of
/// how many.
fn refused(robot: &Robot, positions: &[Vec<f64>]) -> (usize, usize) {
    let (mut refused, mut count, mut rng) = (0, 0, Rng::with_seed(2));
    for (quantity, coordinates, [mut machine, mut generic]) in both(robot) {
        for q in positions {
            let mut inputs: Vec<f64> = (0..machine.inputs()).map(|_| rng.f64() - 0.5).collect();
            inputs[..q.len()].copy_from_slice(q);
            let (mut found, mut expected) = (vec![0.0; machine.outputs()], vec![0.0; machine.outputs()]);
            let outcome = machine.evaluate(&inputs, &mut found);
            let what = format!("{} {} of {} at {q:?}", coordinates.name(), quantity.name(), robot.name());
            assert_eq!(outcome, generic.evaluate(&inputs, &mut expected), "{what}");
            if quantity.inverts(coordinates) {
                count += 1;
                match outcome {
                    Ok(()) => {}
                    Err(EvalError::SingularMassMatrix { .. }) => refused += 1,
                    Err(error) => panic!("{what}: {error}"),
                }
            } else {
                assert_eq!(outcome, Ok(()), "{what}");
            }
        }
    }
    (refused, count)
}

fn random_positions(n: usize) -> Vec<Vec<f64>> {
    let mut rng = Rng::with_seed(6);
    (0..30).map(|_| (0..n).map(|_| 6.0 * rng.f64() - 3.0).collect()).collect()
}

/// Without the guard these results would be finite numbers.
#[test]
fn a_singular_pose_with_finite_results_is_refused() {
    let robot = gimbal();
    let singular = vec![0.3, std::f64::consts::FRAC_PI_2, -0.7];
    let program =
        robot_program(&robot, Quantity::FX, Coordinates::Hamiltonian, &ProgramOptions::default()).unwrap();
    if let Ok(compiled) = Compiled::new(&program) {
        let mut outputs = vec![f64::NAN; compiled.outputs()];
        compiled.call(&[singular.as_slice(), &[0.1; 6]].concat(), &mut outputs).unwrap();
        assert!(outputs.iter().all(|output| output.is_finite()), "this state tests nothing");
    }
    let (refused, count) = refused(&robot, &[singular]);
    assert!(refused == count && count == 10, "{refused} of {count}");
}

/// Poses that approach the singular one: the limit is that of the generic code.
#[test]
fn poses_near_a_singular_one_are_judged_as_by_the_generic_code() {
    let robot = gimbal();
    let mut positions = Vec::new();
    for k in 0..60 {
        let distance = 10.0_f64.powf(-0.2 * f64::from(k));
        positions.push(vec![0.4, std::f64::consts::FRAC_PI_2 + distance, 1.1]);
    }
    let (refused, count) = refused(&robot, &positions);
    assert!(refused > count / 4 && refused < 3 * count / 4, "{refused} of {count}");
}

#[test]
fn joints_that_move_no_mass_are_refused_in_every_pose() {
    let massless = LinkInertia::massless();
    let on_its_axis = LinkInertia::point(1.0, [0.0; 3]);
    let robots = [
        chain(
            "four joints that move one point",
            &[massless, massless, massless, LinkInertia::point(1.0, [0.4, 0.1, 0.2])],
        ),
        chain("a point on the last axis", &[body(), body(), on_its_axis]),
        chain(
            "seven joints that move one body",
            &[massless, massless, massless, massless, massless, massless, body()],
        ),
        chain("two points on axes", &[body(), on_its_axis, body(), on_its_axis]),
    ];
    for robot in robots {
        let (refused, count) = refused(&robot, &random_positions(robot.dof()));
        assert_eq!(refused, count, "{}", robot.name());
    }
}

#[test]
fn regular_robots_are_not_refused_however_badly_scaled() {
    let light = LinkInertia::about_com(1e-5, [0.1, 0.0, 0.1], Matrix3::identity() * 1e-7);
    let heavy = LinkInertia::about_com(500.0, [0.1, 0.0, 0.1], Matrix3::identity() * 10.0);
    let links = [heavy, body(), light];
    let (refused, _) = refused(&chain("light wrist", &links), &random_positions(3));
    assert_eq!(refused, 0);
}

/// A link without mass, moved by a motor with inertia.
#[test]
fn a_massless_last_link_with_armature_is_regular() {
    let robot = Robot::builder("geared")
        .joint(JointSpec::revolute("a").carrying(body()).armature(0.01))
        .joint(JointSpec::revolute("b").on("a").armature(0.02))
        .build()
        .unwrap();
    let (refused, count) = refused(&robot, &random_positions(2));
    assert!(refused == 0 && count > 0);
}
