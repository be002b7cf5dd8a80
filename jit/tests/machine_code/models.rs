//! Four states at once with their guard, and robots as models by machine code.

use costate::EvalError;
use costate::batch::{Batch, FirstOrderArrays, Model, NodeError, SecondOrderArrays};
use costate::codegen::{Coordinates, Quantity, RobotQuantity};
use costate::dynamics::Dynamics;
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::lagrangian::LagrangianSecondOrder;
use costate::matrix::Block;
use costate::robot::{Robot, file};
use costate::scalar::F64x4;
use costate::step::{RungeKutta4, SemiImplicitEuler, Step};
use costate_jit::{Backend, JitLanes, JitModel, JitQuantity, JitVelocityModel};
use std::f64::consts::FRAC_PI_2;

/// Three revolute axes through one point: M is singular where the second is at a right angle.
const GIMBAL: &str = "name = 'gimbal'\n\
    [[joint]]\nname = 'z'\naxis = [0.0, 0.0, 1.0]\n\
    [[joint]]\nname = 'y'\nparent = 'z'\naxis = [0.0, 1.0, 0.0]\n\
    [[joint]]\nname = 'x'\nparent = 'y'\naxis = [1.0, 0.0, 0.0]\n\
    mass = 1.0\ninertia = { xx = 0.2, yy = 0.3, zz = 0.4 }\n";

fn numbers(count: usize, seed: usize) -> Vec<f64> {
    (0..count).map(|k| (1.3 * (k + 31 * seed + 1) as f64).sin()).collect()
}

fn assert_close(found: &[f64], expected: &[f64], what: &str) {
    let size = expected.iter().fold(1e-300, |size: f64, entry| size.max(entry.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= 1e-11 * size, "{what}: {found} is not {expected}");
    }
    assert_eq!(found.len(), expected.len(), "{what}");
}

#[test]
fn four_states_are_those_of_the_generic_code_or_uncertain() {
    let robot = file::parse(GIMBAL, Default::default()).unwrap();
    for quantity in Quantity::ALL {
        for coordinates in Coordinates::ALL {
            let Ok(mut generic) = RobotQuantity::<f64>::new(&robot, quantity, coordinates) else {
                assert!(JitLanes::new(&robot, quantity, coordinates).is_err());
                continue;
            };
            let Ok(four) = JitLanes::new(&robot, quantity, coordinates).unwrap() else { return };
            let mut states: [Vec<f64>; 4] = std::array::from_fn(|seed| numbers(generic.inputs(), seed));
            states[1][1] = FRAC_PI_2; // q of the second joint
            states[3][2] = f64::NAN;
            let inputs: Vec<[f64; 4]> =
                (0..generic.inputs()).map(|k| std::array::from_fn(|lane| states[lane][k])).collect();
            let mut outputs = vec![[0.0; 4]; four.outputs()];
            let certain = four.evaluate(&inputs, &mut outputs).unwrap();
            assert_eq!(certain, [true, !quantity.inverts(coordinates), true, false]);
            let mut expected = vec![0.0; generic.outputs()];
            for lane in (0..4).filter(|&lane| certain[lane]) {
                generic.evaluate(&states[lane], &mut expected).unwrap();
                let found: Vec<f64> = outputs.iter().map(|numbers| numbers[lane]).collect();
                assert_close(&found, &expected, quantity.name());
            }
            let short = four.evaluate(&inputs[1..], &mut outputs);
            assert!(matches!(short, Err(EvalError::WrongLength(_))));
        }
    }
}

#[test]
fn clones_share_machine_code_and_nothing_else() {
    let robot = file::parse(GIMBAL, Default::default()).unwrap();
    let mut first = JitQuantity::new(&robot, Quantity::FX, Coordinates::Lagrangian).unwrap();
    let bytes = |of: &JitQuantity| match of.backend() {
        Backend::Compiled { bytes, .. } => bytes,
        _ => 0,
    };
    let mut second = first.clone();
    assert_eq!(bytes(&first), bytes(&second));
    let (state, mut ours, mut theirs) =
        (numbers(first.inputs(), 1), vec![0.0; first.outputs()], vec![0.0; first.outputs()]);
    first.evaluate(&state, &mut ours).unwrap();
    drop(first);
    std::thread::scope(|scope| {
        scope.spawn(|| second.evaluate(&state, &mut theirs).unwrap());
    });
    assert_eq!(ours, theirs);
}

