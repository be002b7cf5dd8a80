//! Which of several motions is best.

use super::settled::repeats;
use crate::options::Verify;
use crate::result::solution::Solution;
use crate::result::verification::{CheckOutcome, Verification};
use crate::status::Status;
use std::cmp::Ordering;

/// What a motion is ranked by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Standing {
    pub class: Class,
    /// Largest excess of a hard limit, relative to its range; 0 if all are kept.
    pub violation: f64,
    /// Cost and penalties (infinite if there is no motion), and by how much they may be wrong.
    pub cost: f64,
    pub cost_error: f64,
    pub is_solved: bool,
}

/// Motions of one class are compared by numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Class {
    /// A motion that keeps its limits and repeats: solved, or with an estimate of its cost, which may be in
    /// doubt.
    Feasible,
    /// A proof that no motion keeps the limits.
    Certificate,
    /// The equations are solved, but torques do not lead along the motion.
    Unverified,
    /// Another motion that keeps its limits.
    Iterate,
    /// A motion that exceeds limits.
    Violating,
    Nothing,
}

impl Standing {
    pub fn of(solution: &Solution) -> Self {
        let motion = &solution.motion;
        let infeasible = solution.limits.infeasible.as_ref();
        let cost = if motion.total().is_nan() { f64::INFINITY } else { motion.total() };
        // What the motion costs is known where another quadrature gives the same, whatever the optimum is.
        let error = match solution.verified.as_ref().map(|verified| &verified.cost) {
            Some(cost) if cost.passes() => cost.value.unwrap_or(f64::INFINITY),
            _ => solution.cost_error().map_or(f64::INFINITY, f64::abs),
        };
        let lacking = infeasible.iter().flat_map(|found| &found.limits).map(|limit| limit.part);
        let violation = match solution.limits.violation() {
            0.0 => lacking.fold(0.0, f64::max),
            violation => violation,
        };
        let verified = solution.verified.as_ref();
        let violation = match verified.map(|verified| &verified.limits).filter(|limits| limits.fails()) {
            Some(limits) => limits.value.unwrap_or(f64::INFINITY).max(violation),
            None => violation,
        };
        let leads = match verified.map(|verified| verified.dynamics.outcome) {
            Some(CheckOutcome::Passed) => true,
            Some(CheckOutcome::Failed) => false,
            Some(CheckOutcome::NotVerified) | None => repeats(solution),
        };
        let is_known = motion.verification == Verify::Full && leads && error.is_finite();
        let is_in_doubt = verified.is_some_and(Verification::doubts_cost);
        let class = match &motion.status {
            _ if infeasible.is_some_and(|found| found.is_global) => Class::Certificate,
            _ if !cost.is_finite() => Class::Nothing,
            status if violation > 0.0 || status.exceeds_limits() => Class::Violating,
            status if status.is_solved() => Class::Feasible,
            Status::NotVerified if is_known && is_in_doubt => Class::Feasible,
            Status::NotVerified | Status::SwitchesNotRefined => Class::Unverified,
            _ if is_known => Class::Feasible,
            _ => Class::Iterate,
        };
        let is_solved = motion.status.is_solved();
        Self { class, violation, cost, cost_error: error * cost.abs(), is_solved }
    }

    /// The cost that a motion certainly does not exceed, as far as its error is estimated; that of a solved
    /// one as it is.
    fn certain_cost(&self) -> f64 {
        if self.is_solved { self.cost } else { self.cost + self.cost_error }
    }
}

/// The better one comes first.
///
/// A motion that keeps its limits and repeats beats all else; of several the one that costs least, those that
/// are not solved with their estimated error. So a cheaper motion that is not converged beats a converged one
/// that is dearer by more than that. Next comes a proof that there is none, then motions that keep their
/// limits and were not verified, then those that exceed limits, by how much they do, whatever their status
/// is.
pub(crate) fn compare(a: &Solution, b: &Solution) -> Ordering {
    by_standing(&Standing::of(a), &Standing::of(b))
}

