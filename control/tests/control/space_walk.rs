//! Steps of a biped in space, with soles that stand flat and the reflection in the plane y = 0.
//!
//! The judges use the frames, the inverse dynamics and the impact of the library, none of which the solver
//! uses for this; the wrench of the ground is what the base needs, which has no motors.

use super::gaits::{example, largest_difference, solved};
use super::plane_twins::Twins;
use costate::constraints::Impact;
use costate::contacts::{Contact, Stance};
use costate::hamiltonian::Hamiltonian;
use costate::kinematics::Kinematics;
use costate::lagrangian::Lagrangian;
use costate_control::{
    Certificate, Gait, GaitError, Problem, ProblemError, ProblemFile, Solution, Solver, SolverOptions,
    Status, Verify,
};
use nalgebra::{Matrix3, Vector3};
use std::sync::OnceLock;

/// Six of the base and six of each leg.
const N: usize = 18;

fn file() -> ProblemFile {
    example("biped_walk")
}

fn gait() -> Gait {
    file().problem.gait.unwrap()
}

fn solve(problem: &Problem, options: SolverOptions) -> Solution {
    let solution = solved(problem, options);
    assert_eq!(solution.motion.status, Status::Converged);
    solution
}

/// Those of the example but for the tolerance, the first mesh and what is solved again, which would take
/// minutes.
fn options() -> SolverOptions {
    file().options.with_tolerance(1e-4).with_nodes(49).with_verify(Verify::Factors)
}

/// The motion of the example, solved once for all tests.
fn walk() -> &'static (Problem, Solution) {
    static WALK: OnceLock<(Problem, Solution)> = OnceLock::new();
    WALK.get_or_init(|| {
        let file = file();
        let solution = solve(&file.problem, options().with_verify(Verify::Full));
        (file.problem, solution)
    })
}

/// In the mirror: legs exchanged; what moves along y or turns about x and z changes its sign.
pub(crate) fn mirrored(list: &[f64]) -> Vec<f64> {
    let sign = |i: usize| match i {
        0 | 2 | 5 => 1.0,
        1 | 3 | 4 => -1.0,
        _ if [1, 2, 5].contains(&((i - 6) % 6)) => -1.0,
        _ => 1.0,
    };
    let from = |i: usize| if i < 6 { i } else { 6 + (i - 6 + 6) % 12 };
    (0..N).map(|i| sign(i) * list[from(i)]).collect()
}

/// Force and moment of the ground about the origin of a foot at `foot`, that the base needs.
fn wrench_at(tau: &[f64], q: &[f64], foot: [f64; 3]) -> (Vector3<f64>, Vector3<f64>) {
    let force = Vector3::new(tau[0], tau[1], tau[2]);
    // The axes of yaw, roll and pitch.
    let (yaw, roll) = (nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), q[3]), q[4]);
    let rolled = yaw * nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), roll);
    let axes = Matrix3::from_columns(&[Vector3::z(), yaw * Vector3::x(), rolled * Vector3::y()]);
    let moment = axes.transpose().try_inverse().unwrap() * Vector3::new(tau[3], tau[4], tau[5]);
    let arm = Vector3::new(q[0], q[1], q[2]) - Vector3::from(foot);
    (force, moment + arm.cross(&force))
}

/// How far a wrench on a foot is inside the cone of its four corners, in parts of a weight: friction, centre
/// of pressure, turning. Negative outside.
pub(crate) fn inside(gait: &Gait, force: Vector3<f64>, moment: Vector3<f64>, weight: f64) -> f64 {
    let ([heel, toe], mu) = (gait.sole.unwrap(), gait.friction);
    let (x, y, middle) = (0.5 * (toe - heel), 0.5 * gait.sole_width, 0.5 * (heel + toe));
    let m = moment - Vector3::new(middle, 0.0, 0.0).cross(&force);
    let turn = |sign: f64| {
        mu * (x + y) * force.z - (y * force.x - sign * mu * m.x).abs() - (x * force.y - sign * mu * m.y).abs()
            + sign * m.z
    };
    let lengths = [
        (mu * force.z - force.x.abs(), 1.0),
        (mu * force.z - force.y.abs(), 1.0),
        (y * force.z - m.x.abs(), y),
        (x * force.z - m.y.abs(), x),
        (turn(1.0), mu * (x + y)),
        (turn(-1.0), mu * (x + y)),
    ];
    lengths.into_iter().fold(f64::INFINITY, |least, (value, length)| least.min(value / (length * weight)))
}

