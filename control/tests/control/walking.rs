//! Steps of walking robots.
//!
//! The judges are a program of its own in other coordinates, and the impact of the library on its contacts.

use super::gaits::{example, keeps_its_limits, largest_difference, solved};
use costate::constraints::Impact;
use costate::contacts::{Contact, Stance};
use costate::hamiltonian::Hamiltonian;
use costate::kinematics::Kinematics;
use costate::robot::Robot;
use costate_control::{
    FinalTime, LimitUse, Objective, Problem, ProblemFile, Solution, SolverOptions, Status,
};
use std::sync::OnceLock;

pub(crate) const N: usize = 7;
pub(crate) const LENGTH: f64 = 0.5;
const TIME: f64 = 0.7;
pub(crate) const FRICTION: f64 = 0.6;
pub(crate) const CLEARANCE: f64 = 0.02;
/// Legs exchanged.
pub(crate) const EXCHANGE: [usize; N] = [0, 1, 2, 5, 6, 3, 4];

pub(crate) fn file() -> ProblemFile {
    example("rabbit_walk")
}

/// The motion of the example, solved once for all tests.
pub(crate) fn walk() -> &'static (Problem, Solution) {
    static WALK: OnceLock<(Problem, Solution)> = OnceLock::new();
    WALK.get_or_init(|| {
        let file = file();
        let solution = solved(&file.problem, file.options.clone());
        (file.problem, solution)
    })
}

pub(crate) fn exchanged(list: &[f64]) -> Vec<f64> {
    EXCHANGE.iter().map(|&i| list[i]).collect()
}

fn on(robot: &Robot, foot: &str) -> Stance {
    Stance::new(robot, &[Contact::point("foot", foot).planar().friction(FRICTION)]).unwrap()
}

#[test]
fn rabbit_walks() {
    let (problem, solution) = walk();
    assert_eq!(solution.motion.status, Status::Converged);
    // benches/ocp/harness/walking.py, by CasADi and IPOPT: collocation at three Gauss points of 20 intervals,
    // in the angles of the five links of a robot that is pinned at its foot, and with the impact in seven
    // coordinates: 195.395269664.
    assert!((solution.total() - 195.3952697).abs() < 2e-5, "{}", solution.total());
    let gait = solution.gait.as_ref().unwrap();
    let [impulse] = gait.impulses[..] else { panic!("{gait:?}") };
    assert!(largest_difference(&impulse, &[-13.950956, 0.0, 29.055444]) < 1e-3, "{impulse:?}");
    assert!((gait.speed - LENGTH / TIME).abs() < 1e-9, "{gait:?}");
    assert!(gait.miss < 1e-6, "{gait:?}");
    assert_eq!(gait.cost_of_transport, gait.work / gait.weight_times_length);
    // After a step the robot has its energy again: what motors add is what they and the landing take.
    assert!(gait.loss > 0.0 && gait.braking > 0.0, "{gait:?}");
    assert!((gait.work - gait.braking - gait.loss).abs() < 1e-5 * gait.work, "{gait:?}");
    // 40 kg.
    assert!((gait.weight_times_length - 40.0 * 9.81 * LENGTH).abs() < 1e-9, "{gait:?}");
    assert!(solution.end_defect < 1e-3, "{}", solution.end_defect);
    let motion = &solution.trajectory;
    let (first, last) = (0, motion.t.len() - 1);
    let mut back = exchanged(&motion.q[last]);
    back[0] -= LENGTH;
    assert!(largest_difference(&back, &motion.q[first]) < 1e-9, "{back:?} {:?}", motion.q[first]);
    keeps_its_limits(problem, motion);
}

