//! Robots with two equal sides, whose steps are computed in pairs.

use costate::codegen::{Coordinates, ProgramOptions, Quantity, robot_program};
use costate::hamiltonian::Hamiltonian;
use costate::robot::{Friction, JointSpec, LinkInertia, Placement, Robot, Spring};
use costate_jit::{Backend, Compiled, JitError, JitQuantity, limit_of};
use costate_test_support::generic::{Rounding, State, expected, judge};
use costate_test_support::rounding::At;
use fastrand::Rng;
use nalgebra::Matrix3;

/// How the numbers of the right side follow from those of the left one.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Right {
    /// Mirrored in the plane y = 0.
    Mirrored,
    /// Mirrored, with one mass of its own.
    Heavier,
    /// All its own.
    Other,
}

/// A trunk of two joints with two limbs and a head.
fn robot(rng: &mut Rng, limb: usize, right: Right) -> Robot {
    let trunk = |name: &str, on: Option<&str>, rng: &mut Rng| {
        let numbers = [rng.f64(), 0.0, rng.f64()];
        let joint = JointSpec::revolute(name)
            .axis([0.0, 1.0, 0.0])
            .placed(Placement::from_xyz_rpy(numbers, [0.0; 3]));
        let joint = joint.carrying(LinkInertia::about_com(4.0, numbers, Matrix3::identity() * 0.3));
        on.map_or(joint.clone(), |on| joint.on(on))
    };
    let mut robot = Robot::builder("sides").joint(trunk("trunk_0", None, rng));
    robot = robot.joint(trunk("trunk_1", Some("trunk_0"), rng)).joint(trunk("head", Some("trunk_1"), rng));
    let seed = rng.u64(..);
    for (side, sign) in [("left", 1.0), ("right", -1.0)] {
        let own = right == Right::Other && side == "right";
        let mut rng = Rng::with_seed(if own { !seed } else { seed });
        for k in 0..limb {
            let mut vector = |sign: f64| {
                let [x, y, z] = std::array::from_fn(|_| rng.f64() - 0.5);
                [x, sign * y, z]
            };
            let [xyz, com] = [vector(sign), vector(sign)];
            let axis = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]][rng.usize(..3)];
            let extra = if right == Right::Heavier && sign < 0.0 && k == 0 { 0.7 } else { 0.0 };
            let inertia = LinkInertia::about_com(1.0 + rng.f64() + extra, com, Matrix3::identity() * 0.1);
            let joint = if rng.u8(..4) == 0 { JointSpec::prismatic } else { JointSpec::revolute };
            let on = if k == 0 { "trunk_1".into() } else { format!("{side}_{}", k - 1) };
            let mut joint = joint(format!("{side}_{k}")).on(on).axis(axis).carrying(inertia);
            joint = joint.placed(Placement::from_xyz_rpy(xyz, [0.0; 3]));
            if k == 1 {
                joint = joint.spring(Spring { stiffness: 3.0, rest: 0.2 * sign });
                joint = joint.friction(Friction { viscous: 0.4, coulomb: 0.3, coulomb_velocity: 0.2 });
            }
            robot = robot.joint(joint);
        }
    }
    robot.build().unwrap()
}

/// Compares every quantity with the generic code; returns steps of machine code and of programs, summed.
fn check(robot: &Robot, rng: &mut Rng) -> Option<[usize; 2]> {
    let n = robot.dof();
    let mut vector = |entries: usize| -> Vec<f64> { (0..entries).map(|_| 2.0 * rng.f64() - 1.0).collect() };
    let (q, v, u, y, d) = (vector(n), vector(n), vector(n), vector(2 * n), vector(2 * n));
    let mut steps = [0; 2];
    let rounding = Rounding::new(robot, At { q: &q, v: &v, u: &u, y: &y, d: &d });
    for coordinates in [Coordinates::Hamiltonian, Coordinates::Lagrangian] {
        let p = Hamiltonian::<f64>::new(robot).momentum(&q, &v).unwrap().to_vec();
        let second = if coordinates == Coordinates::Hamiltonian { p } else { v.clone() };
        let state = State { q: q.clone(), second, u: u.clone(), y: y.clone(), d: d.clone() };
        for quantity in Quantity::ALL {
            let options = ProgramOptions::default();
            let Ok(program) = robot_program(robot, quantity, coordinates, &options) else { continue };
            let compiled = match Compiled::<f64>::with_limit(&program, usize::MAX) {
                Err(JitError::Processor { .. }) => return None,
                compiled => compiled.unwrap(),
            };
            steps = [steps[0] + compiled.steps(), steps[1] + program.steps()];
            let inputs = state.inputs(&program);
            let expected = expected(robot, quantity, coordinates, &state, &rounding);
            let mut outputs = vec![f64::NAN; compiled.outputs()];
            compiled.call(&inputs, &mut outputs).unwrap();
            judge(&program, &outputs, &expected).unwrap();
            let mut guarded = JitQuantity::with_limit(robot, quantity, coordinates, usize::MAX).unwrap();
            outputs.fill(f64::NAN);
            guarded.evaluate(&inputs, &mut outputs).unwrap();
            judge(&program, &outputs, &expected).unwrap();
        }
    }
    Some(steps)
}

#[test]
fn robots_with_two_sides_agree_with_the_generic_code() {
    let mut rng = Rng::with_seed(15);
    for limb in [2, 3, 5] {
        for right in [Right::Mirrored, Right::Heavier, Right::Other] {
            let robot = robot(&mut rng, limb, right);
            let Some([steps, all]) = check(&robot, &mut rng) else { return };
            let share = steps as f64 / all as f64;
            assert!(share <= 1.0, "{limb}, {right:?}: {share}");
        }
    }
}

#[test]
fn humanoids_take_two_thirds_of_their_steps() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../robots/humanoid32.urdf");
    let robot = Robot::from_file(file).unwrap();
    let steps = |quantity| {
        let options = ProgramOptions::default();
        let program = robot_program(&robot, quantity, Coordinates::Hamiltonian, &options).unwrap();
        match Compiled::<f64>::with_limit(&program, usize::MAX) {
            Err(JitError::Processor { .. }) => None,
            compiled => Some(compiled.unwrap().steps() as f64 / program.steps() as f64),
        }
    };
    let Some(shares) = [Quantity::F, Quantity::FX, Quantity::YFX, Quantity::YFXX]
        .map(steps)
        .into_iter()
        .collect::<Option<Vec<_>>>()
    else {
        return;
    };
    assert!(shares[..3].iter().all(|&share| share < 0.65) && shares[3] < 0.75, "{shares:?}");
}

#[test]
fn the_default_limit_compiles_what_pays() {
    for (name, quantity, pays) in [
        ("humanoid32", Quantity::YFXX, true),
        ("humanoid50", Quantity::FX, true),
        ("humanoid50", Quantity::YFXX, false),
    ] {
        let robot =
            Robot::from_file(format!("{}/../robots/{name}.urdf", env!("CARGO_MANIFEST_DIR"))).unwrap();
        let quantity = JitQuantity::new(&robot, quantity, Coordinates::Hamiltonian).unwrap();
        let text = quantity.backend().to_string();
        match quantity.backend() {
            Backend::Generic { reason: JitError::Processor { .. } } => return,
            backend => assert_eq!(matches!(backend, Backend::Compiled { .. }), pays, "{name}: {text}"),
        }
        assert!(pays || text.contains(&limit_of(&robot).to_string()), "{text}");
    }
}
