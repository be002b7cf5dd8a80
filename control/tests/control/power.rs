//! Limits of mechanical power, torque-speed limits of motors, and a cost of energy.
//!
//! The values are those of `bash benches/ocp/run --values in_phases` (`benches/ocp/harness/in_phases.py`):
//! direct collocation on Radau's points with the inverse dynamics of the two-link arm written out, in CasADi
//! with IPOPT. Elements of four points are split until the cost changes by less than a relative 1e-9.

use costate::robot::{LoadOptions, Robot};
use costate_control::{
    ActiveLimit, FinalTime, LimitUse, MotionLimits, Objective, Polish, PolishOutcome, Problem, ProblemFile,
    Solution, Solver, SolverOptions, Status, Verify,
};
use std::f64::consts::FRAC_PI_2;

pub(super) const INF: f64 = f64::INFINITY;

/// The cost of the motion without limits.
const FREE: f64 = 145.13113754;

/// The unit two-link arm with a quarter turn of both joints in 1 s, least squared torques.
pub(super) fn arm(limits: MotionLimits) -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0; 2], &[FRAC_PI_2; 2], 1.0).with_limits(limits)
}

pub(super) fn with_energy(limits: MotionLimits) -> Problem {
    arm(limits).with_cost(Objective::new(0.0, vec![1.0; 2]).with_energy(vec![1.0; 2]))
}

pub(super) fn none() -> MotionLimits {
    MotionLimits::none()
}

fn solve_with(problem: &Problem, options: SolverOptions) -> Solution {
    Solver::new(problem, options).unwrap().solve()
}

fn solve(problem: &Problem) -> Solution {
    solve_with(problem, SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never))
}

/// Solved with this cost.
fn check(solution: &Solution, value: f64) {
    let cost = solution.total();
    assert_eq!(solution.motion.status, Status::Converged, "{cost}");
    assert!((cost / value - 1.0).abs() < 3e-6, "{cost} instead of {value}");
    assert!(solution.end_defect < 1e-3, "{}", solution.end_defect);
}

/// Kept at the points to 1e-8 of the range, and active for the joints of these names alone.
fn kept(usage: Option<&LimitUse>, range: f64, names: &[&str]) {
    let usage = usage.unwrap();
    assert!(usage.at_points <= 1e-8 * range && usage.worst.is_none(), "{usage:?}");
    let found = |ActiveLimit { name, .. }: &ActiveLimit| names.contains(&name.as_str());
    assert!(usage.active.iter().all(found), "{usage:?}");
    for name in names {
        let long =
            usage.active.iter().filter(|span| span.name == *name).any(|span| span.to - span.from > 0.02);
        assert!(long, "{name}: {usage:?}");
    }
}

/// Largest |tau_i v_i| of a joint at the nodes and points of a motion, and of the sum over all.
fn most_power(solution: &Solution) -> [f64; 3] {
    let rows = solution.trajectory.v.iter().zip(&solution.trajectory.u);
    rows.fold([0.0; 3], |most, (v, tau)| {
        let power = [v[0] * tau[0], v[1] * tau[1]];
        [power[0], power[1], power[0] + power[1]]
            .map(f64::abs)
            .iter()
            .zip(most)
            .map(|(p, most)| p.max(most))
            .collect::<Vec<_>>()
            .try_into()
            .unwrap()
    })
}

#[test]
fn power_of_joints() {
    let free = most_power(&solve(&arm(none())));
    assert!(free[0] > 40.0 && free[1] > 220.0 && free[2] > 200.0, "{free:?}");
    let problem = arm(none().with_power_max(vec![30.0, 150.0]));
    let solution = solve(&problem);
    check(&solution, 151.21889);
    assert!(solution.total() > 1.01 * FREE);
    kept(solution.limits.power.as_ref(), 300.0, &["shoulder", "elbow"]);
    assert!(solution.limits.torque.is_none() && solution.limits.torque_speed.is_none());
}

#[test]
fn power_of_all_joints() {
    let problem = arm(none().with_total_power_max(120.0));
    let solution = solve(&problem);
    check(&solution, 146.80174);
    kept(solution.limits.power.as_ref(), 240.0, &["all joints"]);
}

#[test]
fn motors_with_a_torque_speed_limit() {
    let limits = none().with_torque_max(vec![20.0, 28.0]);
    let problem = arm(limits.clone().with_torque_speed(vec![3.0, 4.0], vec![8.0, 12.0]));
    let solution = solve(&problem);
    check(&solution, 150.33038);
    kept(solution.limits.torque_speed.as_ref(), 40.0, &["elbow"]);
    // Where a motor drives it gives less than its torque limit, where it brakes all of it.
    let only_torques = solve(&arm(limits));
    assert!(only_torques.total() < solution.total() && only_torques.limits.torque_speed.is_none());
    for (v, u) in solution.trajectory.v.iter().zip(&solution.trajectory.u) {
        for (i, (most, corner, no_load)) in [(20.0, 3.0, 8.0), (28.0, 4.0, 12.0)].into_iter().enumerate() {
            let driving = most * (no_load - v[i].abs()) / (no_load - corner);
            // Nodes are between points: there the polynomial may be off by some percent of a jump.
            assert!(v[i] * u[i] <= 0.0 || u[i].abs() <= driving + 0.05 * most, "{v:?} {u:?}");
        }
    }
}

