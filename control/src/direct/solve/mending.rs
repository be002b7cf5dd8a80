//! What is done about limits that are exceeded between points alone.

use crate::constants::direct as constants;

/// How a motion that its points resolve comes to keep its limits between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mending {
    /// It keeps them, or no mesh makes it do so.
    Done,
    /// Limits move inside by what they are exceeded.
    Move,
    /// This would cost too much on this mesh.
    Divide,
}

/// What was tried so far.
#[derive(Debug)]
pub(super) struct Mended {
    /// How often limits were moved on this mesh.
    moves: usize,
    /// By how much limits were exceeded before the last time, in parts of ranges.
    before: f64,
    /// How many meshes may be made for limits whose values jump, and the loss on the last one of them.
    meshes: usize,
    loss: f64,
}

impl Default for Mended {
    fn default() -> Self {
        Self { moves: 0, before: f64::INFINITY, meshes: constants::MESHES_FOR_JUMPS, loss: f64::INFINITY }
    }
}

impl Mended {
    /// What is next for a motion that exceeds limits between points by the parts `violation` and `overshoot`
    /// of their ranges, those whose values may jump at nodes by the second one, and whose cost is resolved to
    /// `error`, relative to it as the `tolerance` and the `loss` by limits that are kept.
    ///
    /// Values that may jump at nodes overshoot on the interval in which the exact motion jumps or a limit
    /// begins to be active. Where it costs too much to keep such a limit, nodes move to the jump, as long as
    /// that helps: a motion may jump too often for that.
    /// That is decided when the mesh is solved as precisely as it will be.
    pub fn next(
        &mut self,
        [violation, overshoot]: [f64; 2],
        [error, loss]: [f64; 2],
        tolerance: f64,
        is_precise: bool,
    ) -> Mending {
        let most = violation.max(overshoot);
        let is_beyond = |part: f64| part > constants::VIOLATION_BETWEEN;
        if error > tolerance || !is_beyond(most) {
            return Mending::Done;
        }
        let falls = most < constants::LESS_EXCEEDED * self.before;
        let is_little = violation < constants::MOST_MOVED && error + loss <= tolerance;
        if is_little && falls && self.moves < constants::MOVES {
            self.moves += 1;
            self.before = most;
            return Mending::Move;
        }
        let helps = self.meshes > 0 && loss < constants::LESS_EXCEEDED * self.loss;
        if is_precise && is_beyond(overshoot) && !is_beyond(violation) && helps {
            self.meshes -= 1;
            self.loss = loss;
            return Mending::Divide;
        }
        Mending::Done
    }

    /// Begins a new mesh.
    pub fn begin_mesh(&mut self) {
        (self.moves, self.before) = (0, f64::INFINITY);
    }
}

#[cfg(test)]
mod tests {
    use super::{Mended, Mending, constants};

    const TOLERANCE: f64 = 1e-4;

    #[test]
    fn limits_move_while_that_helps() {
        let mut mended = Mended::default();
        let mut next = |part: f64, loss: f64| mended.next([0.0, part], [0.0, loss], TOLERANCE, true);
        assert_eq!(next(0.2, 0.5 * TOLERANCE), Mending::Move);
        assert_eq!(next(0.05, 0.5 * TOLERANCE), Mending::Move);
        // Not much less than before: a finer mesh, once.
        assert_eq!(next(0.04, 0.5 * TOLERANCE), Mending::Divide);
        assert_eq!(next(0.04, 0.4 * TOLERANCE), Mending::Done);
        mended.begin_mesh();
        let next = mended.next([0.0, 0.04], [0.0, 0.4 * TOLERANCE], TOLERANCE, true);
        assert_eq!(next, Mending::Move);
    }

    #[test]
    fn meshes_for_jumps_are_few() {
        let mut mended = Mended::default();
        let mut loss = 100.0 * TOLERANCE;
        let mut divisions = 0;
        // Only precise solutions tell.
        assert_eq!(mended.next([0.0, 0.3], [0.0, loss], TOLERANCE, false), Mending::Done);
        while mended.next([0.0, 0.3], [0.0, loss], TOLERANCE, true) == Mending::Divide {
            (loss, divisions) = (0.4 * loss, divisions + 1);
            mended.begin_mesh();
        }
        assert_eq!(divisions, constants::MESHES_FOR_JUMPS);
    }

    #[test]
    fn what_is_not_resolved_or_kept_is_left() {
        let next =
            |beyond: [f64; 2], error: f64| Mended::default().next(beyond, [error, 0.0], TOLERANCE, true);
        assert_eq!(next([0.0, 0.5 * constants::VIOLATION_BETWEEN], 0.0), Mending::Done);
        assert_eq!(next([1e-3, 0.0], 2.0 * TOLERANCE), Mending::Done);
        assert_eq!(next([1e-3, 0.0], 0.5 * TOLERANCE), Mending::Move);
        // Positions and rates move by little.
        assert_eq!(next([2.0 * constants::MOST_MOVED, 0.0], 0.5 * TOLERANCE), Mending::Done);
    }
}
