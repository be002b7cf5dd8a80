//! Frames of a robot in the frames of its tree.

use super::link::Placement;

/// A frame of the robot in the frames of the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeFrame {
    /// Index of the joint that moves it; `None` if it is fixed to the world.
    pub joint: Option<usize>,
    /// The frame in the aligned frame of that joint, or in the world of the robot (m): constant.
    pub placement: Placement,
}
