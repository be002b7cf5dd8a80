//! Models that are not robots, and robots as models.

mod models;

use crate::sharp;
use costate::dynamics::{AutomaticCost, Dynamics};
use costate::robot::Robot;
use costate::{EvalError, hamiltonian, lagrangian};
use costate_control::{
    BoundaryValueProblem, Bounds, ControlLaw, DynamicsExtremal, DynamicsProblem, DynamicsProblemError,
    EndState, ExtremalSolution, FinalTime, JacobianRoute, LagrangianExtremal, Method, Objective, Problem,
    RobotExtremal, solve_dynamics,
};
use models::{Cart, Quadrotor, Square, Tilt, Unicycle};

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * expected.abs().max(1.0), "{found} {expected}");
}

fn close_all(found: &[f64], expected: &[f64], tolerance: f64) {
    let scale = expected.iter().fold(1.0_f64, |most, entry| most.max(entry.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= tolerance * scale, "{found} {expected}");
    }
}

fn draw(count: usize, seed: u64) -> Vec<f64> {
    let mut random = fastrand::Rng::with_seed(seed);
    (0..count).map(|_| 2.0 * random.f64() - 1.0).collect()
}

/// g is the canonical gradient of H*, and the Jacobian is that of g: both against central differences.
fn check_derivatives<E: BoundaryValueProblem>(extremal: &mut E, seed: u64) {
    let m = 2 * extremal.states();
    let z = draw(m, seed);
    let (mut g, mut again, mut jacobian) = (vec![0.0; m], vec![0.0; m], vec![0.0; m * m]);
    let terms = extremal.linearise(&z, ControlLaw::Maximal, &mut g, &mut jacobian).unwrap();
    assert_eq!(extremal.evaluate(&z, ControlLaw::Maximal, &mut again).unwrap(), terms);
    close_all(&g, &again, 1e-13);
    let h = 1e-5;
    let (mut gradient, mut differences) = (vec![0.0; m], vec![0.0; m * m]);
    for j in 0..m {
        let mut at = |sign: f64| {
            let (mut beside, mut g) = (z.clone(), vec![0.0; m]);
            beside[j] += sign * h;
            let terms = extremal.evaluate(&beside, ControlLaw::Maximal, &mut g).unwrap();
            (terms.hamiltonian, g)
        };
        let ((h_after, after), (h_before, before)) = (at(1.0), at(-1.0));
        let (row, sign) = if j < m / 2 { (m / 2 + j, -1.0) } else { (j - m / 2, 1.0) };
        gradient[row] = sign * (h_after - h_before) / (2.0 * h);
        for i in 0..m {
            differences[i * m + j] = (after[i] - before[i]) / (2.0 * h);
        }
    }
    close_all(&g, &gradient, 1e-8);
    close_all(&jacobian, &differences, 1e-7);
}

#[test]
fn derivatives_of_any_model_are_exact() {
    let quadrotor = |effort: f64| {
        let ends = EndState::fixed(&[0.0; 6]);
        let problem = DynamicsProblem::new(ends.clone(), ends, FinalTime::Fixed(1.0), 2);
        problem.with_cost(Objective::new(0.5, vec![effort, 2.0 * effort]))
    };
    let bounds = Bounds::new(vec![-0.1, -50.0], vec![0.1, 50.0]);
    for seed in 0..5 {
        let mut extremal = DynamicsExtremal::new(Quadrotor::automatic(), &quadrotor(0.7)).unwrap();
        check_derivatives(&mut extremal, seed);
        let tilt = AutomaticCost::<Tilt>::terminal(Tilt);
        let problem = quadrotor(0.7).with_bounds(bounds.clone());
        let model = Quadrotor::automatic();
        check_derivatives(&mut DynamicsExtremal::with_running_cost(model, tilt, &problem).unwrap(), seed);
        let ends = EndState::fixed(&[0.0; 3]);
        let problem = DynamicsProblem::new(ends.clone(), ends, FinalTime::Fixed(1.0), 2);
        check_derivatives(&mut DynamicsExtremal::new(Unicycle::automatic(), &problem).unwrap(), seed);
    }
}