#[test]
fn energy_has_a_cost() {
    let solution = solve(&with_energy(none()));
    check(&solution, 172.99066);
    assert!(solution.limits.is_empty());
    // More than the effort alone, less than that of the motion of least effort.
    let work = |solution: &Solution| -> f64 {
        let rows = solution.trajectory.v.iter().zip(&solution.trajectory.u);
        let power: Vec<f64> =
            rows.map(|(v, u)| v.iter().zip(u).map(|(v, u)| (v * u).max(0.0)).sum()).collect();
        let spans = solution.trajectory.t.windows(2).zip(power.windows(2));
        spans.map(|(t, power)| 0.5 * (t[1] - t[0]) * (power[0] + power[1])).sum()
    };
    assert!(work(&solution) < 0.97 * work(&solve(&arm(none()))));
    // The motion repeats its cost without smoothing up to half of it a second and joint.
    let mut sharp = with_energy(none());
    sharp.cost.energy_smoothing = 0.1;
    let sharp = solve(&sharp);
    let least = sharp.total() - solution.total();
    assert!(least > 0.0 && least < 0.5 * 2.0 * (1.0 - 0.1), "{least}");
}

/// The drift of H* that a tolerance of the cost leaves. A torque that is off by d on an interval of the width
/// w costs d^2 w, which is at most the tolerance times J, and changes H* at a limit by up to 2 |u| d:
/// relative to the largest u^2 that is 2 (tolerance T/w)^(1/2). Nodes where a power changes its sign are
/// close.
fn drift_allowed(solution: &Solution, tolerance: f64) -> f64 {
    // Of each interval both ends and three points.
    let rows = solution.trajectory.t.chunks_exact(5);
    let narrowest = rows.fold(f64::INFINITY, |least: f64, t| least.min(t[4] - t[0]));
    2.0 * (tolerance * solution.motion.final_time / narrowest).sqrt()
}

/// H* is constant, and both H* and the costates are derivatives of the cost.
#[test]
fn costates_contain_powers() {
    let sharp = |problem: &Problem| {
        let options = SolverOptions::default()
            .with_tolerance(1e-6)
            .with_polish(Polish::Never)
            .with_verify(Verify::None);
        solve_with(problem, options.with_tolerance(1e-7))
    };
    let limits = none().with_power_max(vec![30.0, 150.0]).with_total_power_max(110.0);
    let limits = limits.with_torque_max(vec![25.0, 28.0]).with_torque_speed(vec![3.0, INF], vec![9.0, INF]);
    let step = 1e-3;
    for problem in [with_energy(limits), with_energy(none()), arm(none().with_power_max(vec![INF, 150.0]))] {
        let solution = sharp(&problem);
        let drift = solution.motion.hamiltonian_drift;
        let allowed = drift_allowed(&solution, 1e-7);
        assert!(drift < allowed, "{drift} of {allowed}");
        let slope = |change: &dyn Fn(&mut Problem, f64)| {
            let [above, below] = [step, -step].map(|step| {
                let mut near = problem.clone();
                change(&mut near, step);
                sharp(&near).total()
            });
            (above - below) / (2.0 * step)
        };
        let by_time = slope(&|near, step| near.time = FinalTime::Fixed(1.0 + step));
        let found = -solution.motion.hamiltonian;
        assert!((by_time / found - 1.0).abs() < 3e-4, "{by_time} {found}");
        let by_start = slope(&|near, step| near.start.q[1] += step);
        let found = -solution.trajectory.y_q[0][1];
        assert!((by_start / found - 1.0).abs() < 3e-4, "{by_start} {found}");
    }
}

#[test]
fn a_polish_keeps_powers_or_is_not_tried() {
    let outcome = |problem: &Problem| {
        let solution =
            solve_with(problem, SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Always));
        (solution.polish.as_ref().unwrap().outcome, solution)
    };
    let motors = none().with_torque_max(vec![20.0, 28.0]).with_torque_speed(vec![3.0, 4.0], vec![8.0, 12.0]);
    for limited in [
        arm(none().with_power_max(vec![30.0, INF])),
        arm(none().with_total_power_max(120.0)),
        arm(motors),
        with_energy(none()),
    ] {
        assert_eq!(outcome(&limited).0, PolishOutcome::Limited);
    }
    // Limits that are far away change nothing.
    let wide = none().with_power_max(vec![300.0, INF]).with_total_power_max(900.0);
    let (outcome, solution) = outcome(&arm(wide));
    assert_eq!(outcome, PolishOutcome::Polished);
    assert!((solution.total() / FREE - 1.0).abs() < 1e-8, "{}", solution.total());
    assert!(solution.limits.power.as_ref().unwrap().active.is_empty());
}

#[test]
fn motors_with_limited_power_and_a_cost_of_energy() {
    let path = "../examples/problems/two_link_motors.toml";
    let ProblemFile { problem, options, .. } = ProblemFile::read(path, LoadOptions::default()).unwrap();
    let solution = solve_with(&problem, options);
    let total = solution.total();
    assert_eq!(solution.motion.status, Status::Converged, "{total}");
    assert!((total / 180.73515 - 1.0).abs() < 3e-6, "{total}");
    kept(solution.limits.power.as_ref(), 160.0, &["all joints"]);
}

#[test]
fn a_power_that_is_too_small_is_told() {
    let solution = solve(&arm(none().with_total_power_max(1.0)));
    assert_eq!(solution.motion.status, Status::LocallyInfeasible);
    let worst = solution.limits.power.as_ref().unwrap().worst.as_ref().unwrap();
    assert!(worst.name == "all joints" && worst.unit == "W" && worst.limit.abs() == 1.0, "{worst:?}");
    assert!((worst.value.abs() - 1.0 - worst.excess).abs() < 1e-9, "{worst:?}");
}
