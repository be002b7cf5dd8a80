//! What steps in (q, p) keep: the symplectic form, momenta in the world, energy without drift.

use super::*;
use crate::configuration::samples::{placed, robots, state};
use crate::hamiltonian::Hamiltonian;
use crate::robot::{JointSpec, LinkInertia};
use crate::step::{ImplicitMidpoint, RungeKutta4, StoermerVerlet};
use nalgebra::{DMatrix, Matrix3, Quaternion, UnitQuaternion, Vector3};

type Plain = Box<dyn Step<f64, Error = StepError<EvalError>>>;

const STEP: f64 = 0.02;
const STEPS: usize = 10_000;

fn link(k: f64) -> LinkInertia {
    let inertia = Matrix3::new(0.5, 0.02, -0.1, 0.02, 0.7, 0.05, -0.1, 0.05, 0.6);
    LinkInertia::about_com(1.0 + 0.3 * k, [0.2 * k, -0.1, 0.1], inertia * (0.3 + 0.1 * k))
}

/// A root with a hinge and a spherical joint on it.
fn body(root: JointSpec, gravity: [f64; 3]) -> Robot {
    Robot::builder("body")
        .joint(root.carrying(link(1.0)))
        .joint(
            JointSpec::revolute("hinge")
                .on("root")
                .placed(placed(0.3))
                .axis([0.3, -0.5, 0.8])
                .carrying(link(0.2)),
        )
        .joint(JointSpec::spherical("ball").on("root").placed(placed(-0.2)).carrying(link(0.1)))
        .gravity(gravity)
        .build()
        .unwrap()
}

