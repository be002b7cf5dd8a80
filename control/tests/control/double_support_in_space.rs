//! Steps of the biped in space that begin on both soles: the foot behind rolls on the edge of its toe, or
//! stays flat.
//!
//! The judges are forward dynamics with contacts, frames and the impact of the library, none of which the
//! solver uses; the edge of a toe is two points there, each held along all axes.

use super::gaits::{ROWS, example, is_best_duration, largest_difference, lift_off, solved};
use super::plane_twins::Twins;
use super::space_walk::{inside, mirrored};
use costate::constraints::{ConstrainedLagrangian, Impact};
use costate::contacts::{Contact, Stance};
use costate::hamiltonian::Hamiltonian;
use costate::kinematics::{Kinematics, Pose};
use costate::robot::Placement;
use costate_control::{FinalTime, Gait, Problem, SoleContact, Solution, SolverOptions, Status, Verify};
use nalgebra::Vector3;
use std::sync::OnceLock;

/// Coordinates of the base.
const BASE: usize = 6;

/// The example with soles behind that stand so.
fn step(trailing: SoleContact) -> Problem {
    let problem = example("biped_double_support").problem;
    let gait = problem.gait.clone().unwrap().with_trailing(trailing);
    problem.with_gait(gait)
}

/// Those of the example but for the tolerance, the first mesh and what is solved again.
fn options() -> SolverOptions {
    let options = example("biped_double_support").options;
    options.with_tolerance(1e-4).with_nodes(49).with_verify(Verify::Factors)
}

fn solve(problem: &Problem) -> Solution {
    let solution = solved(problem, options());
    assert_eq!(solution.motion.status, Status::Converged);
    solution
}

/// The motion of the example, solved once for all tests.
fn walk() -> &'static (Problem, Solution) {
    static WALK: OnceLock<(Problem, Solution)> = OnceLock::new();
    WALK.get_or_init(|| {
        let problem = example("biped_double_support").problem;
        let solution = solve(&problem);
        (problem, solution)
    })
}

/// y of the corners of a sole.
fn sides(gait: &Gait) -> [f64; 2] {
    [0.5 * gait.sole_width, -0.5 * gait.sole_width]
}

/// The contacts of a foot that stands so.
fn contacts(gait: &Gait, foot: &str, contact: SoleContact) -> Vec<Contact> {
    let [_, toe] = gait.sole.unwrap();
    let corner = |y: f64| {
        let at = Placement::from_xyz_rpy([toe, y, 0.0], [0.0; 3]);
        Contact::point(format!("{foot} {y}"), foot).placed(at)
    };
    match contact {
        SoleContact::Toe => sides(gait).map(corner).to_vec(),
        _ => vec![Contact::foot(foot, foot)],
    }
}

/// What stands in double support: the front foot, the foot behind, or the corners of its toe.
fn both(problem: &Problem, [front, behind]: [&str; 2]) -> Stance {
    let gait = problem.gait.as_ref().unwrap();
    let feet = [contacts(gait, front, SoleContact::Flat), contacts(gait, behind, gait.trailing)].concat();
    Stance::new(&problem.robot, &feet).unwrap()
}

/// Force and moment of the ground on the foot behind, at the middle of its toe if it stands on that; and how
/// far they are inside of its cone, in parts of a weight.
fn behind(gait: &Gait, stance: &Stance, lambda: &[f64], weight: f64) -> ([f64; 3], [f64; 3], f64) {
    if gait.trailing == SoleContact::Flat {
        let (force, moment) = stance.wrench(1, lambda);
        return (force, moment, inside(gait, force.into(), moment.into(), weight));
    }
    let corners = [1, 2].map(|corner| Vector3::from(stance.wrench(corner, lambda).0));
    let arms = sides(gait).map(|y| Vector3::new(0.0, y, 0.0));
    let (force, mu) = (corners[0] + corners[1], gait.friction);
    let moment = arms[0].cross(&corners[0]) + arms[1].cross(&corners[1]);
    // The edge is stiff: forces along it count together.
    let least = corners.iter().map(|corner| (mu * corner.z - corner.x.abs()).min(corner.z));
    let least = least.fold(mu * force.z - force.y.abs(), f64::min) / weight;
    (force.into(), moment.into(), least)
}

