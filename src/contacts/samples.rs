//! Robots that stand, and states of them, for tests.

use super::{Contact, Sole};
use crate::kinematics::Kinematics;
use crate::robot::{JointSpec, LinkInertia, Placement, Robot};
use crate::scalar::Scalar;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

pub(super) fn lift<S: Scalar>(a: &[f64]) -> Vec<S> {
    a.iter().map(|&a| S::from_f64(a)).collect()
}

pub(super) fn at(xyz: [f64; 3]) -> Placement {
    Placement::from_xyz_rpy(xyz, [0.0; 3])
}

/// A body on a base of three joints in the plane of x and z, with two legs of two links: n = 7.
pub(super) fn biped() -> Robot {
    let inertia = |mass: f64, z: f64| {
        LinkInertia::about_com(mass, [0.01, 0.0, z], Matrix3::from_diagonal_element(0.05 * mass))
    };
    let turn = |name: &str| JointSpec::revolute(name).axis([0.0, 1.0, 0.0]);
    let mut builder = Robot::builder("planar biped")
        .gravity([0.0, 0.0, -9.81])
        .joint(JointSpec::prismatic("x").axis([1.0, 0.0, 0.0]))
        .joint(JointSpec::prismatic("z").on("x").axis([0.0, 0.0, 1.0]))
        .joint(turn("pitch").on("z").carrying(inertia(20.0, 0.3)));
    for side in ["left", "right"] {
        let (hip, knee) = (format!("{side}_hip"), format!("{side}_knee"));
        builder = builder.joint(turn(&hip).on("pitch").carrying(inertia(5.0, -0.2)));
        builder =
            builder.joint(turn(&knee).on(&hip).placed(at([0.0, 0.0, -0.4])).carrying(inertia(3.0, -0.15)));
    }
    builder.build().unwrap()
}

pub(super) fn toe(side: &str) -> Contact {
    Contact::point(side, &format!("{side}_knee")).placed(at([0.0, 0.0, -0.4])).friction(0.6)
}

/// Position, velocity before the constraints, torques: none at the base.
pub(super) fn biped_state() -> [Vec<f64>; 3] {
    let q = vec![0.1, 0.75, 0.1, -0.5, 0.4, 0.35, 0.3];
    let v = vec![0.6, -0.2, 0.3, -0.4, 0.8, 0.5, -0.7];
    [q, v, vec![0.0, 0.0, 0.0, 12.0, -7.0, 5.0, 9.0]]
}

fn body() -> LinkInertia {
    let inertia = Matrix3::new(0.4, 0.02, 0.0, 0.02, 0.5, 0.1, 0.0, 0.1, 0.3);
    LinkInertia::about_com(6.0, [0.05, -0.1, 0.2], inertia)
}

fn ankle(on: &str) -> JointSpec {
    JointSpec::revolute("ankle").axis([0.2, 1.0, 0.1]).on(on).placed(at([0.1, 0.0, -0.4])).carrying(body())
}

/// A leg with a foot on a base of six joints, and one joint more: n = 7.
pub(super) fn hopper() -> (Robot, Contact, Placement) {
    let along = |name: &str, axis| JointSpec::prismatic(name).axis(axis);
    let about = |name: &str, axis| JointSpec::revolute(name).axis(axis);
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let robot = Robot::builder("hopper")
        .gravity([0.0, 0.0, -9.81])
        .joint(along("x", x))
        .joint(along("y", y).on("x"))
        .joint(along("z", z).on("y"))
        .joint(about("yaw", z).on("z"))
        .joint(about("roll", x).on("yaw"))
        .joint(about("pitch", y).on("roll").carrying(body()))
        .joint(ankle("pitch"))
        .build()
        .unwrap();
    let q = hopper_state()[0].clone();
    let mut kinematics = Kinematics::<f64>::new(&robot);
    kinematics.set_position(&q).unwrap();
    let pose = kinematics.pose(robot.frame_index("ankle").unwrap()).unwrap();
    // The axes of the contact are those of the world where it stands.
    let rotation = Matrix3::from_fn(|i, j| pose.rotation[j][i]);
    let placement = Placement { rotation, translation: Vector3::new(0.02, 0.01, -0.1) };
    let sole = Sole { x: [-0.1, 0.15], y: [-0.05, 0.06] };
    let foot = Contact::foot("foot", "ankle").placed(placement).friction(0.5).torsion(0.03).sole(sole);
    (robot, foot, placement)
}

pub(super) fn hopper_state() -> [Vec<f64>; 3] {
    let q = vec![0.3, -0.2, 0.8, 0.4, -0.3, 0.2, 0.5];
    let v = vec![0.5, 0.3, -0.4, 0.7, 0.2, -0.6, 0.9];
    [q, v, vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 8.0]]
}

/// The same on a floating base, in the same place: q, v and u of the body in its axes.
pub(super) fn floating_hopper() -> (Robot, Contact, [Vec<f64>; 3]) {
    let [q, v, u] = hopper_state();
    let about = |axis: Vector3<f64>, angle: f64| UnitQuaternion::new(axis * angle);
    let turn = about(Vector3::z(), q[3]) * about(Vector3::x(), q[4]) * about(Vector3::y(), q[5]);
    let robot = Robot::builder("floating hopper")
        .gravity([0.0, 0.0, -9.81])
        .joint(JointSpec::floating("base").carrying(body()))
        .joint(ankle("base"))
        .build()
        .unwrap();
    let q = [&q[..3], turn.coords.as_slice(), &q[6..]].concat();
    (robot, hopper().1, [q, v, u])
}
