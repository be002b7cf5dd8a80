//! A solution in words: what is minimised, how it ended and why, rows of tables.

use crate::advice::advice;
pub use crate::criterion::criterion;
use crate::figures::{Needed, time_is_free};
use crate::laws;
use crate::numbers::{scientific, short};
use costate_control::{
    Certificate, Iteration, Method, PolishOutcome, Problem, RelaxedLimit, Solution, SolverOptions,
    StartResult, Status, Verify,
};

/// A status in words.
pub fn status(status: &Status) -> String {
    match status {
        Status::ConvergedSmoothed => "converged, smoothed control".into(),
        status => spaced(status.name()),
    }
}

/// Why a motion is not a solution, and what to do; `None` for a solution.
pub fn explanation(problem: &Problem, solution: &Solution) -> Option<String> {
    let status = &solution.motion.status;
    let best = "the motion is the best iterate so far, not a solution";
    Some(match status {
        status if status.is_solved() => return None,
        Status::BoundsNotReached => match Needed::new(problem, solution) {
            Some(Needed { joint, factor, time, u, bound }) => format!(
                "no motion within the bounds was found: the bounds of joint '{joint}' would have to be {factor} \
                 times as wide, {u} instead of {bound} at t = {time}; widen bounds.u_min and bounds.u_max, or {}",
                longer(problem)
            ),
            None => status.to_string(),
        },
        Status::LimitsNotKept => {
            let exceeded: Vec<_> = exceeded(problem, solution).collect();
            match exceeded.is_empty() {
                true => status.to_string(),
                false => format!(
                    "no motion that keeps all limits was found: {}; widen them, {}, or raise solver.starts",
                    exceeded.join("; "),
                    longer(problem)
                ),
            }
        }
        Status::Infeasible => infeasible(solution),
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
                 was not seen; allow more time, or verify = \"factors\""
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
    })
}

/// Whether the direct method was stopped after it had solved a motion to its tolerance, and before it had
/// verified it.
fn is_unverified(solution: &Solution) -> bool {
    let SolverOptions { method, tolerance, .. } = solution.options;
    let error = solution.motion.errors.first().copied().unwrap_or(f64::INFINITY);
    method == Method::Direct && error <= tolerance && solution.motion.verification == Verify::None
}

/// That the torques of a solution do not lead the robot to its end without a correction.
pub fn needs_feedback(problem: &Problem, solution: &Solution) -> Option<String> {
    let direct = solution.options.method == Method::Direct && !is_polished(solution);
    let by_parts = direct && solution.motion.shooting_defect.is_finite();
    let is_open_tree = problem.gait.is_none() && problem.robot.constraints().is_empty();
    let has_gains = problem.has_gains() && is_open_tree && problem.robot.free_joints().is_empty();
    let gains = if has_gains { ", or use gains (--feedback)" } else { "" };
    (by_parts && solution.motion.status.is_solved()).then(|| {
        format!(
            "errors grow along this motion: torques alone, repeated without feedback, lead the robot elsewhere; \
             track the positions{gains}; rotors (robot.armature) calm light wrists"
        )
    })
}

/// That a solution is a saddle.
pub fn saddle(solution: &Solution) -> Option<String> {
    let motion = &solution.motion;
    (motion.status.is_solved() && motion.certificate == Certificate::SaddleOnMesh).then(|| {
        "the motion is a saddle: it is stationary, but motions nearby cost less; another start may find one (a larger \
         solver.starts, another solver.seed, [start_from])"
            .into()
    })
}

/// What a kind of limits limits, in words.
pub(crate) fn quantity(kind: &str) -> String {
    match kind {
        // Where a motor drives fast, its torque is limited to less.
        "torque_speed" => "torque".into(),
        "torque_rate" => "rate of the torque".into(),
        kind => spaced(kind),
    }
}

/// What the ground does to a foot, if that is what a kind of limits limits.
pub(crate) fn of_ground(kind: &str) -> Option<&'static str> {
    match kind {
        "ground_force" => Some("the force of the ground"),
        "landing_impulse" => Some("the impulse of the landing"),
        _ => None,
    }
}

/// Of a joint, or of all.
pub(crate) fn whose(name: &str) -> String {
    if name == "all joints" { name.into() } else { format!("joint '{name}'") }
}

/// Whether the extremal is shown.
pub(crate) fn is_polished(solution: &Solution) -> bool {
    solution.polish.as_ref().is_some_and(|report| report.outcome.is_polished())
}

/// How the robot gets more time.
fn longer(problem: &Problem) -> &'static str {
    if time_is_free(problem) { "raise time.guess" } else { "raise time.final" }
}