/// A point of a foot.
fn point(pose: &Pose<f64>, x: f64, y: f64) -> [f64; 3] {
    [0, 1, 2].map(|row| pose.position[row] + x * pose.rotation[row][0] + y * pose.rotation[row][1])
}

/// Whether a step keeps what the ground asks for; the largest forces upward on both feet (N).
fn check(problem: &Problem, solution: &Solution) -> [f64; 2] {
    let (gait, motion) = (problem.gait.as_ref().unwrap(), &solution.trajectory);
    let lift_off = lift_off(solution);
    assert!((lift_off - gait.double_support.unwrap() * solution.motion.final_time).abs() < 1e-12);
    let feet = [&*gait.stance[0], &*gait.swing[0]];
    let single = contacts(gait, feet[0], SoleContact::Flat);
    let stances = [both(problem, feet), Stance::new(&problem.robot, &single).unwrap()];
    let mut models = stances.each_ref().map(|stance| ConstrainedLagrangian::<f64>::new(stance.robot()));
    let weight = solution.gait.as_ref().unwrap().weight_times_length / gait.length;
    // At the points the forces that are told are those of forward dynamics, and in their cones.
    let mut largest = [0.0_f64; 2];
    for k in (0..motion.t.len()).filter(|k| (1..ROWS - 1).contains(&(k % ROWS))) {
        let phase = usize::from(motion.t[k] > lift_off);
        let u = [&[0.0; BASE], &motion.u[k][BASE..]].concat();
        let (_, lambda) = models[phase].evaluate(&motion.q[k], &motion.v[k], &u).unwrap();
        let (force, moment) = stances[phase].wrench(0, lambda);
        let mut found = vec![(force, moment, inside(gait, force.into(), moment.into(), weight))];
        if phase == 0 {
            found.push(behind(gait, &stances[0], lambda, weight));
        }
        for (foot, (force, moment, least)) in found.iter().enumerate() {
            let told = &solution.constraints[foot];
            let miss = largest_difference(&told.force[k], force);
            let miss = miss.max(largest_difference(&told.moment[k], moment));
            assert!(miss < 1e-4 * weight, "{k} {foot}: {miss}");
            assert!(*least > -1e-4, "{k} {foot}: {least}");
            largest[foot] = largest[foot].max(force[2]);
        }
        let idle = solution.constraints[2 - phase..]
            .iter()
            .map(|foot| largest_difference(&foot.force[k], &[0.0; 3]));
        assert!(idle.fold(0.0, f64::max) < 1e-6);
    }
    // What stands does not move, and no corner sinks into the ground.
    let mut kinematics = Kinematics::<f64>::new(&problem.robot);
    let indices = feet.map(|foot| problem.robot.frame_index(foot).unwrap());
    let times: Vec<f64> =
        (0..1000).map(|k| solution.motion.final_time * (f64::from(k) + 0.5) / 1000.0).collect();
    let samples = solution.sample_at(problem, &times).unwrap();
    let ([heel, toe], side) = (gait.sole.unwrap(), 0.5 * gait.width);
    let places = [[0.0, -side], [-gait.length, side]];
    let (mut moved, mut lowest) = (0.0_f64, 0.0_f64);
    for (t, q) in times.iter().zip(&samples.q) {
        kinematics.set_position(q).unwrap();
        for (foot, [ahead, across]) in places.into_iter().enumerate() {
            let pose = kinematics.pose(indices[foot]).unwrap();
            let swings = foot == 1 && *t > lift_off;
            let stands_on = |x: f64| !swings && (x == toe || foot == 0 || gait.trailing == SoleContact::Flat);
            for (x, y) in [heel, toe].into_iter().flat_map(|x| sides(gait).map(|y| (x, y))) {
                let at = point(&pose, x, y);
                match stands_on(x) {
                    true => moved = moved.max(largest_difference(&at, &[ahead + x, across + y, 0.0])),
                    false => lowest = lowest.min(at[2]),
                }
            }
        }
    }
    println!("moved {moved:.1e} lowest {lowest:.1e} largest {largest:?}");
    assert!(moved < 1e-4 && lowest > -1e-4, "{moved} {lowest}");
    is_at_rest(problem, solution, weight);
    largest
}

