//! Motions in closed form pass, and planted faults are found with their size.

use super::adjoint::{Conditions, Multipliers, Prices};
use super::cost::cost;
use super::dynamics::Trees;
use super::limits::{Quantity, excesses};
use super::motion::defects;
use super::optimality::{Costates, Optimality, check};
use super::path::{Path, Piece};
use super::running::Running;
use super::splits::Splits;
use crate::numerics::dormand_prince::Stopped;
use crate::problem::{Bounds, MotionLimits, Objective, Problem};
use crate::task::build::TaskRows;
use costate::EvalError;
use costate::robot::{Friction, JointSpec, Robot};

const TOLERANCE: f64 = 1e-6;

/// No limits beside those of torques.
struct NoMultipliers;

impl Multipliers for NoMultipliers {
    fn add(&mut self, _: usize, _: f64, _: &[f64], _: &[f64], _: &mut Prices) -> Result<(), EvalError> {
        Ok(())
    }
}

/// Unit inertias on axes of their own.
fn axes(names: &[&str], friction: Friction) -> Robot {
    let joint = |name: &&str| JointSpec::prismatic(*name).armature(1.0).friction(friction);
    names.iter().fold(Robot::builder("axes"), |robot, name| robot.joint(joint(name))).build().unwrap()
}

/// A unit mass from rest to rest over one metre in a second, with the cost of effort.
fn unit_mass() -> Problem {
    Problem::rest_to_rest(axes(&["x"], Friction::none()), &[0.0], &[1.0], 1.0)
        .with_limits(MotionLimits::none())
}

/// Polynomials between these times through q, v, a and the jerk of each coordinate, one after the other.
fn path(times: &[f64], n: usize, at: impl Fn(f64) -> Vec<[f64; 4]>) -> Path {
    path_behind(1e-12, times, n, at)
}

/// The same with the values so far behind each start, where they may jump.
fn path_behind(behind: f64, times: &[f64], n: usize, at: impl Fn(f64) -> Vec<[f64; 4]>) -> Path {
    let z = |t: f64| -> Vec<f64> { (0..4).flat_map(|m| at(t).into_iter().map(move |q| q[m])).collect() };
    let pieces = times.windows(2).map(|ends| {
        let (left, right) = (z(ends[0] + behind), z(ends[1]));
        Piece::through(ends[0], ends[1] - ends[0], 0, &left, &right)
    });
    Path { dof: n, pieces: pieces.collect() }
}

/// The optimal motion of [`unit_mass`]: q = 3 t^2 - 2 t^3, u = 6 - 12 t, J = 6.
fn least_effort(t: f64) -> [f64; 4] {
    [3.0 * t * t - 2.0 * t.powi(3), 6.0 * t - 6.0 * t * t, 6.0 - 12.0 * t, -12.0]
}

/// Costates at the ends of pieces between these times.
fn costates(times: &[f64], at: impl Fn(f64) -> Vec<f64>) -> Costates {
    let (left, right) = times.windows(2).map(|ends| (at(ends[0]), at(ends[1]))).unzip();
    Costates { left, right, jumps: vec![None; times.len() - 1] }
}

fn optimality(
    problem: &Problem,
    path: &Path,
    costates: &Costates,
    multipliers: &mut dyn Multipliers,
) -> Optimality {
    let rows = TaskRows::new(problem).unwrap();
    let (mut running, splits) = (Running::new(problem, &rows), Splits::new(problem, path));
    let conditions = Conditions {
        path,
        splits: &splits,
        dynamics: &mut Trees::new(&problem.robots()),
        running: &mut running,
        multipliers,
        limits: &problem.joint_limits(),
        stops: &mut || false,
    };
    check(conditions, costates, TOLERANCE, 7).unwrap()
}

const TIMES: [f64; 4] = [0.0, 0.3, 0.55, 1.0];

