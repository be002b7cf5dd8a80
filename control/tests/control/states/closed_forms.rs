//! Motions known in closed form, or by another program.

use super::{FREE, Model, cart, costs, ends, solve, task};
use costate::lagrangian::LagrangianSecondOrder;
use costate::robot::Robot;
use costate_control::{DirectDynamics, DynamicsProblem, EndState, FinalTime, Objective, SolverOptions};
use std::f64::consts::FRAC_PI_2;

#[test]
fn a_cart_costs_six() {
    let motion = solve(&mut task(Model::Cart, &cart(FinalTime::Fixed(1.0))));
    costs(&motion, 6.0);
    // u = 6 - 12 t, y = (12, u): H* = y'f - u^2/2 = 18 at t = 0.
    for ((t, u), y) in motion.t.iter().zip(&motion.u).zip(&motion.y) {
        let exact = 6.0 - 12.0 * t;
        assert!((u[0] - exact).abs() < 1e-6 && (y[1] - exact).abs() < 1e-4 && (y[0] - 12.0).abs() < 1e-4);
    }
    assert!(motion.hamiltonian.iter().all(|h| (h - 18.0).abs() < 1e-4), "{:?}", motion.hamiltonian);
}

/// Costs by an interior point on the extremals and by collocation on a mesh graded by hand, as listed in
/// `benches/ocp/harness/values.py`.
#[test]
fn a_pendulum_keeps_its_angle() {
    for (limit, cost) in [(-0.7, 19.4870292), (-0.2, 27.844211)] {
        let problem = ends(&[0.0, 0.0], &[std::f64::consts::PI, 0.0], FinalTime::Fixed(3.0));
        let mut task =
            task(Model::Pendulum, &problem).with_state_limits(&[limit, -FREE], &[FREE; 2]).unwrap();
        let motion = solve(&mut task);
        costs(&motion, cost);
    }
}

#[test]
fn a_heading_need_not_be_affine() {
    let problem = cart(FinalTime::Free { guess: 1.0 }).with_cost(Objective::new(1.0, vec![1e-12]));
    let motion = solve(&mut task(Model::Boat, &problem));
    assert!(motion.status.is_converged() && (motion.final_time - 1.25).abs() < 1e-6);
}

/// A free rate at the end: u = 3 (1 - t), J = 3/2. A free start as well: y_2 = u vanishes at both ends, so
/// nothing but a constant rate is left, which costs nothing.
#[test]
fn free_ends_have_no_costate() {
    let end = EndState::fixed(&[1.0, 0.0]).with_free(&[1]);
    let problem = |start| DynamicsProblem::new(start, end.clone(), FinalTime::Fixed(1.0), 1);
    let motion = solve(&mut task(Model::Cart, &problem(EndState::fixed(&[0.0, 0.0]))));
    costs(&motion, 1.5);
    assert!(motion.y.last().unwrap()[1].abs() < 1e-4);
    let motion = solve(&mut task(Model::Cart, &problem(EndState::fixed(&[0.0, 0.0]).with_free(&[1]))));
    assert!(motion.status.is_converged() && motion.cost.abs() < 1e-9);
    assert!((motion.x[0][1] - 1.0).abs() < 1e-4, "{:?}", motion.x[0]);
}

/// A unit of time costs 6: d(6/T^3 + 6 T)/dT = 0 at T^4 = 3.
#[test]
fn a_free_time_is_the_best_one() {
    let problem = cart(FinalTime::Free { guess: 0.7 }).with_cost(Objective::new(6.0, vec![1.0]));
    let motion = solve(&mut task(Model::Cart, &problem));
    let time = 3.0_f64.powf(0.25);
    assert!(motion.status.is_converged() && (motion.final_time - time).abs() < 1e-5, "{}", motion.final_time);
    assert!((motion.cost - (6.0 / time.powi(3) + 6.0 * time)).abs() < 1e-7);
    assert!(motion.hamiltonian.iter().all(|h| (h - 6.0).abs() < 1e-3), "{:?}", motion.hamiltonian);
}

/// The robot of `tests/control`, here as any model in (q, v). Collocation with CasADi and IPOPT has its cost
/// 155.74483972 to 8e-8: `bash benches/ocp/run --values values`.
#[test]
fn a_robot_is_a_model_too() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let (start, end) = (EndState::fixed(&[0.0; 4]), EndState::fixed(&[FRAC_PI_2, FRAC_PI_2, 0.0, 0.0]));
    let problem = DynamicsProblem::new(start, end, FinalTime::Fixed(1.0), 2);
    let none = [FREE; 4];
    let mut task = DirectDynamics::new(LagrangianSecondOrder::<f64>::new(&robot), &problem)
        .unwrap()
        .with_state_limits(&[-FREE, -FREE, -FREE, -7.0], &[none[0], none[1], none[2], 7.0])
        .unwrap();
    let motion = task.solve(&SolverOptions::default().with_tolerance(1e-6)).unwrap();
    costs(&motion, 155.74483972);
}
