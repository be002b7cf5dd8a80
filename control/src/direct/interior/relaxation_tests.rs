//! The elastic phase: its distances, and its bordered equations.

use super::super::elastic::Given;
use super::super::iterate::Interior;
use super::super::iterate::tests::started;
use super::price;
use crate::constants::direct as constants;
use crate::constants::elastic;
use crate::direct::motion::shape::Shape;
use crate::direct::points::generic_points::RobotPoints;
use crate::direct::points::phases::PhaseDynamics;
use crate::direct::points::values::PointDynamics;
use crate::direct::solve::prepare::interior;
use crate::options::SolverOptions;
use crate::problem::{MotionLimits, Problem};
use crate::task::build::TaskRows;
use costate::robot::Robot;

#[test]
fn the_price_is_smooth() {
    let delta = elastic::ROUNDED_PRICE;
    for e in [-1e3, -2.0, -delta, -0.1 * delta, 0.0, 0.3 * delta, 0.5, 1e4] {
        let [value, first, second] = price(e);
        assert!(value > 0.0 && first > 0.0 && first < 1.0 + 1e-12 && second >= 0.0);
        let step = 1e-4 * delta.max(1e-2 * e.abs());
        let slope = (price(e + step)[0] - price(e - step)[0]) / (2.0 * step);
        assert!((slope - first).abs() < 1e-6, "{e}: {slope} {first}");
        let curvature = (price(e + step)[1] - price(e - step)[1]) / (2.0 * step);
        assert!((curvature - second).abs() < 1e-5 * price(0.0)[2], "{e}: {curvature} {second}");
    }
    assert!((price(1.0)[0] - 1.0).abs() < delta && price(-1.0)[0] < delta);
}

/// A motion that exceeds limits and an equation, in the elastic phase.
fn relaxed(shape: Shape) -> Interior<PhaseDynamics<RobotPoints>> {
    let mut interior = started(shape);
    assert!(interior.figures.violation > 0.1);
    interior.relax(None).unwrap();
    interior
}

#[test]
fn limits_give_as_far_as_the_motion_exceeds_them() {
    [Shape::Quartic, Shape::Quintic].into_iter().for_each(give_as_far_as_the_motion_exceeds_them);
}

fn give_as_far_as_the_motion_exceeds_them(shape: Shape) {
    let interior = relaxed(shape);
    let barrier = &interior.barrier;
    assert!(barrier.all_sides().all(|side| !side.is_equation));
    assert_eq!(barrier.rate_sides().is_empty(), !shape.is_smooth());
    for at in (0..barrier.count()).filter(|&at| barrier.is_limit(at)) {
        // Each with room, and the slack is where the motion is.
        let room = elastic::COLD.0 * barrier.side(at).range * (1.0 - 1e-9);
        assert!(barrier.distance[at] >= room && barrier.slack[at] == barrier.distance[at], "{at}");
    }
    assert!(interior.violation_without_relief() > 0.1);
    // A limit is relaxed by its largest violation and the room.
    let given = interior.given();
    let most = given.iter().map(|given| given.part).fold(0.0, f64::max);
    let halves = barrier.all_sides().filter(|side| side.is_half).count();
    assert!(halves == 2 && most > 0.1, "{halves} {given:?}");
    // Parts are those of the ranges outside of the elastic phase, which are narrower here.
    let own = started(shape).barrier.with_halves();
    let widened = |given: &&Given| barrier.numbered(given.side).range > 1.01 * own.numbered(given.side).range;
    assert!(given.iter().any(|given| widened(&given)));
    for Given { side, amount, part, .. } in given {
        let expected = amount / own.numbered(side).range;
        assert!((part - expected).abs() <= 1e-12 * expected.abs(), "{part} {expected}");
    }
}

#[test]
fn equations_become_no_stiffer_than_elsewhere() {
    let mut interior = relaxed(Shape::Quartic);
    // Limits that do not give cost next to nothing, however dear that is.
    interior.relaxation.give.fill(-1e3);
    for _ in 0..6 {
        interior.raise_price(elastic::DEARER);
        let most = constants::MOST_STIFFNESS * interior.figures.size;
        assert!(interior.barrier.stiffness <= most * (1.0 + 1e-12), "{}", interior.barrier.stiffness / most);
    }
}

#[test]
fn an_iterate_is_found_again() {
    [Shape::Quartic, Shape::Quintic].into_iter().for_each(is_found_again);
}

fn is_found_again(shape: Shape) {
    let mut interior = relaxed(shape);
    let (kept, figures) = (interior.keep(), interior.figures);
    let (distance, given) = (interior.barrier.distance.clone(), interior.given());
    interior.raise_price(elastic::DEARER);
    interior.iterate(1e-9, 2, |_, _| None).unwrap();
    assert!(interior.figures.cost != figures.cost);
    interior.come_back(kept).unwrap();
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * (1.0 + b.abs());
    assert!(close(interior.figures.cost, figures.cost) && close(interior.figures.gap, figures.gap));
    assert!(interior.barrier.distance.iter().zip(&distance).all(|(a, b)| close(*a, *b)));
    assert!(interior.given().iter().zip(&given).all(|(a, b)| close(a.part, b.part) && a.at == b.at));
}

