//! Robots to measure: files of `robots/`, and serial chains with axes and inertias in general directions.

use costate::robot::{JointSpec, LinkInertia, Placement, Robot, RobotError};
use fastrand::Rng;

/// Titles in tables, and the files.
pub const FILES: [(&str, &str); 3] = [("UR5", "ur5.urdf"), ("Panda", "panda.urdf"), ("biped", "biped.toml")];

/// Numbers of joints of the chains.
pub const CHAINS: [usize; 5] = [2, 6, 12, 24, 48];

/// Rotor inertia of every joint of a chain (kg m^2): keeps the mass matrix well conditioned, whatever the
/// length.
const ARMATURE: f64 = 0.5;

/// A robot of `robots/`.
pub fn from_file(file: &str) -> Result<Robot, RobotError> {
    Robot::from_file(format!("{}/../../robots/{file}", env!("CARGO_MANIFEST_DIR")))
}

/// n revolute joints one on another, all directions, lengths and inertias random with a fixed seed.
///
/// A link: mass 0.5 to 1.5 kg, centre of mass and next joint up to 0.2 m away along each axis, a diagonal
/// inertia about the centre of mass of 0.04 to 0.06 kg m^2 (the random turn of each joint makes it general in
/// every other frame).
pub fn chain(n: usize) -> Result<Robot, RobotError> {
    let mut random = Rng::with_seed(24_2005);
    let mut builder = Robot::builder(format!("chain_{n}"));
    for i in 0..n {
        let mut numbers =
            |most: f64| -> [f64; 3] { std::array::from_fn(|_| most * (2.0 * random.f64() - 1.0)) };
        let [offset, turns, axis, com] = [numbers(0.2), numbers(3.0), numbers(1.0), numbers(0.2)];
        let inertia = numbers(0.01).map(|spread| 0.05 + spread);
        let link = LinkInertia::about_com(
            0.5 + random.f64(),
            com,
            [[inertia[0], 0.0, 0.0], [0.0, inertia[1], 0.0], [0.0, 0.0, inertia[2]]].into(),
        );
        let mut joint = JointSpec::revolute(format!("joint_{i}"))
            .axis(axis)
            .placed(Placement::from_xyz_rpy(offset, turns))
            .carrying(link)
            .armature(ARMATURE);
        if i > 0 {
            joint = joint.on(format!("joint_{}", i - 1));
        }
        builder = builder.joint(joint);
    }
    builder.build()
}
