//! Joints that turn freely: floating and spherical ones.
//!
//! A free joint is a chain of joints of one degree of freedom that never leave zero, behind an orientation
//! that is given by a unit quaternion. Its axes are fixed to the link, and rates along them are the twist of
//! the moved frame: derivatives are those in the left-trivialised tangent space (`kernels/world/`). What does
//! not differentiate by them, as the potential energy, runs on the chain in body frames.

/// The type of a joint that turns freely.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FreeKind {
    /// Moves without restriction: q = (x, y, z, qx, qy, qz, qw), position of its frame in the parent's (m)
    /// and unit quaternion; v = (linear, angular) velocity (m/s, rad/s) in the axes of the moved frame.
    Floating,
    /// Turns without restriction about its origin: q = (qx, qy, qz, qw), a unit quaternion; v is the angular
    /// velocity (rad/s) in the axes of the moved frame.
    Spherical,
}

impl FreeKind {
    /// `"floating"` or `"spherical"`.
    pub fn name(self) -> &'static str {
        match self {
            FreeKind::Floating => "floating",
            FreeKind::Spherical => "spherical",
        }
    }

    /// Number of its entries of q: 7 or 4.
    pub fn positions(self) -> usize {
        self.slides() + 4
    }

    /// Number of its degrees of freedom: 6 or 3.
    pub fn dof(self) -> usize {
        self.slides() + 3
    }

    /// Number of its displacements, which come before its three angles: 3 or 0. As many prismatic joints are
    /// in its chain, before three revolute ones.
    pub fn slides(self) -> usize {
        match self {
            FreeKind::Floating => 3,
            FreeKind::Spherical => 0,
        }
    }
}

/// Which part of a free joint a joint of one degree of freedom is.
#[derive(Clone, Debug, PartialEq)]
pub struct FreePart {
    /// Name of the free joint.
    pub joint: String,
    /// Its type.
    pub kind: FreeKind,
    /// Its number in the chain, from 0.
    pub place: usize,
}

/// A floating or spherical joint of a [`Robot`](super::Robot).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FreeJoint {
    /// Its name.
    pub name: String,
    /// Its type.
    pub kind: FreeKind,
    /// Index of its first entry of q.
    pub position: usize,
    /// Index of its first entry of v, p and u.
    pub coordinate: usize,
    /// Index in [`Robot::joints`](super::Robot::joints) of the first of its revolute joints, which carries
    /// its orientation.
    pub turned: usize,
}

impl FreeJoint {
    /// Index of the first entry of its quaternion in q.
    pub fn quaternion(&self) -> usize {
        self.position + self.kind.slides()
    }
}
