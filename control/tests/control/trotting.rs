//! A quadruped that trots: two diagonal feet stand, the other two land together.
//!
//! The judges are forward dynamics with constraints, contacts and impacts of the library, none of which the
//! solver uses.

use super::gaits::{ROWS, example, integrated, largest_difference, lift_off, solved};
use costate::constraints::{ConstrainedLagrangian, Impact};
use costate::contacts::{Contact, Stance};
use costate::hamiltonian::Hamiltonian;
use costate::kinematics::Kinematics;
use costate::robot::Robot;
use costate_control::{Gait, Problem, ProblemFile, Solution, SolverOptions, Status, Verify};
use std::sync::OnceLock;

const N: usize = 11;
const LENGTH: f64 = 0.2;
const CLEARANCE: f64 = 0.03;
const FRICTION: f64 = 0.6;
const STANCE: [&str; 2] = ["front_right_foot", "hind_left_foot"];
const SWING: [&str; 2] = ["front_left_foot", "hind_right_foot"];
/// Legs exchanged.
const EXCHANGE: [usize; N] = [0, 1, 2, 5, 6, 3, 4, 9, 10, 7, 8];

fn file() -> ProblemFile {
    example("quadruped_trot")
}

/// Those of the example, without what is integrated again.
fn options() -> SolverOptions {
    file().options.with_verify(Verify::Factors)
}

/// The motion of the example, solved once for all tests.
fn trot() -> &'static (Problem, Solution) {
    static TROT: OnceLock<(Problem, Solution)> = OnceLock::new();
    TROT.get_or_init(|| {
        let file = file();
        let solution = solved(&file.problem, file.options.clone());
        (file.problem, solution)
    })
}

fn exchanged(list: &[f64]) -> Vec<f64> {
    EXCHANGE.iter().map(|&i| list[i]).collect()
}

fn on(robot: &Robot, feet: &[&str]) -> Stance {
    let contacts: Vec<Contact> =
        feet.iter().map(|foot| Contact::point(*foot, foot).planar().friction(FRICTION)).collect();
    Stance::new(robot, &contacts).unwrap()
}

/// Whether a force or an impulse is in the cone, but for rounding and what friction gives beyond it.
fn is_in_cone([x, _, z]: [f64; 3], off: f64) -> bool {
    z > -off && x.abs() <= FRICTION * z + off
}

/// The state with which the next step begins, legs exchanged, by the contacts of the library; and the
/// impulses of the landing (N s).
fn landed(robot: &Robot, q: &[f64], v: &[f64]) -> (Vec<f64>, Vec<f64>, [[f64; 3]; 2]) {
    // The feet that stand let go before the others land.
    let before = Hamiltonian::<f64>::new(robot).momentum(q, v).unwrap().to_vec();
    let landing = on(robot, &SWING);
    let mut impact = Impact::<f64>::new(landing.robot());
    let after = impact.evaluate(q, &before).unwrap();
    let impulses = [0, 1].map(|foot| landing.wrench(foot, after.impulse).0);
    let mut q = exchanged(q);
    q[0] -= LENGTH;
    (q, exchanged(after.velocity), impulses)
}

#[test]
fn the_quadruped_trots() {
    let (problem, solution) = trot();
    assert_eq!(solution.motion.status, Status::Converged);
    // The gap of the maximum principle counts, of which a solution may have 8 tolerances.
    assert!(solution.motion.errors[0] <= 8e-6, "{:?}", solution.motion.errors);
    let gait = solution.gait.as_ref().unwrap();
    assert!((gait.speed - LENGTH / 0.3).abs() < 1e-9 && gait.miss < 1e-6, "{gait:?}");
    // After a step the robot has its energy again: what motors add is what they and the landing take.
    assert!(gait.loss > 0.0 && gait.braking > 0.0, "{gait:?}");
    assert!((gait.work - gait.braking - gait.loss).abs() < 1e-5 * gait.work, "{gait:?}");
    assert_eq!(gait.cost_of_transport, gait.work / gait.weight_times_length);
    // 8.912 kg.
    assert!((gait.weight_times_length - 8.912 * 9.81 * LENGTH).abs() < 1e-9, "{gait:?}");
    assert!(solution.end_defect < 1e-3, "{}", solution.end_defect);
    let motion = &solution.trajectory;
    let limits = problem.limits.q_max.as_ref().unwrap();
    for k in 0..motion.t.len() {
        assert!(motion.u[k][..3].iter().all(|u| u.abs() < 1e-5), "{k}: {:?}", motion.u[k]);
        assert!(motion.q[k].iter().zip(limits).all(|(q, most)| *q < most + 1e-6), "{k}: {:?}", motion.q[k]);
    }
}

