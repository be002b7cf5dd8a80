//! Constraints that close loops: what they hold, and how they are described.

use super::link::Placement;

/// A row of a constraint between two frames: a component of the pose of the first frame, seen from the
/// second.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ConstraintRow {
    /// The origin along the x axis of the second frame (m).
    X,
    /// Along its y axis (m).
    Y,
    /// Along its z axis (m).
    Z,
    /// The orientation: twice the first component of its quaternion, an angle about x where it is small
    /// (rad).
    TurnX,
    /// Likewise about y.
    TurnY,
    /// Likewise about z.
    TurnZ,
}

impl ConstraintRow {
    /// All six.
    pub const ALL: [Self; 6] = [Self::X, Self::Y, Self::Z, Self::TurnX, Self::TurnY, Self::TurnZ];

    /// Its name in files: `"x"`, `"turn_x"`.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::TurnX => "turn_x",
            Self::TurnY => "turn_y",
            Self::TurnZ => "turn_z",
        }
    }

    /// Which of the three axes, and whether it is an orientation.
    pub(crate) fn component(self) -> (usize, bool) {
        match self {
            Self::X => (0, false),
            Self::Y => (1, false),
            Self::Z => (2, false),
            Self::TurnX => (0, true),
            Self::TurnY => (1, true),
            Self::TurnZ => (2, true),
        }
    }
}

/// A constraint g(q) = 0 of a robot, as in [`Robot::constraints`](super::Robot::constraints).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Constraint {
    /// Its name, unique among the constraints.
    pub name: String,
    /// What it holds.
    pub kind: ConstraintKind,
}

/// What a constraint holds.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ConstraintKind {
    /// Components of the pose of one frame, seen from another one, are zero: one row of g for each.
    Frames {
        /// The frame that is held.
        frame: ConstraintFrame,
        /// The frame that holds it.
        to: ConstraintFrame,
        /// The components, in the order of [`ConstraintRow::ALL`].
        rows: Vec<ConstraintRow>,
    },
    /// The distance d of two origins: one row, `g = (d^2 - length^2) / (2 length)`.
    Distance {
        /// One frame.
        frame: ConstraintFrame,
        /// The other one.
        to: ConstraintFrame,
        /// The distance (m).
        length: f64,
    },
    /// A linear equation of joint positions: one row, `g = sum of factor q_joint - constant`.
    Coupling {
        /// Positions in [`Robot::joints`](super::Robot::joints), with factors.
        terms: Vec<(usize, f64)>,
        /// The constant (rad, m).
        constant: f64,
    },
}

impl ConstraintKind {
    /// Number of rows of g.
    pub fn rows(&self) -> usize {
        match self {
            Self::Frames { rows, .. } => rows.len(),
            Self::Distance { .. } | Self::Coupling { .. } => 1,
        }
    }

    /// The frames, if it holds any.
    pub(super) fn frames_mut(&mut self) -> impl Iterator<Item = &mut ConstraintFrame> {
        let both = match self {
            Self::Frames { frame, to, .. } | Self::Distance { frame, to, .. } => [Some(frame), Some(to)],
            Self::Coupling { .. } => [None, None],
        };
        both.into_iter().flatten()
    }
}

/// A frame of the robot, displaced.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ConstraintFrame {
    /// Position of the frame in [`Robot::frames`](super::Robot::frames).
    pub frame: usize,
    /// The frame of the constraint in it (m).
    pub placement: Placement,
}

/// Description of a constraint, for [`Robot::with_constraint`](super::Robot::with_constraint).
///
/// Frames are named as for [`Robot::frame`](super::Robot::frame); `"world"` is the world.
#[derive(Clone, Debug, PartialEq)]
#[must_use = "a description does nothing until it is given to a robot"]
pub struct ConstraintSpec {
    pub(super) name: String,
    pub(super) held: Held,
    pub(super) frame: Described,
    pub(super) to: Described,
}

/// A frame by its name, and the placement in it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Described {
    pub name: String,
    pub placement: Placement,
}

/// What a description asks for.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Held {
    Rows(Vec<ConstraintRow>),
    Distance(f64),
    Coupling(Vec<(String, f64)>, f64),
}

impl ConstraintSpec {
    fn between(name: impl Into<String>, frame: &str, to: &str, held: Held) -> Self {
        let described = |name: &str| Described { name: name.to_owned(), placement: Placement::identity() };
        Self { name: name.into(), held, frame: described(frame), to: described(to) }
    }

    /// The origin of `frame` is that of `to`: three rows, a spherical joint.
    pub fn pinned(name: impl Into<String>, frame: &str, to: &str) -> Self {
        use ConstraintRow::{X, Y, Z};
        Self::rows(name, frame, to, &[X, Y, Z])
    }

    /// Both frames are one: six rows, a weld or a grip.
    pub fn rigid(name: impl Into<String>, frame: &str, to: &str) -> Self {
        Self::rows(name, frame, to, &ConstraintRow::ALL)
    }

    /// These components of the pose of `frame`, seen from `to`, are zero. X and Y put a point on the z axis,
    /// Z on the plane of x and y; X, Y, Z, TurnX and TurnY are a revolute joint about z; X and Y close a
    /// planar loop without redundant rows.
    pub fn rows(name: impl Into<String>, frame: &str, to: &str, rows: &[ConstraintRow]) -> Self {
        Self::between(name, frame, to, Held::Rows(rows.to_vec()))
    }

    /// The origins of two frames stay at this distance (m): a massless rod between two spherical joints.
    pub fn distance(name: impl Into<String>, frame: &str, to: &str, length: f64) -> Self {
        Self::between(name, frame, to, Held::Distance(length))
    }

    /// `sum of factor q_joint = constant`: gears, parallel fingers, `mimic` with a force.
    pub fn coupling(name: impl Into<String>, terms: &[(&str, f64)], constant: f64) -> Self {
        let terms = terms.iter().map(|&(joint, factor)| (joint.to_owned(), factor)).collect();
        Self::between(name, "world", "world", Held::Coupling(terms, constant))
    }

    /// The first frame of the constraint in the frame that is named; the frame itself if this is not called.
    pub fn placed(mut self, placement: Placement) -> Self {
        self.frame.placement = placement;
        self
    }

    /// The second frame of the constraint likewise.
    pub fn to_placed(mut self, placement: Placement) -> Self {
        self.to.placement = placement;
        self
    }
}