fn by_standing(a: &Standing, b: &Standing) -> Ordering {
    let by_numbers = match a.class {
        Class::Feasible => a.certain_cost().total_cmp(&b.certain_cost()).then(b.is_solved.cmp(&a.is_solved)),
        Class::Certificate | Class::Violating => a.violation.total_cmp(&b.violation),
        Class::Unverified | Class::Iterate | Class::Nothing => Ordering::Equal,
    };
    a.class.cmp(&b.class).then(by_numbers).then(a.cost.total_cmp(&b.cost))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::infeasibility::{Infeasibility, RelaxedLimit};
    use crate::result::limit_use::{LimitUse, LimitViolation};
    use crate::result::verification::Check;

    fn solution(status: Status, cost: f64) -> Solution {
        let robot = costate::robot::Robot::from_file("../robots/two_link.toml").unwrap();
        let mut solution = Solution::missing(&robot, status, 1.0);
        solution.motion.cost = cost;
        solution
    }

    /// Integrated again, with this estimated error of its cost.
    fn integrated(status: Status, cost: f64, error: f64) -> Solution {
        let mut solution = solution(status, cost);
        (solution.motion.verification, solution.motion.errors) = (Verify::Full, vec![error]);
        solution
    }

    /// Not verified: of this check, whose value is 0.2, the others pass.
    fn failing(cost: f64, check: &str) -> Solution {
        let mut solution = integrated(Status::NotVerified, cost, 0.1);
        let mut verified = Verification { dynamics: Check::of(0.0, 0.1), ..Verification::default() };
        let failed = match check {
            "dynamics" => &mut verified.dynamics,
            "limits" => &mut verified.limits,
            _ => &mut verified.optimality,
        };
        *failed = Check::of(0.2, 0.1);
        solution.verified = Some(verified);
        solution
    }

    fn exceeding(status: Status, cost: f64, part: f64) -> Solution {
        let mut solution = solution(status, cost);
        let (name, unit) = ("elbow".into(), "N m".into());
        let worst = LimitViolation {
            name,
            time: 0.5,
            excess: part,
            unit,
            value: 1.0 + part,
            limit: 1.0,
            part,
            jumps: false,
            rate: None,
        };
        solution.limits.torque = Some(LimitUse { worst: Some(worst), ..LimitUse::default() });
        solution
    }

    fn lacking(status: Status, cost: f64, part: f64, is_global: bool) -> Solution {
        let mut solution = solution(status, cost);
        let limit = RelaxedLimit {
            kind: "torque".into(),
            name: "elbow".into(),
            side: "max".into(),
            time: 0.0,
            amount: 1.0,
            part,
            unit: "N m".into(),
            limit: None,
            rate: None,
            no_load_speed: None,
        };
        let limits = vec![limit];
        solution.limits.infeasible = Some(Infeasibility { limits, is_global, ..Infeasibility::default() });
        solution
    }

    #[test]
    fn motions_are_ordered_by_what_they_keep_and_cost() {
        let best_first = [
            integrated(Status::MeshLimit, 3.0, 0.1),
            integrated(Status::Converged, 4.0, 1e-6),
            // Cheaper, but perhaps by nothing.
            integrated(Status::MeshLimit, 3.9, 0.1),
            failing(3.95, "optimality"),
            solution(Status::Converged, 9.0),
            failing(9.5, "optimality"),
            lacking(Status::Infeasible, 5.0, 0.5, true),
            solution(Status::NotVerified, 1.0),
            failing(2.0, "dynamics"),
            solution(Status::MeshLimit, 1.0),
            solution(Status::IterationLimit, 3.0),
            exceeding(Status::LimitsNotKept, 7.0, 1e-5),
            lacking(Status::LocallyInfeasible, 7.0, 0.1, false),
            failing(0.5, "limits"),
            lacking(Status::LocallyInfeasible, 1.0, 0.2, false),
            lacking(Status::LocallyInfeasible, 2.0, 0.2, false),
            exceeding(Status::LimitsNotKept, 1.0, 0.3),
            solution(Status::NewtonFailed, f64::INFINITY),
        ];
        for (i, a) in best_first.iter().enumerate() {
            for (j, b) in best_first.iter().enumerate() {
                assert_eq!(compare(a, b), i.cmp(&j), "{i} {j}");
            }
        }
    }
}
