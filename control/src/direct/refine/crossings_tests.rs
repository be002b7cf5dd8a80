use super::super::resolution::Resolution;
use super::*;
use crate::constants::direct::SAFETY;
use crate::direct::solve::prepare::{Dynamics, interior};
use crate::options::SolverOptions;
use crate::problem::{JointReference, MotionLimits, Objective, Problem, Task};
use crate::task::build::TaskRows;
use costate::robot::{Friction, JointSpec, LinkInertia, Robot};

#[test]
fn places_are_graded_towards_the_ends_of_an_interval() {
    let all = graded(&[0.001]);
    assert!(all[0] == 0.001 && all.len() > 3, "{all:?}");
    let ends: Vec<f64> = std::iter::once(0.0).chain(all).chain([1.0]).collect();
    let gaps: Vec<f64> = ends.windows(2).map(|ends| ends[1] - ends[0]).collect();
    let ratios = gaps.windows(2).map(|gaps| gaps[1] / gaps[0]);
    assert!(ratios.clone().all(|ratio| ratio < 2.0 * constants::GRADED && ratio > 0.1), "{gaps:?}");
    assert!(graded(&[]).is_empty());
    let many: Vec<f64> = (1..200).map(|k| f64::from(k) / 200.0).collect();
    assert_eq!(graded(&many), many);
}

/// A slider with friction, on equal intervals along its cubic guess.
fn guess(problem: &Problem, nodes: usize) -> Interior<Dynamics> {
    let rows = TaskRows::new(problem).unwrap();
    let options = SolverOptions::default().with_nodes(nodes);
    let mut interior = interior(problem, &rows, &options, 0, None);
    interior.start(None).unwrap();
    interior.refresh().unwrap();
    interior
}

fn slider(friction: Friction) -> Problem {
    let joint = JointSpec::prismatic("x").carrying(LinkInertia::point(1.0, [0.0; 3])).friction(friction);
    let robot = Robot::builder("slider").gravity([0.0; 3]).joint(joint).build().unwrap();
    Problem::rest_to_rest(robot, &[0.0], &[10.0], 4.0).with_limits(MotionLimits::none())
}

/// Error and cost as they are estimated, and without what is known to be narrow.
fn estimates(interior: &mut Interior<Dynamics>) -> [[f64; 2]; 2] {
    let mut resolution = Resolution::default();
    let mut estimate = |interior: &mut Interior<Dynamics>| {
        resolution.measure(interior).unwrap();
        [resolution.error(), resolution.cost]
    };
    let known = estimate(interior);
    interior.crossed = Narrow::default();
    [known, estimate(interior)]
}

/// `u = m + c tanh(v/s)` along the cubic, m = a at the start, a = 6 d/T^2, and -a at the end. With f = 1 -
/// tanh, whose integral over time is `ln(2) s/a` and that of its square `(2 ln(2) - 1) s/a`, the cost of `1/2
/// u^2` is less by `int (m + c) c f - c^2 f^2/2` at each end, which is `c^2 s/a` for both.
#[test]
fn a_transition_between_the_points_is_seen_by_the_estimate_alone() {
    let (dry, transition) = (2.0, 1e-3);
    let friction = Friction { viscous: 0.0, coulomb: dry, coulomb_velocity: transition };
    let mut interior = guess(&slider(friction), 21);
    let missing = dry * dry * transition / (60.0 / 16.0);
    let [[error, cost], [blind, of_points]] = estimates(&mut interior);
    assert!(((of_points - cost) / missing - 1.0).abs() < 1e-2, "{cost} {of_points} {missing}");
    // It is less by `c^2 s/(2 a) + ln(2) c s` at the start and by `c^2 s/(2 a) - ln(2) c s` at the end: the
    // estimate adds their magnitudes, with its factor.
    let estimate = SAFETY * 2.0 * std::f64::consts::LN_2 * dry * transition;
    assert!((error / estimate - 1.0).abs() < 1e-2 && blind < 1e-6 * error, "{error} {estimate} {blind}");
}

/// The energy of braking is not got back: the cost bends where the power changes its sign, inside of an
/// interval.
#[test]
fn the_sign_of_a_power_splits_the_integral() {
    let smoothing = 1e-6;
    let cost = Objective::new(0.0, vec![0.0]).with_energy(vec![1.0]).with_energy_smoothing(smoothing);
    let mut interior = guess(&slider(Friction::none()).with_cost(cost), 16);
    let [[_, cost], [_, blind]] = estimates(&mut interior);
    // All of the kinetic energy at the peak of the rate, 3/2 of its mean.
    let exact = 0.5 * (1.5_f64 * 10.0 / 4.0).powi(2);
    assert!(
        (cost / exact - 1.0).abs() < 1e-5 && (blind / exact - 1.0).abs() > 5e-4,
        "{cost} {blind} {exact}"
    );
}

/// An event between two points: all points see nothing of it.
#[test]
fn an_event_between_two_knots_is_seen_by_its_panels_alone() {
    let (centre, width, weight) = (1.31, 0.01, 100.0);
    let times = vec![0.0, centre - width, centre, centre + width, 4.0];
    let rows: Vec<Vec<f64>> = [0.0, 0.0, 1.0, 0.0, 0.0].iter().map(|q| vec![*q]).collect();
    let still = vec![vec![0.0]; 5];
    let reference = JointReference::new(times, rows, vec![weight]).with_velocities(still);
    let mut problem = slider(Friction::none()).with_task(Task::default().with_reference(reference));
    problem.end.q = vec![0.0];
    let mut interior = guess(&problem, 21);
    let at_points = |p: usize| interior.points.z(p).iter().chain(interior.points.tau(p)).all(|z| *z == 0.0);
    assert!((0..interior.points.count()).all(at_points), "it rests");
    // Of the two cubics, `int (3 x^2 - 2 x^3)^2 dx = 13/35` each; the rule with three points has an error of
    // 1e-3 here.
    let exact = 0.5 * weight * 2.0 * width * 13.0 / 35.0;
    let [[error, cost], _] = estimates(&mut interior);
    assert!((cost / exact - 1.0).abs() < 1e-12, "{cost} {exact}");
    assert!(error < 0.01 * exact && (interior.figures.cost / exact - 1.0).abs() < 5e-3, "{error}");
    // Nodes at its knots, and no panel is left.
    let nodes = interior.seeded(100);
    assert_eq!(nodes.len(), interior.spline.mesh.nodes.len() + 3);
    interior.move_to(nodes).unwrap();
    assert!(!interior.running.split(&interior.spline));
    assert!(interior.with_knots(vec![0.0, 1.0], 2, 1e-6).len() == 2, "too many of them");
}
