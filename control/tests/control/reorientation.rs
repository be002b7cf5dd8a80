//! A floating body with a hinge turns by 150 degrees and moves, every coordinate driven: two extremals, and a
//! minimum between them. CasADi and IPOPT find both by equations of their own, one as the least cost of the
//! problem in states, one by collocation of the extremals: `bash benches/ocp/run --values freely`.

use costate::dynamics::QuaternionDynamics;
use costate::hamiltonian::Hamiltonian;
use costate::robot::{JointSpec, LinkInertia, Placement, Robot};
use costate_control::{
    Certificate, DirectDynamics, DynamicsExtremal, DynamicsProblem, EndState, ExtremalSolution, FinalTime,
    MotionLimits, Problem, Solver, SolverOptions, solve_extremal,
};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

const TIME: f64 = 2.0;
/// The extremal that cubics with zero costates lead to, which is a saddle, and a cheaper one.
const COSTS: [f64; 2] = [33.456_745_6, 33.386_719_9];
/// (x, y, z, qx, qy, qz, qw) and the hinge: 15 states with the momenta.
const NQ: usize = 8;
const STATES: usize = 15;

fn robot() -> Robot {
    let diagonal = |a, b, c| Matrix3::from_diagonal(&Vector3::new(a, b, c));
    let trunk = LinkInertia::about_com(2.0, [0.05, 0.0, 0.1], diagonal(0.3, 0.4, 0.5));
    let link = LinkInertia::about_com(0.8, [0.5, 0.0, 0.0], diagonal(0.02, 0.1, 0.1));
    let at = Placement::from_xyz_rpy([0.2, 0.0, 0.0], [0.0; 3]);
    Robot::builder("body")
        .joint(JointSpec::floating("root").carrying(trunk))
        .joint(JointSpec::revolute("hinge").on("root").axis([0.0, 1.0, 0.0]).placed(at).carrying(link))
        .gravity([0.0, 0.0, -2.0])
        .build()
        .unwrap()
}

fn turn() -> Vector3<f64> {
    Vector3::new(0.2, 1.0, 0.3).normalize() * 150_f64.to_radians()
}

/// The positions at part s of the way.
fn place(part: f64) -> [f64; NQ] {
    let a = UnitQuaternion::from_scaled_axis(turn() * part).coords;
    [0.5 * part, 0.2 * part, 0.3 * part, a.x, a.y, a.z, a.w, 0.8 * part]
}

/// x on the way that the cubic of its part makes.
fn cubic(s: f64) -> Vec<f64> {
    let (part, rate) = (s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) / TIME);
    let q = place(part);
    let back = UnitQuaternion::from_scaled_axis(turn() * part).inverse();
    let linear = back * Vector3::new(0.5, 0.2, 0.3) * rate;
    let mut v = linear.as_slice().to_vec();
    v.extend((turn() * rate).iter());
    v.push(0.8 * rate);
    let mut model = Hamiltonian::<f64>::new(&robot());
    [&q[..], model.momentum(&q, &v).unwrap()].concat()
}

fn in_states() -> DynamicsProblem {
    let at = |part: f64| [&place(part)[..], &[0.0; STATES - NQ]].concat();
    let end = EndState::fixed(&at(1.0)).with_orientation(3);
    DynamicsProblem::new(EndState::fixed(&at(0.0)), end, FinalTime::Fixed(TIME), STATES - NQ)
}

fn extremal_from(options: &SolverOptions, guess: impl FnMut(f64, &mut [f64])) -> ExtremalSolution {
    let model = QuaternionDynamics::<f64>::new(&robot());
    let mut extremal = DynamicsExtremal::new(model, &in_states()).unwrap();
    solve_extremal(&mut extremal, FinalTime::Fixed(TIME), options, guess)
}

/// Cost and the length of the quaternion.
fn check(found: &ExtremalSolution, cost: f64) {
    let motion = &found.motion;
    assert!(motion.status.is_converged(), "{:?}", motion.status);
    assert!((motion.cost / cost - 1.0).abs() < 1e-8, "{}", motion.cost);
    assert!(motion.hamiltonian_drift < 1e-7, "{}", motion.hamiltonian_drift);
    let length = |z: &Vec<f64>| (z[3..7].iter().map(|a| a * a).sum::<f64>().sqrt() - 1.0).abs();
    let off = found.nodes.z.iter().map(length).fold(0.0, f64::max);
    assert!(off < 1e-8, "{off:.1e}");
}

#[test]
fn cubics_with_zero_costates_lead_to_one_extremal() {
    let options = SolverOptions::default().with_tolerance(1e-9).with_nodes(25);
    let found = extremal_from(&options, |s, z| {
        z.fill(0.0);
        z[..STATES].copy_from_slice(&cubic(s));
    });
    check(&found, COSTS[0]);
    // Near the singular pose of a chain of joints: 79.6 deg.
    let pitch = |z: &Vec<f64>| (2.0 * (z[6] * z[4] - z[3] * z[5])).clamp(-1.0, 1.0).asin().to_degrees();
    let steepest = found.nodes.z.iter().map(pitch).fold(0.0, f64::max);
    assert!(steepest > 75.0, "{steepest}");
}

#[test]
fn the_direct_method_leaves_the_saddle() {
    let from = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let problem = Problem::rest_to_rest(robot(), &from, &place(1.0), TIME)
        .with_limits(MotionLimits::none().with_torque_max(vec![f64::INFINITY; 7]));
    let options = SolverOptions::default().with_tolerance(1e-8);
    let solution = Solver::new(&problem, options.clone()).unwrap().solve();
    assert!(solution.motion.status.is_converged(), "{:?}", solution.motion.status);
    // From the turn at a constant axis and its torques it is a minimum between the two.
    let motion = &solution.motion;
    assert!(motion.certificate == Certificate::LocalMinimumOnMesh && motion.hamiltonian_drift < 1e-5);
    assert!(
        motion.cost < COSTS[0] * (1.0 - 1e-5) && motion.cost > COSTS[1] * (1.0 - 1e-7),
        "{}",
        motion.cost
    );
    assert!(solution.end_defect < 1e-6, "{}", solution.end_defect);
    // In states from cubics without torques: the cheaper one, and the extremal from there.
    let model = QuaternionDynamics::<f64>::new(&robot());
    let mut direct = DirectDynamics::new(model, &in_states()).unwrap();
    let t: Vec<f64> = (0..=40).map(|k| TIME * f64::from(k) / 40.0).collect();
    let x: Vec<Vec<f64>> = t.iter().map(|t| cubic(t / TIME)).collect();
    let u = vec![vec![0.0; STATES - NQ]; t.len()];
    direct = direct.with_guess(&t, &x, &u).unwrap();
    let motion = direct.solve(&options).unwrap();
    assert!(motion.status.is_converged(), "{:?}", motion.status);
    assert!((motion.cost / COSTS[1] - 1.0).abs() < 1e-7, "{}", motion.cost);
    let found = extremal_from(&options.with_tolerance(1e-9), |s, z| {
        let after = motion.t.partition_point(|t| *t < s * TIME).clamp(1, motion.t.len() - 1);
        let part = (s * TIME - motion.t[after - 1]) / (motion.t[after] - motion.t[after - 1]);
        let row = |k: usize| motion.x[k].iter().chain(&motion.y[k]);
        for (z, (a, b)) in z.iter_mut().zip(row(after - 1).zip(row(after))) {
            *z = a + part * (b - a);
        }
    });
    check(&found, COSTS[1]);
}
