//! Bad states and extreme ones: what happens.

use costate::derivative::{DerivativeError, Jacobian, PhaseVelocity, Routes, Verdict, largest};
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::kernels::KernelOne;
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder, LegendreTransform};
use costate::matrix::Matrix;
use costate::robot::{JointSpec, LinkInertia, Placement, Robot, Tree};
use costate::{EvalError, LengthError};
use nalgebra::Matrix3;

fn panda() -> Robot {
    Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/panda.urdf")).unwrap()
}

#[test]
fn wrong_lengths_are_named() {
    let robot = panda();
    let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
    let (right, wrong) = ([0.0; 7], [0.0; 6]);
    let error = |what| EvalError::WrongLength(LengthError { what, expected: 7, found: 6 });
    assert_eq!(hamiltonian.evaluate(&wrong, &right, &right).unwrap_err(), error("q"));
    assert_eq!(hamiltonian.evaluate(&right, &wrong, &right).unwrap_err(), error("p"));
    assert_eq!(hamiltonian.linearise(&right, &right, &wrong).unwrap_err(), error("u"));
    assert_eq!(hamiltonian.momentum(&right, &wrong).unwrap_err(), error("v"));
    let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
    let refused = second.contract(&right, &right, &right, &right).unwrap_err();
    assert_eq!(refused, EvalError::WrongLength(LengthError { what: "y", expected: 14, found: 7 }));
    assert!(refused.to_string().contains("y has 7 entries, not 14"));
    let mut dual: Jacobian<_> = Jacobian::new(PhaseVelocity::new(&robot));
    assert!(matches!(
        dual.linearise(&right),
        Err(DerivativeError::WrongLength(LengthError { what: "x", .. }))
    ));
    let mut routes = Routes::new(&robot);
    assert!(matches!(
        routes.compare(&right, &right, &[0.0; 14]),
        Err(DerivativeError::WrongLength(LengthError { what: "x", .. }))
    ));
    assert!(matches!(
        routes.compare(&[0.0; 14], &wrong, &[0.0; 14]),
        Err(DerivativeError::WrongLength(LengthError { what: "u", .. }))
    ));
    let tree = Tree::from(&robot);
    let mut kernel = KernelOne::<f64>::new(&tree);
    assert_eq!(kernel.set_position(&tree, &wrong).unwrap_err(), error("q"));
    assert_eq!(kernel.set_velocity(&tree, &wrong).unwrap_err(), error("v"));
    assert!(robot.with_gravity([0.0, f64::NAN, 0.0]).is_err());
    dual.function_mut().u.pop();
    assert!(matches!(dual.linearise(&[0.0; 14]), Err(DerivativeError::Function(EvalError::WrongLength(_)))));
}

#[test]
fn not_a_number_and_infinity_are_named_with_their_joint() {
    let robot = panda();
    let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (argument, name) in ["q", "p", "u", "y"].into_iter().enumerate() {
            let mut arguments = [vec![0.1; 7], vec![0.1; 7], vec![0.1; 7], vec![0.1; 14]];
            arguments[argument][3] = bad;
            let [q, p, u, y] = &arguments;
            let error = second.contract(q, p, u, y).unwrap_err();
            assert_eq!(error, EvalError::NonFinite { what: name, index: 3, joint: "panda_joint4".into() });
        }
    }
    let mut y = [0.1; 14];
    y[9] = f64::NAN;
    let error = second.contract(&[0.1; 7], &[0.1; 7], &[0.1; 7], &y).unwrap_err();
    assert!(error.to_string().contains("y[9] (joint 'panda_joint3')"), "{error}");
    assert!(second.contract(&[0.1; 7], &[0.1; 7], &[0.1; 7], &[0.1; 14]).is_ok(), "usable afterwards");
}

