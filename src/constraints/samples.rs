//! Robots with constraints of all kinds, and states of them, for tests.

use crate::robot::{ConstraintRow, ConstraintSpec, Friction, JointSpec, LinkInertia, Placement, Robot};
use nalgebra::Matrix3;

fn link(k: f64) -> LinkInertia {
    let inertia = Matrix3::new(0.5, 0.02, -0.1, 0.02, 0.7, 0.05, -0.1, 0.05, 0.6);
    LinkInertia::about_com(1.0 + 0.3 * k, [0.2 * k, -0.3, 0.1 + 0.1 * k], inertia * (0.3 + 0.1 * k))
}

fn placed(x: f64) -> Placement {
    Placement::from_xyz_rpy([x, 0.3, -0.2], [0.5 - x, x, 0.4 * x])
}

/// A tree of seven joints with two branches, a mimic and friction.
fn tree() -> Robot {
    let joint = |name: &str, k: f64| JointSpec::revolute(name).placed(placed(k)).carrying(link(k));
    let slide = |name: &str, k: f64| JointSpec::prismatic(name).placed(placed(k)).carrying(link(k));
    let rub = Friction { viscous: 0.3, coulomb: 0.4, coulomb_velocity: 0.5 };
    Robot::builder("tree")
        .gravity([0.7, -1.0, -9.81])
        .joint(joint("a", 0.3).axis([0.3, -0.5, 0.8]))
        .joint(joint("b", 0.6).on("a").friction(rub))
        .joint(slide("c", -0.4).on("b").axis([0.0, 1.0, 0.0]))
        .joint(joint("d", 0.2).on("a").axis([1.0, 0.0, 0.2]))
        .joint(slide("e", 0.5).on("d"))
        .joint(joint("f", 0.1).on("e").mimicking("b", -0.7, 0.2))
        .joint(joint("g", 0.4).on("c").axis([0.0, 1.0, 0.3]))
        .build()
        .unwrap()
}

/// The four-bar linkage of `robots/four_bar.toml`.
pub(super) fn four_bar() -> Robot {
    Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/four_bar.toml")).unwrap()
}

/// Every kind of constraint alone, and some together.
pub(super) fn looped() -> Vec<Robot> {
    use ConstraintRow::{TurnX, TurnZ, X, Z};
    let specs = [
        ConstraintSpec::pinned("pin", "g", "f").placed(placed(0.1)),
        ConstraintSpec::rows("row", "f", "world", &[Z, TurnX, TurnZ]).to_placed(placed(-0.3)),
        ConstraintSpec::distance("rod", "c", "e", 0.8).placed(placed(0.2)).to_placed(placed(-0.5)),
        ConstraintSpec::coupling("gear", &[("a", 1.0), ("f", -0.4), ("g", 2.0)], 0.3),
        ConstraintSpec::rows("line", "world", "g", &[X, Z]),
    ];
    let with = |specs: &[&ConstraintSpec]| {
        specs.iter().fold(tree(), |robot, &spec| robot.with_constraint(spec.clone()).unwrap())
    };
    let [pin, row, rod, gear, line] = &specs;
    let weld = ConstraintSpec::rigid("weld", "g", "world").to_placed(placed(0.6));
    vec![with(&[pin]), with(&[row]), with(&[rod, gear]), with(&[line, gear, rod]), with(&[&weld]), tree()]
}

/// Four chains of eight joints, each tied to the next one by four rows or three: blocks of the derivatives
/// are limited to what tree and rows leave, and the last rows know of the first chain only through rows
/// before them.
pub(super) fn tied_chains() -> Robot {
    let mut builder = Robot::builder("tied_chains").gravity([0.7, -1.0, -9.81]);
    for chain in ["a", "b", "c", "d"] {
        for j in 0..8 {
            let k = 0.1 * f64::from(j);
            let axis = [1.0 - k, 0.3 * f64::from(j % 3), 0.5 + k];
            let joint =
                JointSpec::revolute(format!("{chain}{j}")).placed(placed(k)).carrying(link(k)).axis(axis);
            builder = builder.joint(if j == 0 { joint } else { joint.on(format!("{chain}{}", j - 1)) });
        }
    }
    let ties = [
        ConstraintSpec::pinned("pin_ab", "a7", "b5").placed(placed(0.1)),
        ConstraintSpec::distance("rod_ab", "a4", "b7", 0.8).placed(placed(0.2)),
        ConstraintSpec::pinned("pin_bc", "b6", "c7").placed(placed(-0.2)),
        ConstraintSpec::distance("rod_bc", "b4", "c5", 0.7).placed(placed(0.3)),
        ConstraintSpec::pinned("pin_cd", "c6", "d7").placed(placed(0.4)),
    ];
    ties.into_iter().fold(builder.build().unwrap(), |robot, tie| robot.with_constraint(tie).unwrap())
}

/// Four vectors of n, n, n and 2n entries.
pub(super) fn state(n: usize) -> [Vec<f64>; 4] {
    let wave = |scale: f64, from: f64, count: usize| -> Vec<f64> {
        (0..count).map(|i| scale * (from + 1.7 * i as f64).sin()).collect()
    };
    [wave(0.6, 0.3, n), wave(1.4, 1.1, n), wave(2.0, -0.4, n), wave(1.0, 2.0, 2 * n)]
}