#[test]
fn the_closed_form_of_least_effort_has_no_gap() {
    let path = path(&TIMES, 1, |t| vec![least_effort(t)]);
    let exact = costates(&TIMES, |t| vec![12.0, 6.0 - 12.0 * t]);
    let found = optimality(&unit_mass(), &path, &exact, &mut NoMultipliers);
    // Rounding: the gap is a difference of numbers of 18, half the square of the largest torque.
    assert!(
        found.gap < 100.0 * 18.0 * f64::EPSILON && found.stationarity < 1e-10 && found.defect < 1e-10,
        "{found:?}"
    );
}

/// A torque that is off by d(t) = 0.3 (1 - 6 t + 6 t^2) leads to the same end and costs `1/2 int d^2` = 0.009
/// more; the gap with the costates of the optimum is that.
#[test]
fn the_gap_of_a_shifted_torque_is_what_it_costs() {
    let wrong = |t: f64| {
        let [q, v, a, j] = least_effort(t);
        // The integrals of 1 - 6 t + 6 t^2 vanish at both ends.
        let d = [
            0.5 * t * t - t.powi(3) + 0.5 * t.powi(4),
            t - 3.0 * t * t + 2.0 * t.powi(3),
            1.0 - 6.0 * t + 6.0 * t * t,
            -6.0 + 12.0 * t,
        ];
        vec![[q + 0.3 * d[0], v + 0.3 * d[1], a + 0.3 * d[2], j + 0.3 * d[3]]]
    };
    let path = path(&TIMES, 1, wrong);
    let exact = costates(&TIMES, |t| vec![12.0, 6.0 - 12.0 * t]);
    let found = optimality(&unit_mass(), &path, &exact, &mut NoMultipliers);
    // 1/2 0.09 int (1 - 6 t + 6 t^2)^2 = 0.045 / 5.
    assert!((found.gap / 0.009 - 1.0).abs() < 1e-6, "{found:?}");
    assert!(found.worst.is_some_and(|(_, joint)| joint == 0) && found.stationarity > 0.03, "{found:?}");
}

/// A costate of the solver that jumps at a node by 0.1 where nothing makes it jump: carried on to the start
/// it costs 1/2 0.1^2 a second, however short the piece is in which it arises.
#[test]
fn a_defect_of_the_costates_is_a_gap() {
    let path = path(&TIMES, 1, |t| vec![least_effort(t)]);
    let mut wrong = costates(&TIMES, |t| vec![12.0, 6.0 - 12.0 * t]);
    wrong.right[2][1] += 0.1;
    let found = optimality(&unit_mass(), &path, &wrong, &mut NoMultipliers);
    assert!((found.gaps[2] / (0.005 * 0.45) - 1.0).abs() < 1e-6, "{found:?}");
    assert!((found.gaps[1] / (0.005 * 0.25) - 1.0).abs() < 1e-6, "{found:?}");
    assert!((found.gaps[0] / (0.005 * 0.3) - 1.0).abs() < 1e-6, "{found:?}");
    assert!((found.defect - 0.1 / 6.0).abs() < 1e-9, "{found:?}");
}

/// A torque that is larger by 0.1 up to 0.549 s, with costates of the solver that say so, and exact ones
/// from there on: 1/2 0.1^2 a second before the jump, though no costate is off by more than a millisecond
/// after it.
#[test]
fn a_jump_between_exact_costates_counts_over_all_before_it() {
    let times = [0.0, 0.3, 0.549, 0.55, 1.0];
    let [from, more] = [times[2], 0.1];
    let offset = |t: f64| match t <= from {
        true => [0.5 * more * t * t, more * t, more, 0.0],
        false => [more * from * (t - 0.5 * from), more * from, 0.0, 0.0],
    };
    let motion = |t: f64| {
        let (exact, offset) = (least_effort(t), offset(t));
        vec![std::array::from_fn(|order| exact[order] + offset[order])]
    };
    let path = path(&times, 1, motion);
    let mut given = costates(&times, |t| vec![12.0, 6.0 - 12.0 * t]);
    for k in 0..2 {
        given.left[k][1] += more;
        given.right[k][1] += more;
    }
    let found = optimality(&unit_mass(), &path, &given, &mut NoMultipliers);
    assert!((found.gap / (0.005 * from) - 1.0).abs() < 1e-6, "{found:?}");
    // Where it arises, not where it counts.
    let causes = found.causes(TOLERANCE);
    assert!(causes[2] > 0.99 * found.gap, "{causes:?}");
}

