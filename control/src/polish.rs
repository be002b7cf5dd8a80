//! The motion of the direct method as the first guess of an extremal.
//!
//! Where nothing but controls is at its limits, the optimal motion is an extremal of the problem with these
//! limits as bounds on u. Newton's method finds it from the motion, its costates and its mesh in a few steps,
//! with switching times as unknowns. What the direct method found is kept if that fails or costs more.

use crate::bvp::collocation::error::defined;
use crate::constants::direct::{ACTIVE, VIOLATION_ACCEPTED};
use crate::constants::polish::{
    BESIDE_STEPS, NODE, PLACES, SHARE, SHARP_ENOUGH, SHARPER, SLACK, SLACK_UNSOLVED,
};
use crate::direct::Powers;
use crate::options::{Method, Polish, SolverOptions, Verify};
use crate::problem::key::Key;
use crate::problem::limits::JointLimits;
use crate::problem::{Bounds, MotionLimits, Problem};
use crate::result::limit_use::{ActiveLimit, LimitReport, LimitUse};
use crate::result::motion::{Certificate, Motion};
use crate::result::polish_report::{PolishOutcome, PolishReport};
use crate::result::solution::Solution;
use crate::result::trajectory::Trajectory;
use crate::result::verification::{Check, Verification};
use crate::search::guess::SavedMotion;
use crate::solve::Recorder;
use crate::starts::{Starts, of_direct};
use crate::status::Status;
use costate::robot::printable;

/// Polishes what the direct method found, as the options say.
pub(crate) fn polish(
    problem: &Problem,
    options: &SolverOptions,
    found: Solution,
    recorder: &mut Recorder<'_>,
) -> Solution {
    if options.polish == Polish::Never || found.motion.status.is_interruption() {
        return found;
    }
    if problem.first_of_phases().is_some() {
        return with_report(found, PolishOutcome::Phases, None, None);
    }
    let (limits, powers) = (problem.joint_limits(), Powers::new(problem));
    if !found.is_motion() {
        return with_report(found, PolishOutcome::NoMotion, None, None);
    }
    if let Some(cause) = active(&found.limits).or_else(|| no_extremal(problem)) {
        return with_report(found, PolishOutcome::Limited, Some(cause), None);
    }
    let problem = with_bounds(problem, &limits);
    let options = indirect(options);
    let motion = &found.trajectory.with_each_time_once();
    let polished = match options.polish {
        Polish::Always => extremal_near(&problem, &options, of_direct(motion), recorder),
        _ => {
            let work: usize = found.motion.iterations.iter().map(|step| step.nodes).sum();
            let most = SHARE * (work + BESIDE_STEPS) / NODE;
            recorder.within(most, |recorder| extremal_near(&problem, &options, of_direct(motion), recorder))
        }
    };
    let Some(polished) = polished else { return with_report(found, PolishOutcome::Failed, None, None) };
    let unverified = |status: &Status| *status == Status::NotVerified && options.verify == Verify::None;
    let solved = found.motion.status.is_solved() || unverified(&found.motion.status);
    let slack = if solved { SLACK * found.options.tolerance } else { SLACK_UNSOLVED };
    let excess = excess(&limits, &powers, &problem.gain, &polished.trajectory);
    let polished = with_limits(polished, excess);
    let outcome = match &polished.motion.status {
        status if status.is_interruption() => PolishOutcome::OutOfTime,
        Status::NotVerified if solved && polished.motion.verification == Verify::Full => {
            PolishOutcome::NotVerified
        }
        // Solved equations are more than a motion that is not solved either.
        status
            if !(status.is_solved() || unverified(status) || (*status == Status::NotVerified && !solved)) =>
        {
            PolishOutcome::Failed
        }
        // An extremal may lead back to the saddle that the search has left.
        _ if polished.motion.certificate == Certificate::NotMinimal => PolishOutcome::NoMinimum,
        _ if polished.total() > found.total() + slack * found.total().abs() => PolishOutcome::CostsMore,
        _ if excess > VIOLATION_ACCEPTED => PolishOutcome::BeyondLimits,
        _ => PolishOutcome::Polished,
    };
    let usage = usage(&found.limits, &problem, (&limits, &powers), &polished.trajectory);
    let reasons = polished.verified.as_ref().filter(|_| outcome == PolishOutcome::NotVerified);
    let cause = reasons
        .and_then(Verification::reason)
        .map(|reason| format!("the extremal is not verified ({reason})"));
    with_report(found, outcome, cause, Some((polished, usage)))
}