#[test]
fn lagrangian_arguments_are_named_too() {
    let robot = panda();
    let (mut lagrangian, mut second) =
        (Lagrangian::<f64>::new(&robot), LagrangianSecondOrder::<f64>::new(&robot));
    let (right, wrong) = ([0.1; 7], [0.1; 6]);
    let error = |what| EvalError::WrongLength(LengthError { what, expected: 7, found: 6 });
    assert_eq!(lagrangian.inverse_dynamics(&right, &right, &wrong).unwrap_err(), error("a"));
    assert_eq!(lagrangian.linearise_inverse_dynamics(&right, &wrong, &right).unwrap_err(), error("v"));
    assert_eq!(lagrangian.forward_dynamics(&wrong, &right, &right).unwrap_err(), error("q"));
    assert_eq!(lagrangian.linearise(&right, &right, &wrong).unwrap_err(), error("u"));
    assert_eq!(lagrangian.coriolis_matrix(&right, &wrong).unwrap_err(), error("v"));
    assert_eq!(lagrangian.gravity(&wrong).unwrap_err(), error("q"));
    assert_eq!(second.contract_forward_dynamics(&right, &right, &right, &wrong).unwrap_err(), error("y"));
    assert_eq!(second.contract_inverse_dynamics(&right, &right, &right, &wrong).unwrap_err(), error("w"));
    let bad = [0.1, 0.1, f64::NAN, 0.1, 0.1, 0.1, 0.1];
    let not_finite = |what| EvalError::NonFinite { what, index: 2, joint: "panda_joint3".into() };
    assert_eq!(lagrangian.energy(&right, &bad).unwrap_err(), not_finite("v"));
    assert_eq!(lagrangian.linearise_forward_dynamics(&right, &right, &bad).unwrap_err(), not_finite("u"));
    assert_eq!(second.contract_forward_dynamics(&right, &right, &right, &bad).unwrap_err(), not_finite("y"));
    let mut coordinates = LegendreTransform::<f64>::new(&robot);
    assert_eq!(coordinates.at_momentum(&right, &bad, &right).unwrap_err(), not_finite("p"));
    let mut map = coordinates.at(&right, &right, &right).unwrap();
    let narrow = Matrix::<f64>::zeros(14, 13);
    let error = |what| EvalError::WrongLength(LengthError { what, expected: 14, found: 13 });
    assert_eq!(map.jacobian_to_lagrangian(narrow.view()).unwrap_err(), error("f_x"));
    assert_eq!(map.jacobian_to_hamiltonian(narrow.view()).unwrap_err(), error("g_z"));
    assert_eq!(map.costate_to_lagrangian(&mut [0.0; 13]).unwrap_err(), error("y"));
    assert!(lagrangian.forward_dynamics(&right, &right, &right).is_ok(), "usable afterwards");
}

/// The last link is a point on its axis: M is singular, and that is said, not answered with infinities.
#[test]
fn a_singular_mass_matrix_is_an_error_that_names_the_joint() {
    let robot = Robot::builder("needle")
        .joint(JointSpec::revolute("shoulder").carrying(LinkInertia::point(1.0, [1.0, 0.0, 0.0])))
        .joint(
            JointSpec::revolute("spin")
                .on("shoulder")
                .placed(Placement::from_xyz_rpy([1.0, 0.0, 0.0], [0.3, 0.2, 0.1]))
                .carrying(LinkInertia::point(0.5, [0.0, 0.0, 0.7])),
        )
        .build()
        .unwrap();
    assert!(robot.warnings().iter().any(|warning| warning.to_string().contains("'spin'")));
    let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
    let error = hamiltonian.evaluate(&[0.1, 0.2], &[1.0, 1.0], &[0.0; 2]).unwrap_err();
    assert_eq!(error, EvalError::SingularMassMatrix { joint: "spin".into() });
    assert!(hamiltonian.linearise(&[0.1, 0.2], &[1.0, 1.0], &[0.0; 2]).is_err());
    assert!(hamiltonian.momentum(&[0.1, 0.2], &[1.0, 1.0]).is_ok(), "p = M v needs no inverse");
    let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
    assert!(second.contract(&[0.1, 0.2], &[1.0, 1.0], &[0.0; 2], &[1.0; 4]).is_err());
    let mut lagrangian = Lagrangian::<f64>::new(&robot);
    let refused = lagrangian.forward_dynamics(&[0.1, 0.2], &[1.0, 1.0], &[0.0; 2]).unwrap_err();
    assert_eq!(refused, error);
    assert!(lagrangian.linearise_inverse_dynamics(&[0.1, 0.2], &[1.0, 1.0], &[0.0; 2]).is_ok());
}

