//! Statuses of motions that were solved on their meshes and break something all the same.

use crate::constants::direct::{OVERSHOOT, VERIFIED};
use crate::options::Verify;
use crate::result::limit_use::{LimitReport, LimitViolation};
use crate::result::motion::Motion;
use crate::result::solution::Solution;
use crate::result::trajectory::Trajectory;
use crate::solve::recorder::Interruption;
use crate::status::Status;

/// Gives a solved motion that exceeds hard limits, does not repeat, or was not verified as it was asked for
/// the status that says so; its starts too. What [`Solution::remarks`] finds wrong with a solved motion is no
/// remark beside its status then. `interruption` is what stopped the search.
pub(crate) fn settled(mut solution: Solution, interruption: Option<Interruption>) -> Solution {
    for start in &mut solution.starts {
        if start.status.is_solved() && start.violation > 0.0 {
            start.status = Status::LimitsNotKept;
        }
    }
    if solution.motion.status.is_solved() {
        if solution.limits.violation() > 0.0 {
            solution.motion.status = Status::LimitsNotKept;
        } else if solution.options.verify == Verify::Full && solution.motion.verification != Verify::Full {
            solution.motion.status = interruption.map_or(Status::NotVerified, Status::from);
        } else if !repeats(&solution) {
            solution.motion.status = Status::NotVerified;
        }
    }
    solution
}

/// Whether a motion leads to its end, or at least along each part of it, when it is integrated again; so it
/// counts where that was not asked for.
///
/// Of the direct method the miss of the whole motion, else the sum of the misses of its parts, is compared
/// with [`VERIFIED`] times the root of the tolerance when the status is found. Extremals have the status of
/// their own [verification](Solution::verified): that of a polish which fails is not shown.
pub(crate) fn repeats(solution: &Solution) -> bool {
    let Solution { motion, options, .. } = solution;
    if motion.verification != Verify::Full {
        return true;
    }
    if solution.is_extremal() {
        return solution.verified.as_ref().is_none_or(|verified| verified.failure().is_none());
    }
    let bound = bound(options.tolerance);
    match motion.shooting_defect {
        parts if parts.is_finite() => parts <= bound,
        // The status was found with the miss of each component.
        _ if motion.status.is_solved() => true,
        _ => {
            let Trajectory { q, v, .. } = &solution.trajectory;
            let values = q.iter().chain(v).flatten();
            solution.end_defect <= bound * values.fold(0.0_f64, |most, value| most.max(value.abs()))
        }
    }
}

/// Largest relative miss of a verified motion of the direct method, of the whole or of the sum of its parts:
/// that of robots with floating and spherical joints is compared with the root of the bound of extremals.
fn bound(tolerance: f64) -> f64 {
    (VERIFIED * tolerance.sqrt()).max(Motion::verification_bound(tolerance).sqrt())
}

/// Whether an excess between the points is what a polynomial overshoots beside a jump: of a quantity that may
/// jump, by at most a [tenth](OVERSHOOT) of its range. No mesh makes that smaller, only narrower.
pub(super) fn is_overshoot(worst: &LimitViolation) -> bool {
    worst.jumps && worst.part > 0.0 && worst.part <= OVERSHOOT
}

impl LimitReport {
    /// Largest excess of a hard limit, relative to its range: at the points beyond 1e-7, between them beyond
    /// 1e-4; 0 if all limits are kept. Torques between the points are cut to their limits and do not count,
    /// nor does the overshoot of a polynomial beside a jump.
    pub fn violation(&self) -> f64 {
        let between = self.violations_between().filter(|(_, worst)| !is_overshoot(worst));
        let all = self.violations().chain(between);
        // Files of earlier versions do not have the part.
        let part = |part: f64| if part > 0.0 { part } else { f64::MIN_POSITIVE };
        all.map(|(_, worst)| part(worst.part)).fold(0.0, f64::max)
    }
}