fn symplectic(robot: &Robot) -> [(&'static str, FreeStep<f64, Plain>); 2] {
    [
        ("midpoint", FreeStep::in_momenta(robot, |model| Box::new(ImplicitMidpoint::new(model)) as Plain)),
        ("Verlet", FreeStep::in_momenta(robot, |model| Box::new(StoermerVerlet::new(model)) as Plain)),
    ]
}

/// Linear and angular momentum in the world, about its origin, of the joint at the root.
fn momentum(robot: &Robot, x: &[f64]) -> [Vector3<f64>; 2] {
    let (root, nq) = (&robot.free_joints()[0], robot.nq());
    let a = root.quaternion();
    let turn = UnitQuaternion::new_unchecked(Quaternion::from([x[a], x[a + 1], x[a + 2], x[a + 3]]));
    let three = |at: usize| Vector3::new(x[at], x[at + 1], x[at + 2]);
    if a == root.position {
        return [Vector3::zeros(), turn * three(nq + root.coordinate)];
    }
    let linear = turn * three(nq + root.coordinate);
    [linear, turn * three(nq + root.coordinate + 3) + three(root.position).cross(&linear)]
}

fn start(robot: &Robot) -> Vec<f64> {
    let [q, p, ..] = state(&ConfigurationSpace::new(robot));
    [q, p].concat()
}

/// Runs all steps: x after each.
fn run(robot: &Robot, step: &mut FreeStep<f64, Plain>, mut each: impl FnMut(usize, &[f64])) {
    let (mut x, u) = (start(robot), vec![0.0; robot.dof()]);
    for k in 0..STEPS {
        x = step.evaluate(&x, &u, STEP).unwrap().to_vec();
        each(k, &x);
    }
}

/// The largest error of energy in the last tenth is not larger than in the first but by what motions differ.
fn energy_stays(robot: &Robot, name: &str, errors: &[f64]) {
    let largest = |errors: &[f64]| errors.iter().copied().fold(0.0, f64::max);
    let (first, last) = (largest(&errors[..STEPS / 10]), largest(&errors[STEPS - STEPS / 10..]));
    assert!(first < 1e-2 && last < 2.0 * first, "{} {name}: {first:.1e} {last:.1e}", robot.name());
}

#[test]
fn a_body_in_space_keeps_its_momentum_and_its_energy() {
    let robot = body(JointSpec::floating("root"), [0.0; 3]);
    let (x, nq) = (start(&robot), robot.nq());
    let mut energy = Hamiltonian::<f64>::new(&robot);
    let h = energy.hamiltonian(&x[..nq], &x[nq..]).unwrap();
    let before = momentum(&robot, &x);
    for (name, mut step) in symplectic(&robot) {
        let (mut errors, mut lost) = (Vec::new(), 0.0_f64);
        run(&robot, &mut step, |_, x| {
            errors.push((energy.hamiltonian(&x[..nq], &x[nq..]).unwrap() - h).abs() / h);
            for (now, before) in momentum(&robot, x).iter().zip(&before) {
                lost = lost.max((now - before).amax() / before.norm());
            }
        });
        assert!(lost < 1e-11, "{name}: {lost:.1e}");
        energy_stays(&robot, name, &errors);
    }
}

#[test]
fn a_top_keeps_its_momentum_about_the_vertical() {
    let robot = body(JointSpec::spherical("root"), [0.0, 0.0, -9.81]);
    let (x, nq) = (start(&robot), robot.nq());
    let mut energy = Hamiltonian::<f64>::new(&robot);
    let kinetic = energy.energy(&x[..nq], &x[nq..]).unwrap().kinetic;
    let h = energy.hamiltonian(&x[..nq], &x[nq..]).unwrap();
    let [_, before] = momentum(&robot, &x);
    for (name, mut step) in symplectic(&robot) {
        let (mut errors, mut lost, mut turned) = (Vec::new(), 0.0_f64, 0.0_f64);
        run(&robot, &mut step, |_, x| {
            errors.push((energy.hamiltonian(&x[..nq], &x[nq..]).unwrap() - h).abs() / kinetic);
            let [_, now] = momentum(&robot, x);
            lost = lost.max((now.z - before.z).abs() / before.norm());
            turned = turned.max((now - before).norm() / before.norm());
        });
        assert!(lost < 1e-11 && turned > 0.5, "{name}: {lost:.1e} {turned}");
        energy_stays(&robot, name, &errors);
    }
}

/// The midpoint rule in the body's momenta, which are not canonical, loses angular momentum.
#[test]
fn momenta_of_the_body_as_they_are_are_not_enough() {
    let robot = body(JointSpec::floating("root"), [0.0; 3]);
    let (nq, u) = (robot.nq(), vec![0.0; robot.dof()]);
    let mut x = start(&robot);
    let before = momentum(&robot, &x);
    let mut plain = ImplicitMidpoint::new(QuaternionDynamics::<f64>::new(&robot));
    for _ in 0..1000 {
        x = plain.evaluate(&x, &u, STEP).unwrap().to_vec();
        ConfigurationSpace::new(&robot).normalize(&mut x[..nq]).unwrap();
    }
    let lost = (momentum(&robot, &x)[1] - before[1]).norm() / before[1].norm();
    assert!(lost > 1e-4, "{lost:.1e}");
}

/// `e_2 . d_1 - e_1 . d_2 + p . [d_1, d_2]`, the canonical form in the axes of the moved frames.
fn form(robot: &Robot, x: &[f64]) -> DMatrix<f64> {
    let (n, nq) = (robot.dof(), robot.nq());
    let mut form = DMatrix::zeros(2 * n, 2 * n);
    for i in 0..n {
        form[(i, n + i)] = 1.0;
        form[(n + i, i)] = -1.0;
    }
    for free in robot.free_joints() {
        let (linear, slides) = (free.coordinate, free.quaternion() > free.position);
        let angular = linear + if slides { 3 } else { 0 };
        let matrix = |at: usize| Vector3::new(x[nq + at], x[nq + at + 1], x[nq + at + 2]).cross_matrix();
        // p . (a x b) = -a' [p] b.
        form.view_mut((angular, angular), (3, 3)).copy_from(&-matrix(angular));
        if slides {
            form.view_mut((angular, linear), (3, 3)).copy_from(&-matrix(linear));
            form.view_mut((linear, angular), (3, 3)).copy_from(&-matrix(linear));
        }
    }
    form
}

#[test]
fn jacobians_keep_the_symplectic_form() {
    let mut defects = [0.0_f64; 2];
    for robot in robots().iter().filter(|robot| robot.joints().iter().all(|joint| joint.friction.is_none())) {
        // A torque that turns with a body comes from no potential: nothing drives the robot.
        let (x, u) = (start(robot), vec![0.0; robot.dof()]);
        let fourth = FreeStep::in_momenta(robot, |model| Box::new(RungeKutta4::new(model)) as Plain);
        for (name, mut step) in symplectic(robot).into_iter().chain([("fourth", fourth)]) {
            let first = step.linearise(&x, &u, 0.01).unwrap();
            let (phi_x, before) = (first.phi_x.to_nalgebra(), form(robot, &x));
            let defect = phi_x.transpose() * form(robot, first.next) * &phi_x - &before;
            let defect = defect.amax() / phi_x.amax().powi(2) / before.amax();
            let most = &mut defects[usize::from(name == "fourth")];
            *most = most.max(defect);
        }
    }
    assert!(defects[0] < 1e-12 && defects[1] > 1e-9, "{defects:?}");
}