#[test]
fn steps_solve_the_bordered_equations() {
    [Shape::Quartic, Shape::Quintic].into_iter().for_each(steps_solve_bordered_equations);
}

fn steps_solve_bordered_equations(shape: Shape) {
    steps_solve_the_equations_of(relaxed(shape));
}

/// A pole without a motor: that it has no torque stays an equation, which no limit gives.
#[test]
fn laws_of_physics_are_not_relaxed() {
    let robot = Robot::from_file("../robots/cart_pole.toml").unwrap();
    let limits = MotionLimits::none().with_torque_max(vec![0.5, 0.0]).with_v_max(vec![0.3, 1.0]);
    let problem = Problem::rest_to_rest(robot, &[0.0, 3.0], &[1.0, 0.0], 1.5).with_limits(limits);
    let rows = TaskRows::new(&problem).unwrap();
    let mut interior = interior(&problem, &rows, &SolverOptions::default(), 0, None);
    interior.start(None).unwrap();
    interior.relax(None).unwrap();
    let (barrier, relaxation) = (&interior.barrier, &interior.relaxation);
    let laws: Vec<usize> =
        (0..barrier.all_sides().count()).filter(|&i| barrier.numbered(i).is_law()).collect();
    assert_eq!(laws.len(), 1);
    assert!(barrier.numbered(laws[0]).joint == 1 && relaxation.limits[laws[0]].is_none());
    assert!(relaxation.relief(laws[0]) == 0.0 && barrier.equations().count() == barrier.points());
    let given = interior.given();
    assert!(given.len() == 3 && given.iter().all(|given| given.side != laws[0]), "{given:?}");
    // The pole would fall: what its torque is off by is seen.
    assert!(interior.violation_without_relief() > 0.1);
    steps_solve_the_equations_of(interior);
}

fn steps_solve_the_equations_of<D: PointDynamics>(mut interior: Interior<D>) {
    interior.refresh().unwrap();
    let Interior { system, relaxation, spline, points, barrier, running, ends, .. } = &mut interior;
    system.assemble(spline, points, barrier, running, ends);
    relaxation.assemble(spline, points, barrier, ends);
    assert!((0..9).any(|k| interior.factorise(10.0_f64.powi(k))));
    interior.solve();
    // The row of each e: its price and the multipliers of its limit balance after the step, with the changes
    // of distances that the step makes.
    let mu = 0.4 * interior.mu;
    interior.steps_of(mu);
    let (barrier, relaxation) = (&interior.barrier, &interior.relaxation);
    let count = relaxation.give.len();
    let mut sums = vec![0.0; count];
    for at in (0..barrier.count()).filter(|&at| barrier.is_limit(at)) {
        let side = barrier.side_index(at).unwrap();
        let multiplier = barrier.multiplier[at] + interior.trial.multiplier_step[at];
        sums[relaxation.limits[side].unwrap()] += relaxation.ranges[side] * multiplier;
    }
    for (i, sum) in sums.iter().enumerate() {
        let [_, first, second] = price(relaxation.give[i]);
        let step = relaxation.steps[0][i] + mu * relaxation.steps[1][i];
        let slope = relaxation.price * (first + second * step);
        let scale = relaxation.price + sum.abs();
        assert!((sum - slope).abs() < 1e-8 * scale, "{i}: {sum} {slope}");
    }
    // Distances change with the motion and with what limits give.
    let (base, step) = (interior.spline.clone(), 1e-6);
    let size = interior.steps[0].iter().fold(1e-300, |most: f64, dx| most.max(dx.abs()));
    let mut along = |sign: f64| {
        let factor = sign * step / size;
        let mut spline = base.clone();
        let pairs = spline.unknowns.iter_mut().zip(&interior.steps[0]);
        pairs.for_each(|(unknown, dx)| *unknown += factor * dx);
        spline.times[0] += factor * interior.time_steps[0][0];
        let relaxation = &interior.relaxation;
        interior.barrier.move_out(|side| {
            let give = relaxation.limits[side].map_or(0.0, |limit| relaxation.steps[0][limit]);
            relaxation.relief(side) + factor * relaxation.ranges[side] * give
        });
        interior.model.evaluate(&spline, &mut interior.points).unwrap();
        let mut distance = vec![0.0; interior.barrier.count()];
        interior.barrier.measure(&spline, &interior.points, &mut distance);
        distance
    };
    let (above, below) = (along(1.0), along(-1.0));
    let scale = interior.changes[0].iter().fold(0.0, |most: f64, c| most.max(c.abs())) / size;
    for ((above, below), change) in above.iter().zip(&below).zip(&interior.changes[0]) {
        let difference = (above - below) / (2.0 * step);
        assert!((change / size - difference).abs() < 1e-6 * scale, "{change} {difference}");
    }
}
