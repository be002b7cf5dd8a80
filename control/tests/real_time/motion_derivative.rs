//! Derivatives of motions by limits and payloads, against solving again.

use crate::solved::{problem, solved};
use costate::robot::LinkInertia;
use costate_control::{
    FinalTime, MotionLimits, MotionParameter, Objective, Payload, Problem, Resolve, ResolveError,
    SolverOptions,
};

/// Cost; T; states and torques at all points, at the same parts of the time.
fn values(problem: &Problem, intervals: usize, tolerance: f64) -> [Vec<f64>; 4] {
    let (mut motion, cost) = solved(problem, intervals, tolerance);
    let n = motion.dof();
    let feedback = motion.feedback().unwrap().unwrap().clone();
    let (mut z, mut tau) = (vec![0.0; 3 * n], vec![0.0; n]);
    let (mut states, mut torques) = (Vec::new(), Vec::new());
    for p in 0..feedback.points() {
        motion.state_at(feedback.time(p), &mut z).unwrap();
        motion.torques_at(feedback.time(p), &mut tau).unwrap();
        states.extend_from_slice(&z[..2 * n]);
        torques.extend_from_slice(&tau);
    }
    [vec![cost], vec![motion.final_time().unwrap()], states, torques]
}

/// Largest differences of the derivatives from central differences of solving again on the same mesh,
/// relative to the largest of each kind: cost, T, states, torques.
pub fn differences(
    problem: &Problem,
    parameter: &MotionParameter,
    change: impl Fn(&Problem, f64) -> Problem,
    (intervals, tolerance, step): (usize, f64, f64),
) -> [f64; 4] {
    let (mut motion, _) = solved(problem, intervals, tolerance);
    let found = motion.derivative_by(parameter).unwrap().unwrap();
    let found = [vec![found.cost], vec![found.final_time], found.states, found.torques];
    let moved = |step: f64| values(&change(problem, step), intervals, tolerance);
    let (above, below) = (moved(step), moved(-step));
    std::array::from_fn(|kind| {
        let slope = above[kind].iter().zip(&below[kind]).map(|(above, below)| (above - below) / (2.0 * step));
        let slopes: Vec<f64> = slope.collect();
        let size = slopes.iter().fold(0.0, |most: f64, slope| most.max(slope.abs()));
        let far = slopes.iter().zip(&found[kind]).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        if size > 0.0 { far / size } else { far }
    })
}

/// The two-link arm in free time, with these limits of torques.
fn arm(torques: [f64; 2]) -> Problem {
    let mut arm = problem("two_link").with_limits(MotionLimits::none().with_torque_max(torques.to_vec()));
    arm.time = FinalTime::Free { guess: 2.0 };
    arm.cost = Objective::new(20.0, vec![1.0; 2]);
    arm
}

#[test]
fn limits_change_motions_as_solving_again_says() {
    let torques = |step: f64| arm([12.0, 5.0 + step]);
    let by_torque = |tolerance: f64| {
        let parameter = MotionParameter::TorqueMax(1);
        differences(&torques(0.0), &parameter, |_, step| torques(step), (24, tolerance, 1e-3))
    };
    let found = by_torque(1e-6);
    assert!(found.iter().all(|&part| part < 1e-4), "{found:?}");
    // Where the products of slacks and multipliers are not equal yet.
    let found = by_torque(1e-4);
    assert!(found.iter().all(|&part| part < 0.15), "{found:?}");
    let fast = |step: f64| {
        let limits =
            MotionLimits::none().with_v_max(vec![2.2 + step, 10.0]).with_torque_max(vec![60.0, 30.0]);
        problem("two_link").with_limits(limits)
    };
    let by_rate = |tolerance: f64| {
        let parameter = MotionParameter::VelocityMax(0);
        differences(&fast(0.0), &parameter, |_, step| fast(step), (24, tolerance, 1e-4))
    };
    // No point reaches or leaves the limit by so little.
    let found = by_rate(1e-10);
    assert!(found.iter().all(|&part| part < 1e-2), "{found:?}");
    let [cost, ..] = by_rate(1e-6);
    assert!(cost < 1e-3, "{cost}");
}

#[test]
fn masses_change_motions_as_solving_again_says() {
    let payload = |mass: f64| {
        Payload::new(
            "elbow",
            LinkInertia::from_entries(
                mass,
                [0.9, 0.1, 0.0],
                [0.1, 0.1, 0.2, 0.0, 0.0, 0.0].map(|i| i * mass),
            ),
        )
    };
    let loaded = |mut arm: Problem, mass: f64| {
        let body = payload(mass);
        arm.robot = arm.robot.with_payload(&body.frame, &body.inertia).unwrap();
        arm
    };
    for energy in [0.0, 0.4] {
        let mut base = arm([14.0, 6.0]);
        base.cost = base.cost.with_energy(vec![energy; 2]);
        let found = differences(
            &loaded(base.clone(), 0.3),
            &MotionParameter::PayloadMass(payload(2.0)),
            |_, step| loaded(base.clone(), 0.3 + step),
            (24, 1e-10, 1e-3),
        );
        assert!(found.iter().all(|&part| part < 1e-3), "{energy}: {found:?}");
    }
}

#[test]
fn what_is_not_there_is_refused() {
    let (mut motion, _) = solved(&arm([12.0, 5.0]), 12, 1e-6);
    let error = motion.derivative_by(&MotionParameter::VelocityMax(0)).unwrap_err();
    assert_eq!(error, ResolveError::NoLimit { kind: "rate", joint: "shoulder".into() });
    assert!(motion.derivative_by(&MotionParameter::TorqueMax(7)).is_err());
    let massless = Payload::point("elbow", 0.0, [0.0; 3]);
    assert_eq!(motion.derivative_by(&MotionParameter::PayloadMass(massless)), Err(ResolveError::NoMass));
    let nowhere = Payload::point("hand", 1.0, [0.0; 3]);
    let error = motion.derivative_by(&MotionParameter::PayloadMass(nowhere)).unwrap_err().to_string();
    assert!(error.contains("hand"), "{error}");
    let mut new = Resolve::new(&arm([12.0, 5.0]), SolverOptions::default().with_tolerance(1e-6)).unwrap();
    assert_eq!(new.derivative_by(&MotionParameter::TorqueMax(0)), Err(ResolveError::NotSolved));
}