#[test]
fn the_ground_bears_what_the_feet_press() {
    let (_, solution) = walk();
    let [foot] = &solution.constraints[..] else { panic!("{:?}", solution.constraints) };
    assert_eq!((&*foot.name, &*foot.frame), ("right_foot", "right_foot"));
    assert!(foot.drift < 1e-6, "{}", foot.drift);
    let motion = &solution.trajectory;
    let mut impulse = 0.0;
    for (k, [x, y, z]) in foot.force.iter().enumerate() {
        assert!(*y == 0.0 && *z > -1e-3 && x.abs() <= FRICTION * z + 1e-2, "{k}: {x} {y} {z}");
        if k > 0 {
            impulse += 0.5 * (motion.t[k] - motion.t[k - 1]) * (z + foot.force[k - 1][2]);
        }
    }
    // They are limits of their own, none of a joint's accelerations or rates, which have none.
    let limits = &solution.limits;
    assert!(limits.acceleration.is_none() && limits.rate.is_none());
    for kind in [&limits.ground_force, &limits.landing_impulse] {
        let LimitUse { at_points, worst, .. } = kind.as_ref().unwrap();
        assert!(*at_points < 1e-4 && worst.is_none(), "{kind:?}");
    }
    let [x, _, z] = solution.gait.as_ref().unwrap().impulses[0];
    assert!(z > 0.0 && x.abs() <= FRICTION * z * (1.0 + 1e-6), "{x} {z}");
    // Over a step the vertical momentum comes back: landing and standing bear the weight.
    let weight = 40.0 * 9.81 * TIME;
    assert!((impulse + z - weight).abs() < 1e-2 * weight, "{impulse} {z} {weight}");
}

#[test]
fn the_foot_that_swings_clears_the_ground() {
    let (problem, solution) = walk();
    let clearance = problem.gait.as_ref().unwrap().clearance;
    let mut kinematics = Kinematics::<f64>::new(&problem.robot);
    let swing = problem.robot.frame_index("left_foot").unwrap();
    let mut most = 0.0_f64;
    for q in &solution.trajectory.q {
        kinematics.set_position(q).unwrap();
        let [x, _, z] = kinematics.pose(swing).unwrap().position;
        let part = x / LENGTH;
        assert!(z - clearance * (1.0 - part * part) > -1e-5, "{x} {z}");
        most = most.max(z);
    }
    assert!(most > clearance * 0.9, "{most}");
}

/// The state after the other foot has landed on a contact of the library is the one at the start, with the
/// legs exchanged; what the ground gives to the foot is all that changes the momentum.
#[test]
fn the_gait_closes() {
    let (problem, solution) = walk();
    let (robot, motion) = (&problem.robot, &solution.trajectory);
    let last = motion.t.len() - 1;
    let (q, v) = (&motion.q[last], &motion.v[last]);
    // The foot that stands lets go before the other one lands.
    let before = Hamiltonian::<f64>::new(robot).momentum(q, v).unwrap().to_vec();
    let landing = on(robot, "left_foot");
    let mut impact = Impact::<f64>::new(landing.robot());
    let after = impact.evaluate(q, &before).unwrap();
    let miss = largest_difference(&exchanged(after.velocity), &motion.v[0]);
    assert!(miss < 1e-6, "{miss}");
    let force = landing.wrench(0, after.impulse).0;
    let jump = after.momentum[1] - before[1];
    assert!((jump - force[2]).abs() < 1e-9, "{jump} {force:?}");
}

/// With the other foot on the ground the motion has its legs exchanged, where a limit is used up too.
#[test]
fn the_other_foot_stands() {
    let (problem, best) = walk();
    let largest = |motion: &Solution, joint: usize| {
        motion.trajectory.u.iter().fold(0.0_f64, |most, u| most.max(u[joint].abs()))
    };
    // A motor of both legs is weaker than the cheapest gait needs it.
    let weak = (3..N).max_by(|&a, &b| largest(best, a).total_cmp(&largest(best, b))).unwrap();
    let mut right = problem.clone();
    let mut most = right.limits.torque_max.clone().unwrap();
    (most[weak], most[EXCHANGE[weak]]) = (0.8 * largest(best, weak), 0.8 * largest(best, weak));
    right.limits.torque_max = Some(most.clone());
    right.cost.effort = vec![0.0, 0.0, 0.0, 1.0, 1.1, 1.0, 1.1];
    let mut left = right.clone();
    left.start.q = exchanged(&right.start.q);
    let gait = left.gait.as_mut().unwrap();
    std::mem::swap(&mut gait.stance, &mut gait.swing);
    let motions = [&right, &left].map(|problem| solved(problem, file().options));
    for (motion, joint) in motions.iter().zip([weak, EXCHANGE[weak]]) {
        assert_eq!(motion.motion.status, Status::Converged);
        assert!((largest(motion, joint) / most[weak] - 1.0).abs() < 1e-4, "{}", largest(motion, joint));
    }
    let costs = motions.each_ref().map(Solution::total);
    assert!((costs[1] / costs[0] - 1.0).abs() < 1e-6 && costs[0] > best.total(), "{costs:?}");
    let times: Vec<f64> = (0..=50).map(|k| TIME * f64::from(k) / 50.0).collect();
    let [on_right, on_left] =
        [(&motions[0], &right), (&motions[1], &left)].map(|(one, of)| one.sample_at(of, &times).unwrap());
    for (q, other) in on_right.q.iter().zip(&on_left.q) {
        assert!(largest_difference(q, &exchanged(other)) < 1e-4, "{q:?} {other:?}");
    }
}

