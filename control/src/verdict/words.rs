//! The remarks about how a solution ended, and about its certificate, in words.

use super::advice::advice;
use super::between::between;
use super::laws;
use super::limit_words::{of_ground, quantity, whose};
use super::numbers::{apart, scientific, short};
use super::remark::{Remark, RemarkKey, Severity};
use super::settled::is_overshoot;
use crate::options::{Method, SolverOptions, Verify};
use crate::problem::{FinalTime, Problem};
use crate::result::infeasibility::{Infeasibility, RelaxedLimit};
use crate::result::limit_use::LimitViolation;
use crate::result::motion::Certificate;
use crate::result::polish_report::PolishOutcome;
use crate::result::solution::Solution;
use crate::status::Status;
use costate::robot::{JointKind, printable};

/// Why a motion is not a solution, and what to do; `None` for a solution.
pub(super) fn not_solved(problem: &Problem, solution: &Solution) -> Option<Remark> {
    let status = &solution.motion.status;
    if status.is_solved() {
        return None;
    }
    let remark = Remark::new(RemarkKey::NotSolved, Severity::Error, explanation(problem, solution));
    let relaxed = solution.limits.infeasible.as_ref().and_then(|found| found.limits.first());
    let verified = solution.verified.as_ref().filter(|_| *status == Status::NotVerified);
    let failed = verified.and_then(|verified| verified.failure());
    Some(match (relaxed, violations(solution).first(), failed) {
        (Some(limit), ..) => Remark {
            name: Some(limit.name.clone()),
            kind: Some(limit.kind.clone()),
            time: Some(limit.time),
            limit: limit.limit,
            excess: Some(limit.amount),
            unit: Some(limit.unit.clone()),
            ..remark
        },
        (None, Some((kind, worst, _)), _) if status.exceeds_limits() => remark.of_violation(kind, worst),
        (None, _, Some((name, check))) => {
            let [value, allowed] = [check.value, check.allowed].map(|number| number.unwrap_or(f64::NAN));
            Remark { kind: Some(name.into()), time: check.time, ..remark.comparing(value, allowed) }
        }
        _ => remark,
    })
}

fn explanation(problem: &Problem, solution: &Solution) -> String {
    let status = &solution.motion.status;
    let best = "the motion is the best iterate so far, not a solution";
    match status {
        Status::BoundsNotReached => needed_bounds(problem, solution).unwrap_or_else(|| status.to_string()),
        Status::LimitsNotKept => {
            let exceeded = violations(solution);
            if exceeded.is_empty() {
                return status.to_string();
            }
            let is_law = |(kind, worst, _): &(&str, &LimitViolation, bool)| {
                laws::not_kept(problem, kind, worst).is_some()
            };
            let widen = if exceeded.iter().all(is_law) { "" } else { "widen them, " };
            let texts: Vec<_> = exceeded.iter().map(|violation| violation_text(problem, violation)).collect();
            format!(
                "no motion that keeps all limits was found: {}; {widen}{}, or raise solver.starts",
                texts.join("; "),
                longer(problem)
            )
        }
        Status::Infeasible | Status::LocallyInfeasible => infeasible(solution),
        Status::NotVerified if solution.motion.verification == Verify::None => {
            "the motion was not verified, as asked for: it may be a solution".into()
        }
        Status::PathOnly => status.to_string(),
        status if solution.trajectory.t.is_empty() => format!("no motion was found: {status}"),
        status if status.is_interruption() && is_unverified(solution) => {
            let what =
                if *status == Status::Cancelled { "interrupted" } else { "the time limit was reached" };
            format!(
                "{what} while the motion was verified: it is solved on its mesh, but whether its torques lead along it \
                 was not checked; allow more time, or verify = \"factors\""
            )
        }
        Status::Cancelled => format!("interrupted: {best}"),
        Status::TimeLimit => {
            format!("the time limit was reached: {best}; raise solver.time_limit or --time-limit")
        }
        status => {
            let reason = advice(problem, solution).unwrap_or_else(|| status.to_string());
            format!("the motion is the best iterate, not a solution: {reason}")
        }
    }
}

