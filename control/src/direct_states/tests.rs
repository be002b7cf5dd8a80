use crate::direct_states::problem::{DirectDynamics, DirectDynamicsError};
use crate::{Bounds, DynamicsProblem, EndState, FinalTime, Objective, SolverOptions, StateMotion};
use costate::derivative::Function;
use costate::dynamics::Automatic;
use costate::lagrangian::LagrangianSecondOrder;
use costate::robot::Robot;
use costate::scalar::Scalar;
use std::f64::consts::FRAC_PI_2;

/// One of these models.
#[derive(Clone, Copy)]
enum Model {
    /// (position, rate), u = acceleration.
    Cart,
    /// Point mass on a rod of 1 m, u = torque.
    Pendulum,
    /// x' = -x + sin(u), which is not affine in u.
    Sine,
    /// (x, y), u = heading at speed 1.
    Boat,
    /// x' = sqrt(x) + u, which is not a number below 0.
    Root,
}

impl Function for Model {
    type Workspace<S: Scalar> = ();
    type Error = std::convert::Infallible;
    fn inputs(&self) -> usize {
        self.outputs() + 1
    }
    fn outputs(&self) -> usize {
        if matches!(self, Self::Sine | Self::Root) { 1 } else { 2 }
    }
    fn workspace<S: Scalar>(&self) {}
    fn evaluate<S: Scalar>(&self, _: &mut (), z: &[S], f: &mut [S]) -> Result<(), Self::Error> {
        match self {
            Self::Cart => (f[0], f[1]) = (z[1], z[2]),
            Self::Pendulum => (f[0], f[1]) = (z[1], z[2] - S::from_f64(9.81) * z[0].sin_cos().0),
            Self::Sine => f[0] = z[1].sin_cos().0 - z[0],
            Self::Root => f[0] = z[0].sqrt() + z[1],
            Self::Boat => (f[0], f[1]) = (z[2].sin_cos().1, z[2].sin_cos().0 + S::from_f64(0.6)),
        }
        Ok(())
    }
}

fn task(model: Model, problem: &DynamicsProblem) -> DirectDynamics<Automatic<Model>> {
    DirectDynamics::new(Automatic::<Model>::new(model), problem).unwrap()
}

fn ends(from: &[f64], to: &[f64], time: FinalTime) -> DynamicsProblem {
    DynamicsProblem::new(EndState::fixed(from), EndState::fixed(to), time, 1)
}

const FREE: f64 = f64::INFINITY;

fn solve(task: &mut DirectDynamics<Automatic<Model>>) -> StateMotion {
    let motion = task.solve(&SolverOptions::default());
    println!(
        "{:?} J {:.9} T {:.9} error {:.1e} end {:.1e} change {:.1e} steps {} on {} {:?} violation {:.1e}",
        motion.status,
        motion.cost,
        motion.final_time,
        motion.error,
        motion.end_error,
        motion.cost_change,
        motion.steps.len(),
        motion.intervals,
        motion.certificate,
        motion.largest_violation
    );
    motion
}

#[test]
fn a_cart_costs_six() {
    let motion = solve(&mut task(Model::Cart, &ends(&[0.0, 0.0], &[1.0, 0.0], FinalTime::Fixed(1.0))));
    assert!(motion.status.is_converged() && (motion.cost - 6.0).abs() < 1e-6);
    // u = 6 - 12 t, y = (12, u): H* = y'f - u^2/2 = 18 at t = 0.
    for ((t, u), y) in motion.t.iter().zip(&motion.u).zip(&motion.y) {
        let exact = 6.0 - 12.0 * t;
        assert!((u[0] - exact).abs() < 1e-6 && (y[1] - exact).abs() < 1e-4 && (y[0] - 12.0).abs() < 1e-4);
    }
    assert!(motion.hamiltonian.iter().all(|h| (h - 18.0).abs() < 1e-4), "{:?}", motion.hamiltonian);
}

/// u = a (1 - t/b), then 0, with 2 v / a = b: T = 1 over 1 m at |v| <= 1.2 by the necessary conditions of
/// Bryson and Ho, section 3.11: v rises as a parabola to its limit in b, 2 (2/3) v b + v (T - 2 b) = 1.
#[test]
fn a_limited_rate_costs_what_parabolas_say() {
    let mut task = task(Model::Cart, &ends(&[0.0, 0.0], &[1.0, 0.0], FinalTime::Fixed(1.0)))
        .with_state_limits(&[-FREE, -FREE], &[FREE, 1.2])
        .unwrap();
    let motion = solve(&mut task);
    let v = 1.2_f64;
    let b = 1.5 * (v - 1.0) / v;
    // Twice the integral of u^2/2, u = (2 v / b) (1 - t / b).
    let cost = (2.0 * v / b).powi(2) * b / 3.0;
    assert!((motion.cost / cost - 1.0).abs() < 1e-4, "{} {cost}", motion.cost);
    assert!(motion.status.is_converged() && motion.largest_violation < 1e-3);
}

#[test]
fn a_bounded_force_takes_the_least_time() {
    let problem = ends(&[0.0, 0.0], &[1.0, 0.0], FinalTime::Free { guess: 3.0 })
        .with_cost(Objective::new(1.0, vec![0.0]))
        .with_bounds(Bounds { u_min: vec![-1.0], u_max: vec![1.0] });
    let motion = solve(&mut task(Model::Cart, &problem));
    // Half the way at full force: T = 2 sqrt(1 m / (1 m/s^2)).
    assert!((motion.final_time - 2.0).abs() < 1e-5, "{}", motion.final_time);
}

