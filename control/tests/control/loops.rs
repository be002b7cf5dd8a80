//! Robots with constraints: loops that stay closed along optimal motions.
//!
//! The four-bar linkage has one degree of freedom. Its motion in three coordinates with two constraints costs
//! what that of the crank alone costs, whose energies are written by hand below.

use super::reduced::{Energies, Reduced, between};
use costate::constraints::{ConstrainedHamiltonian, Constraints};
use costate::dynamics::Automatic;
use costate::robot::{ConstraintRow, ConstraintSpec, Robot};
use costate::scalar::Scalar;
use costate_control::{
    Bounds, DirectDynamics, FinalTime, Method, MotionLimits, Objective, Problem, ProblemError, Resolve,
    Solution, Solver, SolverOptions, Status, Via,
};

pub const FREE: f64 = f64::INFINITY;

pub fn four_bar() -> Robot {
    Robot::from_file("../robots/four_bar.toml").unwrap()
}

/// The position with these joints held.
pub fn closed(robot: &Robot, near: &[f64], held: &[bool]) -> Vec<f64> {
    let mut q = near.to_vec();
    ConstrainedHamiltonian::<f64>::new(robot).close(&mut q, held).unwrap();
    q
}

/// The crank turns from 1 rad to 2.4 rad in a second, from rest to rest; only the crank has a motor.
pub fn crank(robot: Robot, most: f64) -> Problem {
    let held = [true, false, false];
    let from = closed(&robot, &[1.0, -0.6, -2.0], &held);
    let to = closed(&robot, &[2.4, from[1], from[2]], &held);
    Problem::rest_to_rest(robot, &from, &to, 1.0)
        .with_cost(Objective::new(0.0, vec![1.0, 0.0, 0.0]))
        .with_limits(MotionLimits::none().with_torque_max(vec![most, 0.0, 0.0]))
}

fn solved(problem: &Problem, tolerance: f64) -> Solution {
    let options = SolverOptions::default().with_tolerance(tolerance);
    let solution = Solver::new(problem, options).unwrap().solve();
    println!(
        "{} J {:.10} error {:?} end {:.1e} nodes {} steps {} drift {:?}",
        solution.motion.status,
        solution.total(),
        solution.motion.errors,
        solution.end_defect,
        solution.nodes(),
        solution.newton_iterations,
        solution.constraints.iter().map(|one| one.drift).collect::<Vec<_>>()
    );
    solution
}

/// The four-bar linkage by the angle of its crank.
#[derive(Clone, Copy)]
struct Crank;

impl Energies for Crank {
    fn energies<S: Scalar>(&self, angle: S) -> [S; 2] {
        let [l1, l2, l3, base] = [0.5, 1.2, 0.9, 1.3];
        let number = S::from_f64;
        let (sin, cos) = angle.sin_cos();
        let knee = [cos.times(l1), sin.times(l1)];
        // From the knee to the pivot, along that line and beside it to the joint of coupler and rocker.
        let to = [number(base) - knee[0], -knee[1]];
        let length = (to[0] * to[0] + to[1] * to[1]).sqrt();
        let unit = [to[0] / length, to[1] / length];
        let along = (length * length + number(l2 * l2 - l3 * l3)) / length.times(2.0);
        let beside = (number(l2 * l2) - along * along).sqrt();
        let rod = [unit[0] * along - unit[1] * beside, unit[1] * along + unit[0] * beside];
        let joint = [knee[0] + rod[0], knee[1] + rod[1]];
        let last = [number(base) - joint[0], -joint[1]];
        // Rates of the absolute angles for a rate of one: k2 turn(rod) + k3 turn(last) = -turn(knee).
        let turn = |r: [S; 2]| [-r[1], r[0]];
        let cross = |a: [S; 2], b: [S; 2]| a[0] * b[1] - a[1] * b[0];
        let [v1, t2, t3] = [turn(knee), turn(rod), turn(last)];
        let determinant = cross(t2, t3);
        let (k2, k3) = (-cross(v1, t3) / determinant, cross(v1, t2) / determinant);
        let middle = |from: [S; 2], rate: S, turned: [S; 2]| {
            [from[0] + (rate * turned[0]).times(0.5), from[1] + (rate * turned[1]).times(0.5)]
        };
        let zero = number(0.0);
        let v3 = [v1[0] + k2 * t2[0], v1[1] + k2 * t2[1]];
        let rates = [number(1.0), k2, k3];
        let moving = [middle([zero, zero], rates[0], v1), middle(v1, k2, t2), middle(v3, k3, t3)];
        let heights = [knee[1].times(0.5), knee[1] + rod[1].times(0.5), joint[1] + last[1].times(0.5)];
        let (mut mass, mut potential) = (zero, zero);
        for (i, (m, l)) in [(1.0, l1), (1.5, l2), (1.0, l3)].into_iter().enumerate() {
            let square = moving[i][0] * moving[i][0] + moving[i][1] * moving[i][1];
            mass = mass + square.times(m) + (rates[i] * rates[i]).times(m * l * l / 12.0);
            potential += heights[i].times(m * 9.81);
        }
        [mass, potential]
    }
}

