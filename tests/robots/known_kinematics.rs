//! Frames, Jacobians, centre of mass and momentum against an independent program
//! (`tests/fixtures/README.md`).

use costate::kinematics::{Kinematics, ReferenceFrame};
use costate::lagrangian::Lagrangian;
use costate::robot::{Robot, Wrench, WrenchAxes};
use costate::spatial::{Motion, Vec3};
use costate_test_support::reference::{Reference, flat};
use std::path::Path;

const CONVENTIONS: [(&str, ReferenceFrame); 3] = [
    ("local", ReferenceFrame::Local),
    ("world", ReferenceFrame::World),
    ("aligned", ReferenceFrame::LocalWorldAligned),
];

/// A robot of `robots/` or of the fixtures, without friction, with its reference.
fn read(file: &str, name: &str) -> (Robot, Vec<Reference>) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let robot = Robot::from_file(root.join(file)).unwrap().without_friction();
    let references = Reference::read(&root.join(format!("tests/fixtures/{name}.kinematics.jsonl")));
    for reference in &references {
        let names: Vec<_> = robot.joints().iter().map(|joint| joint.name.as_str()).collect();
        assert_eq!(reference.line["joints"].as_array().unwrap().len(), names.len());
        assert!(reference.line["joints"].as_array().unwrap().iter().eq(names.iter()), "{names:?}");
    }
    (robot, references)
}

fn both(motion: Motion<f64>) -> Vec<f64> {
    [motion.angular, motion.linear].map(Vec3::to_array).concat()
}

fn check(file: &str, name: &str) {
    let (robot, references) = read(file, name);
    let mut kinematics = Kinematics::<f64>::new(&robot);
    assert!(!references.is_empty());
    for (number, reference) in references.iter().enumerate() {
        let frame = robot.frame_index(reference.line["frame"].as_str().unwrap()).unwrap();
        let context = format!("{name} line {}", number + 1);
        let [q, v, a] = ["q", "v", "a"].map(|key| reference.numbers(key));
        kinematics.set_motion(&q, &v, &a).unwrap();
        let pose = kinematics.pose(frame).unwrap();
        reference.agrees("rotation", &pose.rotation.concat(), &context);
        reference.agrees("position", &pose.position, &context);
        for (key, axes) in CONVENTIONS {
            let agrees =
                |what: &str, found: &[f64]| reference.agrees(&format!("{what}.{key}"), found, &context);
            agrees("twist", &both(kinematics.twist(frame, axes).unwrap()));
            agrees("acceleration", &both(kinematics.acceleration(frame, axes).unwrap()));
            agrees("jacobian", kinematics.jacobian(frame, axes).unwrap().as_slice());
            agrees("jacobian_rate", kinematics.jacobian_rate(frame, axes).unwrap().as_slice());
        }
        let centre = kinematics.centre_of_mass().unwrap();
        reference.agrees("com", &centre.position, &context);
        reference.agrees("com_velocity", &centre.velocity, &context);
        reference.agrees("com_acceleration", &centre.acceleration, &context);
        reference.agrees("com_jacobian", centre.jacobian.as_slice(), &context);
        let momentum = kinematics.momentum().unwrap();
        reference.agrees("momentum", &[momentum.angular, momentum.linear].concat(), &context);
        reference.agrees("momentum_rate", &[momentum.angular_rate, momentum.linear_rate].concat(), &context);
        reference.agrees("momentum_matrix", momentum.matrix.as_slice(), &context);
    }
}

/// Inverse and forward dynamics with a wrench at the frame, given in its axes or in those of the world.
fn check_wrenches(file: &str, name: &str) {
    let (robot, references) = read(file, name);
    for (number, reference) in references.iter().enumerate() {
        let frame = reference.line["frame"].as_str().unwrap();
        let context = format!("{name} line {}", number + 1);
        let [q, v, a] = ["q", "v", "a"].map(|key| reference.numbers(key));
        let tau = Lagrangian::<f64>::new(&robot).inverse_dynamics(&q, &v, &a).unwrap().to_vec();
        reference.agrees("tau", &tau, &context);
        let wrench = reference.numbers("wrench");
        let three = |start: usize| [wrench[start], wrench[start + 1], wrench[start + 2]];
        for (key, axes) in [("local", WrenchAxes::Local), ("aligned", WrenchAxes::Aligned)] {
            let wrench = Wrench { moment: three(0), force: three(3), axes };
            let mut lagrangian = Lagrangian::<f64>::new(&robot.with_wrench(frame, wrench).unwrap());
            let agrees =
                |what: &str, found: &[f64]| reference.agrees(&format!("{what}.{key}"), found, &context);
            agrees("tau", lagrangian.inverse_dynamics(&q, &v, &a).unwrap());
            agrees("qdd", lagrangian.forward_dynamics(&q, &v, &a).unwrap());
            if axes == WrenchAxes::Local {
                let inverse = lagrangian.linearise_inverse_dynamics(&q, &v, &a).unwrap();
                agrees("tau_q", inverse.tau_q.as_slice());
                let forward = lagrangian.linearise_forward_dynamics(&q, &v, &a).unwrap();
                agrees("qdd_q", &flat(forward.a_q()));
                agrees("qdd_v", &flat(forward.a_v()));
            }
        }
    }
}

#[test]
fn wrenches_at_links() {
    check_wrenches("robots/ur5.urdf", "ur5");
    check_wrenches("robots/panda.urdf", "panda");
    check_wrenches("tests/fixtures/mixed_tree.urdf", "mixed_tree");
}

#[test]
fn ur5() {
    check("robots/ur5.urdf", "ur5");
}

#[test]
fn panda() {
    check("robots/panda.urdf", "panda");
}

#[test]
fn mixed_tree() {
    check("tests/fixtures/mixed_tree.urdf", "mixed_tree");
}
