//! The robots to measure: files, and random ones with axes and inertias in general directions.

use costate::robot::{JointSpec, LinkInertia, Placement, Robot};
use fastrand::Rng;
use nalgebra::Matrix3;

/// Joints and links in random directions; joint i stands on one of the `reach` joints before it.
pub fn random(name: &str, n: usize, reach: usize) -> Robot {
    let mut rng = Rng::with_seed(24_2005);
    let mut builder = Robot::builder(name);
    for i in 0..n {
        let mut numbers = || std::array::from_fn(|_| rng.f64() - 0.5);
        let [translation, turns, axis, com]: [[f64; 3]; 4] = std::array::from_fn(|_| numbers());
        let spread = Matrix3::from_columns(&[numbers(), numbers(), numbers()].map(nalgebra::Vector3::from));
        let inertia = (spread * spread.transpose() + Matrix3::identity()) * 0.05;
        let mut joint = JointSpec::revolute(format!("joint_{i}"))
            .axis(axis)
            .placed(Placement::from_xyz_rpy(translation, turns.map(|turn| 6.0 * turn)))
            .carrying(LinkInertia::about_com(0.5 + rng.f64(), com, inertia));
        if i > 0 {
            joint = joint.on(format!("joint_{}", rng.usize(i.saturating_sub(reach)..i)));
        }
        builder = builder.joint(joint);
    }
    builder.build().unwrap()
}

/// A robot of the folder `robots/`.
pub fn file(name: &str) -> Robot {
    Robot::from_file(format!("{}/../../robots/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// All of them, with the name for the table.
pub fn all() -> Vec<(String, Robot)> {
    let read = |name: &str, path: &str| (name.to_owned(), file(path));
    let mut robots = vec![
        read("UR5", "ur5.urdf"),
        read("PUMA 560", "puma560.toml"),
        read("Panda", "panda.urdf"),
        read("biped", "biped.toml"),
    ];
    for n in [6, 8, 10, 12, 16, 24, 48] {
        robots.push((format!("general chain {n}"), random("chain", n, 1)));
    }
    robots.push(("general tree 24".to_owned(), random("tree", 24, 4)));
    robots
}
