//! A floating body with a hinge turns by 150 degrees and moves, every coordinate driven: an extremal that an
//! independent program finds too (collocation of the extremals, with derivatives by CasADi).

use costate::dynamics::QuaternionDynamics;
use costate::hamiltonian::Hamiltonian;
use costate::robot::{JointSpec, LinkInertia, Placement, Robot};
use costate_control::{
    DynamicsExtremal, DynamicsProblem, EndState, ExtremalSolution, FinalTime, SolverOptions, solve_extremal,
};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

const TIME: f64 = 2.0;
/// Of the extremal that cubics with zero costates lead to.
const COST: f64 = 33.456_745_6;
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

/// Cost, the length of the quaternion, and a pitch near the singular pose of a chain of joints (79.6 deg).
fn check(found: &ExtremalSolution) {
    let motion = &found.motion;
    assert!(motion.status.is_converged(), "{:?}", motion.status);
    assert!((motion.cost / COST - 1.0).abs() < 1e-8, "{}", motion.cost);
    assert!(motion.hamiltonian_drift < 1e-7, "{}", motion.hamiltonian_drift);
    let length = |z: &Vec<f64>| (z[3..7].iter().map(|a| a * a).sum::<f64>().sqrt() - 1.0).abs();
    let off = found.nodes.z.iter().map(length).fold(0.0, f64::max);
    assert!(off < 1e-8, "{off:.1e}");
    let pitch = |z: &Vec<f64>| (2.0 * (z[6] * z[4] - z[3] * z[5])).clamp(-1.0, 1.0).asin().to_degrees();
    let steepest = found.nodes.z.iter().map(pitch).fold(0.0, f64::max);
    assert!(steepest > 75.0, "{steepest}");
}

#[test]
fn cubics_with_zero_costates_lead_to_one_extremal() {
    let options = SolverOptions::default().with_tolerance(1e-9).with_nodes(25);
    let found = extremal_from(&options, |s, z| {
        z.fill(0.0);
        z[..STATES].copy_from_slice(&cubic(s));
    });
    check(&found);
}