/// With the largest excess of a limit on positions, rates or powers, relative to its size, as a check.
fn with_limits(polished: Solution, excess: f64) -> Solution {
    let limits = Check::of(excess, VIOLATION_ACCEPTED);
    let verified = polished.verified.map(|verified| Verification { limits, ..verified });
    Solution { verified, ..polished }
}

/// The options of a polish: of a method of high order more digits cost little.
fn indirect(options: &SolverOptions) -> SolverOptions {
    let tolerance = options.tolerance.min((SHARPER * options.tolerance).max(SHARP_ENOUGH));
    SolverOptions { method: Method::Collocation, tolerance, ..options.clone() }
}

/// The extremal near a saved motion, if it is solved and keeps the limits of a problem without powers.
pub(crate) fn polish_saved(
    problem: &Problem,
    options: &SolverOptions,
    saved: SavedMotion<'_>,
    recorder: &mut Recorder<'_>,
) -> Option<Solution> {
    let (limits, powers) = (problem.joint_limits(), Powers::new(problem));
    let bounded = with_bounds(problem, &limits);
    let found = extremal_near(&bounded, &indirect(options), saved, recorder)?;
    let excess = excess(&limits, &powers, &problem.gain, &found.trajectory);
    let found = with_limits(found, excess);
    (found.motion.status.is_converged() && excess <= VIOLATION_ACCEPTED).then(|| {
        let any = |finite: fn(&JointLimits) -> bool| limits.iter().any(finite).then(LimitUse::default);
        let limited = LimitReport {
            position: any(|limits| limits.q.iter().any(|q| q.is_finite())),
            rate: any(|limits| limits.v.is_finite()),
            torque: any(|limits| limits.torque.iter().any(|torque| torque.is_finite())),
            ..LimitReport::default()
        };
        let limits = usage(&limited, &bounded, (&limits, &powers), &found.trajectory);
        Solution { limits, options: options.clone(), ..found }
    })
}

/// Tells why a motion is not polished, where that is asked for, of a robot whose motions never are.
pub(crate) fn unpolished(found: Solution, options: &SolverOptions, problem: &Problem) -> Solution {
    if options.polish != Polish::Always || found.motion.status.is_interruption() {
        return found;
    }
    let cause = match (&problem.gait, problem.robot.free_joints().first()) {
        (Some(_), _) => "gait is given".into(),
        (None, Some(free)) => format!("joint '{}' is {}", printable(&free.name), free.kind.name()),
        (None, None) => "the robot has constraints".into(),
    };
    with_report(found, PolishOutcome::Limited, Some(cause), None)
}

/// Whether a problem has nothing but controls to limit, unless an optimal motion does not reach the rest.
pub(crate) fn may_polish(problem: &Problem) -> bool {
    no_extremal(problem).is_none()
}

/// What keeps an optimal motion from being an extremal with bounds on controls, whatever the motion is.
fn no_extremal(problem: &Problem) -> Option<String> {
    // Kinks of stiff penalties beside jumps of controls leave Newton's method no place to converge to.
    let kinks = problem.penalty.is_some() && problem.cost.effort.contains(&0.0);
    let accelerations = problem.joint_limits().iter().any(|limits| limits.a.is_finite());
    let causes = [
        (problem.cost.has_energy(), "energy has a cost"),
        (accelerations, "accelerations are limited"),
        (kinks, "penalties, and a joint without effort"),
    ];
    let given = |key: Key| format!("{} is given", key.part());
    let cause = causes.into_iter().find(|(applies, _)| *applies).map(|(_, cause)| cause.into());
    cause.or_else(|| problem.task.first_key().or_else(|| problem.first_of_rates()).map(given))
}

