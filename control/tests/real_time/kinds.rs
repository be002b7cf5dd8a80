//! Motions with vias, periodic ones and those with continuous accelerations, solved again and again.

use costate::robot::Robot;
use costate_control::{
    BoundaryState, Budget, FinalTime, MachineCode, MotionLimits, Objective, Payload, Problem, Resolve,
    ResolveError, ResolveStatus, SolverOptions, Via,
};
use costate_test_support::allocations::allocations;
use std::f64::consts::{FRAC_PI_2, TAU};

pub fn options(nodes: usize, tolerance: f64) -> SolverOptions {
    let options = SolverOptions::default().with_tolerance(1e-6).with_machine_code(MachineCode::AtOnce);
    options.with_tolerance(tolerance).with_nodes(nodes)
}

/// A quarter turn of both joints of the unit two-link arm in a second.
pub fn arm(limits: MotionLimits) -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0; 2], &[FRAC_PI_2; 2], 1.0).with_limits(limits)
}

/// Without accelerations at the ends.
pub fn at_rest(mut problem: Problem) -> Problem {
    problem.start = problem.start.with_a(&[0.0; 2]);
    problem.end = problem.end.with_a(&[0.0; 2]);
    problem
}

/// With two vias, one of them with a payload from there on, in a given time or a free one.
pub fn with_vias(limits: MotionLimits, is_free: bool) -> Problem {
    let tip = Payload::point("joint:elbow", 0.5, [1.0, 0.0, 0.0]);
    let problem = arm(limits)
        .with_via(Via::at(&[0.4, 0.9]).with_payload(tip))
        .with_via(Via::at(&[1.0, 0.7]).with_q_free(&[1]));
    match is_free {
        true => {
            problem.with_time(FinalTime::Free { guess: 1.5 }).with_cost(Objective::new(60.0, vec![1.0; 2]))
        }
        false => problem.with_time(FinalTime::Fixed(1.6)),
    }
}

/// A full turn of the shoulder in a given time, again and again, from a given place or from any one of the
/// elbow, then with gravity.
pub fn periodic(limits: MotionLimits, is_given: bool) -> Problem {
    let mut problem = arm(limits).with_period(vec![TAU, 0.0]).with_time(FinalTime::Fixed(2.0));
    problem.start = BoundaryState::fixed(&[0.0, 0.3], &[0.0; 2]);
    problem.start.v_free = vec![0, 1];
    if !is_given {
        // What is free settles where gravity and the turn want it.
        problem.start.q_free = vec![1];
        problem.robot = problem.robot.with_gravity([0.0, -9.81, 0.0]).unwrap();
    }
    problem
}

/// All kinds, with a number of nodes.
fn kinds() -> Vec<(&'static str, Problem, usize)> {
    let none = MotionLimits::none;
    let rates = || none().with_torque_rate_max(vec![260.0, 150.0]);
    let rate_cost = Objective::new(0.0, vec![1.0; 2]).with_torque_rate(vec![1e-3, 5e-4]);
    vec![
        ("vias", with_vias(none().with_torque_max(vec![40.0, 15.0]), false), 73),
        ("vias, free time", with_vias(none(), true), 73),
        (
            "vias with given times",
            {
                let mut problem = with_vias(none(), true);
                problem.vias[1].time = Some(1.1);
                problem
            },
            73,
        ),
        ("periodic", periodic(none(), true), 49),
        ("periodic, free", periodic(none(), false), 49),
        ("jerks", at_rest(arm(none().with_jerk_max(vec![200.0, 300.0]))), 65),
        ("jerks, free accelerations", arm(none().with_jerk_max(vec![100.0, 150.0])), 65),
        ("torque rates", at_rest(arm(rates())), 65),
        ("cost of torque rates", arm(none()).with_cost(rate_cost), 49),
        ("vias and jerks", with_vias(none().with_jerk_max(vec![300.0; 2]), false), 73),
        ("periodic with jerks", periodic(none().with_jerk_max(vec![80.0, 200.0]), true), 49),
    ]
}

/// Moves what is given by a little, the k-th time.
fn moved(problem: &Problem, k: usize) -> Problem {
    let mut problem = problem.clone();
    let by = |i: usize, size: f64| size * ((i + 3 * k) as f64).sin();
    let periodic = problem.periodic.is_some();
    for i in 0..2 {
        problem.start.q[i] += by(i, 0.02);
        if !periodic {
            problem.start.v[i] += by(i + 1, 0.05);
            problem.end.q[i] += by(i + 2, 0.02);
        }
        for via in &mut problem.vias {
            via.q.as_mut().unwrap()[i] += by(i + 4, 0.02);
        }
    }
    for (i, a) in problem.start.a.iter_mut().flatten().enumerate() {
        *a += by(i, 0.5);
    }
    problem
}

/// Sets what [`moved`] moves.
fn set(motion: &mut Resolve, problem: &Problem) {
    motion.set_start(&problem.start.q, &problem.start.v).unwrap();
    if problem.periodic.is_none() {
        motion.set_end(&problem.end.q, &problem.end.v).unwrap();
    }
    for (via, state) in problem.vias.iter().enumerate() {
        motion.set_via(via, state.q.as_ref().unwrap(), &[0.0; 2]).unwrap();
    }
    if let Some(a) = &problem.start.a {
        motion.set_start_acceleration(a).unwrap();
    }
}