/// Whether a step keeps what the ground asks for, at 2000 instants that are no points of its mesh.
pub(crate) fn check(problem: &Problem, solution: &Solution) {
    let gait = problem.gait.as_ref().unwrap();
    let [heel, toe] = gait.sole.unwrap();
    let time = solution.motion.final_time;
    let times: Vec<f64> = (0..2000).map(|k| time * (f64::from(k) + 0.5) / 2000.0).collect();
    let samples = solution.sample_at(problem, &times).unwrap();
    let mut model = Lagrangian::<f64>::new(&problem.robot);
    let mut kinematics = Kinematics::<f64>::new(&problem.robot);
    let [stance, swing] =
        [&gait.stance[0], &gait.swing[0]].map(|foot| problem.robot.frame_index(foot).unwrap());
    let weight = solution.gait.as_ref().unwrap().weight_times_length / gait.length;
    // The left foot is at positive y.
    let side = if gait.stance[0] == "left_foot" { 0.5 } else { -0.5 };
    let (mut least, mut lowest) = (f64::INFINITY, 0.0_f64);
    for ((q, v), a) in samples.q.iter().zip(&samples.v).zip(&samples.a) {
        let tau = model.inverse_dynamics(q, v, a).unwrap();
        kinematics.set_position(q).unwrap();
        let flat = kinematics.pose(stance).unwrap();
        let place = [0.0, side * gait.width, 0.0];
        assert!(largest_difference(&flat.position, &place) < 1e-4, "{:?}", flat.position);
        let turned = (0..3).map(|i| (flat.rotation[i][i] - 1.0).abs()).fold(0.0, f64::max);
        assert!(turned < 1e-7, "{:?}", flat.rotation);
        let (force, moment) = wrench_at(tau, q, place);
        least = least.min(inside(gait, force, moment, weight));
        let foot = kinematics.pose(swing).unwrap();
        for x in [heel, toe] {
            for y in [0.5 * gait.sole_width, -0.5 * gait.sole_width] {
                let at =
                    |row: usize| foot.position[row] + x * foot.rotation[row][0] + y * foot.rotation[row][1];
                let part = (at(0) - x) / gait.length;
                lowest = lowest.min(at(2) - gait.clearance * (1.0 - part * part));
            }
        }
    }
    assert!(least > -3e-2, "{least}");
    assert!(lowest > -5e-4, "{lowest}");
    // The state after the landing on the whole sole is the one at the start, mirrored.
    let (motion, last) = (&solution.trajectory, solution.trajectory.t.len() - 1);
    let (q, v) = (&motion.q[last], &motion.v[last]);
    let before = Hamiltonian::<f64>::new(&problem.robot).momentum(q, v).unwrap().to_vec();
    let landing = Stance::new(&problem.robot, &[Contact::foot("foot", &gait.swing[0])]).unwrap();
    let mut impact = Impact::<f64>::new(landing.robot());
    let after = impact.evaluate(q, &before).unwrap();
    let miss = largest_difference(&mirrored(after.velocity), &motion.v[0]);
    assert!(miss < 1e-6, "{miss}");
    let (force, moment) = landing.wrench(0, after.impulse);
    let inside = inside(gait, force.into(), moment.into(), weight);
    assert!(inside > -1e-5, "{inside}");
    let mut back = mirrored(q);
    back[0] -= gait.length;
    assert!(largest_difference(&back, &motion.q[0]) < 1e-9);
}

#[test]
fn a_biped_in_space_walks() {
    let (problem, solution) = walk();
    check(problem, solution);
    assert!(solution.gait.as_ref().unwrap().miss < 1e-6);
    // Integrated again in 20 pieces, by dynamics with constraints that the solver does not use.
    assert!(solution.motion.shooting_defect < 1e-2, "{}", solution.motion.shooting_defect);
    let gait = solution.gait.as_ref().unwrap();
    assert!((gait.work - gait.braking - gait.loss).abs() < 1e-3 * gait.work, "{gait:?}");
    let [foot] = &solution.constraints[..] else { panic!("{:?}", solution.constraints) };
    assert_eq!((&*foot.name, &*foot.frame), ("right_foot", "right_foot"));
    // Every side of the cone has its name among the forces of the ground.
    let limits = &solution.limits;
    for usage in [&limits.ground_force, &limits.landing_impulse] {
        let usage = usage.as_ref().unwrap();
        assert!(usage.worst.is_none(), "{usage:?}");
        assert!(usage.active.iter().all(|span| span.name.starts_with("right_foot (")), "{usage:?}");
    }
    let active = limits.task.iter().flat_map(|usage| &usage.active);
    assert!(active.into_iter().all(|span| !span.name.contains("right_foot")), "{limits:?}");
    // The ground presses the sole from somewhere within it.
    let (sole, half) =
        (problem.gait.as_ref().unwrap().sole.unwrap(), 0.5 * file().problem.gait.unwrap().sole_width);
    for ([_, _, z], [m_x, m_y, _]) in foot.force.iter().zip(&foot.moment) {
        let (x, y) = (-m_y / z, m_x / z);
        assert!(*z > 0.0 && x > sole[0] - 1e-6 && x < sole[1] + 1e-6 && y.abs() < half + 1e-6, "{x} {y} {z}");
    }
}