/// A multiplier of a rate that is not at its limit.
struct False(f64);

impl Multipliers for False {
    fn add(&mut self, piece: usize, _: f64, z: &[f64], _: &[f64], to: &mut Prices) -> Result<(), EvalError> {
        if piece == 1 {
            to.by_z[1] += self.0;
            to.slack += self.0.max(0.0) * (2.0 - z[1]);
        }
        Ok(())
    }
}

#[test]
fn a_false_multiplier_is_a_gap_of_either_sign() {
    let path = path(&TIMES, 1, |t| vec![least_effort(t)]);
    let exact = costates(&TIMES, |t| vec![12.0, 6.0 - 12.0 * t]);
    for multiplier in [0.5, -0.5] {
        let found = optimality(&unit_mass(), &path, &exact, &mut False(multiplier));
        // 1/2 int (0.5 t)^2 over 0.25 s, beside the slack of a positive one.
        let own = 0.125 * 0.25_f64.powi(3) / 3.0;
        assert!(found.gap > 0.999 * own && found.defect > 0.01, "{found:?}");
    }
}

/// From rest to rest over one metre with |u| <= 4 takes a second: u = 4, then -4. With H = 0 the costates are
/// lambda_v = (1 - 2 t)/4 * 2 and lambda_q = 1. The gap with a wrong time of switching is
/// `int |lambda_v| (4 - sign u)`.
#[test]
fn least_time_has_no_gap_and_the_wrong_sign_has_one() {
    let problem =
        unit_mass().with_cost(Objective::new(1.0, vec![0.0])).with_bounds(Bounds::symmetric(vec![4.0]));
    let times = [0.0, 0.5, 0.6, 1.0];
    let bang = |t: f64| {
        let r = 1.0 - t;
        vec![if t <= 0.5 + 1e-13 {
            [2.0 * t * t, 4.0 * t, 4.0, 0.0]
        } else {
            [1.0 - 2.0 * r * r, 4.0 * r, -4.0, 0.0]
        }]
    };
    let path = path(&times, 1, bang);
    // lambda_v u = 1 at rest.
    let exact = |t: f64| vec![0.5, 0.25 - 0.5 * t];
    let found = optimality(&problem, &path, &costates(&times, exact), &mut NoMultipliers);
    assert!(found.gap < 1e-9, "{found:?}");
    let late = |t: f64| vec![0.5, 0.3 - 0.5 * t];
    let found = optimality(&problem, &path, &costates(&times, late), &mut NoMultipliers);
    // For 0.1 s the sign is wrong by up to 0.05: 2 u times the triangle.
    assert!((found.gap / (8.0 * 0.5 * 0.1 * 0.05) - 1.0).abs() < 1e-6, "{found:?}");
}