#[test]
fn a_pendulum_keeps_its_angle() {
    for (limit, cost) in [(-0.7, 19.4870292), (-0.2, 27.844211)] {
        let problem = ends(&[0.0, 0.0], &[std::f64::consts::PI, 0.0], FinalTime::Fixed(3.0));
        let mut task =
            task(Model::Pendulum, &problem).with_state_limits(&[limit, -FREE], &[FREE; 2]).unwrap();
        let motion = solve(&mut task);
        assert!(motion.status.is_converged(), "{:?}", motion.status);
        assert!((motion.cost / cost - 1.0).abs() < 1e-6, "{} {cost}", motion.cost);
    }
}

#[test]
fn a_heading_need_not_be_affine() {
    let problem = ends(&[0.0, 0.0], &[1.0, 0.0], FinalTime::Free { guess: 1.0 })
        .with_cost(Objective::new(1.0, vec![1e-12]));
    let motion = solve(&mut task(Model::Boat, &problem));
    assert!(motion.status.is_converged() && (motion.final_time - 1.25).abs() < 1e-6);
}

#[test]
fn limits_are_refused_by_component() {
    let problem = ends(&[0.0, 0.0], &[1.0, 0.0], FinalTime::Fixed(1.0));
    let cart = || task(Model::Cart, &problem);
    let empty = cart().with_state_limits(&[-FREE, 1.0], &[FREE, 1.0]).unwrap_err();
    assert_eq!(empty, DirectDynamicsError::Empty { component: 1, low: 1.0, high: 1.0 });
    let nan = cart().with_state_limits(&[f64::NAN, 0.0], &[FREE, 1.0]).unwrap_err();
    assert!(matches!(nan, DirectDynamicsError::Empty { component: 0, .. }), "{nan}");
    let outside = cart().with_state_limits(&[-1.0, -1.0], &[0.5, 1.0]).unwrap_err();
    assert_eq!(outside.to_string(), "end.x[0] = 1 is outside of its limits [-1, 0.5]");
    let length = cart().with_state_limits(&[0.0], &[1.0, 1.0]).unwrap_err();
    assert_eq!(length.to_string(), "x_min has length 1, the model needs 2");
}

#[test]
fn an_impossible_end_is_told() {
    let problem = ends(&[0.0], &[2.0], FinalTime::Fixed(1.0));
    let motion = solve(&mut task(Model::Sine, &problem));
    // sin u <= 1: x stays below 1 - 1/e.
    assert!(!motion.status.is_converged());
    assert_eq!(motion.missed_component, Some(0));
    assert!(motion.end_missed > 1.3, "{}", motion.end_missed);
}

/// A free rate at the end: u = 3 (1 - t), J = 3/2. A free start as well: y_2 = u vanishes at both ends, so
/// nothing but a constant rate is left, which costs nothing.
#[test]
fn free_ends_have_no_costate() {
    let end = EndState::fixed(&[1.0, 0.0]).with_free(&[1]);
    let problem = |start| DynamicsProblem::new(start, end.clone(), FinalTime::Fixed(1.0), 1);
    let motion = solve(&mut task(Model::Cart, &problem(EndState::fixed(&[0.0, 0.0]))));
    assert!(motion.status.is_converged() && (motion.cost - 1.5).abs() < 1e-6);
    assert!(motion.y.last().unwrap()[1].abs() < 1e-4);
    let motion = solve(&mut task(Model::Cart, &problem(EndState::fixed(&[0.0, 0.0]).with_free(&[1]))));
    assert!(motion.status.is_converged() && motion.cost.abs() < 1e-9);
    assert!((motion.x[0][1] - 1.0).abs() < 1e-4, "{:?}", motion.x[0]);
}

/// A unit of time costs 6: d(6/T^3 + 6 T)/dT = 0 at T^4 = 3.
#[test]
fn a_free_time_is_the_best_one() {
    let problem = ends(&[0.0, 0.0], &[1.0, 0.0], FinalTime::Free { guess: 0.7 })
        .with_cost(Objective::new(6.0, vec![1.0]));
    let motion = solve(&mut task(Model::Cart, &problem));
    let time = 3.0_f64.powf(0.25);
    assert!(motion.status.is_converged() && (motion.final_time - time).abs() < 1e-5, "{}", motion.final_time);
    assert!((motion.cost - (6.0 / time.powi(3) + 6.0 * time)).abs() < 1e-7);
    assert!(motion.hamiltonian.iter().all(|h| (h - 6.0).abs() < 1e-3), "{:?}", motion.hamiltonian);
}

/// The robot of `tests/control`, here as any model in (q, v): 155.74483972 by two other methods.
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
    let motion = task.solve(&SolverOptions::default());
    assert!(motion.status.is_converged(), "{motion:?}");
    assert!((motion.cost / 155.74483972 - 1.0).abs() < 1e-6, "{}", motion.cost);
}

#[test]
fn a_model_that_cannot_be_evaluated_is_told() {
    let problem = ends(&[0.0], &[f64::MAX], FinalTime::Fixed(1.0));
    let motion = solve(&mut task(Model::Sine, &problem));
    assert!(!motion.status.is_converged() && motion.cost_change.is_infinite());
    let problem = ends(&[-1.0], &[2.0], FinalTime::Fixed(1.0));
    let motion = solve(&mut task(Model::Root, &problem));
    assert_eq!(motion.status.name(), "evaluation_failed", "{:?}", motion.status);
}
