//! A step of the biped in space that begins on both soles.
//!
//! The judges are forward dynamics with contacts, frames and the impact of the library, none of which the
//! solver uses.

use super::gaits::{ROWS, example, largest_difference, lift_off, solved};
use super::space_walk::{inside, mirrored};
use costate::constraints::{ConstrainedLagrangian, Impact};
use costate::contacts::{Contact, Stance};
use costate::hamiltonian::Hamiltonian;
use costate::kinematics::Kinematics;
use costate_control::{GaitError, ProblemError, SoleContact, Solver, SolverOptions, Status, Verify};
use nalgebra::Vector3;

/// Coordinates of the base.
const BASE: usize = 6;

#[test]
fn both_soles_stand_flat_and_then_one_swings() {
    let file = example("biped_double_support");
    let problem = &file.problem;
    // Those of the example but for the tolerance, the first mesh and what is solved again.
    let options = file.options.clone().with_tolerance(1e-4).with_nodes(49).with_verify(Verify::Factors);
    let solution = solved(problem, options);
    assert_eq!(solution.motion.status, Status::Converged);
    let (gait, motion) = (problem.gait.as_ref().unwrap(), &solution.trajectory);
    let lift_off = lift_off(&solution);
    assert!((lift_off - gait.double_support.unwrap() * solution.motion.final_time).abs() < 1e-12);
    let feet = [&gait.stance[0], &gait.swing[0]];
    let both: Vec<Contact> = feet.iter().map(|foot| Contact::foot(foot.as_str(), foot)).collect();
    let stances = [&both[..], &both[..1]].map(|feet| Stance::new(&problem.robot, feet).unwrap());
    let mut models = stances.each_ref().map(|stance| ConstrainedLagrangian::<f64>::new(stance.robot()));
    let weight = solution.gait.as_ref().unwrap().weight_times_length / gait.length;
    // At the points the forces that are told are those of forward dynamics, and in their cones.
    let mut largest = [0.0_f64; 2];
    for k in (0..motion.t.len()).filter(|k| (1..ROWS - 1).contains(&(k % ROWS))) {
        let phase = usize::from(motion.t[k] > lift_off);
        let u = [&[0.0; BASE], &motion.u[k][BASE..]].concat();
        let (_, lambda) = models[phase].evaluate(&motion.q[k], &motion.v[k], &u).unwrap();
        for (foot, told) in solution.constraints.iter().enumerate().take(2 - phase) {
            let (force, moment) = stances[phase].wrench(foot, lambda);
            let miss = largest_difference(&told.force[k], &force);
            let miss = miss.max(largest_difference(&told.moment[k], &moment));
            assert!(miss < 1e-4 * weight, "{k}: {miss}");
            let least = inside(gait, Vector3::from(force), Vector3::from(moment), weight);
            assert!(least > -1e-4, "{k}: {least}");
            largest[foot] = largest[foot].max(force[2]);
        }
        let idle = solution.constraints[2 - phase..]
            .iter()
            .map(|foot| largest_difference(&foot.force[k], &[0.0; 3]));
        assert!(idle.fold(0.0, f64::max) < 1e-6);
    }
    assert!(largest.iter().all(|z| *z > 0.2 * weight), "{largest:?}");
    // Neither sole moves in double support, and none sinks into the ground.
    let mut kinematics = Kinematics::<f64>::new(&problem.robot);
    let indices = feet.map(|foot| problem.robot.frame_index(foot).unwrap());
    let times: Vec<f64> =
        (0..1000).map(|k| solution.motion.final_time * (f64::from(k) + 0.5) / 1000.0).collect();
    let samples = solution.sample_at(problem, &times).unwrap();
    let side = 0.5 * gait.width;
    let (mut moved, mut lowest) = (0.0_f64, 0.0_f64);
    for (t, q) in times.iter().zip(&samples.q) {
        kinematics.set_position(q).unwrap();
        let places = [[0.0, -side, 0.0], [-gait.length, side, 0.0]];
        for (index, place) in indices.iter().zip(places).take(if *t < lift_off { 2 } else { 1 }) {
            let pose = kinematics.pose(*index).unwrap();
            let turned = (0..3).map(|i| (pose.rotation[i][i] - 1.0).abs()).fold(0.0, f64::max);
            moved = moved.max(largest_difference(&pose.position, &place)).max(turned);
        }
        let pose = kinematics.pose(indices[1]).unwrap();
        for x in gait.sole.unwrap() {
            for y in [0.5 * gait.sole_width, -0.5 * gait.sole_width] {
                lowest = lowest.min(pose.position[2] + x * pose.rotation[2][0] + y * pose.rotation[2][1]);
            }
        }
    }
    println!("moved {moved:.1e} lowest {lowest:.1e} largest {largest:?}");
    assert!(moved < 1e-4 && lowest > -1e-4, "{moved} {lowest}");
    // The landing, by the impact of the library on both soles, has no impulse.
    let (q, v) = (motion.q.last().unwrap(), motion.v.last().unwrap());
    let before = Hamiltonian::<f64>::new(&problem.robot).momentum(q, v).unwrap().to_vec();
    let mut impact = Impact::<f64>::new(stances[0].robot());
    let after = impact.evaluate(q, &before).unwrap();
    for foot in 0..2 {
        let impulse = stances[0].wrench(foot, after.impulse).0;
        assert!(largest_difference(&impulse, &[0.0; 3]) < 1e-4 * weight, "{impulse:?}");
    }
    let miss = largest_difference(&mirrored(after.velocity), &motion.v[0]);
    assert!(miss < 1e-4, "{miss}");
}

#[test]
fn toes_in_space_are_refused_by_name() {
    let problem = example("biped_double_support").problem;
    let gait = problem.gait.clone().unwrap().with_trailing(SoleContact::Toe);
    let error = Solver::new(&problem.with_gait(gait), SolverOptions::default()).unwrap_err();
    let ProblemError::Gait { key, cause } = error else { panic!("{error}") };
    assert_eq!((key.to_string().as_str(), *cause), ("gait.double_support", GaitError::ToesInSpace));
}