/// The largest friction that a gait uses (forces of less than 1 N do not count).
fn used(solution: &Solution) -> f64 {
    let forces = solution.constraints[0].force.iter().filter(|[_, _, z]| *z > 1.0);
    forces.map(|[x, _, z]| x.abs() / z).fold(0.0_f64, f64::max)
}

/// A friction that is too little for the example, and the motion with it, solved once for all tests.
pub(crate) fn slippery() -> &'static (f64, Solution) {
    static SLIPPERY: OnceLock<(f64, Solution)> = OnceLock::new();
    SLIPPERY.get_or_init(|| {
        let (problem, best) = walk();
        let friction = 0.8 * used(best);
        let gait = problem.gait.clone().unwrap().with_friction(friction);
        (friction, solved(&problem.clone().with_gait(gait), file().options))
    })
}

/// Less friction costs more, and is kept.
#[test]
fn slippery_ground_costs_more() {
    let ((_, best), (least, solution)) = (walk(), slippery());
    assert_eq!(solution.motion.status, Status::Converged);
    assert!(solution.total() > best.total() * (1.0 + 1e-6), "{} {}", solution.total(), best.total());
    assert!(used(solution) < least * 1.02, "{} {least}", used(solution));
}

/// A free time is that of the best speed.
#[test]
fn a_step_of_free_time_has_the_best_speed() {
    let (problem, _) = walk();
    let free = problem.clone().with_time(FinalTime::Free { guess: TIME });
    let best = solved(&free, file().options);
    assert_eq!(best.motion.status, Status::Converged);
    let time = best.motion.final_time;
    assert!((best.gait.as_ref().unwrap().speed - LENGTH / time).abs() < 1e-9);
    let costs = [0.97, 1.03].map(|factor| {
        let fixed = problem.clone().with_time(FinalTime::Fixed(factor * time));
        let other = solved(&fixed, file().options);
        assert_eq!(other.motion.status, Status::Converged);
        other.total()
    });
    println!("{} {costs:?}", best.total());
    assert!(costs.iter().all(|&cost| cost > best.total()), "{costs:?} {}", best.total());
}

/// With all energy as the cost, the free time is that of the least cost of transport.
#[test]
fn the_best_speed_has_the_least_cost_of_transport() {
    let motors = |weight: f64| [vec![0.0; 3], vec![weight; 4]].concat();
    let cost = Objective::new(40.0, motors(0.1)).with_energy(motors(1.0)).with_energy_smoothing(0.1);
    let options = SolverOptions::default().with_tolerance(1e-4);
    let at = |time: FinalTime| {
        let problem = file().problem.with_cost(cost.clone()).with_time(time);
        let solution = solved(&problem, options.clone());
        assert_eq!(solution.motion.status, Status::Converged);
        let (gait, time) = (solution.gait.as_ref().unwrap(), solution.motion.final_time);
        // Work is a part of the cost, of which the smoothed power gives half of its smoothing back at most.
        let others = solution.total() - 40.0 * time + 4.0 * 0.05 * time;
        assert!(gait.work > 0.0 && gait.work < others, "{gait:?} {others}");
        (gait.speed, solution.total() / gait.weight_times_length)
    };
    let (speed, least) = at(FinalTime::Free { guess: 0.8 });
    for factor in [0.8, 1.25] {
        let (other, cost) = at(FinalTime::Fixed(LENGTH / (factor * speed)));
        assert!(cost > least && (other / speed - factor).abs() < 1e-9, "{factor}: {cost} {least}");
    }
}