/// The landing, by the impact of the library on all that stands then, has no impulse.
fn is_at_rest(problem: &Problem, solution: &Solution, weight: f64) {
    let (gait, motion) = (problem.gait.as_ref().unwrap(), &solution.trajectory);
    let (q, v) = (motion.q.last().unwrap(), motion.v.last().unwrap());
    let before = Hamiltonian::<f64>::new(&problem.robot).momentum(q, v).unwrap().to_vec();
    let landing = both(problem, [&gait.swing[0], &gait.stance[0]]);
    let mut impact = Impact::<f64>::new(landing.robot());
    let after = impact.evaluate(q, &before).unwrap();
    for contact in 0..landing.contacts().len() {
        let impulse = landing.wrench(contact, after.impulse).0;
        assert!(largest_difference(&impulse, &[0.0; 3]) < 1e-4 * weight, "{impulse:?}");
    }
    let miss = largest_difference(&mirrored(after.velocity), &motion.v[0]);
    assert!(miss < 1e-4, "{miss}");
}

#[test]
fn the_foot_behind_rolls_on_the_edge_of_its_toe() {
    let (problem, solution) = walk();
    let largest = check(problem, solution);
    let weight = solution.gait.as_ref().unwrap().weight_times_length / problem.gait.as_ref().unwrap().length;
    assert!(largest.iter().all(|z| *z > 0.2 * weight), "{largest:?}");
    // At lift-off its heel is up, and it has turned about the edge alone.
    let mut kinematics = Kinematics::<f64>::new(&problem.robot);
    let samples = solution.sample_at(problem, &[lift_off(solution)]).unwrap();
    kinematics.set_position(&samples.q[0]).unwrap();
    let foot = kinematics.pose(problem.robot.frame_index("left_foot").unwrap()).unwrap();
    assert!(foot.rotation[2][0] < -0.05, "{:?}", foot.rotation);
    assert!((foot.rotation[1][1] - 1.0).abs() < 1e-6, "{:?}", foot.rotation);
    // Six rows are told of the foot in front, the force of the other one.
    let told: Vec<usize> = solution.constraints.iter().map(|foot| foot.multipliers[0].len()).collect();
    assert_eq!(told, [6, 3]);
}

#[test]
fn both_soles_stand_flat_and_then_one_swings() {
    let flat = step(SoleContact::Flat);
    let solution = solve(&flat);
    let largest = check(&flat, &solution);
    let weight = solution.gait.as_ref().unwrap().weight_times_length / flat.gait.as_ref().unwrap().length;
    assert!(largest.iter().all(|z| *z > 0.2 * weight), "{largest:?}");
    // To stay flat costs more than to roll.
    assert!(solution.total() > 1.5 * walk().1.total(), "{}", solution.total());
}

/// A robot whose hips and masses are in one plane rolls on its toe as the planar one does: its rows, its cone
/// and its impact are others, with other unknowns.
#[test]
fn in_a_plane_it_is_the_planar_robot() {
    let twins = Twins::of(&walk().0);
    twins.agree(&solve(&twins.in_space), &solve(&twins.in_plane));
}

/// The best duration costs less than those beside it, and J has no slope there.
#[test]
fn the_best_duration_is_found() {
    let (problem, given) = walk();
    let free = solve(&problem.clone().with_time(FinalTime::Free { guess: given.motion.final_time }));
    check(problem, &free);
    is_best_duration(problem, &options(), &free);
}