fn entries(block: Block<'_, f64>) -> Vec<f64> {
    block.iter_rows().flatten().copied().collect()
}

/// All results of two models at one state.
fn compare(
    mut model: impl Dynamics<f64, Error = EvalError>,
    mut expected: impl Dynamics<f64, Error = EvalError>,
) {
    let (states, controls) = (expected.states(), expected.controls());
    assert_eq!((model.states(), model.controls()), (states, controls));
    assert_eq!(model.structure(), expected.structure());
    let (x, u, y) = (numbers(states, 0), numbers(controls, 1), numbers(states, 2));
    assert_close(model.evaluate(&x, &u).unwrap(), expected.evaluate(&x, &u).unwrap(), "f");
    // Twice, since buffers are used again.
    for _ in 0..2 {
        let (found, wanted) = (model.linearise(&x, &u).unwrap(), expected.linearise(&x, &u).unwrap());
        assert_close(&entries(found.f_x), &entries(wanted.f_x), "f_x");
        assert_close(&entries(found.f_u), &entries(wanted.f_u), "f_u");
        let (found, wanted) = (model.contract(&x, &u, &y).unwrap(), expected.contract(&x, &u, &y).unwrap());
        assert_close(found.first.f, wanted.first.f, "f");
        assert_close(&entries(found.first.f_x), &entries(wanted.first.f_x), "f_x");
        assert_close(&entries(found.xx), &entries(wanted.xx), "xx");
        assert_eq!(found.ux.is_some(), wanted.ux.is_some());
        if let (Some(found), Some(wanted)) = (found.ux, wanted.ux) {
            assert_close(&entries(found), &entries(wanted), "ux");
        }
        assert!(found.uu.is_none() && wanted.uu.is_none());
    }
    assert!(matches!(model.evaluate(&x[1..], &u), Err(EvalError::WrongLength(_))));
    assert!(matches!(model.contract(&x, &u, &y[1..]), Err(EvalError::WrongLength(_))));
    let nan = vec![f64::NAN; states];
    assert!(matches!(model.evaluate(&nan, &u), Err(EvalError::NonFinite { .. })));
}