/// The first limit other than on controls that is active.
fn active(limits: &LimitReport) -> Option<String> {
    let LimitReport { position, rate, power, torque_speed, .. } = limits;
    let kinds = [("position", position), ("rate", rate), ("power", power), ("torque-speed", torque_speed)];
    kinds.into_iter().find_map(|(kind, usage)| {
        let span = usage.as_ref()?.active.first()?;
        Some(format!("a {kind} limit is active, that of {}", printable(&span.name)))
    })
}

/// The problem with its limits on torques as bounds on u and without the others.
fn with_bounds(problem: &Problem, limits: &[JointLimits]) -> Problem {
    let of = |side: usize| {
        let ends = limits.iter().zip(&problem.gain);
        ends.map(|(limits, gain)| limits.torque[if *gain > 0.0 { side } else { 1 - side }] / gain).collect()
    };
    let bounded = limits.iter().any(|limits| limits.torque.iter().any(|torque| torque.is_finite()));
    let bounds = bounded.then(|| Bounds::new(of(0), of(1)));
    Problem { bounds, limits: MotionLimits::none(), ..problem.clone() }
}

/// The extremal to which Newton's method leads from a motion alone; `None` where it cannot begin.
fn extremal_near(
    problem: &Problem,
    options: &SolverOptions,
    saved: SavedMotion<'_>,
    recorder: &mut Recorder<'_>,
) -> Option<Solution> {
    let problem = problem.check().ok()?;
    Starts { problem, options, saved: Some(saved), alone: true }.search_from(0, recorder).ok()
}

/// The one of the two that `outcome` says, with a report and the steps of both.
fn with_report(
    direct: Solution,
    outcome: PolishOutcome,
    cause: Option<String>,
    polished: Option<(Solution, LimitReport)>,
) -> Solution {
    let finite = |total: f64| total.is_finite().then_some(total);
    let report = PolishReport {
        outcome,
        cause,
        direct_total: finite(direct.total()),
        polished_total: polished.as_ref().and_then(|(polished, _)| finite(polished.total())),
        status: polished.as_ref().map(|(polished, _)| polished.motion.status.clone()),
    };
    let mut iterations = direct.motion.iterations.clone();
    let mut steps = direct.newton_iterations;
    if let Some((polished, _)) = &polished {
        iterations.extend(polished.motion.iterations.iter().cloned());
        steps += polished.newton_iterations;
    }
    let mut shown = match polished.filter(|_| outcome.is_polished()) {
        Some((polished, limits)) => {
            let Solution { starts, options, stage_times, motion: Motion { certificate, .. }, .. } = direct;
            let mut shown = Solution { limits, starts, options, stage_times, ..polished };
            // Where conjugate times say nothing, the second derivatives of the direct method may.
            if shown.motion.certificate == Certificate::NotChecked {
                shown.motion.certificate = certificate;
            }
            shown
        }
        None => direct,
    };
    shown.motion.iterations = iterations;
    Solution { newton_iterations: steps, polish: Some(report), ..shown }
}

/// Positions, rates and controls at the nodes of a motion.
fn at_nodes(motion: &Trajectory) -> impl Iterator<Item = [Vec<f64>; 3]> {
    (0..motion.t.len()).map(|k| [&motion.q, &motion.v, &motion.u].map(|rows| rows[k].clone()))
}

/// The same between them.
fn between_nodes(motion: &Trajectory) -> impl Iterator<Item = [Vec<f64>; 3]> {
    let between =
        motion.t.windows(2).filter(|pair| pair[1] > pair[0]).flat_map(|pair| {
            PLACES.iter().filter_map(|part| motion.at(pair[0] + part * (pair[1] - pair[0])))
        });
    between.map(|point| [point.q, point.v, point.u])
}

