//! What happens within a small part of a motion: dry friction and short events of references, against closed
//! forms.
//!
//! A joint with the inertia M and the dry friction c that moves by d, with an effort 1/2 u^2, moves for the
//! time t with `t^4 = 36 (M d/c)^2` if it has more, which costs `2/3 c^2 t`, and rests before or after. Its
//! torque is 2 c where it moves off and 0 where it stops. Smooth friction with the transition velocity s lets
//! it move off with `u = 2 c tanh(v/s)`, from H = 0 near rest, so `M v' = c tanh(v/s)`; `1/2 u^2` per v is `2
//! c M tanh(v/s)`, and the cost is less by `2 c M s ln(2)`, up to the square of s over the largest rate.
//!
//! A unit mass that follows a reference r from rest to rest, with the cost 1/2 u^2 + 1/2 w (q - r)^2, follows
//! r * G with `G(t) = k/2 exp(-k |t|) (cos k t + sin k |t|)`, `4 k^4 = w`, and the cost is `w/2 (int r^2 -
//! int r (r * G))`, as long as both ends are farther than some 1/k from where r is not zero.

use crate::sledge;
use costate::robot::{Friction, JointSpec, LinkInertia, Placement, Robot};
use costate_control::{
    Certificate, FinalTime, JointReference, MotionLimits, Objective, Polish, Problem, Solution, Solver,
    SolverOptions, Task, Via,
};
use nalgebra::Matrix3;

const INERTIA: f64 = 0.05;

fn spindle(name: &str, coulomb: f64, coulomb_velocity: f64) -> JointSpec {
    JointSpec::revolute(name)
        .axis([0.0, 0.0, 1.0])
        .carrying(LinkInertia::about_com(1.0, [0.0; 3], INERTIA * Matrix3::identity()))
        .friction(Friction { viscous: 0.0, coulomb, coulomb_velocity })
}

/// Independent spindles in the plane of no gravity.
fn robot(joints: impl IntoIterator<Item = JointSpec>) -> Robot {
    let builder = Robot::builder("spindles").gravity([0.0; 3]);
    joints.into_iter().fold(builder, |builder, joint| builder.joint(joint)).build().unwrap()
}

fn solve(problem: &Problem) -> Solution {
    let options = SolverOptions::default().with_polish(Polish::Never);
    Solver::new(problem, options).unwrap().solve()
}

fn turn(robot: Robot, to: &[f64], time: f64) -> Problem {
    let from = vec![0.0; to.len()];
    Problem::rest_to_rest(robot, &from, to, time)
        .with_cost(Objective::new(0.0, vec![1.0; to.len()]))
        .with_limits(MotionLimits::none())
}

/// The least cost of a turn with more time than it takes, and what the transition makes of it.
fn least_cost(way: f64, coulomb: f64, transition: f64) -> [f64; 2] {
    let time = (36.0 * (INERTIA * way / coulomb).powi(2)).powf(0.25);
    let less = 2.0 * coulomb * INERTIA * std::f64::consts::LN_2 * transition;
    [2.0 / 3.0 * coulomb * coulomb * time - less, less]
}

/// Converged at the least cost, to a tenth of what the transition makes of it.
fn check(solution: &Solution, [cost, transition]: [f64; 2]) {
    let off = solution.motion.cost - cost;
    assert!(solution.motion.status.is_converged(), "{}: {}", solution.motion.status, solution.motion.cost);
    assert!(off.abs() < 0.1 * transition + 1e-5 * cost, "{} {cost} {transition}", solution.motion.cost);
}

/// The cubic over the whole time costs 4.1157, and every point of a coarse mesh lies beyond the transition.
#[test]
fn a_spindle_with_dry_friction_waits() {
    let way = 62.83185307;
    let solution = solve(&turn(robot([spindle("spin", 1.0, 0.01)]), &[way], 8.0));
    check(&solution, least_cost(way, 1.0, 0.01));
}

