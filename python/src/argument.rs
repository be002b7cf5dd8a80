//! The arguments of a call.

/// What the entries of an argument belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entries {
    /// The joints of the robot, in their order: all of them, or several times one after the other.
    Joints,
    /// The configuration of a robot with quaternions.
    Positions,
    /// The axes x, y, z.
    Axes,
    /// The rows of the constraints.
    Rows,
}

/// An argument of a call: a vector for each state.
#[derive(Clone, Copy, Debug)]
pub struct Argument {
    /// As its caller knows it.
    pub name: &'static str,
    pub length: usize,
    pub entries: Entries,
}

impl Argument {
    /// One entry for each of n joints.
    pub const fn of_joints(name: &'static str, length: usize) -> Self {
        Self { name, length, entries: Entries::Joints }
    }

    /// A configuration: nq entries, n of which belong to the joints alone where there are no quaternions.
    pub const fn of_positions(name: &'static str, [nq, n]: [usize; 2]) -> Self {
        let entries = if nq == n { Entries::Joints } else { Entries::Positions };
        Self { name, length: nq, entries }
    }

    /// One entry for each row of the constraints.
    pub const fn of_rows(name: &'static str, length: usize) -> Self {
        Self { name, length, entries: Entries::Rows }
    }

    /// A vector in space.
    pub const fn in_space(name: &'static str) -> Self {
        Self { name, length: 3, entries: Entries::Axes }
    }
}
