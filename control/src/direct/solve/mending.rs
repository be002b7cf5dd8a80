//! What is done about limits that are exceeded between points alone.

use crate::constants::direct as constants;

/// What was tried so far on a mesh.
#[derive(Debug)]
pub(super) struct Mended {
    /// How often limits were moved.
    moves: usize,
    /// By how much limits were exceeded before the last time, in parts of ranges.
    before: f64,
}

impl Default for Mended {
    fn default() -> Self {
        Self { moves: 0, before: f64::INFINITY }
    }
}

impl Mended {
    /// Whether limits move inside by what they are exceeded, for a motion that exceeds limits between points
    /// by the parts `violation` and `overshoot` of their ranges, those whose values may jump at nodes by the
    /// second one, and whose cost is resolved to `error`, relative to it as the `tolerance` and the `loss` by
    /// limits that are kept.
    ///
    /// Values that may jump overshoot on the interval in which the exact motion jumps or a limit begins to be
    /// active, on any mesh. They stay so where it costs too much to keep the limit there.
    pub fn moves_limits(
        &mut self,
        [violation, overshoot]: [f64; 2],
        [error, loss]: [f64; 2],
        tolerance: f64,
    ) -> bool {
        let most = violation.max(overshoot);
        let falls = most < constants::LESS_EXCEEDED * self.before;
        let is_little = violation < constants::MOST_MOVED && error + loss <= tolerance;
        let moves =
            most > constants::VIOLATION_BETWEEN && is_little && falls && self.moves < constants::MOVES;
        if moves {
            self.moves += 1;
            self.before = most;
        }
        moves
    }

    /// Begins a new mesh.
    pub fn begin_mesh(&mut self) {
        (self.moves, self.before) = (0, f64::INFINITY);
    }
}

#[cfg(test)]
mod tests {
    use super::{Mended, constants};

    const TOLERANCE: f64 = 1e-4;

    #[test]
    fn limits_move_while_that_helps() {
        let mut mended = Mended::default();
        let mut moves = |part: f64| mended.moves_limits([0.0, part], [0.0, 0.5 * TOLERANCE], TOLERANCE);
        assert!(moves(0.2) && moves(0.05));
        // Not much less than before.
        assert!(!moves(0.04));
        mended.begin_mesh();
        let mut moves = |part: f64| mended.moves_limits([0.0, part], [0.0, 0.5 * TOLERANCE], TOLERANCE);
        assert!(moves(0.04) && moves(0.01) && moves(0.004) && !moves(0.001), "at most {}", constants::MOVES);
    }

    #[test]
    fn what_is_not_resolved_or_kept_is_left() {
        let moves = |beyond: [f64; 2], error: f64, loss: f64| {
            Mended::default().moves_limits(beyond, [error, loss], TOLERANCE)
        };
        assert!(!moves([0.0, 0.5 * constants::VIOLATION_BETWEEN], 0.0, 0.0));
        assert!(!moves([1e-3, 0.0], 2.0 * TOLERANCE, 0.0));
        assert!(moves([1e-3, 0.0], 0.5 * TOLERANCE, 0.0));
        // To keep the limit would cost too much.
        assert!(!moves([0.0, 0.3], 0.5 * TOLERANCE, 0.6 * TOLERANCE));
        // Positions and rates move by little.
        assert!(!moves([2.0 * constants::MOST_MOVED, 0.0], 0.5 * TOLERANCE, 0.0));
    }
}