/// The general extremal of a model and the special one of its robot, at random states.
fn compare<D: Dynamics<f64>>(model: D, robot: &mut impl BoundaryValueProblem, problem: &DynamicsProblem) {
    let mut general = DynamicsExtremal::new(model, problem).unwrap();
    let m = 2 * robot.states();
    for seed in 0..5 {
        let z = draw(m, seed);
        let evaluated = |extremal: &mut dyn BoundaryValueProblem| {
            let (mut g, mut jacobian) = (vec![0.0; m], vec![0.0; m * m]);
            let terms = extremal.linearise(&z, ControlLaw::Maximal, &mut g, &mut jacobian).unwrap();
            (terms.hamiltonian, g, jacobian)
        };
        let (expected, found) = (evaluated(robot), evaluated(&mut general));
        close(found.0, expected.0, 1e-12);
        close_all(&found.1, &expected.1, 1e-12);
        close_all(&found.2, &expected.2, 1e-12);
    }
}

#[test]
fn a_robot_as_a_model_has_the_extremals_of_the_robot() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let bounds = Bounds::new(vec![-0.4; 2], vec![0.5; 2]);
    let cost = Objective::new(0.3, vec![0.2, 0.9]);
    let problem = Problem::rest_to_rest(robot.clone(), &[0.0; 2], &[1.0; 2], 1.0);
    let problem = problem.with_cost(cost.clone()).with_bounds(bounds.clone());
    let ends = EndState::fixed(&[0.0; 4]);
    let general = DynamicsProblem::new(ends.clone(), ends, FinalTime::Fixed(1.0), 2);
    let general = general.with_cost(cost).with_bounds(bounds);
    let checked = problem.check().unwrap();
    let mut special = RobotExtremal::new(checked, JacobianRoute::Exact).unwrap();
    compare(hamiltonian::HamiltonianSecondOrder::<f64>::new(&robot), &mut special, &general);
    // Here f_u = M^-1 depends on the state.
    let mut special = LagrangianExtremal::new(checked, JacobianRoute::Exact).unwrap();
    compare(lagrangian::LagrangianSecondOrder::<f64>::new(&robot), &mut special, &general);
}

/// By collocation and by multiple shooting; the two agree.
fn solve<D: Dynamics<f64>>(model: D, problem: &DynamicsProblem) -> ExtremalSolution {
    let mut extremal = DynamicsExtremal::new(model, problem).unwrap();
    let motion = solve_dynamics(&mut extremal, &sharp());
    assert!(motion.motion.status.is_converged(), "{}", motion.motion.status);
    let options = sharp().with_method(Method::Shooting);
    let shot = solve_dynamics(&mut extremal, &options);
    assert!(shot.motion.status.is_converged(), "{}", shot.motion.status);
    close(motion.motion.cost, shot.motion.cost, 1e-8);
    close(motion.motion.final_time, shot.motion.final_time, 1e-8);
    assert!(motion.motion.shooting_defect < 1e-7);
    motion
}

#[test]
fn a_cart_has_its_closed_forms() {
    let ends = |to: f64| (EndState::fixed(&[0.0, 0.0]), EndState::fixed(&[to, 0.0]));
    let (start, end) = ends(1.0);
    // J = c T + 6 / T^3.
    let free = DynamicsProblem::new(start.clone(), end.clone(), FinalTime::Free { guess: 1.7 }, 1);
    let motion = solve(Cart::automatic(), &free.with_cost(Objective::new(18.0, vec![1.0])));
    close(motion.motion.final_time, 1.0, 1e-9);
    close(motion.motion.cost, 24.0, 1e-9);
    // A free rate at the end: J = 3 / (2 T^3).
    let fixed = DynamicsProblem::new(start.clone(), end.clone().with_free(&[1]), FinalTime::Fixed(2.0), 1);
    close(solve(Cart::automatic(), &fixed).motion.cost, 3.0 / 16.0, 1e-10);
    // Least time with |u| <= 1.
    let least = DynamicsProblem::new(start, end, FinalTime::Free { guess: 3.0 }, 1)
        .with_cost(Objective::new(1.0, vec![0.0]))
        .with_bounds(Bounds::symmetric(vec![1.0]));
    let mut extremal = DynamicsExtremal::new(Cart::automatic(), &least).unwrap();
    let motion = solve_dynamics(&mut extremal, &sharp());
    assert!(motion.motion.status.is_converged(), "{}", motion.motion.status);
    close(motion.motion.final_time, 2.0, 1e-8);
    assert_eq!(motion.motion.switches.len(), 1);
    close(motion.motion.switches[0], 1.0, 1e-8);
}