#[test]
fn two_spindles_wait_each_for_its_own_time() {
    let ways = [62.83185307, 20.0];
    let solution = solve(&turn(robot([spindle("a", 1.0, 0.05), spindle("b", 0.5, 0.05)]), &ways, 8.0));
    let [one, other] = [least_cost(ways[0], 1.0, 0.05), least_cost(ways[1], 0.5, 0.05)];
    check(&solution, [one[0] + other[0], one[1] + other[1]]);
}

/// An event of `width` s to each side of `centre`: the reference goes to 1 m and back.
fn event(centre: f64, width: f64, knots: usize) -> (Vec<f64>, Vec<f64>) {
    let rise = |x: f64| x * x * (3.0 - 2.0 * x);
    let inner = (0..=2 * knots).map(|k| k as f64 / knots as f64 - 1.0);
    let (mut times, mut values) = (vec![0.0], vec![0.0]);
    for x in inner {
        times.push(centre + width * x);
        values.push(rise(1.0 - x.abs()));
    }
    times.push(60.0);
    values.push(0.0);
    (times, values)
}

fn tracking(times: Vec<f64>, values: &[f64], rates: &[f64], weight: f64) -> Problem {
    let rows = |list: &[f64]| list.iter().map(|value| vec![*value]).collect::<Vec<_>>();
    let reference = JointReference::new(times, rows(values), vec![weight]).with_velocities(rows(rates));
    Problem::rest_to_rest(sledge(), &[0.0], &[0.0], 60.0)
        .with_cost(Objective::new(0.0, vec![1.0]))
        .with_limits(MotionLimits::none())
        .with_task(Task::default().with_reference(reference))
}

/// `w/2 (int r^2 - int r (r * G))` of the event of two cubics, by Gauss's rule on small pieces.
fn cost_of_event(width: f64, weight: f64) -> f64 {
    let rise = |t: f64| {
        let x = 1.0 - (t / width).abs();
        x * x * (3.0 - 2.0 * x)
    };
    let k = (weight / 4.0_f64).powf(0.25);
    let green = |t: f64| 0.5 * k * (-k * t.abs()).exp() * ((k * t).cos() + (k * t.abs()).sin());
    let pieces = 60;
    let points: Vec<[f64; 2]> = (-pieces..pieces)
        .flat_map(|piece| {
            let h = width / f64::from(pieces);
            [-(0.6_f64.sqrt()), 0.0, 0.6_f64.sqrt()]
                .into_iter()
                .zip([5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0])
                .map(move |(x, w)| [h * (f64::from(piece) + 0.5 + 0.5 * x), h * w])
        })
        .collect();
    let squares: f64 = points.iter().map(|[t, w]| w * rise(*t).powi(2)).sum();
    let products: f64 = points
        .iter()
        .map(|[t, w]| points.iter().map(|[s, u]| w * u * rise(*t) * green(t - s) * rise(*s)).sum::<f64>())
        .sum();
    0.5 * weight * (squares - products)
}

/// An event of 0.12 s in 60 s, at 24 places: the cost is the same at each of them. The kink of G at 0 makes
/// the double sum exact to about the square of a piece over the width, 1e-4.
#[test]
fn a_short_event_of_a_reference_is_seen_wherever_it_is() {
    let (width, weight) = (0.06, 1e7);
    let exact = cost_of_event(width, weight);
    for place in 0..24 {
        let centre = 2.0 + 56.0 * f64::from(place) / 23.0 + 0.013 * f64::from(place % 5);
        let (times, values) = event(centre, width, 1);
        let solution = solve(&tracking(times.clone(), &values, &vec![0.0; times.len()], weight));
        let cost = solution.motion.cost;
        assert!(solution.motion.status.is_converged(), "{centre}: {}", solution.motion.status);
        assert!((cost / exact - 1.0).abs() < 2e-4, "{centre}: {cost} {exact}");
    }
}

