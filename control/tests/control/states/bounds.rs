//! Bounds on controls: closed forms.

use super::{FREE, Model, cart, costs, ends, solve, task};
use costate_control::{Bounds, DynamicsProblem, EndState, FinalTime, Objective, StateMotion};

fn least_time(problem: DynamicsProblem, weight: f64, u_min: f64, u_max: f64) -> DynamicsProblem {
    let controls = problem.cost.effort.len();
    problem
        .with_cost(Objective::new(weight, vec![0.0; controls]))
        .with_bounds(Bounds::new(vec![u_min; controls], vec![u_max; controls]))
}

fn carts(count: usize, time: FinalTime) -> DynamicsProblem {
    let at = |position: f64| [vec![position; count], vec![0.0; count]].concat();
    DynamicsProblem::new(EndState::fixed(&at(0.0)), EndState::fixed(&at(1.0)), time, count)
}

/// Half the way at full force: T = 2 sqrt(1 m / (1 m/s^2)).
#[test]
fn a_bounded_force_takes_the_least_time() {
    let motion =
        solve(&mut task(Model::Cart, &least_time(cart(FinalTime::Free { guess: 3.0 }), 1.0, -1.0, 1.0)));
    costs(&motion, 2.0);
    assert!((motion.final_time - 2.0).abs() < 2e-6, "{}", motion.final_time);
}

/// Every active limit adds its barrier to the cost, whatever the unit of the cost is.
#[test]
fn equal_carts_take_as_long_as_one() {
    for weight in [1.0, 0.1] {
        let problem = least_time(carts(6, FinalTime::Free { guess: 3.0 }), weight, -1.0, 1.0);
        costs(&solve(&mut task(Model::Carts(6), &problem)), 2.0 * weight);
    }
}

/// u = 2 for a third of the time, then -1, off the nodes: v = 2 T/3 at most, and half of that times T is 1 m.
#[test]
fn a_force_may_switch_between_nodes() {
    let problem = least_time(cart(FinalTime::Free { guess: 3.0 }), 1.0, -1.0, 2.0);
    costs(&solve(&mut task(Model::Cart, &problem)), 3.0_f64.sqrt());
}

/// v' = u - c v, u = 1 for t_1, then -1 for t_2: c L = t_1 - t_2, and with y = exp(c t_2) the end at rest is
/// y = 2 - exp(-c^2 L) / y.
#[test]
fn a_dragged_cart_keeps_what_its_estimates_promise() {
    let problem = least_time(cart(FinalTime::Free { guess: 3.0 }), 1.0, -1.0, 1.0);
    let motion = solve(&mut task(Model::Drag, &problem));
    let c = 0.7_f64;
    let y = 1.0 + (1.0 - (-c * c).exp()).sqrt();
    costs(&motion, 2.0 * y.ln() / c + c);
}

/// Least effort over a distance 1 in a time 1 with |u| <= b: u = b until s, falls linearly to -b at 1 - s,
/// with s^2 - s + 3/b = 1/2 and J = b^2 s + b^2 (1 - 2 s)/6.
#[test]
fn two_forces_keep_bounds_of_their_own() {
    let bounds = [5.0, 4.5];
    let problem = carts(2, FinalTime::Fixed(1.0))
        .with_bounds(Bounds::new(bounds.map(|b| -b).to_vec(), bounds.to_vec()));
    let motion = solve(&mut task(Model::Carts(2), &problem));
    let cost = bounds.map(|b: f64| {
        let s = 0.5 - (0.25 - (3.0 / b - 0.5)).sqrt();
        b * b * (s + (1.0 - 2.0 * s) / 6.0)
    });
    costs(&motion, cost.iter().sum());
    let reaches = |i: usize| motion.u.iter().map(|u| u[i].abs()).fold(0.0, f64::max);
    assert!((0..2).all(|i| reaches(i) <= bounds[i] && reaches(i) > 0.999 * bounds[i]));
}

/// u falls linearly to 0 in b, rests at v = 1.2, and mirrors; (4/3) v b + v (1 - 2 b) = 1.
#[test]
fn a_limited_rate_costs_what_parabolas_say() {
    let mut task = task(Model::Cart, &cart(FinalTime::Fixed(1.0)))
        .with_state_limits(&[-FREE, -FREE], &[FREE, 1.2])
        .unwrap();
    let motion = solve(&mut task);
    let v = 1.2_f64;
    let b = 1.5 * (v - 1.0) / v;
    // Twice the integral of u^2/2, u = (2 v / b) (1 - t / b).
    costs(&motion, (2.0 * v / b).powi(2) * b / 3.0);
}

fn swing(effort: f64) -> StateMotion {
    let problem = ends(&[0.0, 0.0], &[std::f64::consts::PI, 0.0], FinalTime::Fixed(3.0))
        .with_cost(Objective::new(0.0, vec![effort]))
        .with_bounds(Bounds::new(vec![-6.0], vec![6.0]));
    solve(&mut task(Model::Pendulum, &problem))
}

/// The unit of the cost changes nothing.
#[test]
fn a_unit_of_cost_does_not_matter() {
    let one = swing(1.0);
    for effort in [1e-6, 1e6] {
        let motion = swing(effort);
        costs(&motion, effort * one.cost);
        assert_eq!(motion.steps.len(), one.steps.len());
    }
}
