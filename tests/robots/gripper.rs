//! The parallel gripper: its fingers stay parallel, it moves as one mass, and loops that are closed in space
//! have rows too many, which are told.

use costate::constraints::{ConstrainedHamiltonian, ConstrainedHamiltonianSecondOrder};
use costate::kinematics::Kinematics;
use costate::robot::{ConstraintSpec, JointSpec, LinkInertia, Placement, Robot};
use nalgebra::Vector3;

/// The way from the first pivot of a side to the finger, and from there to the second one (m).
const ARM: [f64; 2] = [0.0376, 0.043];
const WIDTH: [f64; 2] = [-0.017_901_1, 0.006_516];

fn gripper() -> Robot {
    Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/gripper.toml")).unwrap()
}

/// Where all joints are for an angle of the motor: joint by joint of `independent_joints`.
fn closed(angle: f64) -> [f64; 5] {
    [angle, -angle, angle, -angle, angle]
}

/// Mass that the motor moves (kg m^2) and the moment of the weights (N m), by the parallelogram alone: outer
/// and inner links turn by the angle, fingers go along circles with the radius of the links.
fn one_mass(robot: &Robot, angle: f64) -> [f64; 2] {
    let mut mass = robot.armature_entry(0, 0);
    let mut moment = 0.0;
    let (sin, cos) = angle.sin_cos();
    for joint in robot.joints() {
        let LinkInertia { mass: m, com, inertia } = joint.inertia;
        let is_finger = joint.name.ends_with("finger");
        let [y, z] = if is_finger { ARM } else { [com.y, com.z] };
        mass += m * (y * y + z * z) + if is_finger { 0.0 } else { inertia[(0, 0)] };
        // Height y sin + z cos.
        moment += 9.81 * m * (y * cos - z * sin);
    }
    [mass, moment]
}

#[test]
fn the_fingers_stay_parallel_over_the_whole_stroke() {
    let robot = gripper();
    let joints: Vec<&str> = robot.independent_joints().map(|joint| joint.name.as_str()).collect();
    assert_eq!(joints, ["left_outer", "left_finger", "left_inner", "right_finger", "right_inner"]);
    let mut h = ConstrainedHamiltonian::<f64>::new(&robot);
    let mut kinematics = Kinematics::<f64>::new(&robot.without_constraints());
    let pads = ["left_pad", "right_pad"].map(|pad| robot.frame_index(pad).unwrap());
    let stroke = robot.joints()[0].limits.upper;
    let mut q = closed(0.0);
    let mut widths = Vec::new();
    for step in 0..=81 {
        let angle = stroke * f64::from(step) / 81.0;
        q[0] = angle;
        h.close(&mut q, &[true, false, false, false, false]).unwrap();
        for (found, expected) in q.iter().zip(closed(angle)) {
            assert!((found - expected).abs() < 1e-12, "{angle}: {q:?}");
        }
        kinematics.set_position(&q).unwrap();
        let [left, right] = pads.map(|pad| kinematics.pose(pad).unwrap());
        for (k, side) in [(1.0, &left), (-1.0, &right)] {
            // The left finger is not turned, the right one by pi about z.
            let turned = [[k, 0.0, 0.0], [0.0, k, 0.0], [0.0, 0.0, 1.0]];
            for (found, expected) in side.rotation.as_flattened().iter().zip(turned.as_flattened()) {
                assert!((found - expected).abs() < 1e-12, "{angle}: {:?}", side.rotation);
            }
        }
        let half = 0.030_601_1 - 0.025_195_3 + ARM[0] * angle.cos() - ARM[1] * angle.sin();
        assert!((left.position[1] - half).abs() < 1e-12 && (right.position[1] + half).abs() < 1e-12);
        assert!((left.position[2] - right.position[2]).abs() < 1e-12, "the pads are at one height");
        widths.push(2.0 * half);
    }
    assert!((widths[0] - 0.086).abs() < 2e-5 && widths[81] > 0.0 && widths[81] < 4e-4, "{widths:?}");
    assert!(widths.is_sorted_by(|wider, narrower| wider > narrower));
    let state = [0.0; 5];
    h.evaluate(&q, &state, &state).unwrap();
    assert_eq!((h.rank(), h.redundant().count()), (4, 0));
}

