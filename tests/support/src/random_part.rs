//! Random joints with their links, and which of them depend on others.

use crate::random_position::Kind;
use nalgebra::Vector3;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Everything that one joint is made of.
#[derive(Clone, Debug)]
pub struct Part {
    pub kind: Kind,
    pub parent: usize,
    pub rpy: [f64; 3],
    pub xyz: [f64; 3],
    pub axis: [f64; 3],
    pub mass: f64,
    pub com: [f64; 3],
    pub radii: [f64; 3],
    pub massless: bool,
    /// Armature, spring and friction: of joints of one degree of freedom.
    pub armature: f64,
    pub spring: [f64; 2],
    pub friction: [f64; 3],
    /// The joint that it mimics, with ratio and offset, unless none can be found; see
    /// [`mimicked`](crate::random_robot::Case::mimicked).
    pub mimic: Option<(usize, f64, f64)>,
}

pub(crate) fn numbers(range: f64) -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-range..range)
}

/// General directions, and the special ones that real robots are made of.
fn axes() -> impl Strategy<Value = [f64; 3]> {
    let special = prop::sample::select(vec![
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 1.0, 0.0],
    ]);
    let general = numbers(1.0).prop_filter("an axis has a direction", |a| Vector3::from(*a).norm() > 0.1);
    prop_oneof![special, general]
}

/// General rotations, and quarter turns: parallel and orthogonal axes.
fn angles() -> impl Strategy<Value = [f64; 3]> {
    let special = prop::array::uniform3(prop::sample::select(vec![0.0, 0.0, FRAC_PI_2, -FRAC_PI_2, PI]));
    prop_oneof![special, numbers(PI)]
}

/// General offsets, and none: intersecting axes.
fn offsets() -> impl Strategy<Value = [f64; 3]> {
    prop_oneof![Just([0.0; 3]), Just([0.4, 0.0, 0.0]), numbers(0.6)]
}

fn part(kinds: BoxedStrategy<Kind>) -> impl Strategy<Value = Part> {
    let joint = (kinds, 0..1000_usize, angles(), offsets(), axes());
    let link = (0.2..4.0, numbers(0.3), prop::array::uniform3(0.1..0.4), prop::bool::weighted(0.15));
    let extras = (
        prop_oneof![Just(0.0), 0.0..1.0],
        prop_oneof![Just([0.0, 0.0]), (1.0..20.0, -1.0..1.0).prop_map(|(k, r)| [k, r])],
        prop_oneof![Just([0.0, 0.0, 0.1]), (0.0..2.0, 0.0..2.0, 0.2..1.0).prop_map(|(b, c, s)| [b, c, s])],
    );
    (joint, link, extras).prop_map(|(joint, link, extras)| {
        let (kind, parent, rpy, xyz, axis) = joint;
        let (mass, com, radii, massless) = link;
        let (armature, spring, friction) = extras;
        let mimic = None;
        Part { kind, parent, rpy, xyz, axis, mass, com, radii, massless, armature, spring, friction, mimic }
    })
}

/// Joints, of which in every fourth robot some mimic others: by any ratio, with and without an offset.
pub(crate) fn parts(count: usize, kinds: BoxedStrategy<Kind>) -> impl Strategy<Value = Vec<Part>> {
    let ratio = prop_oneof![Just(1.0), Just(-1.0), 0.3..2.0, -2.0..-0.3];
    let mimic = (0..1000_usize, ratio, prop_oneof![Just(0.0), -1.0..1.0]);
    let mimics = prop::collection::vec(prop::option::weighted(0.4, mimic), count);
    let mimics = prop_oneof![3 => Just(vec![None; count]), 1 => mimics];
    (prop::collection::vec(part(kinds), count), mimics).prop_map(|(mut parts, mimics)| {
        parts.iter_mut().zip(mimics).for_each(|(part, mimic)| part.mimic = mimic);
        parts
    })
}

/// The joints that mimic none.
pub(crate) fn independent(parts: &[Part]) -> impl Iterator<Item = usize> {
    (0..parts.len()).filter(|&i| mimicked(parts, i).is_none())
}

/// Number of degrees of freedom.
pub(crate) fn dof(parts: &[Part]) -> usize {
    independent(parts).map(|i| parts[i].kind.dof()).sum()
}

/// As [`mimicked`](crate::random_robot::Case::mimicked).
pub(crate) fn mimicked(parts: &[Part], i: usize) -> Option<usize> {
    let (choice, ..) = parts[i].mimic.filter(|_| parts[i].kind.free().is_none())?;
    let single = |&k: &usize| parts[k].kind.free().is_none();
    let earlier: Vec<usize> = (0..i).filter(single).collect();
    let later: Vec<usize> =
        (i + 1..parts.len()).filter(|&k| parts[k].mimic.is_none()).filter(single).collect();
    match (choice % 2, earlier.len()) {
        (1, _) | (_, 0) if !later.is_empty() => Some(later[choice / 2 % later.len()]),
        (_, 0) => None,
        (_, count) => Some(earlier[choice / 2 % count]),
    }
}

/// As [`parent`](crate::random_robot::Case::parent).
pub(crate) fn parent(part: &Part, i: usize) -> Option<usize> {
    if part.parent.is_multiple_of(2) { i.checked_sub(1) } else { (part.parent % (i + 1)).checked_sub(1) }
}