/// By how much a motion exceeds the limits on positions, rates and powers most, relative to the sizes of
/// positions and rates and to the ranges of powers.
fn excess(limits: &[JointLimits], powers: &Powers, gain: &[f64], motion: &Trajectory) -> f64 {
    let beyond = |x: f64, [low, high]: [f64; 2]| defined((x - high).max(low - x).max(0.0) / (1.0 + x.abs()));
    let of_state = |[q, v, u]: [Vec<f64>; 3]| {
        let tau: Vec<f64> = u.iter().zip(gain).map(|(u, gain)| gain * u).collect();
        let joints = limits.iter().zip(q.iter().zip(&v));
        let of_joints =
            joints.map(|(limits, (&q, &v))| beyond(q, limits.q).max(beyond(v, [-limits.v, limits.v])));
        of_joints.fold(defined(powers.violation(&v, &tau)), f64::max)
    };
    at_nodes(motion).chain(between_nodes(motion)).map(of_state).fold(0.0, f64::max)
}

/// By how much states exceed limits most, in their units: of positions, rates, torques, powers, and of
/// torques where motors drive fast. `problem` has the limits on torques as bounds.
fn excesses(
    problem: &Problem,
    (limits, powers): (&[JointLimits], &Powers),
    states: impl Iterator<Item = [Vec<f64>; 3]>,
) -> [f64; 5] {
    let beyond = |x: f64, [low, high]: [f64; 2]| (x - high).max(low - x).max(0.0);
    let mut most = [0.0_f64; 5];
    for [q, v, u] in states {
        let tau: Vec<f64> = u.iter().zip(&problem.gain).map(|(u, gain)| gain * u).collect();
        let [power, torque_speed] = powers.excesses(&v, &tau);
        let mut found = [0.0, 0.0, 0.0, power, torque_speed];
        for (i, limits) in limits.iter().enumerate() {
            let bounds = problem.bounds.as_ref().map(|bounds| [bounds.u_min[i], bounds.u_max[i]]);
            let control = bounds.map_or(0.0, |bounds| beyond(u[i], bounds));
            let own = [beyond(q[i], limits.q), beyond(v[i], [-limits.v, limits.v])];
            let own = own.into_iter().chain([problem.gain[i].abs() * control]);
            found.iter_mut().zip(own).for_each(|(most, own)| *most = most.max(own));
        }
        most.iter_mut().zip(found).for_each(|(most, found)| *most = most.max(found));
    }
    most
}

/// How a polished motion uses the limits that `direct` lists: how far it exceeds them at its nodes and
/// between them, and where torques, whose limits are its bounds, are at one. The others it does not reach.
fn usage(
    direct: &LimitReport,
    problem: &Problem,
    limited: (&[JointLimits], &Powers),
    motion: &Trajectory,
) -> LimitReport {
    let (at_points, between) =
        (excesses(problem, limited, at_nodes(motion)), excesses(problem, limited, between_nodes(motion)));
    let measured = |usage: &Option<LimitUse>, kind: usize| {
        let (at_points, between) = (at_points[kind], between[kind]);
        usage.as_ref().map(|_| LimitUse { at_points, between, ..LimitUse::default() })
    };
    let mut limits = LimitReport {
        position: measured(&direct.position, 0),
        rate: measured(&direct.rate, 1),
        acceleration: None,
        torque: measured(&direct.torque, 2),
        jerk: None,
        torque_rate: None,
        power: measured(&direct.power, 3),
        torque_speed: measured(&direct.torque_speed, 4),
        ground_force: None,
        landing_impulse: None,
        task: None,
        infeasible: None,
    };
    let (Some(torque), Some(bounds)) = (&mut limits.torque, &problem.bounds) else { return limits };
    for (i, joint) in problem.robot.independent_joints().enumerate() {
        let (low, high) = (bounds.u_min[i], bounds.u_max[i]);
        let near = ACTIVE * if (high - low).is_finite() { high - low } else { low.abs().min(high.abs()) };
        // A negative gain exchanges the sides.
        let sides = [("min", "max"), ("max", "min")][usize::from(problem.gain[i] < 0.0)];
        let times = || motion.t.iter().zip(&motion.u);
        let low = times().map(|(&t, u)| (t, u[i] <= low + near));
        torque.active.extend(ActiveLimit::spans(&joint.name, sides.0, low));
        let high = times().map(|(&t, u)| (t, u[i] >= high - near));
        torque.active.extend(ActiveLimit::spans(&joint.name, sides.1, high));
    }
    limits
}