/// What the bounds of a problem without a motion would have to be.
fn needed_bounds(problem: &Problem, solution: &Solution) -> Option<String> {
    let violation = solution.motion.bound_violation?;
    let joint = problem.robot.independent_joints().nth(violation.control)?;
    let unit = if joint.kind == JointKind::Prismatic { "N" } else { "N m" };
    Some(format!(
        "no motion within the bounds was found: with bounds {} times as wide one was, which needs {} {unit} instead of \
         {} {unit} at joint '{}' at t = {} s; widen bounds.u_min and bounds.u_max, or {}",
        short(violation.factor, 4),
        short(violation.u, 4),
        short(violation.bound, 4),
        printable(&joint.name),
        short(violation.time, 4),
        longer(problem)
    ))
}

/// Whether the direct method was stopped after it had solved a motion to its tolerance, and before it had
/// verified it.
fn is_unverified(solution: &Solution) -> bool {
    let SolverOptions { method, tolerance, .. } = solution.options;
    let error = solution.motion.errors.first().copied().unwrap_or(f64::INFINITY);
    method == Method::Direct && error <= tolerance && solution.motion.verification == Verify::None
}

/// Kind and place of each violation of a hard limit, and whether it is between the points; a kind that is
/// exceeded at the points stands once.
fn violations(solution: &Solution) -> Vec<(&'static str, &LimitViolation, bool)> {
    let limits = &solution.limits;
    let mut all: Vec<_> = limits.violations().map(|(kind, worst)| (kind, worst, false)).collect();
    for (kind, worst) in limits.violations_between() {
        if all.iter().all(|(known, ..)| *known != kind) {
            all.push((kind, worst, true));
        }
    }
    all
}

fn violation_text(problem: &Problem, (kind, worst, is_between): &(&str, &LimitViolation, bool)) -> String {
    match is_between {
        true => between(kind, worst),
        false => exceeded(problem, kind, worst),
    }
}

/// Hard limits that are exceeded where the status does not say so.
pub(super) fn exceeded_limits(problem: &Problem, solution: &Solution) -> Vec<Remark> {
    if solution.motion.status.exceeds_limits() {
        return Vec::new();
    }
    let all = violations(solution);
    let remark = |violation: &(&str, &LimitViolation, bool)| {
        let (kind, worst, is_between) = *violation;
        let key = if is_between { RemarkKey::LimitExceededBetween } else { RemarkKey::LimitExceeded };
        let mut text = violation_text(problem, violation);
        let mut severity = Severity::Error;
        if is_between && is_overshoot(worst) {
            text.push_str(", beside a jump that its polynomial does not follow");
            severity = Severity::Warning;
        }
        Remark::new(key, severity, text).of_violation(kind, worst)
    };
    all.iter().map(remark).collect()
}

/// Which joint, tool or body exceeds a limit at the points, where, by how much.
fn exceeded(problem: &Problem, kind: &str, worst: &LimitViolation) -> String {
    if let Some(law) = laws::not_kept(problem, kind, worst) {
        return law;
    }
    let (name, unit, time) = (&worst.name, &worst.unit, short(worst.time, 4));
    if kind == "task" {
        return format!("the {name} is off by {} {unit} at t = {time} s", short(worst.excess, 4));
    }
    if let Some(what) = of_ground(kind) {
        let by = short(worst.excess, 4);
        return format!("{what} is {by} {unit} beyond its friction cone, as '{name}', at t = {time} s");
    }
    let ((value, limit), whose) = (apart(worst.value, worst.limit), whose(name));
    let at = worst.rate.map_or_else(String::new, |rate| {
        let speed = speed(unit);
        format!(", where its motor turns at {} {speed} (limits.no_load_speed)", short(rate, 4))
    });
    let what = quantity(kind);
    format!(
        "the {what} of {whose} would have to be {value} {unit} instead of {limit} {unit} at t = {time} s{at}"
    )
}

