//! Limits of what may jump at nodes, which are exceeded between points around a jump that is not at a node.

use crate::constants::direct as constants;
use crate::direct::limits::side::{Limited, Side};

/// Those of torques, which are cut to their limits, and of all else, which is not.
#[derive(Clone, Debug, Default)]
pub(crate) struct Overshoots {
    pub torques: Group,
    pub others: Group,
}

/// By how much limits of one group are exceeded in each interval, and what it costs to keep them there.
#[derive(Clone, Debug, Default)]
pub(crate) struct Group {
    /// Largest violation inside of each interval, in parts of ranges. Where jumps are as close to each other
    /// as nodes may be, those of accelerations and torques are not resolved: 0 there.
    pub most: Vec<f64>,
    /// What it costs in each interval to move limits inside as far as they are exceeded.
    pub losses: Vec<f64>,
}

impl Overshoots {
    /// None in so many intervals.
    pub fn clear(&mut self, intervals: usize) {
        for group in [&mut self.torques, &mut self.others] {
            for values in [&mut group.most, &mut group.losses] {
                values.clear();
                values.resize(intervals, 0.0);
            }
        }
    }

    /// Adds what it costs to move a limit that is exceeded in interval `k` by the part `over` of its range,
    /// of which all costs `price`. Nothing where jumps are not resolved.
    pub fn add_loss(&mut self, k: usize, side: &Side, over: f64, price: f64) {
        let most = most_moved(side.limited);
        let group = self.of_mut(side);
        if group.most[k] > 0.0 && over > constants::MOVED_FROM * constants::VIOLATION_BETWEEN {
            group.losses[k] += price * (constants::MOVED * over).min(most);
        }
    }

    /// Those that a side counts among.
    pub fn of(&self, side: &Side) -> &Group {
        if side.limited == Limited::Torque { &self.torques } else { &self.others }
    }

    /// The same.
    pub fn of_mut(&mut self, side: &Side) -> &mut Group {
        if side.limited == Limited::Torque { &mut self.torques } else { &mut self.others }
    }
}

/// How far a limit of what may jump moves inside at most, in parts of its range. A quadratic whose values at
/// the points keep a limit that has moved so far keeps its own everywhere. Torques are cut to theirs anyway.
pub(super) fn most_moved(limited: Limited) -> f64 {
    if limited == Limited::Torque { f64::INFINITY } else { constants::MOST_OF_JUMPS }
}

impl Group {
    /// Largest violation.
    pub fn largest(&self) -> f64 {
        self.most.iter().copied().fold(0.0, f64::max)
    }

    /// What it costs to keep all of these limits.
    pub fn loss(&self) -> f64 {
        self.losses.iter().sum()
    }
}