/// The motion of least squared jerk, q = 10 t^3 - 15 t^4 + 6 t^5: lambda_a = j, lambda_v = -j', lambda_q =
/// j''. With j + 0.3 d, d = 6 - 48 t + 60 t^2, the gap is `1/2 int (0.3 d)^2` = 0.09 18 with these costates.
/// With others, of a jerk that is a quadratic too, it is none: the motion is the best one to its own end. The
/// torque of a unit mass is its acceleration, and the rate of it the jerk.
#[test]
fn least_jerk_has_no_gap_and_a_shifted_jerk_has_what_it_costs() {
    let (free, weights) = (Objective::new(0.0, vec![0.0]), Some(vec![1.0]));
    let of_jerk = Objective { jerk: weights.clone(), ..free.clone() };
    let of_torque = Objective { torque_rate: weights, ..free };
    let motion = |part: f64| {
        move |t: f64| {
            let [t2, t3, t4, t5] = [2, 3, 4, 5].map(|power| t.powi(power));
            vec![[
                10.0 * t3 - 15.0 * t4 + 6.0 * t5 + part * (t3 - 2.0 * t4 + t5),
                30.0 * t2 - 60.0 * t3 + 30.0 * t4 + part * (3.0 * t2 - 8.0 * t3 + 5.0 * t4),
                60.0 * t - 180.0 * t2 + 120.0 * t3 + part * (6.0 * t - 24.0 * t2 + 20.0 * t3),
                60.0 - 360.0 * t + 360.0 * t2 + part * (6.0 - 48.0 * t + 60.0 * t2),
            ]]
        }
    };
    let exact = costates(&TIMES, |t| vec![720.0, 360.0 - 720.0 * t, 60.0 - 360.0 * t + 360.0 * t * t]);
    for cost in [of_jerk, of_torque] {
        let problem = unit_mass().with_cost(cost);
        let found =
            optimality(&problem, &path_behind(0.0, &TIMES, 1, motion(0.0)), &exact, &mut NoMultipliers);
        // Rounding of differences of numbers of 1800, half the square of the largest jerk.
        assert!(
            found.gap < 100.0 * 1800.0 * f64::EPSILON && found.stationarity < 1e-10 && found.defect < 1e-10,
            "{found:?}"
        );
        let found = optimality(&problem, &path(&TIMES, 1, motion(0.3)), &exact, &mut NoMultipliers);
        match problem.cost.jerk {
            Some(_) => assert!(found.gap < 1e-6, "{found:?}"),
            None => assert!((found.gap / (0.09 * 18.0) - 1.0).abs() < 1e-6, "{found:?}"),
        }
    }
}

/// From rest to rest over one metre with |j| <= 32 takes a second: the jerk changes its sign at 1/4 and 3/4,
/// as lambda_a = c (t - 1/4) (t - 3/4) does. Costates of a solver that do so elsewhere leave no gap either;
/// a jerk that is zero for 0.1 s has one, `int |lambda_a| 32`, whatever the costates are.
#[test]
fn least_time_with_limited_jerks_has_no_gap_and_a_jerk_inside_its_limits_has_one() {
    let problem = unit_mass()
        .with_cost(Objective::new(1.0, vec![0.0]))
        .with_limits(MotionLimits::none().with_jerk_max(vec![32.0]));
    let times = [0.0, 0.25, 0.5, 0.6, 0.75, 1.0];
    let half = |t: f64| match t {
        t if t <= 0.25 + 1e-13 => [16.0 / 3.0 * t.powi(3), 16.0 * t * t, 32.0 * t, 32.0],
        t => {
            let (s, start) = (t - 0.25, [1.0 / 12.0, 1.0, 8.0]);
            let (s2, s3) = (0.5 * s * s, s.powi(3) / 6.0);
            [
                start[0] + start[1] * s + start[2] * s2 - 32.0 * s3,
                start[1] + start[2] * s - 32.0 * s2,
                start[2] - 32.0 * s,
                -32.0,
            ]
        }
    };
    // The second half is the first one backwards.
    let motion = |t: f64| {
        vec![if t <= 0.75 + 1e-13 && t > 0.5 {
            let [q, v, a, j] = half(1.0 - t);
            [1.0 - q, v, -a, j]
        } else if t > 0.75 {
            let r = 1.0 - t;
            [1.0 - 16.0 / 3.0 * r.powi(3), 16.0 * r * r, -32.0 * r, 32.0]
        } else {
            half(t)
        }]
    };
    let path = path(&times, 1, motion);
    // H = lambda_a j - 1 = 0 at rest.
    let c = 1.0 / (32.0 * 0.1875);
    let costate = |shift: f64| {
        costates(&times, move |t| vec![2.0 * c, c * (1.0 - 2.0 * t), c * (t - 0.25) * (t - 0.75) + shift])
    };
    for shift in [0.0, 0.01 * c] {
        let found = optimality(&problem, &path, &costate(shift), &mut NoMultipliers);
        assert!(found.gap < 1e-6, "{shift}: {found:?}");
    }
    let coasting = |t: f64| match t {
        t if t > 0.5 && t <= 0.6 => vec![[t, 1.0, 0.0, 0.0]],
        t => motion(t),
    };
    let found =
        optimality(&problem, &path_behind(1e-12, &times, 1, coasting), &costate(0.0), &mut NoMultipliers);
    let exact = 32.0 * c * (0.0625 * 0.1 - 0.1_f64.powi(3) / 3.0);
    assert!((0.5 * exact..1.01 * exact).contains(&found.gap), "{found:?} {exact}");
}