#[test]
fn the_state_after_the_landing_is_that_of_the_start() {
    let (problem, solution) = trot();
    let motion = &solution.trajectory;
    let last = motion.t.len() - 1;
    let (q, v, impulses) = landed(&problem.robot, &motion.q[last], &motion.v[last]);
    assert!(largest_difference(&q, &motion.q[0]) < 1e-9, "{q:?}");
    assert!(largest_difference(&v, &motion.v[0]) < 1e-6, "{v:?}");
    let gait = solution.gait.as_ref().unwrap();
    for (impulse, told) in impulses.iter().zip(&gait.impulses) {
        assert!(
            largest_difference(impulse, told) < 1e-9 && is_in_cone(*impulse, 1e-6),
            "{impulse:?} {told:?}"
        );
    }
}

/// Forward dynamics on the feet that stand has the forces of the motion at the points of the mesh, and forces
/// in the cone between them too.
#[test]
fn the_ground_bears_both_feet() {
    let (problem, solution) = trot();
    let stance = on(&problem.robot, &STANCE);
    let mut model = ConstrainedLagrangian::<f64>::new(stance.robot());
    let motion = &solution.trajectory;
    let force = |model: &mut ConstrainedLagrangian<f64>, q: &[f64], v: &[f64], u: &[f64]| {
        let u = [&[0.0; 3], &u[3..]].concat();
        let (_, lambda) = model.evaluate(q, v, &u).unwrap();
        [0, 1].map(|foot| stance.wrench(foot, lambda).0)
    };
    let mut lifted = 0.0;
    for k in 0..motion.t.len() {
        let found = force(&mut model, &motion.q[k], &motion.v[k], &motion.u[k]);
        for (foot, found) in solution.constraints.iter().zip(found) {
            let is_point = (1..ROWS - 1).contains(&(k % ROWS));
            let off = largest_difference(&foot.force[k], &found);
            assert!(off < if is_point { 1e-3 } else { 0.1 }, "{k}: {off}");
            assert!(is_in_cone(foot.force[k], 1e-2), "{k}: {:?}", foot.force[k]);
        }
    }
    let times: Vec<f64> = (0..=300).map(|k| 1e-3 * f64::from(k)).collect();
    let samples = solution.sample_at(problem, &times).unwrap();
    for (k, (q, (v, u))) in samples.q.iter().zip(samples.v.iter().zip(&samples.u)).enumerate() {
        for found in force(&mut model, q, v, u) {
            assert!(is_in_cone(found, 0.05), "{k}: {found:?}");
            lifted += if k == 0 || k == 300 { 0.5e-3 * found[2] } else { 1e-3 * found[2] };
        }
    }
    // Over a step the vertical momentum comes back: landing and standing bear the weight.
    let impulse: f64 = solution.gait.as_ref().unwrap().impulses.iter().map(|impulse| impulse[2]).sum();
    let weight = 8.912 * 9.81 * 0.3;
    assert!((lifted + impulse - weight).abs() < 2e-3 * weight, "{lifted} {impulse} {weight}");
}

#[test]
fn both_feet_that_swing_clear_the_ground() {
    let (problem, solution) = trot();
    let mut kinematics = Kinematics::<f64>::new(&problem.robot);
    for (swings, stands) in SWING.iter().zip(STANCE) {
        let [swings, stands] = [swings, stands].map(|foot| problem.robot.frame_index(foot).unwrap());
        let mut most = 0.0_f64;
        for q in &solution.trajectory.q {
            kinematics.set_position(q).unwrap();
            let [[x, _, z], [place, _, ground]] =
                [swings, stands].map(|foot| kinematics.pose(foot).unwrap().position);
            let part = (x - place) / LENGTH;
            assert!(z - CLEARANCE * (1.0 - part * part) > -1e-5 && ground.abs() < 1e-6, "{x} {z} {ground}");
            most = most.max(z);
        }
        assert!(most > 0.9 * CLEARANCE, "{most}");
    }
}

/// The torques of the motion, integrated with forward dynamics on two feet (classical Runge and Kutta, eight
/// steps to an interval) and landed on the other two, come back to the start.
#[test]
fn a_step_integrated_comes_back_to_its_start() {
    let (problem, solution) = trot();
    let motion = &solution.trajectory;
    let stance = on(&problem.robot, &STANCE);
    let mut model = ConstrainedLagrangian::<f64>::new(stance.robot());
    let x = integrated(motion, |_, q, v, tau| model.evaluate(q, v, tau).unwrap().0.to_vec());
    let (q, v, _) = landed(&problem.robot, &x[..N], &x[N..]);
    let miss = largest_difference(&q, &motion.q[0]).max(largest_difference(&v, &motion.v[0]));
    println!("integrated: {miss:.1e}");
    assert!(miss < 1e-3, "{miss}");
}