fn crank_alone(bounds: Option<Bounds>) -> f64 {
    let problem = between([1.0, 2.4], 1.0);
    let problem = match bounds {
        Some(bounds) => problem.with_bounds(bounds),
        None => problem,
    };
    let options = SolverOptions::default().with_tolerance(1e-8);
    let motion =
        DirectDynamics::new(Automatic::<Reduced<_>>::new(Reduced(Crank)), &problem).unwrap().solve(&options);
    let motion = motion.unwrap();
    assert!(motion.status.is_converged(), "{:?}", motion.status);
    motion.cost
}

#[test]
fn a_four_bar_linkage_costs_what_its_crank_alone_does() {
    let alone = crank_alone(None);
    assert!((alone - 21.8783428).abs() < 1e-6, "{alone}");
    let problem = crank(four_bar(), FREE);
    let solution = solved(&problem, 1e-9);
    assert_eq!(solution.motion.status, Status::Converged);
    assert!((solution.total() - 21.8783428).abs() < 2e-7, "{}", solution.total());
    assert!((solution.total() - alone).abs() < 1e-6, "{} {alone}", solution.total());
    assert!(solution.constraints[0].drift < 1e-8, "{}", solution.constraints[0].drift);
    assert!(solution.end_defect < 1e-6, "{}", solution.end_defect);
}

/// The loop of the URDF is closed by a revolute joint in space. Three of its five rows are redundant, and
/// have no forces.
#[test]
fn a_loop_of_a_urdf_costs_what_that_of_the_toml_file_does() {
    let robot = Robot::from_file("../robots/four_bar.urdf").unwrap();
    let solution = solved(&crank(robot, FREE), 1e-9);
    assert_eq!(solution.motion.status, Status::Converged);
    assert!((solution.total() - 21.878_342_8).abs() < 2e-7, "{}", solution.total());
    let [pivot] = &solution.constraints[..] else { panic!("one loop") };
    assert_eq!((&*pivot.name, &*pivot.frame, &*pivot.to), ("rocker_pivot", "rocker", "base"));
    assert!(pivot.drift < 1e-8, "{}", pivot.drift);
}