#[test]
fn robots_are_models_in_both_coordinates() {
    for name in ["puma560.toml", "ur5.urdf", "biped.toml"] {
        let robot = Robot::from_file(format!("{}/../robots/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap();
        let of = |coordinates| JitModel::new(&robot, coordinates).unwrap();
        compare(of(Coordinates::Hamiltonian), HamiltonianSecondOrder::new(&robot));
        compare(of(Coordinates::Lagrangian), LagrangianSecondOrder::new(&robot));
        compare(JitVelocityModel::new(&robot).unwrap(), LagrangianSecondOrder::new(&robot));
    }
}

#[test]
fn four_states_are_those_of_a_model_one_by_one() {
    let robot = Robot::from_file(format!("{}/../robots/puma560.toml", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let (n, nodes) = (robot.dof(), 11);
    let [x, u, y] = [2 * n, n, 2 * n].map(|length| numbers(nodes * length, length));
    for coordinates in Coordinates::ALL {
        let Ok(model) = JitModel::over_lanes(&robot, coordinates).unwrap() else { return };
        assert_eq!(model.structure(), JitModel::new(&robot, coordinates).unwrap().structure());
        let mut batch = Batch::new(Model(model));
        let mut found =
            [2 * n, 4 * n * n, 2 * n * n, 4 * n * n, n * 2 * n].map(|size| vec![0.0; nodes * size]);
        let [f, f_x, f_u, xx, ux] = &mut found;
        let first = FirstOrderArrays { f, f_x, f_u };
        let second = SecondOrderArrays { xx, ux, ..Default::default() };
        assert!(batch.contract([&x, &u, &y], first, second).unwrap().is_empty());
        let [f, f_x, f_u, xx, ux] = &found;
        let mut one = JitModel::new(&robot, coordinates).unwrap();
        for k in 0..nodes {
            let of = |all: &Vec<f64>, size: usize| all[k * size..][..size].to_vec();
            let expected = one.contract(&of(&x, 2 * n), &of(&u, n), &of(&y, 2 * n)).unwrap();
            assert_close(&of(f, 2 * n), expected.first.f, "f");
            assert_close(&of(f_x, 4 * n * n), &entries(expected.first.f_x), "f_x");
            assert_close(&of(f_u, 2 * n * n), &entries(expected.first.f_u), "f_u");
            assert_close(&of(xx, 4 * n * n), &entries(expected.xx), "xx");
            for (i, row) in expected.ux.iter().flat_map(Block::iter_rows).enumerate() {
                assert_close(&of(ux, 2 * n * n)[2 * n * i..][..row.len()], row, "ux");
            }
        }
    }
}

#[test]
fn a_lane_without_a_result_says_why() {
    let robot = file::parse(GIMBAL, Default::default()).unwrap();
    let Ok(model) = JitModel::over_lanes(&robot, Coordinates::Lagrangian).unwrap() else { return };
    let (mut x, u) = (numbers(7 * 6, 3), numbers(7 * 3, 4));
    (x[2 * 6 + 1], x[5 * 6 + 4]) = (FRAC_PI_2, f64::INFINITY);
    let mut f = vec![0.0; 7 * 6];
    let mut batch = Batch::new(Model(model));
    let failures = batch.evaluate(&x, &u, &mut f).unwrap();
    assert!(matches!(
        failures,
        [a, b] if (a.node, b.node) == (2, 5)
            && matches!(a.error, NodeError::Evaluation(EvalError::SingularMassMatrix { .. }))
            && matches!(b.error, NodeError::Evaluation(EvalError::NonFinite { .. }))
    ));
    let mut one = JitModel::new(&robot, Coordinates::Lagrangian).unwrap();
    for k in [0, 1, 3, 4, 6] {
        assert_close(&f[6 * k..][..6], one.evaluate(&x[6 * k..][..6], &u[3 * k..][..3]).unwrap(), "f");
    }
}

#[test]
fn steps_begin_at_four_states() {
    let robot = Robot::from_file(format!("{}/../robots/two_link.toml", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let (Ok(model), Ok(velocities)) = (
        JitModel::over_lanes(&robot, Coordinates::Lagrangian).unwrap(),
        JitVelocityModel::over_lanes(&robot).unwrap(),
    ) else {
        return;
    };
    let (x, u): (Vec<F64x4>, Vec<F64x4>) = (
        (0..4).map(|k| F64x4::from_lanes(&numbers(4, k))).collect(),
        (0..2).map(|k| F64x4::from_lanes(&numbers(4, k + 4))).collect(),
    );
    let (mut rk4, mut euler) = (RungeKutta4::new(model), SemiImplicitEuler::new(velocities));
    let h = F64x4::from_lanes(&[0.01]);
    let next = [rk4.evaluate(&x, &u, h).unwrap().to_vec(), euler.evaluate(&x, &u, h).unwrap().to_vec()];
    let mut rk4 = RungeKutta4::new(JitModel::new(&robot, Coordinates::Lagrangian).unwrap());
    let mut euler = SemiImplicitEuler::new(JitVelocityModel::new(&robot).unwrap());
    for lane in 0..4 {
        let of = |all: &[F64x4]| all.iter().map(|four| four.lane(lane)).collect::<Vec<f64>>();
        let (x, u) = (of(&x), of(&u));
        assert_close(&of(&next[0]), rk4.evaluate(&x, &u, 0.01).unwrap(), "rk4");
        assert_close(&of(&next[1]), euler.evaluate(&x, &u, 0.01).unwrap(), "euler");
    }
}
