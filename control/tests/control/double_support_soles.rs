//! Steps of bipeds with soles that begin on both feet: the foot behind rolls on its toe, or stays flat.
//!
//! The judges are forward dynamics with contacts, frames and impacts of the library, none of which the solver
//! uses.

use super::gaits::{
    ROWS, example, integrated, is_best_duration, keeps_its_limits, largest_difference, least_energy,
    lift_off, solved,
};
use super::soles::{N, exchanged};
use costate::constraints::{ConstrainedLagrangian, Impact};
use costate::contacts::{Contact, Stance};
use costate::hamiltonian::Hamiltonian;
use costate::kinematics::Kinematics;
use costate::robot::{LoadOptions, Placement};
use costate_control::{
    Gait, GaitError, Problem, ProblemError, ProblemFile, SoleContact, Solution, Solver, SolverOptions,
    Status, Trajectory, Verify,
};
use std::sync::OnceLock;

fn file() -> ProblemFile {
    example("seven_link_double_support")
}

fn gait() -> Gait {
    file().problem.gait.unwrap()
}

fn with(gait: Gait) -> Problem {
    file().problem.with_gait(gait)
}

fn solve(problem: &Problem, options: SolverOptions) -> Solution {
    let solution = solved(problem, options);
    assert_eq!(solution.motion.status, Status::Converged);
    check(problem, &solution);
    solution
}

/// The motion of the example, solved once for all tests.
fn walk() -> &'static (Problem, Solution) {
    static WALK: OnceLock<(Problem, Solution)> = OnceLock::new();
    WALK.get_or_init(|| {
        let file = file();
        let solution = solve(&file.problem, file.options.clone());
        (file.problem, solution)
    })
}

/// The feet that stand in both phases: the front one flat, the other one as the gait says.
fn stances(problem: &Problem) -> [Stance; 2] {
    let gait = problem.gait.as_ref().unwrap();
    let front = Contact::foot("front", &gait.stance[0]).planar();
    let behind = behind(gait, &gait.swing[0]);
    [vec![front.clone(), behind], vec![front]].map(|feet| Stance::new(&problem.robot, &feet).unwrap())
}

/// A foot as it stands behind.
fn behind(gait: &Gait, foot: &str) -> Contact {
    let [_, toe] = gait.sole.unwrap();
    match gait.trailing {
        SoleContact::Toe => {
            let at = Placement::from_xyz_rpy([toe, 0.0, 0.0], [0.0; 3]);
            Contact::point("behind", foot).planar().placed(at)
        }
        _ => Contact::foot("behind", foot).planar(),
    }
}

/// How far force and moment about the origin of a sole are outside of the cone of forces on heel and toe (N).
fn outside(gait: &Gait, [x, _, z]: [f64; 3], moment: f64) -> f64 {
    let [heel, toe] = gait.sole.unwrap();
    let on_heel = (toe * z + moment) / (toe - heel);
    let on_toe = z - on_heel;
    let small = [gait.friction * z - x.abs(), on_heel, on_toe];
    small.into_iter().fold(0.0, |most, inside| most.max(-inside))
}

/// Whether a step keeps what the ground asks for, at 2000 instants that are no points of its mesh.
fn check(problem: &Problem, solution: &Solution) {
    let gait = problem.gait.as_ref().unwrap();
    let ([heel, toe], mu) = (gait.sole.unwrap(), gait.friction);
    let time = solution.motion.final_time;
    let times: Vec<f64> = (0..2000).map(|k| time * (f64::from(k) + 0.5) / 2000.0).collect();
    let samples = solution.sample_at(problem, &times).unwrap();
    let stances = stances(problem);
    let mut models = stances.each_ref().map(|stance| ConstrainedLagrangian::<f64>::new(stance.robot()));
    let mut kinematics = Kinematics::<f64>::new(&problem.robot);
    let feet = [&gait.stance[0], &gait.swing[0]].map(|foot| problem.robot.frame_index(foot).unwrap());
    let weight = solution.gait.as_ref().unwrap().weight_times_length / gait.length;
    let is_flat = gait.trailing == SoleContact::Flat;
    let (mut lowest, mut moved, mut off, mut lifted) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0);
    for (k, (q, (v, u))) in samples.q.iter().zip(samples.v.iter().zip(&samples.u)).enumerate() {
        let phase = usize::from(times[k] > lift_off(solution));
        let u = [&[0.0; 3], &u[3..]].concat();
        let (_, lambda) = models[phase].evaluate(q, v, &u).unwrap();
        let (force, [_, moment, _]) = stances[phase].wrench(0, lambda);
        off = off.max(outside(gait, force, moment));
        lifted += force[2] * time / 2000.0;
        if phase == 0 {
            let ([x, _, z], [_, moment, _]) = stances[0].wrench(1, lambda);
            lifted += z * time / 2000.0;
            off = off.max(x.abs() - mu * z);
            if is_flat {
                off = off.max(outside(gait, [x, 0.0, z], moment));
            }
        }
        kinematics.set_position(q).unwrap();
        let flat = kinematics.pose(feet[0]).unwrap();
        moved = flat.position.iter().fold(moved, |most, x| most.max(x.abs()));
        moved = moved.max(flat.rotation[2][0].abs());
        let foot = kinematics.pose(feet[1]).unwrap();
        for corner in [heel, toe] {
            let [x, z] = [0, 2].map(|row| foot.position[row] + corner * foot.rotation[row][0]);
            let part = (x - corner) / gait.length;
            match phase == 0 && (corner == toe || is_flat) {
                true => moved = moved.max((x - corner + gait.length).abs()).max(z.abs()),
                false if phase == 0 => lowest = lowest.min(z),
                false => lowest = lowest.min(z - gait.clearance * (1.0 - part * part)),
            }
        }
    }
    println!("lowest {lowest:.1e} moved {moved:.1e} off {off:.1e} N");
    assert!(lowest > -1e-5 && moved < 1e-5, "{lowest} {moved}");
    assert!(off < 2e-3 * weight, "{off}");
    // Over a step the vertical momentum comes back.
    assert!((lifted / (weight * time) - 1.0).abs() < 1e-3, "{lifted}");
    keeps_its_limits(problem, &solution.trajectory);
    is_at_rest(problem, solution);
}