/// Forces, costates and H* of the motion are those of the constrained Hamiltonian at its states.
#[test]
fn forces_and_costates_are_those_of_the_constrained_hamiltonian() {
    let problem = crank(four_bar(), FREE);
    let solution = solved(&problem, 1e-8);
    let mut model = ConstrainedHamiltonian::<f64>::new(&problem.robot);
    let motion = &solution.trajectory;
    let forces = &solution.constraints[0];
    assert_eq!((&*forces.name, &*forces.frame, &*forces.to), ("rocker_pivot", "rocker_tip", "pivot"));
    assert_eq!(forces.force.len(), motion.t.len());
    for k in 0..motion.t.len() {
        let linear = model.linearise(&motion.q[k], &motion.p[k], &motion.u[k]).unwrap();
        // Momenta are those of the gauge that is zero at the start.
        for (found, expected) in linear.velocity().iter().zip(&motion.v[k]) {
            assert!((found - expected).abs() < 1e-5, "{k}: {found} {expected}");
        }
        for (row, lambda) in linear.lambda().iter().enumerate() {
            let found = forces.multipliers[k][row];
            assert!((found - lambda).abs() < 3e-3, "{k} {row}: {found} {lambda}");
            assert!((forces.force[k][row] - found).abs() < 1e-12);
        }
        let y: Vec<f64> = motion.y_q[k].iter().chain(&motion.y_p[k]).copied().collect();
        let power: f64 = y.iter().zip(linear.f()).map(|(y, f)| y * f).sum();
        let value = power - 0.5 * motion.u[k][0].powi(2);
        assert!((value - motion.hamiltonian[k]).abs() < 2e-2, "{k}: {value} {}", motion.hamiltonian[k]);
        assert!(
            (motion.u[k][0] - motion.y_p[k][0]).abs() < 2e-3,
            "{k}: {} {}",
            motion.u[k][0],
            motion.y_p[k][0]
        );
    }
    assert!(solution.motion.hamiltonian_drift < 1e-4, "{}", solution.motion.hamiltonian_drift);
}

/// The same loop as a pin in space, whose third row depends on the others.
#[test]
fn redundant_rows_change_nothing() {
    let pin = ConstraintSpec::pinned("pin", "rocker_tip", "pivot");
    let problem = crank(four_bar().without_constraints().with_constraint(pin).unwrap(), FREE);
    let solution = solved(&problem, 1e-8);
    assert_eq!(solution.motion.status, Status::Converged);
    assert!((solution.total() - 21.8783428).abs() < 1e-6, "{}", solution.total());
    assert!(solution.constraints[0].multipliers.iter().all(|rows| rows.len() == 3 && rows[2] == 0.0));
    assert_eq!(solution.constraints[0].redundant, [2]);
    let text = serde_json::to_string(&solution).unwrap();
    assert!(text.contains("\"redundant\":[2]"));
    let read: Solution = serde_json::from_str(&text).unwrap();
    assert_eq!(read.constraints, solution.constraints);
}

#[test]
fn limits_of_the_torque_are_kept() {
    let most = 11.0;
    let alone = crank_alone(Some(Bounds::symmetric(vec![most])));
    let problem = crank(four_bar(), most);
    let solution = solved(&problem, 1e-6);
    assert_eq!(solution.motion.status, Status::Converged);
    let largest = solution.trajectory.u.iter().map(|u| u[0].abs()).fold(0.0, f64::max);
    assert!(largest <= most * (1.0 + 1e-9) && largest > 0.999 * most, "{largest}");
    assert!((solution.total() / alone - 1.0).abs() < 3e-6, "{} {alone}", solution.total());
    assert!(solution.total() > 21.8783428, "the limit costs something");
}

/// Three motors move the platform of a delta robot, which three rods hold.
#[test]
fn a_delta_robot_moves_its_platform() {
    let robot = Robot::from_file("../robots/delta.toml").unwrap();
    let at = |x: [f64; 3]| {
        closed(&robot, &[0.3, 0.3, 0.3, x[0], x[1], x[2]], &[false, false, false, true, true, true])
    };
    let (from, to) = (at([-0.05, 0.02, -0.16]), at([0.05, -0.03, -0.14]));
    let most = 0.6;
    let problem = Problem::rest_to_rest(robot.clone(), &from, &to, 0.15)
        .with_cost(Objective::new(0.0, vec![1.0, 1.0, 1.0, 0.0, 0.0, 0.0]))
        .with_limits(MotionLimits::none().with_torque_max(vec![most, most, most, 0.0, 0.0, 0.0]));
    let solution = solved(&problem, 1e-7);
    assert_eq!(solution.motion.status, Status::Converged);
    // Torques have kinks between points where they reach limits: 5e-7 to 1.3e-4 for times that differ by
    // 1e-12.
    assert!(solution.end_defect < 4e-4, "{}", solution.end_defect);
    assert_eq!(solution.constraints.len(), 3);
    let mut rows = Constraints::<f64>::new(&robot);
    for (k, q) in solution.trajectory.q.iter().enumerate() {
        rows.set_position(q).unwrap();
        assert!(rows.values().iter().all(|g| g.abs() < 1e-6), "{k}: {:?}", rows.values());
        // A rod pulls and pushes along itself.
        for one in &solution.constraints {
            let force = one.force[k].iter().map(|f| f * f).sum::<f64>().sqrt();
            assert!((force - one.multipliers[k][0].abs()).abs() < 1e-5 * (1.0 + force), "{k}: {force}");
        }
        assert!(solution.trajectory.u[k][..3].iter().all(|u| u.abs() <= most * (1.0 + 1e-6)));
    }
}