/// Most limits named in one sentence; the one that is relaxed most comes first.
const MOST_LIMITS: usize = 4;

/// Which limits would have to be relaxed, and by how much, so that a motion exists.
fn infeasible(solution: &Solution) -> String {
    let status = &solution.motion.status;
    let Some(found) = solution.limits.infeasible.as_ref().filter(|found| !found.limits.is_empty()) else {
        return status.to_string();
    };
    let gives = |limit: &RelaxedLimit| {
        let (amount, unit) = (short(limit.amount, 4), &limit.unit);
        let when = format!("at t = {} s", short(limit.time, 4));
        if limit.kind == "task" {
            return format!("the {} is relaxed by {amount} {unit} ({when})", limit.name);
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
        let what = if limit.kind == "torque_speed" { "torque".into() } else { spaced(&limit.kind) };
        let from = limit.limit.map_or_else(String::new, |limit| format!("{} {unit} ", short(limit, 4)));
        let at = limit
            .rate
            .map_or_else(String::new, |rate| format!(", where its motor turns at {}", short(rate, 4)));
        format!("the {what} limit {from}of {whose} is relaxed by {amount} {unit} ({when}{at})")
    };
    let mut limits: Vec<_> = found.limits.iter().take(MOST_LIMITS).map(gives).collect();
    let more = found.limits.len().saturating_sub(MOST_LIMITS);
    if more > 0 {
        limits.push(format!("{more} more are relaxed too (limits.infeasible of --json has all)"));
    }
    let later = found.final_time.map_or_else(String::new, |time| {
        format!("; with a final time of {} s a motion keeps all limits", short(time, 4))
    });
    let least = found
        .least_time
        .map_or_else(String::new, |time| format!("; none does in less than {} s", short(time, 4)));
    let certain = match found.is_global {
        true => "",
        false => "; this holds for motions nearby only, another guess (solver.starts) may find one",
    };
    format!("no motion keeps all limits unless {}{least}{later}{certain}", limits.join(" and "))
}

/// The unit of the rate of a joint whose torque or force has this unit.
fn speed(unit: &str) -> &'static str {
    if unit == "N" { "m/s" } else { "rad/s" }
}

/// Two numbers with four digits, or as many more as tell them apart.
fn apart(a: f64, b: f64) -> (String, String) {
    let with = |digits| (short(a, digits), short(b, digits));
    (4..=17).map(with).find(|(a, b)| a != b).unwrap_or_else(|| with(17))
}

/// For each kind of limits that is exceeded: which joint, tool or body, where, by how much.
fn exceeded(problem: &Problem, solution: &Solution) -> impl Iterator<Item = String> {
    solution.limits.violations().map(move |(kind, worst)| {
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
    })
}

/// A search that ended before all of its starts were tried.
pub fn skipped_starts(solution: &Solution) -> Option<String> {
    let (tried, all) = (solution.starts.len(), solution.options.starts.unwrap_or(1));
    (1..all).contains(&tried).then(|| format!("the search ended during start {tried} of {all}"))
}

/// A name without underscores.
pub fn spaced(name: &str) -> String {
    name.replace('_', " ")
}

/// Header of the table of iterations.
pub const ITERATION_HEADER: [&str; 7] =
    ["phase", "nodes", "iteration", "residual", "step", "final time (s)", "cost"];

/// A row of the table of iterations.
pub fn iteration_row(iteration: &Iteration) -> Vec<String> {
    vec![
        iteration.phase.to_string(),
        iteration.nodes.to_string(),
        iteration.number.to_string(),
        scientific(iteration.residual),
        short(iteration.step, 3),
        short(iteration.final_time, 7),
        short(iteration.cost, 9),
    ]
}

/// Header of the table of starts. Of motions that were polished the costs are those before: each start is
/// solved roughly, and the best one is polished. Where that turns out not to apply, only the best one is
/// solved to the tolerance.
pub fn start_header(solution: &Solution) -> [&'static str; 3] {
    let outcome = solution.polish.as_ref().map(|report| report.outcome);
    let cost = match outcome {
        Some(PolishOutcome::Polished) => "cost and penalties, rough, before the polish",
        Some(PolishOutcome::Limited) => "cost and penalties; all but the best may be rough",
        _ => "cost and penalties",
    };
    ["start", "status", cost]
}

/// A row of the table of starts; `index` counts from 0.
pub fn start_row(index: usize, start: &StartResult) -> Vec<String> {
    vec![(index + 1).to_string(), status(&start.status), short(start.total, 12)]
}

/// With a capital letter.
pub fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
