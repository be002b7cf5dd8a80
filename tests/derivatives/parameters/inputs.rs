//! Bad and extreme states, robots and sets.

use costate::lagrangian::Lagrangian;
use costate::parameters::{HamiltonianParameters, LagrangianParameters, ParameterSet, Regressor};
use costate::robot::{JointSpec, LinkInertia, Placement, Robot, Wrench, WrenchAxes};
use costate::{EvalError, LengthError};

fn panda() -> Robot {
    Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/panda.urdf")).unwrap()
}

#[test]
fn wrong_lengths_and_numbers_are_named() {
    let set = ParameterSet::new(&panda()).links().gravity();
    let (right, wrong) = ([0.1; 7], [0.1; 6]);
    let length = |what| EvalError::WrongLength(LengthError { what, expected: 7, found: 6 });
    let mut regressor = Regressor::<f64>::new(&set);
    assert_eq!(regressor.inverse_dynamics(&wrong, &right, &right).unwrap_err(), length("q"));
    assert_eq!(regressor.adjoint(&right, &right, &right, &wrong).unwrap_err(), length("w"));
    assert_eq!(regressor.momentum(&right, &wrong).unwrap_err(), length("v"));
    assert_eq!(regressor.energy(&right, &wrong).unwrap_err(), length("v"));
    let mut in_q_p = HamiltonianParameters::<f64>::new(&set);
    assert_eq!(in_q_p.linearise(&right, &wrong).unwrap_err(), length("p"));
    let refused = in_q_p.contract(&right, &right, &right).unwrap_err();
    assert_eq!(refused, EvalError::WrongLength(LengthError { what: "y", expected: 14, found: 7 }));
    let mut in_q_v = LagrangianParameters::<f64>::new(&set);
    assert_eq!(in_q_v.linearise_forward_dynamics(&right, &right, &wrong).unwrap_err(), length("u"));
    assert_eq!(in_q_v.adjoint_forward_dynamics(&right, &right, &right, &wrong).unwrap_err(), length("y"));
    for bad in [f64::NAN, f64::INFINITY] {
        let mut a = right;
        a[3] = bad;
        let refused = regressor.inverse_dynamics(&right, &right, &a).unwrap_err();
        assert!(matches!(&refused, EvalError::NonFinite { what: "a", index: 3, .. }), "{refused}");
        let refused = in_q_p.adjoint(&right, &right, &[bad; 14]).unwrap_err();
        assert!(matches!(&refused, EvalError::NonFinite { what: "y", index: 0, .. }), "{refused}");
        let refused = in_q_v.linearise_forward_dynamics(&a, &right, &right).unwrap_err();
        assert!(matches!(&refused, EvalError::NonFinite { what: "q", index: 3, .. }), "{refused}");
    }
    assert!(regressor.inverse_dynamics(&right, &right, &right).is_ok(), "usable after an error");
}

#[test]
fn empty_sets_have_no_columns() {
    let set = ParameterSet::new(&panda());
    let (x, y) = ([0.1; 7], [0.1; 14]);
    let mut regressor = Regressor::<f64>::new(&set);
    let tau = regressor.inverse_dynamics(&x, &x, &x).unwrap();
    assert_eq!((tau.rows(), tau.columns()), (7, 0));
    assert!(regressor.energy(&x, &x).unwrap().is_empty());
    assert!(HamiltonianParameters::<f64>::new(&set).contract(&x, &x, &y).unwrap().y_f_theta().is_empty());
    let mut in_q_v = LagrangianParameters::<f64>::new(&set);
    assert!(in_q_v.adjoint_forward_dynamics(&x, &x, &x, &x).unwrap().is_empty());
}

#[test]
fn a_singular_mass_matrix_is_named_and_the_regressor_does_not_need_it() {
    let turn = |name: &str| JointSpec::revolute(name);
    let body = LinkInertia::point(1.0, [0.0, 0.0, 0.4]);
    let robot = Robot::builder("wrist")
        .joint(turn("a"))
        .joint(turn("b").on("a").axis([1.0, 0.0, 0.0]))
        .joint(turn("c").on("b").carrying(body))
        .build()
        .unwrap();
    let set = ParameterSet::new(&robot).model();
    let (q, x) = ([0.3, 0.0, 0.2], [0.5; 3]);
    assert!(Regressor::<f64>::new(&set).inverse_dynamics(&q, &x, &x).is_ok());
    let refused = HamiltonianParameters::<f64>::new(&set).linearise(&q, &x).unwrap_err();
    assert!(matches!(refused, EvalError::SingularMassMatrix { .. }), "{refused}");
    let refused = LagrangianParameters::<f64>::new(&set).linearise_forward_dynamics(&q, &x, &x).unwrap_err();
    assert!(matches!(refused, EvalError::SingularMassMatrix { .. }), "{refused}");
}