/// The end may be that of the crank alone, time may be free, and the solution is one to begin with.
#[test]
fn the_crank_alone_says_where_a_linkage_ends() {
    let problem = crank(four_bar(), 30.0);
    assert!(problem.check_for(Method::Direct).is_ok());
    let end = problem.end.clone().with_q_free(&[1, 2]).with_v_free(&[1, 2]);
    let problem = problem.with_end(end).with_cost(Objective::new(20.0, vec![1.0, 0.0, 0.0]));
    let problem = problem.with_time(FinalTime::Free { guess: 1.0 });
    let solution = solved(&problem, 1e-7);
    assert_eq!(solution.motion.status, Status::Converged);
    assert!(solution.motion.hamiltonian.abs() < 1e-2, "{}", solution.motion.hamiltonian);
    let options = SolverOptions::default();
    let again = Solver::new(&problem, options).unwrap().with_start(&solution.trajectory).unwrap().solve();
    assert_eq!(again.motion.status, Status::Converged);
    assert!((again.total() / solution.total() - 1.0).abs() < 1e-5);
    let text = serde_json::to_string(&solution).unwrap();
    let read: Solution = serde_json::from_str(&text).unwrap();
    assert_eq!(read.constraints, solution.constraints);
    assert!(text.contains("\"drift\""));
}

#[test]
fn what_is_not_taken_is_refused_by_name() {
    let problem = crank(four_bar(), FREE);
    let refused = |problem: &Problem| Solver::new(problem, SolverOptions::default()).unwrap_err();
    let mut leads = problem.clone();
    leads.end.v[0] = 0.5;
    assert!(
        refused(&leads).to_string().starts_with("end.v: these rates change constraint 'rocker_pivot' by ")
    );
    let mut far = problem.clone();
    (far.end.q[1], far.end.q_free) = (1.5, vec![2]);
    assert!(
        refused(&far).to_string().starts_with("end.q: with what is given here the loops cannot be closed: ")
    );
    let free = problem.clone().with_start(problem.start.clone().with_q_free(&[1]));
    assert!(refused(&free).to_string().contains("constraint 'rocker_pivot', and motions of robots with"));
    let on_the_way = closed(&problem.robot, &[1.7, -0.6, -2.0], &[true, false, false]);
    let via = problem.clone().with_via(Via::at(&on_the_way));
    assert!(refused(&via).to_string().contains("rocker_pivot"));
    let jerk = problem.clone().with_limits(problem.limits.clone().with_jerk_max(vec![100.0; 3]));
    assert!(refused(&jerk).to_string().starts_with("limits.jerk_max: the robot has the constraint"));
    let expected = ProblemError::Constrained { constraint: "rocker_pivot".into() };
    assert_eq!(problem.check().unwrap_err(), expected);
    let unlimited =
        problem.clone().with_limits(MotionLimits::none()).with_cost(Objective::new(0.0, vec![1.0; 3]));
    let options = SolverOptions::default().with_method(Method::Collocation);
    assert_eq!(Solver::new(&unlimited, options).unwrap_err(), expected);
    assert_eq!(Resolve::new(&problem, SolverOptions::default()).unwrap_err(), expected);
    let other = ConstraintSpec::rows("wall", "rocker_tip", "pivot", &[ConstraintRow::X]);
    assert!(four_bar().with_constraint(other).is_ok());
}