/// To the tolerance of the example. Squares of the equations were rounded by more than the cost is curved:
/// the search took minutes from other meshes, and told of a saddle.
#[test]
fn first_meshes_lead_to_one_local_minimum() {
    let file = file();
    let [one, other] = [65, 97].map(|nodes| {
        let options = file.options.clone().with_nodes(nodes).with_verify(Verify::Factors);
        let solution = solve(&file.problem, options);
        assert_eq!(solution.motion.certificate, Certificate::LocalMinimumOnMesh, "{nodes}");
        solution.total()
    });
    assert!((one / other - 1.0).abs() < file.options.tolerance, "{one} {other}");
}

/// With the other foot on the ground the motion is the mirror image.
#[test]
fn the_other_foot_stands_in_the_mirror() {
    let (problem, best) = walk();
    let mut right = problem.clone();
    for (joint, factor) in [(6, 1.1), (9, 0.9), (7, 1.2)] {
        right.cost.effort[joint] *= factor;
        right.cost.effort[joint + 6] *= factor;
    }
    let mut left = right.clone();
    left.start.q = mirrored(&right.start.q);
    let gait = left.gait.as_mut().unwrap();
    std::mem::swap(&mut gait.stance, &mut gait.swing);
    let [one, other] = [&right, &left].map(|problem| solve(problem, options()));
    assert!((other.total() / one.total() - 1.0).abs() < 1e-5, "{} {}", one.total(), other.total());
    assert!((one.total() / best.total() - 1.0).abs() > 1e-4);
    check(&left, &other);
    let times: Vec<f64> = (0..=50).map(|k| one.motion.final_time * f64::from(k) / 50.0).collect();
    let [one, other] = [(&one, &right), (&other, &left)].map(|(of, p)| of.sample_at(p, &times).unwrap());
    for (q, other) in one.q.iter().zip(&other.q) {
        assert!(largest_difference(q, &mirrored(other)) < 1e-2, "{q:?} {other:?}");
    }
}

/// A robot in space whose legs and masses are in one plane moves in it as the planar robot does, which is the
/// same one with all that leads out of the plane locked: its rows of constraints, its cone and its impact are
/// others, with other unknowns.
#[test]
fn in_a_plane_it_is_the_planar_robot() {
    let twins = Twins::of(&file().problem);
    let [space, plane] = [&twins.in_space, &twins.in_plane].map(|problem| solve(problem, options()));
    twins.agree(&space, &plane);
}

#[test]
fn what_is_no_gait_in_space_is_refused_by_name() {
    let problem = file().problem;
    let refused = |change: &dyn Fn(&mut Gait)| {
        let mut gait = gait();
        change(&mut gait);
        Solver::new(&problem.clone().with_gait(gait), SolverOptions::default()).unwrap_err()
    };
    let cause = |error: ProblemError| match error {
        ProblemError::Gait { key, cause } => (key.to_string(), *cause),
        other => panic!("{other}"),
    };
    for value in [-0.1, f64::NAN, f64::INFINITY] {
        let (key, found) = cause(refused(&|gait| gait.width = value));
        assert!(key == "gait.width" && matches!(found, GaitError::OutOfRange { .. }), "{found}");
        let (key, found) = cause(refused(&|gait| gait.sole_width = value));
        assert!(key == "gait.sole_width" && matches!(found, GaitError::OutOfRange { .. }), "{found}");
    }
    assert_eq!(cause(refused(&|gait| gait.sole_width = 0.0)).0, "gait.sole_width");
    let (key, found) = cause(refused(&|gait| gait.sole = None));
    assert!(key == "gait.sole_width" && found.to_string().contains("without gait.sole"), "{found}");
    // A robot in space without joints that are flipped is taken for a planar one.
    let (key, found) = cause(refused(&|gait| gait.flipped.clear()));
    assert_eq!((&*key, &found), ("gait.width", &GaitError::WidthInPlane { value: gait().width }));
    assert!(found.to_string().starts_with("is 0.167, but"), "{found}");
    let (key, found) = cause(refused(&|gait| {
        gait.flipped.clear();
        gait.width = 0.0;
    }));
    assert_eq!((&*key, found), ("gait.sole_width", GaitError::WidthInPlane { value: gait().sole_width }));
    let (_, found) = cause(refused(&|gait| {
        gait.flipped.clear();
        (gait.width, gait.sole_width) = (0.0, 0.0);
    }));
    assert!(found.to_string().contains("gait.flipped"), "{found}");
    // A joint that is missing makes another robot of the mirror image.
    let (key, found) = cause(refused(&|gait| drop(gait.flipped.pop())));
    assert!(key == "gait.mirror" && found.to_string().contains("gait.flipped"), "{found}");
    let unknown = refused(&|gait| gait.flipped[0] = "base_w".into());
    assert!(unknown.to_string().contains("base_x"), "{unknown}");
    let twice = refused(&|gait| gait.flipped.push("base_y".into()));
    assert!(matches!(twice, ProblemError::GivenTwice { .. }), "{twice}");
}
