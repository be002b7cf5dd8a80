//! A quadruped for tests.

use crate::robot::{ConstraintSpec, JointSpec, LinkInertia, Placement, Robot};
use nalgebra::Matrix3;

pub(super) fn at(xyz: [f64; 3]) -> Placement {
    Placement::from_xyz_rpy(xyz, [0.0; 3])
}

/// A trunk on four legs of three joints; the base is a floating joint or a chain of six.
pub(super) fn quadruped(floating: bool) -> Robot {
    let body = |mass: f64, z: f64| {
        let inertia = Matrix3::new(1.0, 0.02, -0.05, 0.02, 1.4, 0.03, -0.05, 0.03, 1.2) * (0.02 * mass);
        LinkInertia::about_com(mass, [0.03, -0.02, z], inertia)
    };
    let mut builder = Robot::builder("quadruped").gravity([0.0, 0.0, -9.81]);
    if floating {
        builder = builder.joint(JointSpec::floating("trunk").carrying(body(12.0, 0.05)));
    } else {
        let mut before: Option<String> = None;
        for (k, axis) in [(0, [1.0, 0.0, 0.0]), (1, [0.0, 1.0, 0.0]), (2, [0.0, 0.0, 1.0])] {
            let spec = JointSpec::prismatic(format!("slide{k}")).axis(axis);
            builder = builder.joint(match &before {
                Some(name) => spec.on(name),
                None => spec,
            });
            before = Some(format!("slide{k}"));
        }
        for (name, axis) in [("rx", [1.0, 0.0, 0.0]), ("ry", [0.0, 1.0, 0.0]), ("trunk", [0.0, 0.0, 1.0])] {
            let spec = JointSpec::revolute(name).axis(axis).on(before.as_deref().unwrap());
            builder = builder.joint(if name == "trunk" { spec.carrying(body(12.0, 0.05)) } else { spec });
            before = Some(name.to_owned());
        }
    }
    for (leg, x, y) in [("lf", 0.3, 0.15), ("rf", 0.3, -0.15), ("lh", -0.3, 0.15), ("rh", -0.3, -0.15)] {
        let [roll, hip, knee] = ["roll", "hip", "knee"].map(|joint| format!("{leg}_{joint}"));
        builder = builder
            .joint(JointSpec::revolute(&roll).on("trunk").axis([1.0, 0.0, 0.0]).placed(at([x, y, 0.0])))
            .joint(JointSpec::revolute(&hip).on(&roll).axis([0.0, 1.0, 0.0]).carrying(body(1.5, -0.1)))
            .joint(
                JointSpec::revolute(&knee)
                    .on(&hip)
                    .axis([0.0, 1.0, 0.0])
                    .placed(at([0.0, 0.02, -0.25]))
                    .carrying(body(0.6, -0.1)),
            );
    }
    builder.build().unwrap()
}

pub(super) fn standing(robot: Robot, legs: &[&str]) -> Robot {
    legs.iter().fold(robot, |robot, leg| {
        let spec =
            ConstraintSpec::pinned(*leg, &format!("{leg}_knee"), "world").placed(at([0.0, 0.0, -0.25]));
        robot.with_constraint(spec).unwrap()
    })
}