#[test]
fn a_car_is_parked() {
    let to = |x: f64, y: f64, heading: f64, time: f64| {
        let (start, end) = (EndState::fixed(&[0.0; 3]), EndState::fixed(&[x, y, heading]));
        DynamicsProblem::new(start, end, FinalTime::Fixed(time), 2)
    };
    // Straight ahead, and turning on the spot.
    close(solve(Unicycle::automatic(), &to(2.0, 0.0, 0.0, 1.0)).motion.cost, 2.0, 1e-9);
    close(solve(Unicycle::automatic(), &to(0.0, 0.0, 1.0, 2.0)).motion.cost, 0.25, 1e-9);
    // Without drift J T is constant and H* = J / T.
    let motion = solve(Unicycle::automatic(), &to(1.0, 0.5, 0.8, 1.0));
    close(motion.motion.hamiltonian, motion.motion.cost, 1e-8);
    close(solve(Unicycle::automatic(), &to(1.0, 0.5, 0.8, 2.0)).motion.cost, motion.motion.cost / 2.0, 1e-8);
    // With a free heading its costate ends at zero, and the motion is cheaper.
    let mut free = to(1.0, 0.5, 0.8, 1.0);
    free.end = free.end.with_free(&[2]);
    let free = solve(Unicycle::automatic(), &free);
    assert!(free.motion.cost < motion.motion.cost && free.nodes.z.last().unwrap()[5].abs() < 1e-9);
}

#[test]
fn a_quadrotor_flies_sideways() {
    let (start, end) = (EndState::fixed(&[0.0; 6]), EndState::fixed(&[1.0, 0.3, 0.0, 0.0, 0.0, 0.0]));
    let problem = DynamicsProblem::new(start, end, FinalTime::Fixed(1.5), 2);
    let motion = solve(Quadrotor::automatic(), &problem);
    close_all(&motion.motion.end_state.unwrap(), &problem.end.x, 1e-8);
    assert!(motion.motion.hamiltonian_drift < 1e-7, "{}", motion.motion.hamiltonian_drift);
    // dJ/dT = -H*.
    let at = |h: f64| {
        let mut problem = problem.clone();
        problem.time = FinalTime::Fixed(1.5 + h);
        solve(Quadrotor::automatic(), &problem).motion.cost
    };
    close((at(1e-3) - at(-1e-3)) / 2e-3, -motion.motion.hamiltonian, 1e-4);
    // A bound on one thrust makes it dearer.
    let most = motion.nodes.u.iter().map(|u| u[0]).fold(0.0, f64::max);
    let bounds = Bounds::new(vec![-10.0; 2], vec![0.8 * most, 10.0]);
    let mut bounded =
        DynamicsExtremal::new(Quadrotor::automatic(), &problem.clone().with_bounds(bounds)).unwrap();
    let bounded = solve_dynamics(&mut bounded, &sharp());
    assert!(bounded.motion.status.is_converged(), "{}", bounded.motion.status);
    assert!(bounded.motion.cost > motion.motion.cost && !bounded.motion.switches.is_empty());
    assert!(bounded.nodes.u.iter().all(|u| u[0] <= 0.8 * most + 1e-9));
}

#[test]
fn unfit_problems_are_refused() {
    let ends = EndState::fixed(&[0.0]);
    let problem = DynamicsProblem::new(ends.clone(), ends, FinalTime::Fixed(1.0), 1);
    let refused =
        |problem: &DynamicsProblem| DynamicsExtremal::new(Square::automatic(), problem).err().unwrap();
    assert_eq!(refused(&problem), DynamicsProblemError::NotAffine);
    let free = problem.clone().with_cost(Objective::new(1.0, vec![0.0]));
    assert_eq!(refused(&free), DynamicsProblemError::UnboundedEffort { control: 0 });
    let short = problem.clone().with_cost(Objective::new(1.0, vec![]));
    assert!(matches!(refused(&short), DynamicsProblemError::WrongLength { field: "cost.effort", .. }));
    let mut endless = problem.clone();
    endless.time = FinalTime::Fixed(f64::NAN);
    assert!(matches!(refused(&endless), DynamicsProblemError::OutOfRange { field: "time", .. }));
    let cost = AutomaticCost::<Tilt>::running(Tilt, 1);
    let refused = DynamicsExtremal::with_running_cost(Cart::automatic(), cost, &problem).err().unwrap();
    assert_eq!(refused, DynamicsProblemError::CostOfControls);
    // An error of a robot stays itself.
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let ends = EndState::fixed(&[0.0; 4]);
    let problem = DynamicsProblem::new(ends.clone(), ends, FinalTime::Fixed(1.0), 2);
    let mut extremal =
        DynamicsExtremal::new(hamiltonian::HamiltonianSecondOrder::<f64>::new(&robot), &problem).unwrap();
    let error = extremal.evaluate(&[f64::NAN; 8], ControlLaw::Maximal, &mut [0.0; 8]).unwrap_err();
    assert!(matches!(error, EvalError::NonFinite { .. }), "{error}");
}
