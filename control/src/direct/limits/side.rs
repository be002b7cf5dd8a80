//! One side of a limit.

use crate::direct::motion::shape::Shape;
use crate::task::row::Row;

/// What is limited. The order is that of the values of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Limited {
    Position,
    Rate,
    Acceleration,
    Torque,
    /// The power of a joint, or of all.
    Power,
    /// A torque together with a multiple of the rate.
    TorqueSpeed,
    /// A row of a task.
    Task,
    /// The acceleration of a tool, a row of a task that depends on a too.
    ToolAcceleration,
    /// At Gauss's points of motions whose accelerations are continuous, as what follows.
    Jerk,
    TorqueRate,
}

impl Limited {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Rate => "rate",
            Self::Acceleration => "acceleration",
            Self::Torque => "torque",
            Self::Power => "power",
            Self::TorqueSpeed => "torque_speed",
            Self::Task | Self::ToolAcceleration => "task",
            Self::Jerk => "jerk",
            Self::TorqueRate => "torque_rate",
        }
    }

    /// Whether it is a row of a task.
    pub fn is_task(self) -> bool {
        matches!(self, Self::Task | Self::ToolAcceleration)
    }

    /// Whether it is a smooth function in each interval that may be largest at its ends. Torques are cut to
    /// their limits there.
    pub fn is_largest_at_ends(self) -> bool {
        matches!(self, Self::Acceleration | Self::Power | Self::TorqueSpeed | Self::ToolAcceleration)
    }

    /// Whether it may jump at nodes: only its values at points are those of the motion that is meant.
    pub fn jumps(self, shape: Shape) -> bool {
        match self {
            Self::Jerk | Self::TorqueRate => true,
            Self::Acceleration | Self::Torque | Self::Power | Self::TorqueSpeed | Self::ToolAcceleration => {
                !shape.is_smooth()
            }
            Self::Position | Self::Rate | Self::Task => false,
        }
    }
}

/// A limit on one side: `sign (value - bound) >= 0`; or an equation, with zero on the right and sign 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Side {
    pub limited: Limited,
    /// The joint, or the row of powers or of a task.
    pub joint: usize,
    /// 1 for a lower bound, -1 for an upper one.
    pub sign: f64,
    pub bound: f64,
    /// Distance to the bound on the other side; if there is none, the magnitude of the bound, and 1 of its
    /// unit at least. The unit of violations.
    pub range: f64,
    pub is_equation: bool,
    /// One of two limits that stand for an equation.
    pub is_half: bool,
}

impl Side {
    /// The torque of a joint without a motor is zero; `unit` is the unit of violations.
    pub fn no_torque(joint: usize, unit: f64) -> Self {
        Self {
            limited: Limited::Torque,
            joint,
            sign: 1.0,
            bound: 0.0,
            range: unit,
            is_equation: true,
            is_half: false,
        }
    }

    /// Both sides of a limit; an infinite bound is none.
    pub fn pair(limited: Limited, joint: usize, lower: f64, upper: f64) -> impl Iterator<Item = Self> {
        let range = if (upper - lower).is_finite() {
            upper - lower
        } else {
            [lower, upper]
                .into_iter()
                .filter(|bound| bound.is_finite())
                .fold(1.0, |range: f64, b| range.max(b.abs()))
        };
        [(1.0, lower), (-1.0, upper)].into_iter().filter(|(_, bound)| bound.is_finite()).map(
            move |(sign, bound)| Self {
                limited,
                joint,
                sign,
                bound,
                range,
                is_equation: false,
                is_half: false,
            },
        )
    }

    /// The sides of a row of a task.
    pub fn of_row(limited: Limited, index: usize, row: &Row) -> impl Iterator<Item = Self> {
        let is_equation = row.is_equation();
        Self::pair(limited, index, row.lower, row.upper)
            .take(if is_equation { 1 } else { 2 })
            .map(move |side| Self { range: row.range, is_equation, ..side })
    }

    /// Whether it is a law of physics, which nobody could relax: that a joint without a motor has no torque,
    /// or a row of a constraint.
    pub fn is_law(&self) -> bool {
        self.is_equation && self.limited == Limited::Torque
    }

    /// An equation of a task as two limits, anything else as it is.
    pub fn halves(self) -> impl Iterator<Item = Self> {
        let half = |sign: f64| Self { sign, is_equation: false, is_half: true, ..self };
        let all = if self.is_equation && !self.is_law() {
            [Some(half(1.0)), Some(half(-1.0))]
        } else {
            [Some(self), None]
        };
        all.into_iter().flatten()
    }

    /// How far it is exceeded at a distance, in parts of its range; infinitely where that is undefined.
    pub fn violation(&self, distance: f64) -> f64 {
        let part = (if self.is_equation { distance.abs() } else { -distance }) / self.range;
        if part.is_nan() { f64::INFINITY } else { part }
    }

    /// Where its value stands among q, v, a of a point.
    pub fn index(&self, n: usize) -> usize {
        self.limited as usize * n + self.joint
    }
}