/// Two coaxial joints with a massless link between them: each alone moves mass, together they are redundant.
#[test]
fn coaxial_joints_with_nothing_between_them_are_singular() {
    let body = LinkInertia::about_com(1.0, [0.2, 0.0, 0.0], Matrix3::identity() * 0.1);
    let robot = Robot::builder("twice")
        .joint(JointSpec::revolute("first"))
        .joint(JointSpec::revolute("second").on("first").carrying(body))
        .build()
        .unwrap();
    let error = Hamiltonian::<f64>::new(&robot).evaluate(&[0.0, 0.4], &[1.0, 1.0], &[0.0; 2]).unwrap_err();
    assert_eq!(error, EvalError::SingularMassMatrix { joint: "first".into() });
}

/// An angle of 1e6 rad is the angle modulo a turn, up to the spacing of numbers there.
#[test]
fn large_angles_lose_only_the_digits_they_lack() {
    let robot = panda();
    let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
    let turns = (1e6 / std::f64::consts::TAU).round() * std::f64::consts::TAU;
    let q: Vec<f64> = (0..7).map(|i| 0.2 * i as f64 - 0.5).collect();
    let far: Vec<f64> = q.iter().map(|q| q + turns).collect();
    let p = [0.3; 7];
    let near = hamiltonian.linearise(&q, &p, &p).unwrap().matrix().to_nalgebra();
    let found = hamiltonian.linearise(&far, &p, &p).unwrap().matrix().to_nalgebra();
    assert!(largest(&(&found - &near)) <= 1e-7 * largest(&near));
}

/// Joints whose axes are parallel but for a tiny angle: nothing is lost by the turning of frames.
#[test]
fn nearly_parallel_axes() {
    for tilt in [1e-15, 3e-15, 1e-12, 1e-9, 1e-7, 1e-4] {
        let body = LinkInertia::about_com(1.0, [0.3, 0.1, 0.2], Matrix3::identity() * 0.1);
        let placed = |angle: f64| Placement::from_xyz_rpy([0.4, 0.2, 0.3], [angle, 0.0, 0.5]);
        let arm = |angle: f64| {
            let first = JointSpec::revolute("a").placed(placed(0.4)).carrying(body);
            let second = JointSpec::revolute("b").on("a").placed(placed(angle)).carrying(body);
            Robot::builder("arm").joint(first).joint(second).build().unwrap()
        };
        let m = |robot: &Robot| {
            Hamiltonian::<f64>::new(robot).mass_matrix(&[0.3, -0.8]).unwrap().as_slice().to_vec()
        };
        let (parallel, tilted, twice) = (m(&arm(0.0)), m(&arm(tilt)), m(&arm(2.0 * tilt)));
        for ((a, b), c) in parallel.iter().zip(&tilted).zip(&twice) {
            assert!(
                (b - a).abs() <= tilt + 1e-15 && (c - 2.0 * b + a).abs() <= tilt * tilt + 2e-15,
                "{tilt}: {a} {b} {c}"
            );
        }
    }
}

/// Masses of 1e-6 and 1e6 kg in one chain, without gravity: the methods still agree within their bounds.
#[test]
fn extreme_masses() {
    for masses in [[1e-6, 1e6, 1e-6], [1e6, 1e-6, 1e6], [1e6, 1.0, 1e-6]] {
        let mut builder = Robot::builder("extreme").gravity([0.0; 3]);
        for (i, mass) in masses.into_iter().enumerate() {
            let link = LinkInertia::about_com(mass, [0.3, 0.1, 0.0], Matrix3::identity() * (0.05 * mass));
            let placed = Placement::from_xyz_rpy([0.5, 0.0, 0.1], [0.4, -0.3, 0.8]);
            let mut spec = JointSpec::revolute(format!("j{i}")).placed(placed).carrying(link);
            if i > 0 {
                spec = spec.on(format!("j{}", i - 1));
            }
            builder = builder.joint(spec);
        }
        let robot = builder.build().unwrap();
        let (q, v) = ([0.3, -0.7, 1.1], [0.5, 0.2, -0.4]);
        let p = Hamiltonian::<f64>::new(&robot).momentum(&q, &v).unwrap().to_vec();
        let x = [q.to_vec(), p].concat();
        let report = Routes::new(&robot).compare(&x, &[0.0; 3], &[0.5; 6]).unwrap();
        assert_eq!(report.failures(1.0).collect::<Vec<_>>(), [&report.figures[0]; 0], "{report:?}");
    }
}

