//! Robots with floating and spherical joints beside Pinocchio: M, forward dynamics and its derivatives.

use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::robot::{LinkInertia, LoadOptions, Robot};
use nalgebra::{DMatrix, DVector, Matrix3};
use serde::Deserialize;
use std::path::Path;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// One line of a fixture; joints in the order of Pinocchio. Rows of symmetric matrices may end at the
/// diagonal.
#[derive(Deserialize)]
struct Case {
    robot: String,
    names: Vec<String>,
    q: Vec<f64>,
    v: Vec<f64>,
    tau: Vec<f64>,
    #[serde(rename = "M")]
    mass: Vec<Vec<f64>>,
    a: Vec<f64>,
    a_q: Vec<Vec<f64>>,
    a_v: Vec<Vec<f64>>,
    a_tau: Vec<Vec<f64>>,
}

/// For each entry of q and of v the entry of Pinocchio.
fn places(robot: &Robot, names: &[String]) -> [Vec<usize>; 2] {
    let kind = |name: &str| robot.free_joints().iter().find(|free| free.name == name).map(|free| free.kind);
    let (mut starts, mut at) = (Vec::new(), [0, 0]);
    for name in names {
        starts.push(at);
        let [nq, nv] = kind(name).map_or([1, 1], |kind| [kind.positions(), kind.dof()]);
        at = [at[0] + nq, at[1] + nv];
    }
    let (mut q, mut v) = (Vec::new(), Vec::new());
    let mut seen = Vec::new();
    for joint in robot.joints() {
        let name = joint.free.as_ref().map_or(&joint.name, |part| &part.joint);
        if seen.contains(&name) {
            continue;
        }
        seen.push(name);
        let [from_q, from_v] = starts[names.iter().position(|other| other == name).unwrap()];
        let [nq, nv] = kind(name).map_or([1, 1], |kind| [kind.positions(), kind.dof()]);
        q.extend(from_q..from_q + nq);
        v.extend(from_v..from_v + nv);
    }
    [q, v]
}

fn cases(file: &str) -> Vec<Case> {
    let text = std::fs::read_to_string(root().join("tests/fixtures").join(file)).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// `max |a - b| <= 1e-10 max |b|` for each array as a whole, 1e-12 for M: rounding alone, whatever the robot.
fn agree(robot: &Robot, case: &Case) {
    let name = &case.robot;
    let [to_q, to_v] = places(robot, &case.names);
    assert_eq!((to_q.len(), to_v.len()), (robot.nq(), robot.dof()), "{name}");
    assert_eq!((to_q.len(), to_v.len()), (case.q.len(), case.v.len()), "{name}");
    let pick = |from: &[f64], to: &[usize]| to.iter().map(|&i| from[i]).collect::<Vec<f64>>();
    let matrix = |rows: &[Vec<f64>]| {
        let entry = |i: usize, j: usize| rows[i].get(j).copied().unwrap_or_else(|| rows[j][i]);
        DMatrix::from_fn(to_v.len(), to_v.len(), |i, j| entry(to_v[i], to_v[j]))
    };
    let (q, v, u) = (pick(&case.q, &to_q), pick(&case.v, &to_v), pick(&case.tau, &to_v));
    let n = v.len();
    let mut hamiltonian = Hamiltonian::<f64>::new(robot);
    let mass = hamiltonian.mass_matrix(&q).unwrap().view().to_nalgebra();
    let expected = matrix(&case.mass);
    assert!((&mass - &expected).amax() < 1e-12 * expected.amax(), "{name}");
    let p = hamiltonian.momentum(&q, &v).unwrap().to_vec();
    let linear = hamiltonian.linearise(&q, &p, &u).unwrap();
    // v = M^-1 p along the motion.
    let f = DVector::from_column_slice(linear.f());
    let a = linear.matrix().to_nalgebra().rows(0, n) * &f;
    let expected = DVector::from_vec(pick(&case.a, &to_v));
    assert!((&a - &expected).amax() < 1e-10 * expected.amax(), "{name}: {a} {expected}");
    assert!((f.rows(0, n) - DVector::from_column_slice(&v)).amax() < 1e-11, "{name}");
    let mut lagrangian = Lagrangian::<f64>::new(robot);
    let (ours, theirs) = (lagrangian.energy(&q, &v).unwrap(), hamiltonian.energy(&q, &p).unwrap());
    let velocity = DVector::from_column_slice(&v);
    let kinetic = 0.5 * velocity.dot(&(&mass * &velocity));
    assert!((ours.kinetic - kinetic).abs() < 1e-12 * kinetic, "{name}");
    assert!((theirs.kinetic - kinetic).abs() < 1e-11 * kinetic, "{name}");
    assert_eq!(ours.potential, theirs.potential, "{name}");
    let found = DVector::from_column_slice(lagrangian.forward_dynamics(&q, &v, &u).unwrap());
    assert!((&found - &expected).amax() < 1e-10 * expected.amax(), "{name}: {found} {expected}");
    let back = DVector::from_column_slice(lagrangian.inverse_dynamics(&q, &v, found.as_slice()).unwrap());
    assert!((back - DVector::from_column_slice(&u)).amax() < 1e-10 * expected.amax(), "{name}");
    let mut second = LagrangianSecondOrder::<f64>::new(robot);
    let linear = lagrangian.linearise_forward_dynamics(&q, &v, &u).unwrap();
    let contracted = second.contract_forward_dynamics(&q, &v, &u, &v).unwrap();
    for linear in [linear, contracted.forward_dynamics()] {
        let found = [linear.a_q(), linear.a_v(), linear.a_u()].map(|block| block.to_nalgebra());
        for (what, (found, expected)) in
            ["a_q", "a_v", "a_tau"].iter().zip(found.iter().zip([&case.a_q, &case.a_v, &case.a_tau]))
        {
            let expected = matrix(expected);
            let (error, size) = ((found - &expected).amax(), expected.amax());
            assert!(error < 1e-10 * size, "{name}: {what}: {error} of {size}");
        }
    }
}

#[test]
fn mass_matrix_and_accelerations_are_those_of_pinocchio() {
    let cases = cases("free_joints_pinocchio.jsonl");
    assert_eq!(cases.len(), 4);
    for case in &cases {
        let options = LoadOptions::default().floating_base(case.robot.ends_with("urdf"));
        let mut robot = Robot::from_file_with(root().join(&case.robot), options).unwrap();
        if options.floating_base {
            let moments = Matrix3::from_diagonal(&[0.3, 0.4, 0.35].into());
            let payload = LinkInertia::about_com(5.0, [0.1, -0.05, 0.2], moments);
            robot = robot.with_payload("root_joint", &payload).unwrap();
        }
        agree(&robot, case);
    }
}

/// Humanoids, quadrupeds and drones that are public, three states each.
#[test]
fn public_robots_have_the_accelerations_and_derivatives_of_pinocchio() {
    let cases = cases("public_robots_pinocchio.jsonl");
    for states in cases.chunks(3) {
        let robot = Robot::from_file(root().join(&states[0].robot)).unwrap();
        assert!(states.iter().all(|case| case.robot == states[0].robot));
        assert_eq!(robot.free_joints().len(), 1, "{}", states[0].robot);
        states.iter().for_each(|case| agree(&robot, case));
    }
    assert_eq!(cases.len(), 3 * 7);
}
