//! Robots with floating and spherical joints by the numbers of Pinocchio.

use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::Lagrangian;
use costate::robot::{LinkInertia, LoadOptions, Robot};
use nalgebra::{DMatrix, DVector, Matrix3};
use serde::Deserialize;
use std::path::Path;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// One line of `free_joints_pinocchio.jsonl`; joints in the order of Pinocchio.
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

#[test]
fn mass_matrix_and_accelerations_are_those_of_pinocchio() {
    let text = std::fs::read_to_string(root().join("tests/fixtures/free_joints_pinocchio.jsonl")).unwrap();
    let cases: Vec<Case> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(cases.len(), 4);
    for case in &cases {
        let options = LoadOptions::default().floating_base(case.robot.ends_with("urdf"));
        let mut robot = Robot::from_file_with(root().join(&case.robot), options).unwrap();
        if options.floating_base {
            let moments = Matrix3::from_diagonal(&[0.3, 0.4, 0.35].into());
            let payload = LinkInertia::about_com(5.0, [0.1, -0.05, 0.2], moments);
            robot = robot.with_payload("root_joint", &payload).unwrap();
        }
        let [to_q, to_v] = places(&robot, &case.names);
        assert_eq!((to_q.len(), to_v.len()), (robot.nq(), robot.dof()), "{}", case.robot);
        assert_eq!((to_q.len(), to_v.len()), (case.q.len(), case.v.len()), "{}", case.robot);
        let pick = |from: &[f64], to: &[usize]| to.iter().map(|&i| from[i]).collect::<Vec<f64>>();
        let (q, v, u) = (pick(&case.q, &to_q), pick(&case.v, &to_v), pick(&case.tau, &to_v));
        let n = v.len();
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        let mass = hamiltonian.mass_matrix(&q).unwrap().view().to_nalgebra();
        let expected = DMatrix::from_fn(n, n, |i, j| case.mass[to_v[i]][to_v[j]]);
        assert!((&mass - &expected).amax() < 1e-12 * expected.amax(), "{}", case.robot);
        let p = hamiltonian.momentum(&q, &v).unwrap().to_vec();
        let linear = hamiltonian.linearise(&q, &p, &u).unwrap();
        // v = M^-1 p along the motion.
        let f = DVector::from_column_slice(linear.f());
        let a = linear.matrix().to_nalgebra().rows(0, n) * &f;
        let expected = DVector::from_vec(pick(&case.a, &to_v));
        assert!((&a - &expected).amax() < 1e-10 * expected.amax(), "{}: {a} {expected}", case.robot);
        assert!((f.rows(0, n) - DVector::from_column_slice(&v)).amax() < 1e-11);
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let (ours, theirs) = (lagrangian.energy(&q, &v).unwrap(), hamiltonian.energy(&q, &p).unwrap());
        let velocity = DVector::from_column_slice(&v);
        let kinetic = 0.5 * velocity.dot(&(&mass * &velocity));
        assert!((ours.kinetic - kinetic).abs() < 1e-12 * kinetic, "{}", case.robot);
        assert!((theirs.kinetic - kinetic).abs() < 1e-11 * kinetic, "{}", case.robot);
        assert_eq!(ours.potential, theirs.potential, "{}", case.robot);
        let found = DVector::from_column_slice(lagrangian.forward_dynamics(&q, &v, &u).unwrap());
        assert!((&found - &expected).amax() < 1e-10 * expected.amax(), "{}: {found} {expected}", case.robot);
        let back = DVector::from_column_slice(lagrangian.inverse_dynamics(&q, &v, found.as_slice()).unwrap());
        assert!((back - DVector::from_column_slice(&u)).amax() < 1e-10 * expected.amax(), "{}", case.robot);
        let linear = lagrangian.linearise_forward_dynamics(&q, &v, &u).unwrap();
        let found = [linear.a_q(), linear.a_v(), linear.a_u()].map(|block| block.to_nalgebra());
        for (k, (found, expected)) in found.iter().zip([&case.a_q, &case.a_v, &case.a_tau]).enumerate() {
            let expected = DMatrix::from_fn(n, n, |i, j| expected[to_v[i]][to_v[j]]);
            let error = (found - &expected).amax();
            assert!(error < 1e-9 * expected.amax(), "{}: {k}: {error} of {}", case.robot, expected.amax());
        }
    }
}