/// That a polish led to an extremal that is not verified: the motion of the direct method is shown.
pub(super) fn left_polish(solution: &Solution) -> Option<Remark> {
    let report = solution.polish.as_ref().filter(|report| report.outcome == PolishOutcome::NotVerified)?;
    let text = format!("polish left, the motion is that of the direct method: {}", report.cause.as_ref()?);
    Some(Remark::new(RemarkKey::PolishLeft, Severity::Note, text))
}

/// That the torques of a solution do not lead the robot to its end without feedback.
pub(super) fn unstable(problem: &Problem, solution: &Solution) -> Option<Remark> {
    let motion = &solution.motion;
    let by_parts = !solution.is_extremal() && motion.shooting_defect.is_finite();
    let is_open_tree = problem.gait.is_none() && problem.robot.constraints().is_empty();
    let has_gains = problem.has_gains() && is_open_tree && problem.robot.free_joints().is_empty();
    let gains = if has_gains { ", or use gains (--feedback)" } else { "" };
    (by_parts && motion.status.is_solved()).then(|| {
        let kinds = |kind| problem.robot.independent_joints().any(|joint| joint.kind == kind);
        let unit = match (kinds(JointKind::Revolute), kinds(JointKind::Prismatic)) {
            (true, false) => " (rad, rad/s)",
            (false, true) => " (m, m/s)",
            _ => " (rad, m, rad/s, m/s)",
        };
        let end = match solution.end_defect {
            defect if defect.is_finite() => format!("end {}{unit} off", short(defect, 2)),
            _ => "do not lead to its end".into(),
        };
        let text = format!(
            "the motion is unstable in open loop: torques replayed from the start without feedback {end}; it is verified \
             in parts (each from its own start; their misses sum to {} relative); track the positions{gains}",
            scientific(motion.shooting_defect)
        );
        Remark::new(RemarkKey::Unstable, Severity::Warning, text)
            .comparing(solution.end_defect, f64::INFINITY)
    })
}

/// That a solution is a saddle.
pub(super) fn saddle(solution: &Solution) -> Option<Remark> {
    let motion = &solution.motion;
    (motion.status.is_solved() && motion.certificate == Certificate::SaddleOnMesh).then(|| {
        let text = "the motion is a saddle: it is stationary, but motions nearby cost less; another start may find one (a \
                    larger solver.starts, another solver.seed, [start_from])";
        Remark::new(RemarkKey::Saddle, Severity::Warning, text.into())
    })
}

/// That an extremal is no local minimum.
pub(super) fn not_minimal(solution: &Solution) -> Option<Remark> {
    let motion = &solution.motion;
    let time = motion.conjugate_time.filter(|_| motion.status.is_solved())?;
    let text = format!(
        "the motion is no local minimum: a conjugate time, {} s, lies before its end, and motions nearby cost less; \
         another start may find one (a larger solver.starts, another solver.seed)",
        short(time, 8)
    );
    let remark = Remark::new(RemarkKey::NotMinimal, Severity::Warning, text);
    Some(Remark { time: Some(time), ..remark })
}

/// Limits of the robot that a motion exceeds and was not asked to keep.
pub(super) fn robot_limits(problem: &Problem, solution: &Solution) -> Vec<Remark> {
    // The direct method keeps them, or the status says which it does not keep.
    if solution.options.method == Method::Direct && problem.keeps_robot_limits() {
        return Vec::new();
    }
    let remark = |found: crate::result::limits::RobotExcess| {
        let (value, limit) = found.worst();
        let remark = Remark::new(RemarkKey::RobotLimit, Severity::Warning, found.to_string());
        Remark {
            name: Some(found.joint.clone()),
            kind: Some(found.kind.into()),
            excess: Some((value - limit).abs()),
            unit: Some(found.unit.into()),
            ..remark.comparing(value, limit)
        }
    };
    problem.robot_excesses(&solution.trajectory).into_iter().map(remark).collect()
}

