//! Bodies, and what they keep away from.

use super::cores::CoreBox;
use crate::task::placed::Carried;
use nalgebra::Vector3;

/// A sphere or a capsule: its core in the frame that carries it, or in the world.
#[derive(Clone, Debug)]
pub(in crate::task) struct Body {
    pub carried: Option<Carried>,
    pub from: Vector3<f64>,
    /// The end of a capsule.
    pub to: Option<Vector3<f64>>,
    pub radius: f64,
}

/// What a body keeps away from.
#[derive(Clone, Debug)]
pub(in crate::task) enum Other {
    /// Another body of the list.
    Body(usize),
    Box(CoreBox),
    /// Where `normal . x <= height`; the normal has length one.
    HalfSpace {
        normal: Vector3<f64>,
        height: f64,
    },
}

/// An obstacle by itself.
#[derive(Clone, Debug)]
pub(in crate::task) enum Obstacle {
    Body(Body),
    Box(CoreBox),
    /// As [`Other::HalfSpace`].
    HalfSpace {
        normal: Vector3<f64>,
        height: f64,
    },
}

/// A body and what it keeps away from.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    pub body: usize,
    pub other: Other,
    /// The number of the obstacle that it is, if it is one.
    pub obstacle: Option<usize>,
    /// R.
    pub radius: f64,
    /// The joints that move one of the two against the other, for each: joints that move both do not count.
    pub paths: [Vec<usize>; 2],
    /// The coordinates of these joints.
    pub coordinates: Vec<usize>,
}

/// Largest |q| and |dq/dx| of all coordinates on a piece of a motion over x in [0, 1].
#[derive(Clone, Copy, Debug)]
pub(in crate::task) struct Bounds<'a> {
    pub positions: &'a [f64],
    pub rates: &'a [f64],
}

/// Clearances at a place of a motion.
pub(in crate::task) struct Look {
    /// The largest violation, in parts of ranges, and its row; zero and the first row where there is none.
    pub violation: f64,
    pub row: usize,
    /// How far the motion may go on before two cores could meet.
    pub step: f64,
}

/// A point that is fixed to a link, and where it is in the world; a coordinate that is infinite is free.
#[derive(Clone, Copy, Debug)]
pub(in crate::task) struct Held {
    pub joint: usize,
    /// In the axes of the joint.
    pub own: Vector3<f64>,
    pub place: Vector3<f64>,
}