/// Two joints on one axis with almost nothing between them: rounding leaves no digits of y'F_xx, and the
/// comparison says so instead of showing the zeros among its blocks.
#[test]
fn what_has_no_digits_left_is_not_said_to_agree() {
    let speck = LinkInertia::about_com(0.0, [0.0; 3], Matrix3::identity() * 1e-12);
    let body = LinkInertia::about_com(1.0, [0.05, 0.02, 0.1], Matrix3::identity() * 0.02);
    let turned = Placement::from_xyz_rpy([0.1, 0.2, 0.3], [0.3, -0.4, 0.5]);
    let robot = Robot::builder("wrist")
        .joint(JointSpec::revolute("a").placed(turned).carrying(speck))
        .joint(JointSpec::revolute("b").on("a").carrying(body))
        .joint(JointSpec::revolute("c").on("b").placed(turned).axis([0.0, 1.0, 0.0]).carrying(body))
        .build()
        .unwrap();
    let (q, v) = ([0.3, -0.7, 1.1], [0.5, 0.2, -0.4]);
    let p = Hamiltonian::<f64>::new(&robot).momentum(&q, &v).unwrap().to_vec();
    let report = Routes::new(&robot).compare(&[&q[..], &p].concat(), &[0.1; 3], &[0.5; 6]).unwrap();
    assert!(report.condition > 1e10 && report.is_nearly_singular(), "{report:?}");
    for route in ["analytic", "dual pass", "packed tensor", "tensors"] {
        let figure = report.get("y'F_xx", route).unwrap();
        assert_eq!(figure.verdict(1.0), Verdict::NotComparable, "{figure:?}");
    }
    // Frames do not need M.
    let frames = report.get("(w.V)_zz of frames", "analytic").unwrap();
    assert_eq!(frames.verdict(1.0), Verdict::Agrees, "{frames:?}");
}

/// A chain of 100 joints is only a matter of time.
#[test]
fn a_hundred_joints() {
    let body = LinkInertia::about_com(0.5, [0.05, 0.0, 0.0], Matrix3::identity() * 0.01);
    let mut builder = Robot::builder("snake");
    for i in 0..100 {
        let placed = Placement::from_xyz_rpy(
            [0.1, 0.0, 0.0],
            [std::f64::consts::FRAC_PI_2 * (i % 2) as f64, 0.0, 0.0],
        );
        let mut spec = JointSpec::revolute(format!("j{i}")).placed(placed).carrying(body);
        if i > 0 {
            spec = spec.on(format!("j{}", i - 1));
        }
        builder = builder.joint(spec);
    }
    let robot = builder.build().unwrap();
    let q: Vec<f64> = (0..100).map(|i| 0.1 * f64::from(i).sin()).collect();
    let v: Vec<f64> = (0..100).map(|i| 0.1 * f64::from(i).cos()).collect();
    let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
    let p = hamiltonian.momentum(&q, &v).unwrap().to_vec();
    let found = hamiltonian.velocity(&q, &p).unwrap().to_vec();
    let errors: Vec<f64> = found.iter().zip(&v).map(|(a, b)| a - b).collect();
    let error = largest(&errors);
    assert!(error < 1e-8, "{error:.2e}");
    let mut dual: Jacobian<_> = Jacobian::new(PhaseVelocity::new(&robot));
    let by_dual = dual.linearise(&[q.clone(), p.clone()].concat()).unwrap().jacobian.view().to_nalgebra();
    let by_hand = hamiltonian.linearise(&q, &p, &vec![0.0; 100]).unwrap().matrix().to_nalgebra();
    assert!(largest(&(&by_hand - &by_dual)) <= 1e-9 * largest(&by_dual));
}