/// The landing, by the impact of the library on both feet, has no impulse.
fn is_at_rest(problem: &Problem, solution: &Solution) {
    let (gait, motion) = (problem.gait.as_ref().unwrap(), &solution.trajectory);
    let (q, v) = (motion.q.last().unwrap(), motion.v.last().unwrap());
    let before = Hamiltonian::<f64>::new(&problem.robot).momentum(q, v).unwrap().to_vec();
    let feet = [Contact::foot("front", &gait.swing[0]).planar(), behind(gait, &gait.stance[0])];
    let landing = Stance::new(&problem.robot, &feet).unwrap();
    let mut impact = Impact::<f64>::new(landing.robot());
    let after = impact.evaluate(q, &before).unwrap();
    for foot in 0..2 {
        let impulse = landing.wrench(foot, after.impulse).0;
        assert!(largest_difference(&impulse, &[0.0; 3]) < 1e-5, "{impulse:?}");
    }
    let miss = largest_difference(&exchanged(after.velocity), &motion.v[0]);
    let mut back = exchanged(q);
    back[0] -= gait.length;
    assert!(miss < 1e-5 && largest_difference(&back, &motion.q[0]) < 1e-9, "{miss} {back:?}");
}

#[test]
fn a_biped_rolls_on_its_toe() {
    let (problem, solution) = walk();
    let gait = solution.gait.as_ref().unwrap();
    let time = solution.motion.final_time;
    assert!((lift_off(solution) - 0.2 * time).abs() < 1e-12 && gait.miss < 1e-6, "{gait:?}");
    assert_eq!(gait.double_support, Some(lift_off(solution)));
    assert!((gait.work - gait.braking).abs() < 1e-4 * gait.work && gait.loss.abs() < 1e-9, "{gait:?}");
    // At lift-off the foot stands on its toe.
    let mut kinematics = Kinematics::<f64>::new(&problem.robot);
    let samples = solution.sample_at(problem, &[lift_off(solution)]).unwrap();
    kinematics.set_position(&samples.q[0]).unwrap();
    let foot = kinematics.pose(problem.robot.frame_index("left_foot").unwrap()).unwrap();
    assert!(foot.rotation[2][0] < -0.05, "{:?}", foot.rotation);
    // The forces of both feet are told, that on the toe as one of a point.
    let [front, behind] = &solution.constraints[..] else { panic!("{:?}", solution.constraints) };
    assert_eq!([&*front.name, &*behind.name], ["right_foot", "left_foot"]);
    assert_eq!([front.multipliers[0].len(), behind.multipliers[0].len()], [3, 2]);
    let released = solution.trajectory.t.iter().position(|t| *t == lift_off(solution)).unwrap() + 1;
    assert!(behind.force[released..].iter().flatten().all(|force| force.abs() < 1e-6));
    let most = behind.force.iter().fold(0.0_f64, |most, force| most.max(force[2]));
    assert!(most > 0.2 * 70.0 * 9.81, "{most}");
}

/// At the points of the mesh the forces that are told are those of forward dynamics on the feet that stand.
#[test]
fn forces_are_those_of_forward_dynamics() {
    let (problem, solution) = walk();
    let (stances, motion) = (stances(problem), &solution.trajectory);
    let mut models = stances.each_ref().map(|stance| ConstrainedLagrangian::<f64>::new(stance.robot()));
    for k in (0..motion.t.len()).filter(|k| (1..ROWS - 1).contains(&(k % ROWS))) {
        let phase = usize::from(motion.t[k] > lift_off(solution));
        let u = [&[0.0; 3], &motion.u[k][3..]].concat();
        let (_, lambda) = models[phase].evaluate(&motion.q[k], &motion.v[k], &u).unwrap();
        for (foot, told) in solution.constraints.iter().enumerate().take(2 - phase) {
            let (force, moment) = stances[phase].wrench(foot, lambda);
            assert!(largest_difference(&told.force[k], &force) < 1e-2, "{k}: {:?} {force:?}", told.force[k]);
            assert!(largest_difference(&told.moment[k], &moment) < 1e-2, "{k}: {moment:?}");
        }
    }
}

