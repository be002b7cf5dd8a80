//! `<limit>` of the joints of a URDF, and what is unusual about them.

use super::element::Element;
use crate::robot::error::RobotError;
use crate::robot::joint::Limits;
use crate::robot::printable::joints;
use crate::robot::warning::Warning;

/// Joints with the same oddity, and the line of the first one.
#[derive(Default)]
struct Odd {
    joints: Vec<String>,
    line: usize,
}

impl Odd {
    fn add(&mut self, joint: &str, line: usize) {
        if self.joints.is_empty() {
            self.line = line;
        }
        self.joints.push(joint.to_owned());
    }

    fn warning(self, warning: fn(Vec<String>, usize) -> Warning) -> Option<Warning> {
        (!self.joints.is_empty()).then(|| warning(self.joints, self.line))
    }
}

/// Reads limits and collects one warning of each kind for the whole file.
pub(super) struct LimitReader {
    /// Before version 1.2 of the format, an omitted position is 0.
    is_old: bool,
    missing: Odd,
    unlimited: Odd,
    swapped: Odd,
    negative: Odd,
    without_position: Odd,
}

impl LimitReader {
    pub(super) fn new(version: (u32, u32)) -> Self {
        let (missing, unlimited, swapped, negative, without_position) = Default::default();
        Self { is_old: version < (1, 2), missing, unlimited, swapped, negative, without_position }
    }

    /// All limits of a joint: an omitted one is infinite, but an omitted position is 0 before version 1.2.
    pub(super) fn read(
        &mut self,
        joint: &Element<'_>,
        name: &str,
        is_continuous: bool,
    ) -> Result<Limits, RobotError> {
        let mut limits = Limits::default();
        let Some(limit) = joint.child("limit")? else {
            if !is_continuous {
                self.missing.add(name, joint.line());
            }
            return Ok(limits);
        };
        let line = limit.line();
        let given = [limit.number("effort")?, limit.number("velocity")?];
        for (limit, value) in [&mut limits.effort, &mut limits.velocity].into_iter().zip(given) {
            if let Some(value) = value.filter(|&value| value >= 0.0) {
                *limit = value;
            }
        }
        if given.iter().flatten().any(|&value| value < 0.0) {
            self.negative.add(name, line);
        }
        if self.is_old && given.contains(&None) {
            self.unlimited.add(name, line);
        }
        if is_continuous {
            return Ok(limits);
        }
        let positions = [limit.number("lower")?, limit.number("upper")?];
        if self.is_old && positions == [None, None] {
            self.without_position.add(name, line);
        }
        for (limit, value) in [&mut limits.lower, &mut limits.upper].into_iter().zip(positions) {
            if let Some(value) = value.or(self.is_old.then_some(0.0)) {
                *limit = value;
            }
        }
        if limits.lower > limits.upper {
            self.swapped.add(name, line);
            (limits.lower, limits.upper) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        Ok(limits)
    }

    pub(super) fn warnings(self) -> impl Iterator<Item = Warning> {
        let unlimited: fn(Vec<String>, usize) -> Warning = |of, line| Warning::Note {
            text: format!(
                "<limit> without effort or velocity (first in line {line}) is taken as unlimited: {}",
                joints(&of)
            ),
        };
        let without_position: fn(Vec<String>, usize) -> Warning = |of, line| Warning::Note {
            text: format!(
                "<limit> has neither lower nor upper (first in line {line}), which by the format means 0: {}; \
                 add them, or make a revolute joint continuous",
                joints(&of)
            ),
        };
        [
            self.missing.warning(|joints, line| Warning::WithoutLimit { joints, line }),
            self.unlimited.warning(unlimited),
            self.swapped.warning(|joints, line| Warning::SwappedLimits { joints, line }),
            self.negative.warning(|joints, line| Warning::NegativeLimit { joints, line }),
            self.without_position.warning(without_position),
        ]
        .into_iter()
        .flatten()
    }
}