#[test]
fn it_moves_as_the_one_mass_of_its_motor() {
    let robot = gripper();
    let mut h = ConstrainedHamiltonian::<f64>::new(&robot);
    for (angle, rate, torque) in [(0.0, 0.0, 0.2), (0.3, 1.4, -0.1), (0.81, -2.0, 0.05)] {
        let (q, v) = (closed(angle), closed(rate));
        let [mass, moment] = one_mass(&robot, angle);
        // The mass is the same in every position: only the weights depend on the angle.
        let expected = closed((torque - moment) / mass);
        let p = h.momentum(&q, &v).unwrap().to_vec();
        let linear = h.linearise(&q, &p, &[torque, 0.0, 0.0, 0.0, 0.0]).unwrap();
        for (found, expected) in linear.acceleration().iter().zip(expected) {
            assert!((found - expected).abs() < 1e-10 * expected.abs(), "{angle}: {found} {expected}");
        }
        let energy = h.energy(&q, &p).unwrap();
        let kinetic = 0.5 * mass * rate * rate;
        assert!((energy.kinetic - kinetic).abs() < 1e-12 * kinetic.max(1e-4), "{energy:?} {kinetic}");
    }
}

/// The same gripper with each finger in two halves that a weld holds together: of its six rows three are
/// closed by the joints.
fn welded() -> Robot {
    let robot = gripper();
    let at = |[y, z]: [f64; 2]| Placement::from_xyz_rpy([0.0, y, z], [0.0; 3]);
    let mut builder = Robot::builder("welded");
    for joint in robot.joints() {
        let mut spec = if joint.name.ends_with("outer") || joint.name.ends_with("inner") {
            JointSpec::revolute(&joint.name).placed(joint.placement).carrying(joint.inertia)
        } else {
            let half = LinkInertia {
                mass: 0.5 * joint.inertia.mass,
                inertia: joint.inertia.inertia * 0.5,
                ..joint.inertia
            };
            let side = joint.name.trim_end_matches("finger");
            let moved = Vector3::new(0.0, WIDTH[0], WIDTH[1]);
            let other = JointSpec::revolute(format!("{side}tip")).on(format!("{side}inner")).placed(at(ARM));
            builder = builder
                .joint(other.axis([1.0, 0.0, 0.0]).carrying(LinkInertia { com: half.com - moved, ..half }));
            JointSpec::revolute(&joint.name).on(format!("{side}outer")).placed(at(ARM)).carrying(half)
        };
        spec = spec.axis([1.0, 0.0, 0.0]);
        if joint.name == "left_outer" {
            spec = spec.armature(robot.armature_entry(0, 0));
        }
        if joint.name == "right_outer" {
            spec = spec.mimicking("left_outer", 1.0, 0.0);
        }
        builder = builder.joint(spec);
    }
    let weld = |robot: Robot, side: &str| {
        let weld =
            ConstraintSpec::rigid(format!("{side}_weld"), &format!("{side}_finger"), &format!("{side}_tip"));
        robot.with_constraint(weld.placed(at(WIDTH))).unwrap()
    };
    weld(weld(builder.build().unwrap(), "left"), "right")
}

#[test]
fn of_the_six_rows_of_a_weld_three_are_told_to_be_redundant() {
    let (robot, plain) = (welded(), gripper());
    let mut second = ConstrainedHamiltonianSecondOrder::<f64>::new(&robot);
    let names: Vec<&str> = robot.independent_joints().map(|joint| joint.name.as_str()).collect();
    let n = names.len();
    assert_eq!(n, 7);
    // All but inner links and tips turn back by what the links turn.
    let closed = |angle: f64| -> Vec<f64> {
        let back = |name: &&str| name.ends_with("finger") || name.ends_with("tip");
        names.iter().map(|name| if back(name) { -angle } else { angle }).collect()
    };
    let motor = names.iter().position(|name| *name == "left_outer").unwrap();
    let mut u = vec![0.0; n];
    for (angle, rate, torque) in [(0.2, 1.0, 0.1), (0.7, -1.5, 0.0)] {
        u[motor] = torque;
        let [mass, moment] = one_mass(&plain, angle);
        let expected = closed((torque - moment) / mass);
        let q = closed(angle);
        let p = second.first().momentum(&q, &closed(rate)).unwrap().to_vec();
        let y: Vec<f64> = (0..2 * n).map(|i| (1.0 + 1.7 * i as f64).sin()).collect();
        let all = second.contract(&q, &p, &u, &y).unwrap();
        for (found, expected) in all.linearisation().acceleration().iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-9 * expected.abs(), "{angle}: {found} {expected}");
        }
        assert!(all.matrix().to_nalgebra().iter().all(|entry| entry.is_finite()));
        let first = second.first();
        assert_eq!(first.rank(), 6);
        let redundant: Vec<&str> = first.redundant().collect();
        assert_eq!(
            redundant,
            ["left_weld", "left_weld", "left_weld", "right_weld", "right_weld", "right_weld"]
        );
    }
}