/// More knots than a mesh has intervals are no nodes, but each of them counts: the same event in 8000 knots,
/// which a mesh of twenty intervals jumps over. (Six become too fine too late: the search ends before.)
#[test]
fn a_reference_with_thousands_of_knots_is_integrated_across_them() {
    let (width, weight, centre) = (0.06, 1e7, 33.337);
    let slope = |x: f64| 6.0 * x * (1.0 - x) / width;
    let (mut times, mut values, mut rates) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..=8000 {
        let t = 60.0 * f64::from(k) / 8000.0;
        let x = (1.0 - ((t - centre) / width).abs()).max(0.0);
        times.push(t);
        values.push(x * x * (3.0 - 2.0 * x));
        rates.push(if t < centre { slope(x) } else { -slope(x) });
    }
    let problem = tracking(times, &values, &rates, weight);
    let options = SolverOptions::default().with_polish(Polish::Never).with_nodes(61);
    let solution = Solver::new(&problem, options).unwrap().solve();
    assert!(solution.motion.status.is_converged(), "{}", solution.motion.status);
    // The tip of the event lies between two knots: Hermite's cubics miss the height by less than 1e-3 there.
    let exact = cost_of_event(width, weight);
    assert!((solution.motion.cost / exact - 1.0).abs() < 5e-3, "{} {exact}", solution.motion.cost);
}

/// With a free time knots move through the mesh. A reference that ends at rest after 1 s, with a price of
/// time: the motion is the same on any mesh, so a coarse one and a fine one agree to their tolerance.
#[test]
fn knots_count_with_free_times_and_vias() {
    let (times, values) = (vec![0.1, 0.13, 0.16, 2.0], [0.0, 1.0, 0.0, 0.0]);
    let mut base = tracking(times, &values, &[0.0; 4], 1e5)
        .with_cost(Objective::new(3.0, vec![1.0]))
        .with_time(FinalTime::Free { guess: 1.0 });
    // At its start it would take no time.
    base.end.q = vec![0.5];
    for problem in [base.clone(), base.with_via(Via::at(&[0.1]))] {
        let cost = |nodes: usize| {
            let options = SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never);
            let options = options.with_nodes(nodes);
            let motion = Solver::new(&problem, options).unwrap().solve().motion;
            assert!(motion.status.is_converged(), "{nodes}: {}", motion.status);
            motion.cost
        };
        let [coarse, fine] = [cost(21), cost(301)];
        assert!((coarse / fine - 1.0).abs() < 1e-5, "{coarse} {fine}");
    }
}

/// A turntable on a turntable in the time that is best for both. What is solved first is a saddle, and so are
/// the motions beside it, one after the other, each of which costs less: one that is called converged is none
/// of them. The first costs 12.0266.
#[test]
fn saddles_under_dry_friction_are_left_or_not_verified() {
    let joint = |name: &str, inertia: f64, coulomb: f64, coulomb_velocity: f64| {
        let body = LinkInertia::about_com(1.0, [0.0; 3], inertia * Matrix3::identity());
        let friction = Friction { viscous: 0.0, coulomb, coulomb_velocity };
        let offset = Placement::from_xyz_rpy([0.3, 0.0, 0.0], [0.0; 3]);
        JointSpec::revolute(name).axis([0.0, 0.0, 1.0]).placed(offset).carrying(body).friction(friction)
    };
    let joints = [joint("lower", 0.2197, 0.4995, 0.2444), joint("upper", 1.032, 4.1846, 0.15457).on("lower")];
    let problem = Problem::rest_to_rest(robot(joints), &[0.0; 2], &[6.2708, 1.4931], 2.2435)
        .with_time(FinalTime::Free { guess: 2.2435 })
        .with_cost(Objective::new(0.56624, vec![1.0; 2]))
        .with_limits(MotionLimits::none());
    let solution = solve(&problem);
    let (status, cost) = (&solution.motion.status, solution.motion.cost);
    let is_saddle = solution.motion.certificate == Certificate::SaddleOnMesh;
    assert!(status.is_converged() != is_saddle, "{status}: {cost}");
    assert!(cost < 12.0, "{status}: {cost}");
}
