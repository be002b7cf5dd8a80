//! What is done about limits that are exceeded between points alone.

use super::prepare::Dynamics;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::motion::spline::Spline;
use crate::direct::refine::move_inside::Inside;
use crate::direct::refine::resolution::Resolution;
use costate::EvalError;

/// What was tried so far.
#[derive(Debug)]
pub(super) struct Mended {
    /// How often limits were moved on this mesh.
    moves: usize,
    /// By how much limits were exceeded before the last time, in parts of ranges: without torques, and all.
    before: [f64; 2],
    /// Meshes that are finer for nothing else.
    meshes: usize,
    /// The accurate motion that the first of them began with, or that was there before coefficients were
    /// limited.
    accurate: Option<Spline>,
    /// Whether that one was taken again.
    gives_up: bool,
}

/// What a motion does not keep between its points, and what that costs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Beyond {
    /// Largest violation of limits whose values do not jump at nodes, in parts of ranges.
    pub violation: f64,
    /// The same of those that may: of all but torques, and of torques.
    pub overshoots: [f64; 2],
    /// Estimated error of the cost, relative to it.
    pub error: f64,
    /// What it costs to keep both of these, relative to the cost.
    pub losses: [f64; 2],
}

impl Beyond {
    /// That of a motion whose cost has this size and this error, relative to it.
    pub fn new(resolution: &Resolution, size: f64, error: f64) -> Self {
        let overshoots = &resolution.overshoots;
        let groups = [&overshoots.others, &overshoots.torques];
        Self {
            violation: resolution.violation(),
            overshoots: groups.map(|group| group.largest()),
            error,
            losses: groups.map(|group| group.loss() / size),
        }
    }
}

impl Default for Mended {
    fn default() -> Self {
        Self { moves: 0, before: [f64::INFINITY; 2], meshes: 0, accurate: None, gives_up: false }
    }
}

impl Mended {
    /// Whether an accurate motion exceeds limits of what may jump and is not cut. Such values overshoot on
    /// the interval in which the exact motion jumps or a limit begins to be active, on any mesh, unless their
    /// coefficients are limited there.
    pub fn wants_hulls(&self, beyond: &Beyond) -> bool {
        beyond.overshoots[0] > constants::VIOLATION_BETWEEN && !self.gives_up
    }

    /// The same of torques, which are cut to their limits, and lead elsewhere then.
    pub fn wants_torques(&self, beyond: &Beyond) -> bool {
        beyond.overshoots[1] > constants::VIOLATION_BETWEEN && !self.gives_up
    }

    /// Which limits move inside by what they are exceeded, if any: all of them, if that costs no more than
    /// the tolerance allows; otherwise all but those of torques, which are cut to their limits.
    pub fn moves_limits(&mut self, beyond: &Beyond, tolerance: f64) -> Option<Inside> {
        let Beyond { violation, overshoots: [others, torques], error, losses } = *beyond;
        let most = [violation.max(others), violation.max(others).max(torques)];
        let loss = [losses[0], losses[0] + losses[1]];
        let is_cheap = |loss: f64| violation < constants::MOST_MOVED && error + loss <= tolerance;
        let moves = |all: &bool| {
            let i = usize::from(*all);
            let falls = most[i] < constants::LESS_EXCEEDED * self.before[i];
            most[i] > constants::VIOLATION_BETWEEN
                && is_cheap(loss[i])
                && falls
                && self.moves < constants::MOVES
        };
        let is_beyond = others > constants::VIOLATION_BETWEEN && !self.gives_up;
        let wanted = [true, false].into_iter().take(if is_beyond { 2 } else { 1 });
        let found = wanted.into_iter().find(moves).map(|torques| Inside { torques });
        if found.is_some() {
            self.moves += 1;
            self.before = most;
        }
        found
    }