/// That a converged motion of another start was left for a cheaper one that is not converged.
pub(super) fn dearer_converged(solution: &Solution) -> Option<Remark> {
    let (motion, starts) = (&solution.motion, solution.starts.iter().enumerate());
    if motion.status.is_solved() || !motion.total().is_finite() || motion.status.exceeds_limits() {
        return None;
    }
    let solved = starts.filter(|(_, start)| start.status.is_solved());
    let (number, best) = solved.min_by(|a, b| a.1.total.total_cmp(&b.1.total))?;
    if best.total <= motion.total() {
        return None;
    }
    let text = format!(
        "the motion keeps its limits and costs less than every converged one, but is not converged itself; the best \
         converged one, of start {}, costs {}",
        number + 1,
        short(best.total, 9)
    );
    let remark = Remark::new(RemarkKey::DearerConverged, Severity::Warning, text);
    Some(remark.comparing(best.total, motion.total()))
}

/// A search that ended before all of its starts were tried.
pub(super) fn skipped_starts(solution: &Solution) -> Option<Remark> {
    let (tried, all) = (solution.starts.len(), solution.options.starts.unwrap_or(1));
    let text = || format!("the search ended during start {tried} of {all}");
    (1..all).contains(&tried).then(|| Remark::new(RemarkKey::SkippedStarts, Severity::Note, text()))
}

/// How the robot gets more time.
fn longer(problem: &Problem) -> &'static str {
    match problem.time {
        FinalTime::Free { .. } => "raise time.guess",
        FinalTime::Fixed(_) => "raise time.final",
    }
}

/// Most limits named in one sentence; the one that gives most comes first.
const MOST_LIMITS: usize = 4;

/// Why no motion keeps all limits, or which limits the motion found exceeds, and by how much.
fn infeasible(solution: &Solution) -> String {
    let status = &solution.motion.status;
    let Some(found) = &solution.limits.infeasible else { return status.to_string() };
    let later = found.final_time.map_or_else(String::new, |time| {
        format!("; with a final time of {} s a motion keeps all limits", short(time, 4))
    });
    if let Some(proof) = &found.proof {
        return format!("no motion keeps all limits: {proof}{later}");
    }
    if found.limits.is_empty() {
        return status.to_string();
    }
    format!(
        "no motion that keeps all limits was found: at this one the violation has a local minimum: {}{later}; another \
         guess (solver.starts) may find one",
        what_gives(found)
    )
}

/// What the limits of an elastic motion give.
fn what_gives(found: &Infeasibility) -> String {
    let gives = |limit: &RelaxedLimit| {
        let (amount, unit) = (short(limit.amount, 4), &limit.unit);
        let when = format!("at t = {} s", short(limit.time, 4));
        if limit.kind == "task" {
            return format!("the {} is off by {amount} {unit} ({when})", limit.name);
        }
        if let Some(what) = of_ground(&limit.kind) {
            return format!(
                "{what} is {amount} {unit} beyond its friction cone, as '{}' ({when})",
                limit.name
            );
        }
        let whose = whose(&limit.name);
        if let (Some(rate), Some(most)) = (limit.rate, limit.no_load_speed)
            && rate.abs() >= most
        {
            let (rate, most) = apart(rate.abs(), most);
            let speed = speed(unit);
            return format!(
                "the motor of {whose} gives {amount} {unit} beyond its limits.no_load_speed {most} {speed}, where it \
                 has no torque: the motion needs {rate} {speed} ({when})"
            );
        }
        let from = limit.limit.map_or_else(String::new, |limit| format!(" {} {unit}", short(limit, 4)));
        let at = limit
            .rate
            .map_or_else(String::new, |rate| format!(", where its motor turns at {}", short(rate, 4)));
        format!(
            "the {} of {whose} is {amount} {unit} beyond its limit{from} ({when}{at})",
            quantity(&limit.kind)
        )
    };
    let mut limits: Vec<_> = found.limits.iter().take(MOST_LIMITS).map(gives).collect();
    let more = found.limits.len().saturating_sub(MOST_LIMITS);
    if more > 0 {
        limits.push(format!("{more} more are exceeded too (limits.infeasible of --json has all)"));
    }
    limits.join(" and ")
}

/// The unit of the rate of a joint whose torque or force has this unit.
fn speed(unit: &str) -> &'static str {
    if unit == "N" { "m/s" } else { "rad/s" }
}
