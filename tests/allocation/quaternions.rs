//! Robots with quaternions as plain states.

use crate::robot;
use costate::configuration::{ConfigurationSpace, FreeKinematics};
use costate::dynamics::{Dynamics, QuaternionDynamics};
use costate::kinematics::ReferenceFrame;
use costate::step::{FreeStep, ImplicitMidpoint, StoermerVerlet};
use costate_test_support::allocations::allocations;

#[test]
fn quaternions_as_states_do_not_allocate() {
    let robot = robot("../tests/fixtures/free_tree.toml");
    let mut model = QuaternionDynamics::<f64>::new(&robot);
    let (size, n) = (model.states(), model.dof());
    let (x, u, y) = (vec![0.3; size], vec![0.1; n], vec![0.4; size]);
    let count = allocations(|| {
        model.evaluate(&x, &u).unwrap();
        model.linearise(&x, &u).unwrap();
        model.contract(&x, &u, &y).unwrap();
    });
    assert_eq!(count, 0);
}

#[test]
fn steps_of_free_joints_do_not_allocate() {
    let robot = robot("../tests/fixtures/free_tree.toml");
    let mut step = FreeStep::in_rates(&robot, ImplicitMidpoint::<f64, _>::new);
    let n = step.dof();
    let x = [&ConfigurationSpace::new(&robot).neutral()[..], &vec![0.1; n]].concat();
    let (u, y) = (vec![0.1; n], vec![0.4; 2 * n]);
    let mut canonical = FreeStep::in_momenta(&robot, StoermerVerlet::<f64, _>::new);
    let count = allocations(|| {
        step.evaluate(&x, &u, 0.01).unwrap();
        step.linearise(&x, &u, 0.01).unwrap();
        step.contract(&x, &u, 0.01, &y).unwrap();
        canonical.evaluate(&x, &u, 0.01).unwrap();
        canonical.linearise(&x, &u, 0.01).unwrap();
        canonical.contract(&x, &u, 0.01, &y).unwrap();
    });
    assert_eq!(count, 0);
}

#[test]
fn kinematics_in_the_tangent_space_does_not_allocate() {
    let robot = robot("../tests/fixtures/free_tree.toml");
    let mut kinematics = FreeKinematics::<f64>::new(&robot);
    let q = ConfigurationSpace::new(&robot).neutral();
    let (v, frame, axes) = (vec![0.3; robot.dof()], robot.frames().len() - 1, ReferenceFrame::Local);
    let count = allocations(|| {
        kinematics.set_motion(&q, &v, &v).unwrap();
        kinematics.acceleration(frame, axes).unwrap();
        kinematics.jacobian(frame, axes).unwrap();
        kinematics.jacobian_rate(frame, axes).unwrap();
        kinematics.position_hessian(frame, &[1.0, 2.0, 3.0]).unwrap();
        kinematics.centre_of_mass().unwrap();
        kinematics.momentum().unwrap();
    });
    assert_eq!(count, 0);
}
