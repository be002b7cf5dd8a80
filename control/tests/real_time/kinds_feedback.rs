//! Feedback and derivatives of motions with vias, of periodic ones and of those with continuous
//! accelerations, against solving again.

use crate::kinds::{arm, at_rest, options, periodic, with_vias};
use costate::robot::Robot;
use costate_control::{
    BoundaryState, Budget, FinalTime, MotionLimits, MotionParameter, Objective, Payload, Problem, Resolve,
    ResolveStatus,
};

const INF: f64 = f64::INFINITY;

/// Derivatives by limits of jerks and rates of torques, and by a mass that is carried from a via on.
#[test]
fn derivatives_by_limits_and_masses_are_those_of_solving_again() {
    let tip = |mass: f64| Payload::point("joint:elbow", mass, [1.0, 0.0, 0.0]);
    let none = MotionLimits::none;
    type Change = fn(&mut Problem, f64);
    let limit: Change = |problem, step| problem.limits.jerk_max.as_mut().unwrap()[0] += step;
    let rate: Change = |problem, step| problem.limits.torque_rate_max.as_mut().unwrap()[1] += step;
    let mass: Change = |problem, step| {
        let body = Payload::point("joint:elbow", 0.5 + step, [1.0, 0.0, 0.0]);
        problem.robot = Robot::from_file("../robots/two_link.toml").unwrap();
        if problem.periodic.is_some() {
            problem.robot = problem.robot.with_gravity([0.0, -9.81, 0.0]).unwrap();
        }
        problem.robot = problem.robot.with_payload(&body.frame, &body.inertia).unwrap();
    };
    let rate_cost = || Objective::new(0.0, vec![1.0; 2]).with_torque_rate(vec![1e-3, 5e-4]);
    let carrying = |mut problem: Problem| {
        mass(&mut problem, 0.0);
        problem
    };
    for (name, problem, parameter, change, step) in [
        (
            "jerk",
            at_rest(arm(none().with_jerk_max(vec![200.0, 900.0]))),
            MotionParameter::JerkMax(0),
            limit,
            1e-2,
        ),
        (
            "rate",
            arm(none().with_torque_rate_max(vec![INF, 90.0])),
            MotionParameter::TorqueRateMax(1),
            rate,
            1e-2,
        ),
        (
            "mass",
            carrying(arm(none()).with_cost(rate_cost())),
            MotionParameter::PayloadMass(tip(0.5)),
            mass,
            1e-4,
        ),
        ("mass, vias", carrying(with_vias(none(), true)), MotionParameter::PayloadMass(tip(0.5)), mass, 1e-4),
        (
            "mass, periodic",
            carrying(periodic(none(), false)),
            MotionParameter::PayloadMass(tip(0.5)),
            mass,
            1e-4,
        ),
    ] {
        let solve = |step: f64| {
            let mut problem = problem.clone();
            change(&mut problem, step);
            let mut motion = Resolve::new(&problem, options(49, 1e-11)).unwrap();
            let found = motion.solve().unwrap();
            assert_eq!(found.status, ResolveStatus::Solved, "{name} {found:?}");
            (motion, found.cost)
        };
        let (mut motion, _) = solve(0.0);
        let found = motion.derivative_by(&parameter).unwrap().unwrap();
        let ((above, more), (below, less)) = (solve(step), solve(-step));
        let expected = (more - less) / (2.0 * step);
        assert!((found.cost / expected - 1.0).abs() < 1e-4, "{name}: {} {expected}", found.cost);
        let slope = |of: &dyn Fn(&Resolve) -> f64| (of(&above) - of(&below)) / (2.0 * step);
        let time = slope(&|motion| motion.final_time().unwrap());
        assert!(
            (found.final_time - time).abs() < 1e-3 * time.abs().max(1e-6),
            "{name}: {} {time}",
            found.final_time
        );
        // In the middle of the motion.
        let points = motion.feedback().unwrap().unwrap();
        let (p, m) = (points.points() / 2, points.state());
        let part = points.time(p) / motion.final_time().unwrap();
        let at = |motion: &Resolve, i: usize| {
            let mut z = [0.0; 6];
            motion.state_at(part * motion.final_time().unwrap(), &mut z).unwrap();
            z[i]
        };
        // Times of phases move too: only without vias it is the same part of the whole time.
        if problem.vias.is_empty() {
            let size = found.states[m * p..m * (p + 1)].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            for i in 0..2 {
                let expected = slope(&|motion| at(motion, i));
                let off = (found.states[m * p + i] - expected).abs();
                assert!(off < 0.02 * size + 1e-7, "{name} {i}: {} {expected}", found.states[m * p + i]);
            }
        }
    }
}