    /// The nodes of a finer mesh for an accurate motion of which nothing is left to move, but which exceeds
    /// limits of what is not cut; fewer than `most`. None where that was tried often enough.
    pub fn finer(
        &mut self,
        beyond: &Beyond,
        (resolution, spline): (&mut Resolution, &Spline),
        allowed: f64,
        most: usize,
    ) -> Option<Vec<f64>> {
        let is_kept = beyond.overshoots[0] <= constants::VIOLATION_BETWEEN;
        if is_kept || self.gives_up || self.meshes >= constants::MESHES_BETWEEN {
            return None;
        }
        let nodes = resolution.nodes_for_limits(spline, allowed);
        if nodes == spline.mesh.nodes || nodes.len() > most {
            return None;
        }
        self.meshes += 1;
        self.keep(spline);
        self.begin_mesh();
        Some(nodes)
    }

    /// Keeps an accurate motion in case that nothing better is found.
    pub fn keep(&mut self, spline: &Spline) {
        self.accurate.get_or_insert_with(|| spline.clone());
    }

    /// Takes an accurate motion again where what was done led to none, and does no more about what it
    /// exceeds. Whether there is one.
    ///
    /// # Errors
    /// A motion that cannot be evaluated.
    pub fn comes_back(&mut self, interior: &mut Interior<Dynamics>) -> Result<bool, EvalError> {
        let Some(spline) = self.accurate.take() else { return Ok(false) };
        self.gives_up = true;
        interior.barrier.drop_hulls();
        interior.spline = spline;
        interior.start(None)?;
        self.begin_mesh();
        Ok(true)
    }

    /// Begins a new mesh.
    pub fn begin_mesh(&mut self) {
        (self.moves, self.before) = (0, [f64::INFINITY; 2]);
    }
}

#[cfg(test)]
mod tests {
    use super::{Beyond, Inside, Mended, constants};

    const TOLERANCE: f64 = 1e-4;
    const ALL: Option<Inside> = Some(Inside { torques: true });

    fn torques(part: f64, loss: f64) -> Beyond {
        Beyond { overshoots: [0.0, part], losses: [0.0, loss], ..Beyond::default() }
    }

    #[test]
    fn limits_move_while_that_helps() {
        let mut mended = Mended::default();
        let mut moves = |part: f64| mended.moves_limits(&torques(part, 0.5 * TOLERANCE), TOLERANCE);
        assert!(moves(0.2) == ALL && moves(0.05) == ALL);
        // Not much less than before.
        assert_eq!(moves(0.04), None);
        mended.begin_mesh();
        let mut moves = |part: f64| mended.moves_limits(&torques(part, 0.5 * TOLERANCE), TOLERANCE).is_some();
        assert!(moves(0.04) && moves(0.01) && moves(0.004) && !moves(0.001), "at most {}", constants::MOVES);
    }

    #[test]
    fn what_is_not_resolved_or_kept_is_left() {
        let moves = |beyond: Beyond| Mended::default().moves_limits(&beyond, TOLERANCE);
        assert_eq!(moves(torques(0.5 * constants::VIOLATION_BETWEEN, 0.0)), None);
        let of_rates = |violation: f64, error: f64| Beyond { violation, error, ..Beyond::default() };
        assert_eq!(moves(of_rates(1e-3, 2.0 * TOLERANCE)), None);
        assert_eq!(moves(of_rates(1e-3, 0.5 * TOLERANCE)), ALL);
        // To keep the limit would cost too much.
        let error = 0.5 * TOLERANCE;
        assert_eq!(moves(Beyond { error, ..torques(0.3, 0.6 * TOLERANCE) }), None);
        // Positions and rates move by little.
        assert_eq!(moves(of_rates(2.0 * constants::MOST_MOVED, 0.0)), None);
    }

    /// What is not cut moves alone where torques would cost too much.
    #[test]
    fn torques_are_left_first() {
        let both =
            Beyond { overshoots: [0.01, 0.3], losses: [0.5 * TOLERANCE, TOLERANCE], ..Beyond::default() };
        let alone = Some(Inside { torques: false });
        assert_eq!(Mended::default().moves_limits(&both, TOLERANCE), alone);
        let dear = Beyond { losses: [2.0 * TOLERANCE, 0.0], ..both };
        assert_eq!(Mended::default().moves_limits(&dear, TOLERANCE), None);
    }
}