/// A mass with dry friction of 1 N and the narrow transition w goes through rest with u = -2 + tanh(v/w):
/// the cost is 1/4 (10 - 2 w tanh(1/w)), whatever a few points see of it.
#[test]
fn a_narrow_transition_is_in_the_cost() {
    for width in [0.01, 1e-5] {
        let friction = Friction { viscous: 0.0, coulomb: 1.0, coulomb_velocity: width };
        let problem = Problem::rest_to_rest(axes(&["x"], friction), &[0.0], &[0.0], 1.0)
            .with_limits(MotionLimits::none());
        let rows = TaskRows::new(&problem).unwrap();
        let path = path(&[0.0, 1.0], 1, |t| vec![[t - t * t, 1.0 - 2.0 * t, -2.0, 0.0]]);
        let splits = Splits::new(&problem, &path);
        assert_eq!(splits.of(0).len(), 5, "{splits:?}");
        let mut running = Running::new(&problem, &rows);
        let mut trees = Trees::new(&problem.robots());
        let asked = [TOLERANCE, 1.0];
        let [found, _] = cost(&path, &splits, &mut trees, &mut running, asked, &mut || false).unwrap();
        let exact = 0.25 * (10.0 - 2.0 * width);
        // Beyond three transition velocities friction differs from 1 by 0.005 and less, within about one.
        let tail = 5e-3 * width;
        assert!(
            (found.value - exact).abs() < 1e-8 + tail && found.error < 1e-8,
            "{width}: {found:?} {exact}"
        );
        assert!(found.evaluations < 2000, "{found:?}");
    }
}

/// Beside a driven axis one without a motor, which moves at a constant rate, or is off by 1e-3 t^2: at the
/// end of each piece its position and rate miss by 1e-3 h^2 and 2e-3 h.
#[test]
fn an_undriven_row_that_is_off_is_found() {
    let robot = axes(&["driven", "free"], Friction::none());
    let problem = Problem::rest_to_rest(robot, &[0.0; 2], &[1.0; 2], 1.0)
        .with_limits(MotionLimits::none().with_torque_max(vec![100.0, 0.0]));
    let defects_of = |bump: f64| {
        let free = |t: f64| [t + bump * t * t, 1.0 + 2.0 * bump * t, 2.0 * bump, 0.0];
        let path = path(&TIMES, 2, |t| vec![least_effort(t), free(t)]);
        let splits = Splits::new(&problem, &path);
        let limits = problem.joint_limits();
        let mut trees = Trees::new(&problem.robots());
        defects((&path, &splits), &mut trees, &limits, &[1.0; 4], 2, 1e-3, &mut || false).unwrap()
    };
    assert!(defects_of(0.0).sum() < 1e-9);
    let found = defects_of(1e-3);
    assert!((found.sum() / 2e-3 - 1.0).abs() < 1e-3, "{found:?}");
    assert_eq!(found.worst, Some((2, 1)));
}