/// States and torques at some points, then the final time.
fn values(motion: &mut Resolve) -> Vec<f64> {
    let (mut z, mut tau, mut all) = ([0.0; 6], [0.0; 2], Vec::new());
    let feedback = motion.feedback().unwrap().unwrap().clone();
    for p in (0..feedback.points()).step_by(7) {
        motion.state_at(feedback.time(p), &mut z).unwrap();
        motion.torques_at(feedback.time(p), &mut tau).unwrap();
        all.extend_from_slice(&z[..feedback.state()]);
        all.extend_from_slice(&tau);
    }
    all.push(motion.final_time().unwrap());
    all
}

#[test]
fn derivatives_by_the_start_are_those_of_solving_again() {
    let none = MotionLimits::none;
    let costly =
        |problem: Problem| problem.with_cost(Objective::new(0.0, vec![1.0; 2]).with_jerk(vec![1e-3; 2]));
    let with_costs = Objective::new(0.0, vec![1.0; 2]).with_torque_rate(vec![1e-3, 5e-4]);
    for (name, problem) in [
        ("vias", with_vias(none(), false)),
        ("vias, free time", with_vias(none(), true)),
        ("periodic", periodic(none(), true)),
        ("jerks", at_rest(costly(arm(none())))),
        ("torque rates", arm(none()).with_cost(with_costs)),
        ("vias and jerks", costly(with_vias(none(), false))),
    ] {
        let mut motion = Resolve::new(&problem, options(37, 1e-12)).unwrap();
        assert_eq!(motion.solve().unwrap().status, ResolveStatus::Solved, "{name}");
        let feedback = motion.feedback().unwrap().unwrap().clone();
        let (m, step) = (feedback.state(), 1e-4);
        let is_given = |j: usize| match j / 2 {
            0 => true,
            1 => problem.periodic.is_none(),
            _ => problem.start.a.is_some(),
        };
        for j in (0..m).filter(|&j| is_given(j)) {
            let mut moved = |by: f64| {
                let mut state = [&problem.start.q[..], &problem.start.v, &[0.0; 2]].concat();
                state[j] += by;
                motion.set_start(&state[..2], &state[2..4]).unwrap();
                if problem.start.a.is_some() {
                    motion.set_start_acceleration(&state[4..]).unwrap();
                }
                let found = motion.solve_again(Budget::steps(40)).unwrap();
                assert_eq!(found.status, ResolveStatus::Solved, "{name} {found:?}");
                (values(&mut motion), found.cost)
            };
            let ((above, cost), (below, less)) = (moved(step), moved(-step));
            let mut found = Vec::new();
            for p in (0..feedback.points()).step_by(7) {
                let rows = feedback.states_by_start(p).chunks_exact(m);
                found.extend(rows.chain(feedback.torques_by_start(p).chunks_exact(m)).map(|row| row[j]));
            }
            found.push(feedback.time_by_start()[j]);
            let size = found.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            for (k, found) in found.iter().enumerate() {
                let expected = (above[k] - below[k]) / (2.0 * step);
                assert!((found - expected).abs() < 1e-4 * size, "{name} {j} {k}: {found} {expected}");
            }
            let (expected, gradient) = ((cost - less) / (2.0 * step), feedback.cost_gradient()[j]);
            let size = feedback.cost_gradient().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            assert!((gradient - expected).abs() < 1e-5 * size, "{name} {j}: {gradient} {expected}");
            for i in 0..m {
                let [one, other] = [m * i + j, m * j + i].map(|at| feedback.cost_hessian()[at]);
                assert!(!is_given(i) || (one - other).abs() < 1e-5 * (one.abs() + 1.0), "{name} {i} {j}");
            }
        }
    }
}

