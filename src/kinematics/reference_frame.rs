//! The three usual conventions for twists, Jacobians and wrenches.

/// The axes of a six-vector of a frame, and the point that it belongs to.
///
/// For the pose (R, x) of the frame, angular velocity w and velocity of the origin dx/dt, in axes of the
/// world, the twist `V = (angular; linear)` is
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ReferenceFrame {
    /// `(R'w ; R' dx/dt)`: the origin and the axes of the frame itself.
    Local,
    /// `(w ; dx/dt - w x x)`: the point of the link that is at the origin of the world, axes of the world.
    World,
    /// `(w ; dx/dt)`: the origin of the frame, axes of the world. Its linear part is the derivative of the
    /// position.
    #[default]
    LocalWorldAligned,
}

impl ReferenceFrame {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Local, Self::World, Self::LocalWorldAligned];
}