/// A stiff axis, whose friction would make it stop within 1e-9 s, takes as few steps as others.
#[test]
fn stiff_axes_are_followed() {
    let friction = Friction { viscous: 1e9, coulomb: 0.0, coulomb_velocity: 1.0 };
    let problem =
        Problem::rest_to_rest(axes(&["x"], friction), &[0.0], &[1.0], 1.0).with_limits(MotionLimits::none());
    let path = path(&TIMES, 1, |t| vec![least_effort(t)]);
    let (splits, limits) = (Splits::new(&problem, &path), problem.joint_limits());
    let mut trees = Trees::new(&problem.robots());
    let found = defects((&path, &splits), &mut trees, &limits, &[1.0; 2], 1, 1e-3, &mut || false).unwrap();
    assert!(found.sum() < 1e-6, "{found:?}");
}

/// The jerk of 0.5 t^4 + 0.1 t^5 is 12 t + 6 t^2, and largest at the end: 18 of 12. Between two nodes its
/// rate limit is exceeded inside of a piece, where no node sees it.
#[test]
fn excesses_between_nodes_are_found_with_their_time() {
    let limits = MotionLimits::none().with_jerk_max(vec![12.0]).with_v_max(vec![1.4]);
    let problem = unit_mass().with_limits(limits);
    let rows = TaskRows::new(&problem).unwrap();
    let excesses_of = |path: &Path| {
        let splits = Splits::new(&problem, path);
        let mut trees = Trees::new(&problem.robots());
        excesses(&problem, (path, &splits), &mut trees, &rows, 1, 5, &mut || false).unwrap()
    };
    let of = |found: &[super::limits::Excess], quantity| {
        found.iter().find(|excess| excess.quantity == quantity).unwrap().clone()
    };
    let quintic = |t: f64| {
        vec![[
            0.5 * t.powi(4) + 0.1 * t.powi(5),
            2.0 * t.powi(3) + 0.5 * t.powi(4),
            6.0 * t * t + 2.0 * t.powi(3),
            12.0 * t + 6.0 * t * t,
        ]]
    };
    let jerk = of(&excesses_of(&path(&[0.0, 1.0], 1, quintic)), Quantity::Jerk);
    assert!((jerk.part - 6.0 / 24.0).abs() < 1e-9 && (jerk.time - 1.0).abs() < 1e-9, "{jerk:?}");
    let rate = of(&excesses_of(&path(&[0.0, 0.3, 0.65, 1.0], 1, |t| vec![least_effort(t)])), Quantity::Rate);
    assert!((rate.part - 0.1 / 2.8).abs() < 1e-9 && (rate.time - 0.5).abs() < 1e-6, "{rate:?}");
}

/// Each part of a verification ends where the search is to stop.
#[test]
fn a_search_that_stops_ends_its_verification() {
    let problem = unit_mass().with_limits(MotionLimits::none().with_v_max(vec![2.0]));
    let rows = TaskRows::new(&problem).unwrap();
    let path = path(&TIMES, 1, |t| vec![least_effort(t)]);
    let (splits, limits) = (Splits::new(&problem, &path), problem.joint_limits());
    let (mut running, mut trees) = (Running::new(&problem, &rows), Trees::new(&problem.robots()));
    let mut stops = || true;
    let of_cost = cost(&path, &splits, &mut trees, &mut running, [TOLERANCE, 1.0], &mut stops);
    assert_eq!(of_cost.unwrap_err(), Stopped::Interrupted);
    let of_motion = defects((&path, &splits), &mut trees, &limits, &[1.0; 2], 1, 1e-3, &mut stops);
    assert_eq!(of_motion.unwrap_err(), Stopped::Interrupted);
    let of_limits = excesses(&problem, (&path, &splits), &mut trees, &rows, 1, 5, &mut stops);
    assert_eq!(of_limits.unwrap_err(), Stopped::Interrupted);
    let conditions = Conditions {
        path: &path,
        splits: &splits,
        dynamics: &mut trees,
        running: &mut running,
        multipliers: &mut NoMultipliers,
        limits: &limits,
        stops: &mut stops,
    };
    let exact = costates(&TIMES, |t| vec![12.0, 6.0 - 12.0 * t]);
    assert_eq!(check(conditions, &exact, TOLERANCE, 7).unwrap_err(), Stopped::Interrupted);
}