/// What is left of a problem at a time of its motion, from the state that it has there.
fn rest(problem: &Problem, motion: &Resolve, t: f64, vias: usize, change: (usize, f64)) -> Problem {
    let (mut z, mut end) = ([0.0; 6], [0.0; 6]);
    motion.state_at(t, &mut z).unwrap();
    motion.state_at(motion.final_time().unwrap(), &mut end).unwrap();
    z[change.0] += change.1;
    let mut left = problem.clone();
    // What is carried from the last via on that says so.
    let carried = problem.vias[..vias].iter().rev().find_map(|via| via.payload.clone());
    for payload in carried.into_iter().flatten() {
        left.robot = left.robot.with_payload(&payload.frame, &payload.inertia).unwrap();
    }
    left.vias.drain(..vias);
    left.vias.iter_mut().flat_map(|via| &mut via.time).for_each(|time| *time -= t);
    left.start = BoundaryState::fixed(&z[..2], &z[2..4]);
    if problem.cost.jerk.is_some() || problem.cost.torque_rate.is_some() {
        left.start = left.start.with_a(&z[4..]);
    }
    if left.periodic.take().is_some() {
        left.end = BoundaryState::fixed(&end[..2], &end[2..4]);
    }
    left.time = match problem.time {
        FinalTime::Fixed(time) => FinalTime::Fixed(time - t),
        _ => FinalTime::Free { guess: motion.final_time().unwrap() - t },
    };
    left
}

/// The parabola through values at Gauss's points of an interval, at its start. There the direct method
/// computes controls; at nodes they are off by much more.
fn at_start(values: [[f64; 2]; 3]) -> [f64; 2] {
    let root = 0.15_f64.sqrt();
    // Lagrange's factors at 0 for the places 1/2 - root, 1/2, 1/2 + root.
    let side = |other: f64| 0.5 * other / (2.0 * root * root);
    let factors = [side(0.5 + root), -(0.25 - root * root) / (root * root), side(0.5 - root)];
    std::array::from_fn(|i| (0..3).map(|k| factors[k] * values[k][i]).sum())
}

/// The torques at the start of a motion; with continuous accelerations the jerks.
fn controls(problem: &Problem) -> [f64; 2] {
    let mut motion = Resolve::new(problem, options(241, 1e-10)).unwrap();
    assert_eq!(motion.solve().unwrap().status, ResolveStatus::Solved);
    let feedback = motion.feedback().unwrap().unwrap();
    if feedback.state() == 4 {
        let times = [0, 1, 2].map(|p| feedback.time(p));
        return at_start(times.map(|t| {
            let mut tau = [0.0; 2];
            motion.torques_at(t, &mut tau).unwrap();
            tau
        }));
    }
    // On an interval accelerations are cubics.
    let (length, root) = (feedback.time(4), 0.15_f64.sqrt());
    at_start([0.5 - root, 0.5, 0.5 + root].map(|place| {
        let at = |by: f64| {
            let mut z = [0.0; 6];
            motion.state_at((place + by) * length, &mut z).unwrap();
            z
        };
        let [a, b, c, d] = [-0.1, -0.05, 0.05, 0.1].map(at);
        [4, 5].map(|i| (8.0 * (c[i] - b[i]) - (d[i] - a[i])) / (0.6 * length))
    }))
}

