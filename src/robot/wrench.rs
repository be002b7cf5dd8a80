//! Forces and moments from outside.

/// The axes in which a [`Wrench`] is given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum WrenchAxes {
    /// Those of its frame: the wrench turns with the link, as the thrust of a propeller does.
    #[default]
    Local,
    /// Those of the world: its direction is constant, as that of a weight on a rope.
    Aligned,
}

/// A force at the origin of a frame and a moment, from outside the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Moment (N m).
    pub moment: [f64; 3],
    /// Force (N), through the origin of the frame.
    pub force: [f64; 3],
    /// The axes of both.
    pub axes: WrenchAxes,
}

/// A wrench and the frame that it acts on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct AppliedWrench {
    /// Position of the frame in [`Robot::frames`](super::Robot::frames).
    pub frame: usize,
    /// The wrench.
    pub wrench: Wrench,
}