/// On the other diagonal the motion has its legs exchanged.
#[test]
fn the_other_diagonal_stands() {
    let (problem, right) = trot();
    let mut other = problem.clone();
    let gait = other.gait.as_mut().unwrap();
    std::mem::swap(&mut gait.stance, &mut gait.swing);
    let left = solved(&other, options());
    assert_eq!(left.motion.status, Status::Converged);
    assert!((left.total() / right.total() - 1.0).abs() < 2e-6, "{} {}", left.total(), right.total());
    let times: Vec<f64> = (0..=50).map(|k| 0.3 * f64::from(k) / 50.0).collect();
    let [on_right, on_left] =
        [(right, problem), (&left, &other)].map(|(one, of)| one.sample_at(of, &times).unwrap());
    for (q, other) in on_right.q.iter().zip(&on_left.q) {
        assert!(largest_difference(q, &exchanged(other)) < 1e-3, "{q:?} {other:?}");
    }
}

/// First meshes and guesses lead to the same cost.
#[test]
fn meshes_and_guesses_lead_to_the_same_trot() {
    let (problem, best) = trot();
    let low = {
        let bent = [0.9, -1.8];
        let q = [&[0.0, 0.2, 0.0][..], &bent, &bent, &bent, &bent].concat();
        let mut low = problem.clone();
        low.start.q = q;
        (low, options())
    };
    let coarse = (problem.clone(), options().with_nodes(9));
    let fine = (problem.clone(), options().with_nodes(61));
    for (problem, options) in [low, coarse, fine] {
        let solution = solved(&problem, options);
        assert_eq!(solution.motion.status, Status::Converged);
        assert!(
            (solution.total() / best.total() - 1.0).abs() < 2e-6,
            "{} {}",
            solution.total(),
            best.total()
        );
    }
}

/// Steps that use up the friction of the ground, and short ones, for which torques are hundredths of what the
/// motors could give.
#[test]
fn other_steps_converge() {
    let (problem, best) = trot();
    let with = |change: fn(Gait) -> Gait| {
        let gait = change(problem.gait.clone().unwrap());
        let solution = solved(&problem.clone().with_gait(gait), options());
        assert_eq!(solution.motion.status, Status::Converged);
        solution.total()
    };
    let slippery = with(|gait| gait.with_friction(0.3));
    assert!(slippery > 1.005 * best.total(), "{slippery}");
    let short = with(|mut gait| {
        gait.length = 0.05;
        gait
    });
    assert!(short < 0.1 * best.total(), "{short}");
    // Feet that may slide along the ground, at a clearance of zero, have many local minima.
    let low = with(|gait| gait.with_clearance(5e-3));
    assert!(low < 0.98 * best.total(), "{low}");
}

/// With a fifth of the step on all four feet: forward dynamics on them has the forces of the motion, nothing
/// is lost at the landing, and the state comes back.
#[test]
fn all_four_feet_stand_in_double_support() {
    let file = file();
    let gait = file.problem.gait.clone().unwrap().with_double_support(0.2);
    let problem = file.problem.clone().with_gait(gait);
    let solution = solved(&problem, file.options.clone().with_tolerance(1e-5));
    assert_eq!(solution.motion.status, Status::Converged);
    let gait = solution.gait.as_ref().unwrap();
    assert!(gait.miss < 1e-5 && (gait.work - gait.braking).abs() < 1e-4 * gait.work, "{gait:?}");
    let feet = [STANCE, SWING].concat();
    let told: Vec<&str> = solution.constraints.iter().map(|one| &*one.name).collect();
    assert_eq!(told, feet);
    let stances = [on(&problem.robot, &feet), on(&problem.robot, &STANCE)];
    let mut models = stances.each_ref().map(|stance| ConstrainedLagrangian::<f64>::new(stance.robot()));
    let motion = &solution.trajectory;
    let lift_off = lift_off(&solution);
    assert!((lift_off - 0.06).abs() < 1e-12, "{lift_off}");
    for k in (0..motion.t.len()).filter(|k| (1..ROWS - 1).contains(&(k % ROWS))) {
        let phase = usize::from(motion.t[k] > lift_off);
        let u = [&[0.0; 3], &motion.u[k][3..]].concat();
        let (_, lambda) = models[phase].evaluate(&motion.q[k], &motion.v[k], &u).unwrap();
        for (foot, one) in solution.constraints.iter().enumerate() {
            let stands = phase == 0 || foot < STANCE.len();
            let found = if stands { stances[phase].wrench(foot, lambda).0 } else { [0.0; 3] };
            assert!(largest_difference(&one.force[k], &found) < 1e-3, "{k}: {:?} {found:?}", one.force[k]);
            assert!(is_in_cone(found, 1e-2), "{k}: {found:?}");
        }
    }
}