/// Gains on the way, before and after vias, are what the rest of the motion does in another state.
#[test]
fn gains_are_those_of_the_rest_of_the_motion() {
    let none = MotionLimits::none;
    let jerks = |weight: f64| Objective::new(0.0, vec![1.0; 2]).with_jerk(vec![weight; 2]);
    let rates = || Objective::new(0.0, vec![1.0; 2]).with_torque_rate(vec![0.1; 2]);
    let mut timed = with_vias(none(), false).with_cost(jerks(0.1));
    (timed.vias[0].time, timed.vias[1].time) = (Some(0.5), Some(1.1));
    // Times, and how many vias are over.
    for (name, problem, times) in [
        ("vias", with_vias(none(), false), vec![(0.2, 0), (0.9, 1)]),
        ("periodic, free", periodic(none(), false), vec![(0.4, 0), (1.2, 0)]),
        ("vias, free time", with_vias(none(), true), vec![(0.0, 0), (0.1, 0), (1.5, 1), (2.2, 2)]),
        ("jerks", at_rest(arm(none()).with_cost(jerks(0.1))), vec![(0.0, 0), (0.4, 0)]),
        // They settle within some hundredths of a second.
        ("cheap jerks", arm(none()).with_cost(jerks(1e-3)), vec![(0.3, 0), (0.7, 0)]),
        ("torque rates", at_rest(arm(none()).with_cost(rates())), vec![(0.3, 0)]),
        ("jerks, vias", timed, vec![(0.2, 0), (0.8, 1), (1.3, 2)]),
    ] {
        let mut motion = Resolve::new(&problem, options(241, 1e-10)).unwrap();
        assert_eq!(motion.solve().unwrap().status, ResolveStatus::Solved, "{name}");
        let feedback = motion.feedback().unwrap().unwrap().clone();
        let m = feedback.state();
        let mut gain = vec![0.0; 2 * m];
        for (t, vias) in times {
            assert!(feedback.gain(t, &mut gain), "{name}");
            // Positions, rates and accelerations have units of their own.
            let size = |j: usize| {
                let group = gain.chunks_exact(m).flat_map(|row| &row[j / 2 * 2..j / 2 * 2 + 2]);
                group.fold(0.0, |most: f64, x| most.max(x.abs()))
            };
            for j in 0..m {
                let step = 1e-3;
                let of = |by: f64| controls(&rest(&problem, &motion, t, vias, (j, by)));
                let (above, below) = (of(step), of(-step));
                for i in 0..2 {
                    let expected = (above[i] - below[i]) / (2.0 * step);
                    let off = (gain[m * i + j] - expected).abs();
                    assert!(off < 1e-2 * size(j), "{name} {t} {i} {j}: {} {expected}", gain[m * i + j]);
                }
            }
        }
    }
}

/// The law of jerks has no derivative where they cost nothing.
#[test]
fn jerks_without_a_cost_have_no_gains() {
    let none = MotionLimits::none;
    let one = Objective::new(0.0, vec![1.0; 2]).with_jerk(vec![0.1, 0.0]);
    let both = one.clone().with_torque_rate(vec![0.0, 1e-2]);
    for (problem, has) in [
        (at_rest(arm(none().with_torque_rate_max(vec![260.0, 150.0]))), false),
        (arm(none().with_jerk_max(vec![100.0, 150.0])), false),
        (arm(none()).with_cost(one), false),
        (arm(none()).with_cost(both.clone()), true),
        // The times of vias are free.
        (with_vias(none(), false).with_cost(both), false),
    ] {
        let mut motion = Resolve::new(&problem, options(49, 1e-8)).unwrap();
        assert_eq!(motion.solve().unwrap().status, ResolveStatus::Solved);
        let feedback = motion.feedback().unwrap().unwrap();
        assert_eq!((feedback.gain(0.3, &mut [0.0; 12]), problem.has_gains()), (has, has));
    }
}