/// A turn of 1e6 rad, masses from 1e-6 to 1e6 and no gravity.
#[test]
fn extreme_states_and_masses_give_the_torques_of_inverse_dynamics() {
    let body = |mass| LinkInertia::about_com(mass, [0.2, 0.1, -0.3], nalgebra::Matrix3::identity() * mass);
    let placed = Placement::from_xyz_rpy([0.3, -0.2, 0.1], [0.4, 0.5, -0.6]);
    let robot = Robot::builder("uneven")
        .gravity([0.0; 3])
        .joint(JointSpec::revolute("heavy").placed(placed).carrying(body(1e6)))
        .joint(
            JointSpec::revolute("light")
                .on("heavy")
                .placed(placed)
                .axis([1.0, 2.0, 0.0])
                .carrying(body(1e-6)),
        )
        .joint(JointSpec::prismatic("slide").on("light").placed(placed).carrying(body(1e-3)))
        .build()
        .unwrap();
    let set = ParameterSet::new(&robot).links();
    let (q, v, a) = ([1e6, -1e6, 3e2], [0.3, -20.0, 4.0], [0.2, 30.0, -1.0]);
    let tau = Lagrangian::<f64>::new(&robot).inverse_dynamics(&q, &v, &a).unwrap().to_vec();
    let mut regressor = Regressor::<f64>::new(&set);
    let ours = super::times(regressor.inverse_dynamics(&q, &v, &a).unwrap(), set.values());
    for (i, (ours, tau)) in ours.iter().zip(&tau).enumerate() {
        assert!((ours - tau).abs() <= 1e-11 * tau.abs(), "joint {i}: {ours} {tau}");
    }
}

/// A wrench that is set is that of a robot that was built with it.
#[test]
fn wrenches_are_changed_in_the_workspaces() {
    let pull = |force| Wrench { force, moment: [1.0, 0.2, -0.5], axes: WrenchAxes::Local };
    let [soft, hard] = [[1.0, 2.0, 3.0], [-30.0, 20.0, 5.0]]
        .map(|force| panda().with_wrench("panda_link7", pull(force)).unwrap());
    let sets = [soft, hard].map(|robot| ParameterSet::new(&robot).links().translations());
    let (q, v, y) = ([0.3; 7], [0.7; 7], [0.1; 14]);
    let (moment, force) = ([1.0, 0.2, -0.5], [-30.0, 20.0, 5.0]);
    let [mut set, mut expected] = sets.each_ref().map(Regressor::<f64>::new);
    set.set_wrench(0, &moment, &force).unwrap();
    let tau = |one: &mut Regressor<f64>| one.inverse_dynamics(&q, &v, &v).unwrap().as_slice().to_vec();
    assert_eq!(tau(&mut set), tau(&mut expected));
    let [mut set, mut expected] = sets.each_ref().map(HamiltonianParameters::<f64>::new);
    assert_ne!(set.linearise(&q, &v).unwrap().as_slice(), expected.linearise(&q, &v).unwrap().as_slice());
    set.set_wrench(0, &moment, &force).unwrap();
    let (set, expected) = (set.contract(&q, &v, &y).unwrap(), expected.contract(&q, &v, &y).unwrap());
    assert_eq!(set.f_theta().as_slice(), expected.f_theta().as_slice());
    assert_eq!(set.y_f_x_theta().as_slice(), expected.y_f_x_theta().as_slice());
    let [mut set, mut expected] = sets.each_ref().map(LagrangianParameters::<f64>::new);
    set.set_wrench(0, &moment, &force).unwrap();
    let linear = set.linearise_forward_dynamics(&q, &v, &v).unwrap();
    let expected = expected.linearise_forward_dynamics(&q, &v, &v).unwrap();
    assert_eq!(linear.acceleration, expected.acceleration);
    assert_eq!(linear.a_theta.as_slice(), expected.a_theta.as_slice());
    assert_eq!(set.set_wrench(1, &moment, &force), Err(EvalError::NoWrench { wrench: 1, count: 1 }));
    assert_eq!(set.set_wrench(0, &moment, &[f64::NAN; 3]), Err(EvalError::BadWrench { wrench: 0 }));
    let mut without = Regressor::<f64>::new(&ParameterSet::new(&panda()).links());
    assert_eq!(without.set_wrench(0, &moment, &force), Err(EvalError::NoWrench { wrench: 0, count: 0 }));
}

/// Columns of masses do not depend on wrenches, but a(q, v, u) does.
#[test]
fn wrenches_are_a_part_of_forward_dynamics() {
    let pull = Wrench { force: [3.0, -20.0, 5.0], axes: WrenchAxes::Aligned, ..Wrench::default() };
    let robot = panda().with_wrench("panda_link7", pull).unwrap();
    let (q, v, u) = ([0.3; 7], [0.7; 7], [0.1; 7]);
    let set = ParameterSet::new(&robot).links().gravity();
    let mut in_q_v = LagrangianParameters::<f64>::new(&set);
    let linear = in_q_v.linearise_forward_dynamics(&q, &v, &u).unwrap();
    let change = |step: f64| {
        let mut values = set.values().to_vec();
        values[0] += step;
        let mut moved = Lagrangian::<f64>::new(&set.robot_with(&values).unwrap());
        moved.forward_dynamics(&q, &v, &u).unwrap().to_vec()
    };
    let size = linear.a_theta.as_slice().iter().fold(0.0, |size: f64, entry| size.max(entry.abs()));
    for (i, (beyond, before)) in change(1e-4).iter().zip(change(-1e-4)).enumerate() {
        let found = (beyond - before) / 2e-4;
        assert!((found - linear.a_theta[(i, 0)]).abs() <= 1e-6 * size, "joint {i}");
    }
    let expected = Lagrangian::<f64>::new(&robot).forward_dynamics(&q, &v, &u).unwrap().to_vec();
    assert!(linear.acceleration.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs().max(1.0)));
}
