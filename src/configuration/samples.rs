//! Robots with floating and spherical joints, and states of them, for tests.

use super::ConfigurationSpace;
use crate::robot::{Friction, JointSpec, LinkInertia, Placement, Robot};
use nalgebra::Matrix3;

pub(crate) fn link(k: f64) -> LinkInertia {
    let inertia = Matrix3::new(0.5, 0.02, -0.1, 0.02, 0.7, 0.05, -0.1, 0.05, 0.6);
    LinkInertia::about_com(1.0 + 0.3 * k, [0.2 * k, -0.3, 0.1 + 0.1 * k], inertia * (0.3 + 0.1 * k))
}

pub(crate) fn placed(x: f64) -> Placement {
    Placement::from_xyz_rpy([x, 0.3, -0.2], [1.0 - x, x, 2.0 * x])
}

/// Robots with free joints at the root and beyond, on slides, on branches, with mimics and friction.
pub(crate) fn robots() -> Vec<Robot> {
    let joint = |name: &str, k: f64| JointSpec::revolute(name).placed(placed(k)).carrying(link(k));
    let slide = |name: &str, k: f64| JointSpec::prismatic(name).placed(placed(k)).carrying(link(k));
    let floating = |name: &str, k: f64| JointSpec::floating(name).placed(placed(k)).carrying(link(k));
    let ball = |name: &str, k: f64| JointSpec::spherical(name).placed(placed(k)).carrying(link(k));
    let rub = Friction { viscous: 0.3, coulomb: 0.4, coulomb_velocity: 0.5 };
    let builders = [
        Robot::builder("body").joint(floating("root", 0.4)),
        Robot::builder("ball").joint(ball("root", 0.4)),
        Robot::builder("legs")
            .joint(floating("root", 0.0))
            .joint(joint("a", 0.3).on("root").axis([0.3, -0.5, 0.8]))
            .joint(joint("b", 0.6).on("a").friction(rub))
            .joint(slide("c", -0.4).on("root").axis([0.0, 1.0, 0.0]))
            .joint(joint("d", 0.2).on("c").mimicking("a", -0.7, 0.2)),
        Robot::builder("inside")
            .joint(joint("a", 0.3).axis([0.3, -0.5, 0.8]))
            .joint(ball("wrist", 0.5).on("a"))
            .joint(slide("c", -0.4).on("wrist").axis([1.0, 1.0, 0.0]))
            .joint(floating("load", 0.7).on("c"))
            .joint(joint("d", 0.1).on("load").friction(rub))
            .joint(ball("tail", 0.8).on("wrist")),
    ];
    let mut robots: Vec<Robot> =
        builders.map(|builder| builder.gravity([0.7, -1.0, -9.81]).build().unwrap()).into();
    robots.extend((0..4).map(random));
    robots
}

/// A tree of five joints of any type on any of those before, at least one of them free.
pub(crate) fn random(seed: u64) -> Robot {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = move |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let mut builder = Robot::builder(format!("random {seed}")).gravity([0.7, -1.0, -9.81]);
    let free = next(5);
    for i in 0..5 {
        let name = format!("j{i}");
        let kind = if i == free { 2 + next(2) } else { next(4) };
        let mut spec = match kind {
            0 => JointSpec::revolute(&name).axis([0.3, -0.5, 0.8]),
            1 => JointSpec::prismatic(&name).axis([1.0, 0.4, 0.2]),
            2 => JointSpec::floating(&name),
            _ => JointSpec::spherical(&name),
        };
        spec = spec.placed(placed(0.1 * next(20) as f64 - 1.0)).carrying(link(0.1 * next(10) as f64));
        if i > 0 {
            spec = spec.on(format!("j{}", next(i)));
        }
        builder = builder.joint(spec);
    }
    builder.build().unwrap()
}

/// A configuration, a momentum or velocity, an actuation, and a costate of 2n entries.
pub(crate) fn state(space: &ConfigurationSpace) -> [Vec<f64>; 4] {
    let n = space.dof();
    let wave = |scale: f64, from: f64, count: usize| -> Vec<f64> {
        (0..count).map(|i| scale * (from + 1.7 * i as f64).sin()).collect()
    };
    let mut q = space.neutral();
    space.integrate(&space.neutral(), &wave(1.4, 0.3, n), &mut q).unwrap();
    [q, wave(2.0, 1.1, n), wave(3.0, -0.4, n), wave(1.0, 2.0, 2 * n)]
}
