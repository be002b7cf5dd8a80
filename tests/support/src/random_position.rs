//! Types of joints, and random positions of them.

use costate::robot::{FreeKind, JointSpec};
use proptest::prelude::*;
use proptest::sample::select;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// The type of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Revolute,
    Prismatic,
    Spherical,
    Floating,
}

impl Kind {
    /// What it is if its orientation is a quaternion.
    pub fn free(self) -> Option<FreeKind> {
        match self {
            Self::Spherical => Some(FreeKind::Spherical),
            Self::Floating => Some(FreeKind::Floating),
            Self::Revolute | Self::Prismatic => None,
        }
    }

    /// Number of entries of v.
    pub fn dof(self) -> usize {
        self.free().map_or(1, FreeKind::dof)
    }

    /// Number of entries of q.
    pub fn positions(self) -> usize {
        self.free().map_or(1, FreeKind::positions)
    }

    pub fn spec(self, name: String) -> JointSpec {
        match self {
            Self::Revolute => JointSpec::revolute(name),
            Self::Prismatic => JointSpec::prismatic(name),
            Self::Spherical => JointSpec::spherical(name),
            Self::Floating => JointSpec::floating(name),
        }
    }
}

/// Joints of one degree of freedom.
pub fn single() -> BoxedStrategy<Kind> {
    any::<bool>().prop_map(|prismatic| if prismatic { Kind::Prismatic } else { Kind::Revolute }).boxed()
}

/// Joints of every type.
pub fn every() -> BoxedStrategy<Kind> {
    select(vec![Kind::Revolute, Kind::Prismatic, Kind::Spherical, Kind::Floating]).boxed()
}

fn unit(a: [f64; 4]) -> [f64; 4] {
    let length = a.iter().map(|a| a * a).sum::<f64>().sqrt();
    a.map(|a| a / length)
}

/// Unit quaternions (x, y, z, w): any, of both signs of w; no turn, half turns, and close to these.
fn quaternions() -> impl Strategy<Value = [f64; 4]> {
    let general = prop::array::uniform4(-1.0..1.0_f64)
        .prop_filter("a quaternion has a length", |a| a.iter().map(|a| a * a).sum::<f64>() > 0.01)
        .prop_map(unit);
    let special = select(vec![
        [0.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 0.0, -1.0],
        [1.0, 0.0, 0.0, 0.0],
        [0.0, -1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [FRAC_1_SQRT_2, 0.0, -FRAC_1_SQRT_2, 0.0],
        [FRAC_1_SQRT_2, 0.0, 0.0, -FRAC_1_SQRT_2],
        unit([0.6, 0.0, 0.8, 1e-9]),
        unit([0.6, -0.8, 0.0, -1e-9]),
        unit([1e-9, -2e-9, 1e-9, 1.0]),
        unit([1e-9, 2e-9, 0.0, -1.0]),
    ]);
    prop_oneof![2 => general, 1 => special]
}

/// Places of floating joints: none, close and far.
fn places() -> impl Strategy<Value = [f64; 3]> {
    let close = prop::array::uniform3(-1.0..1.0_f64);
    let far = prop::array::uniform3(-1e3..1e3_f64);
    prop_oneof![1 => Just([0.0; 3]), 3 => close, 1 => far]
}

/// q of joints of these types, one after the other.
pub fn positions(kinds: Vec<Kind>) -> impl Strategy<Value = Vec<f64>> {
    let of = |kind: Kind| match kind {
        Kind::Floating => (places(), quaternions()).prop_map(|(at, turn)| [&at[..], &turn].concat()).boxed(),
        Kind::Spherical => quaternions().prop_map(|turn| turn.to_vec()).boxed(),
        Kind::Revolute | Kind::Prismatic => (-PI..PI).prop_map(|q| vec![q]).boxed(),
    };
    kinds.into_iter().map(of).collect::<Vec<_>>().prop_map(|parts| parts.concat())
}
