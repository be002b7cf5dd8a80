//! How a solve ends where it does not converge, and guesses.

use super::{Model, cart, costs, ends, solve, task, told};
use costate_control::{FinalTime, Objective, SolverOptions, Status};
use std::time::Duration;

#[test]
fn an_impossible_end_is_told() {
    let problem = ends(&[0.0], &[2.0], FinalTime::Fixed(1.0));
    let motion = solve(&mut task(Model::Sine, &problem));
    // sin u <= 1: x stays below 1 - 1/e.
    assert!(!motion.status.is_converged());
    assert_eq!(motion.missed_component, Some(0));
    assert!(motion.end_missed > 1.3, "{}", motion.end_missed);
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

/// The best motion of x' = sqrt(x) + u is a parabola, x = c + (t - 1/2)^2/4, and J = c/2 + 1/48. Newton's
/// steps lead below zero, where f is not a number.
#[test]
fn steps_to_where_f_is_undefined_are_refused() {
    let c = 0.004;
    let end = [c + 1.0 / 16.0];
    let motion = solve(&mut task(Model::Root, &ends(&end, &end, FinalTime::Fixed(1.0))));
    costs(&motion, 0.5 * c + 1.0 / 48.0);
    assert!(motion.steps.iter().any(|step| step.length < 1.0), "no step was refused");
}

/// Rounding grows by exp(60 t): neither the whole motion nor twentieths of it can be integrated again.
#[test]
fn an_unstable_motion_is_not_verified() {
    let motion = solve(&mut task(Model::Linear(60.0), &ends(&[1.0], &[0.0], FinalTime::Fixed(16.0))));
    assert_eq!(motion.status, Status::NotVerified);
    assert!(motion.end_error > 3e-4 && (motion.cost / 60.0 - 1.0).abs() < 1e-5);
}

/// Not the whole motion, which grows by exp(40), but its parts.
#[test]
fn an_unstable_motion_is_verified_by_parts() {
    let motion = solve(&mut task(Model::Linear(4.0), &ends(&[1.0], &[1.0], FinalTime::Fixed(10.0))));
    // Down and up again, each alone: x = exp(-4 t) by u = -8 x costs 4, and rising by itself nothing.
    costs(&motion, 4.0);
}

#[test]
fn few_nodes_and_little_time_are_kept() {
    let problem = cart(FinalTime::Fixed(1.0));
    let mut options = SolverOptions::default();
    (options.nodes, options.max_nodes) = (3, 5);
    let motion = told(task(Model::Pendulum, &problem).solve(&options).unwrap());
    assert_eq!((motion.status, motion.intervals), (Status::MeshLimit, 4));
    assert!(motion.cost_change.is_infinite() && motion.end_missed < 1e-6);
    let mut options = SolverOptions::default();
    options.time_limit = Some(Duration::from_nanos(1));
    let motion = told(task(Model::Pendulum, &problem).solve(&options).unwrap());
    assert_eq!((motion.status, motion.steps.len()), (Status::TimeLimit, 0));
    assert!(motion.end_error.is_infinite() && motion.t.len() == motion.x.len());
    options.time_limit = Some(Duration::MAX);
    options.max_iterations = usize::MAX;
    assert!(task(Model::Cart, &problem).solve(&options).unwrap().status.is_converged());
}

/// d(6/T^3 + c T)/dT = 0 at T^4 = 18/c: a millisecond for c = 18e12, from a guess of half of it.
#[test]
fn a_short_guess_of_time_stays() {
    let problem = cart(FinalTime::Free { guess: 5e-4 }).with_cost(Objective::new(18e12, vec![1.0]));
    let motion = solve(&mut task(Model::Cart, &problem));
    costs(&motion, 24e9);
    assert!((motion.final_time / 1e-3 - 1.0).abs() < 1e-3);
}

/// A motion is its own best guess; samples agree with u = 6 - 12 t.
#[test]
fn a_solved_motion_is_a_guess_for_the_next() {
    let problem = ends(&[0.0, 0.0], &[std::f64::consts::PI, 0.0], FinalTime::Fixed(3.0));
    let first = solve(&mut task(Model::Pendulum, &problem));
    let again = task(Model::Pendulum, &problem).with_guess(&first.t, &first.x, &first.u);
    let again = solve(&mut again.unwrap());
    costs(&again, first.cost);
    let on_first_mesh = |steps: &[costate_control::StateStep]| {
        steps.iter().filter(|step| step.intervals == steps[0].intervals).count()
    };
    assert!(on_first_mesh(&again.steps) < on_first_mesh(&first.steps));
    let motion = solve(&mut task(Model::Cart, &cart(FinalTime::Fixed(1.0))));
    for i in 0..=50 {
        let t = 0.02 * f64::from(i);
        let (x, u) = motion.sample_at(t);
        let exact = [3.0 * t * t - 2.0 * t.powi(3), 6.0 * t * (1.0 - t), 6.0 - 12.0 * t];
        let off = x.iter().chain(&u).zip(exact).map(|(found, exact)| (found - exact).abs());
        assert!(off.fold(0.0, f64::max) < 1e-6, "{t} {x:?} {u:?}");
    }
    // Cut to [0, T].
    assert_eq!(motion.sample_at(-1.0), motion.sample_at(0.0));
    assert_eq!(motion.sample_at(2.0), motion.sample_at(1.0));
}