/// The torques of the motion, integrated with forward dynamics on the feet that stand, lead along it, and the
/// whole comes back to the start as far as a motion does that is unstable without feedback.
#[test]
fn a_step_integrated_comes_back_to_its_start() {
    let (problem, solution) = walk();
    let (stances, motion) = (stances(problem), &solution.trajectory);
    let mut models = stances.each_ref().map(|stance| ConstrainedLagrangian::<f64>::new(stance.robot()));
    let mut end_of = |motion: &Trajectory| {
        integrated(motion, |middle, q, v, tau| {
            let model = &mut models[usize::from(middle > lift_off(solution))];
            model.evaluate(q, v, tau).unwrap().0.to_vec()
        })
    };
    let (mut largest, rows) = (0.0_f64, motion.t.len());
    for first in (0..rows).step_by(10 * ROWS) {
        let last = (first + 10 * ROWS).min(rows);
        let mut part = motion.clone();
        part.t = motion.t[first..last].to_vec();
        part.q = motion.q[first..last].to_vec();
        part.v = motion.v[first..last].to_vec();
        part.u = motion.u[first..last].to_vec();
        let expected = [&motion.q[last - 1][..], &motion.v[last - 1]].concat();
        largest = largest.max(largest_difference(&end_of(&part), &expected));
    }
    let x = end_of(motion);
    let mut back = exchanged(&x[..N]);
    back[0] -= gait().length;
    let miss = largest_difference(&back, &motion.q[0]);
    let miss = miss.max(largest_difference(&exchanged(&x[N..]), &motion.v[0]));
    println!("integrated: {largest:.1e} in parts, {miss:.1e} at the end");
    assert!(largest < 1e-4 && miss < 2e-2, "{largest} {miss}");
}

/// From other first meshes, more coarsely, the motion is the same; of another part it is another one.
#[test]
fn first_meshes_lead_to_the_same_step() {
    let (problem, best) = walk();
    let options = file().options.with_tolerance(1e-5).with_verify(Verify::Factors);
    let other = solve(problem, options.clone().with_nodes(97));
    assert!((other.total() / best.total() - 1.0).abs() < 1e-5, "{}", other.total());
    let short = solve(&with(gait().with_double_support(0.1)), options);
    assert!((lift_off(&short) - 0.06).abs() < 1e-12 && short.total() > 1.02 * best.total());
}

/// With a price of time, both phases stretch in proportion to the best duration.
#[test]
fn the_best_duration_is_found() {
    let (problem, options) =
        (least_energy(&walk().0, 0.8), file().options.with_tolerance(1e-4).with_verify(Verify::Factors));
    let free = solve(&problem, options.clone());
    assert!((lift_off(&free) - 0.2 * free.motion.final_time).abs() < 1e-12);
    is_best_duration(&problem, &options, &free);
}

/// A foot that has to stay flat behind costs more.
#[test]
fn a_foot_that_stays_flat_costs_more() {
    let flat = with(gait().with_trailing(SoleContact::Flat));
    let flat = solve(&flat, file().options.with_tolerance(1e-4).with_nodes(49).with_verify(Verify::Factors));
    assert!(flat.total() > 2.0 * walk().1.total(), "{}", flat.total());
    assert_eq!(flat.constraints[1].multipliers[0].len(), 3);
}

#[test]
fn what_is_no_way_to_stand_behind_is_refused_by_name() {
    let refused = |gait: Gait| match Solver::new(&with(gait), SolverOptions::default()).unwrap_err() {
        ProblemError::Gait { key, cause } => (key.to_string(), *cause),
        other => panic!("{other}"),
    };
    let flat = gait().with_trailing(SoleContact::Flat);
    let (mut on_points, mut without) = (flat.clone(), flat);
    (on_points.sole, without.double_support) = (None, None);
    for gait in [on_points, without] {
        assert_eq!(refused(gait), ("gait.trailing".into(), GaitError::NoSolesBehind));
    }
    let text = file().text;
    let from = "trailing = \"toe\"";
    assert!(text.contains(from));
    for to in ["trailing = \"heel\"", "trailing = 1", "trailing = true"] {
        let read =
            ProblemFile::from_text(&text.replace(from, to), "../examples/problems", LoadOptions::default());
        let message = read.unwrap_err().to_string();
        assert!(message.contains("gait.trailing") && message.contains("\"flat\""), "{to}: {message}");
    }
}