#[test]
fn motions_are_those_of_solving_from_scratch() {
    for (name, problem, nodes) in kinds() {
        let mut motion = Resolve::new(&problem, options(nodes, 1e-8)).unwrap();
        let first = motion.solve().unwrap();
        assert_eq!((first.status, first.keeps_limits()), (ResolveStatus::Solved, true), "{name} {first:?}");
        let (mut steps, mut anew, mut same) = (0, 0, 0);
        for k in 1..=5 {
            let problem = moved(&problem, k);
            set(&mut motion, &problem);
            let found = motion.solve_again(Budget::steps(80)).unwrap();
            assert_eq!(
                (found.status, found.keeps_limits()),
                (ResolveStatus::Solved, true),
                "{name} {k} {found:?}"
            );
            let mut fresh = Resolve::new(&problem, options(nodes, 1e-8)).unwrap();
            let solved = fresh.solve().unwrap();
            (steps, anew) = (steps + found.iterations, anew + solved.iterations);
            // From scratch it may be another local minimum.
            assert!(found.cost < solved.cost * (1.0 + 1e-6), "{name} {k}: {found:?} {solved:?}");
            let is_same = found.cost > solved.cost * (1.0 - 1e-6);
            same += usize::from(is_same);
            if !is_same {
                continue;
            }
            let (mut z, mut other) = ([0.0; 6], [0.0; 6]);
            let time = motion.final_time().unwrap();
            for part in [0.0, 0.3, 0.62, 1.0] {
                motion.state_at(part * time, &mut z).unwrap();
                fresh.state_at(part * time, &mut other).unwrap();
                let off = |i: usize| (z[i] - other[i]).abs();
                assert!((0..4).all(|i| off(i) < 1e-3), "{name} {k} {part}: {z:?} {other:?}");
            }
            if problem.periodic.is_none() {
                assert!((0..2).all(|i| (z[i] - problem.end.q[i]).abs() < 1e-12), "{name} {k}");
            }
        }
        assert!(steps < anew && same >= 3, "{name}: {steps} steps instead of {anew}, {same} alike");
    }
}

#[test]
fn nothing_is_allocated_after_the_first_solve() {
    for (name, problem, nodes) in kinds() {
        let mut motion = Resolve::new(&problem, options(nodes, 1e-5)).unwrap();
        motion.solve().unwrap();
        motion.feedback().unwrap().unwrap();
        let problems: Vec<Problem> = (0..6).map(|k| moved(&problem, k)).collect();
        let mut gain = vec![0.0; 2 * motion.feedback().unwrap().unwrap().state()];
        let (mut steps, has_gains) = (0, problem.has_gains());
        let mut again = |k: usize| {
            motion.advance(0.004);
            set(&mut motion, &problems[k]);
            steps += motion.solve_again(Budget::steps(30)).unwrap().iterations;
            motion.torques_at(0.0, &mut [0.0; 2]).unwrap();
            if let Some(feedback) = motion.feedback().unwrap() {
                assert_eq!(feedback.gain(0.3, &mut gain), has_gains, "{name}");
            }
        };
        again(0);
        let found = allocations(|| (1..6).for_each(&mut again));
        assert!(found == 0 && steps >= 5, "{name}: {found} allocations in {steps} steps");
    }
}

/// The rest of an optimal motion is optimal: vias stay where they are on the clock.
#[test]
fn motions_with_vias_go_on_when_time_does() {
    for limits in [MotionLimits::none(), MotionLimits::none().with_jerk_max(vec![300.0; 2])] {
        for is_free in [true, false] {
            let smooth = limits.jerk_max.is_some();
            let mut problem = with_vias(limits.clone(), is_free);
            if smooth {
                problem.start = problem.start.with_a(&[0.0; 2]);
            }
            let mut motion = Resolve::new(&problem, options(73, 1e-6)).unwrap();
            motion.solve().unwrap();
            let whole = motion.final_time().unwrap();
            let (mut z, mut through) = ([0.0; 6], [0.0; 6]);
            motion.state_at(0.8 * whole, &mut through).unwrap();
            for k in 1..=4 {
                let dt = 0.04;
                motion.state_at(dt, &mut z).unwrap();
                motion.advance(dt);
                motion.set_start(&z[..2], &z[2..4]).unwrap();
                if smooth {
                    motion.set_start_acceleration(&z[4..]).unwrap();
                }
                let found = motion.solve_again(Budget::steps(20)).unwrap();
                assert_eq!(found.status, ResolveStatus::Solved, "{is_free} {k} {found:?}");
                let left = whole - f64::from(k) * dt;
                let time = motion.final_time().unwrap();
                assert!((time / left - 1.0).abs() < 5e-3, "{is_free} {k}: {time} {left}");
                motion.state_at(0.8 * whole - f64::from(k) * dt, &mut z).unwrap();
                let off = (0..2).map(|i| (z[i] - through[i]).abs()).fold(0.0, f64::max);
                assert!(off < 2e-2, "{is_free} {k}: {z:?} {through:?}");
            }
        }
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let mut motion = Resolve::new(&with_vias(MotionLimits::none(), true), options(37, 1e-4)).unwrap();
    assert_eq!(
        motion.set_via(2, &[0.0; 2], &[0.0; 2]),
        Err(ResolveError::NoEntry { table: "via", entry: 2 })
    );
    assert!(motion.set_via(0, &[0.0, f64::NAN], &[0.0; 2]).unwrap_err().to_string().contains("q at the via"));
    let free = motion.set_start_acceleration(&[0.0; 2]).unwrap_err();
    assert!(matches!(free, ResolveError::FreeAcceleration { .. }), "{free}");
    let mut turn = Resolve::new(&periodic(MotionLimits::none(), true), options(37, 1e-4)).unwrap();
    assert_eq!(turn.set_end(&[0.0; 2], &[0.0; 2]), Err(ResolveError::Periodic));
    assert_eq!(turn.set_end_acceleration(&[0.0; 2]), Err(ResolveError::Periodic));
}
