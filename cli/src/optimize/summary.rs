//! A solution as text: heading, figures, tables.

use super::report::numbers::short;
use super::report::units;
use crate::report::{Table, scientific, title};
use costate::robot::escape_hidden;
use costate_control::{
    Certificate, FinalTime, Iteration, Method, Motion, Problem, Solution, StartResult, Status, Verify,
};
use std::io::Write;

/// What is minimised: `minimum of T + 1/2 u'Ru, final time free, actuation bounded, limits kept`. Bounds and
/// limits that the motion does not satisfy are left out.
pub fn criterion(problem: &Problem, solution: &Solution) -> String {
    let status = &solution.motion.status;
    let effort = problem.cost.effort.iter().any(|&r| r != 0.0);
    let time = match problem.cost.time {
        0.0 => None,
        1.0 => Some("T".to_owned()),
        weight => Some(format!("{} T", short(weight, 6))),
    };
    let terms = [time, effort.then(|| "\u{222b} \u{bd} \u{3a3} r\u{1d62} u\u{1d62}\u{b2} dt".to_owned())];
    let terms: Vec<_> = terms.into_iter().flatten().collect();
    let minimum = match terms.is_empty() {
        true => "motion without a cost".into(),
        false => format!("minimum of {}", terms.join(" + ")),
    };
    let time = if time_is_free(problem) { "final time free" } else { "final time fixed" };
    let exceeded = matches!(status, Status::BoundsNotReached | Status::LimitsNotKept);
    let within_bounds = problem.bounds.is_some() && !exceeded;
    let bounds = if within_bounds { ", actuation bounded" } else { "" };
    let penalty = if problem.penalty.is_some() { ", with penalties" } else { "" };
    let kept = !solution.limits.is_empty() && solution.limits.violations().next().is_none();
    let limits = if kept { ", limits kept" } else { "" };
    format!("{minimum}, {time}{bounds}{penalty}{limits}")
}

/// Whether the final time is free.
fn time_is_free(problem: &Problem) -> bool {
    matches!(problem.time, FinalTime::Free { .. })
}

/// A status in words.
pub fn status(status: &Status) -> String {
    match status {
        Status::ConvergedSmoothed => "converged, smoothed control".into(),
        status => spaced(status.name()),
    }
}

/// What the bounds of a problem without a motion would have to be, with units.
struct Needed<'a> {
    joint: &'a str,
    factor: String,
    time: String,
    u: String,
    bound: String,
}

impl<'a> Needed<'a> {
    fn new(problem: &Problem, solution: &'a Solution) -> Option<Self> {
        let violation = solution.motion.bound_violation?;
        let joint = solution.robot.joints.get(violation.control)?;
        let kind = problem.robot.independent_joints().nth(violation.control)?.kind;
        let unit = units::of_joint(kind, units::EFFORT);
        Some(Self {
            joint,
            factor: short(violation.factor, 4),
            time: format!("{} s", short(violation.time, 4)),
            u: format!("{} {unit}", short(violation.u, 4)),
            bound: format!("{} {unit}", short(violation.bound, 4)),
        })
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
                 times as wide, {u} instead of {bound} at t = {time}; widen the bounds or allow more time"
            ),
            None => status.to_string(),
        },
        Status::LimitsNotKept => {
            let exceeded: Vec<_> = exceeded(problem, solution).collect();
            match exceeded.is_empty() {
                true => status.to_string(),
                false => format!(
                    "no motion that keeps all limits was found: {}; widen the limits or allow more time",
                    exceeded.join("; ")
                ),
            }
        }
        Status::NotVerified if solution.motion.verification == Verify::None => {
            "the motion was not verified, as asked for: it may be a solution".into()
        }
        Status::PathOnly => status.to_string(),
        status if solution.trajectory.t.is_empty() => format!("no motion was found: {status}"),
        Status::Cancelled => format!("interrupted: {best}"),
        Status::TimeLimit => format!("the time limit was reached: {best}; allow more time"),
        status => format!("the motion is the best iterate, not a solution: {status}"),
    })
}

/// Units of the kinds of limits.
fn limit_units(kind: &str) -> units::Units {
    match kind {
        "position" => units::POSITION,
        "rate" => units::RATE,
        "acceleration" => units::ACCELERATION,
        _ => units::EFFORT,
    }
}

/// For each kind of limits that is exceeded: which joint, where, by how much.
fn exceeded(problem: &Problem, solution: &Solution) -> impl Iterator<Item = String> {
    solution.limits.violations().map(|(kind, worst)| {
        let joint = problem.robot.independent_joints().find(|joint| joint.name == worst.joint);
        let unit = joint.map_or("", |joint| units::of_joint(joint.kind, limit_units(kind)));
        format!(
            "the {kind} of joint '{}' would have to be {} {unit} instead of {} {unit} at t = {} s",
            worst.joint,
            short(worst.value, 4),
            short(worst.limit, 4),
            short(worst.time, 4)
        )
    })
}

/// A search that ended before all of its starts were tried.
pub fn skipped_starts(solution: &Solution) -> Option<String> {
    let (tried, all) = (solution.starts.len(), solution.options.starts);
    (1..all).contains(&tried).then(|| format!("the search ended during start {tried} of {all}"))
}

/// Name and value of each figure of a solution.
pub fn figures(problem: &Problem, solution: &Solution) -> Vec<(&'static str, String)> {
    let motion = &solution.motion;
    let iterations = ("Newton iterations", solution.newton_iterations.to_string());
    if let Some(Needed { joint, factor, time, u, bound }) = Needed::new(problem, solution) {
        return vec![
            ("bounds needed", format!("{factor} times as wide")),
            ("at joint", joint.to_owned()),
            ("at time", time),
            ("control there", u),
            ("its bound", bound),
            iterations,
        ];
    }
    if solution.trajectory.t.is_empty() {
        return vec![iterations];
    }
    let mut figures = vec![("cost", short(motion.cost, 12))];
    if problem.penalty.is_some() {
        figures.push(("cost of penalties", short(motion.penalty_cost, 6)));
    }
    if motion.smoothing > 0.0 {
        figures.push(("smoothing left", scientific(motion.smoothing)));
    }
    let [position, rate] = [units::POSITION, units::RATE].map(|unit| units::of_robot(&problem.robot, unit));
    figures.push(("final time", format!("{} s", short(motion.final_time, 10))));
    let polished = solution.polish.as_ref();
    if let Some(report) = polished {
        let cost = match (report.outcome.is_polished(), report.direct_total, report.polished_total) {
            (true, Some(cost), _) => format!("; the direct method's cost {}", short(cost, 12)),
            (false, _, Some(cost)) => format!(", {}", short(cost, 12)),
            _ => String::new(),
        };
        figures.push(("shown", format!("{}{cost}", report.outcome.reason())));
    }
    let extremal = polished.is_some_and(|report| report.outcome.is_polished());
    if solution.options.method == Method::Direct && !extremal {
        figures.push(verification(motion));
        figures.extend(direct_figures(problem, solution));
        figures.extend([iterations, ("mesh nodes", solution.nodes().to_string())]);
        return figures;
    }
    figures.extend([
        ("H*", format!("{} cost/s", short(motion.hamiltonian, 10))),
        ("drift of H*", format!("{} relative", scientific(motion.hamiltonian_drift))),
        verification(motion),
        ("end defect", defect(solution.end_defect, motion.verification, &format!("{position}, {rate}"))),
        ("shooting defect", defect(motion.shooting_defect, motion.verification, "relative")),
        iterations,
        ("mesh nodes", solution.nodes().to_string()),
        ("conjugate time", conjugate(problem, motion)),
    ]);
    if extremal {
        figures.extend(limit_figures(problem, solution));
    }
    if !motion.switches.is_empty() {
        figures.push(("switches", motion.switches.len().to_string()));
    }
    figures
}

/// How the motion was verified.
fn verification(motion: &Motion) -> (&'static str, String) {
    let how = match motion.verification {
        Verify::Full => "integrated again".into(),
        Verify::Factors if motion.conditioning.is_finite() => {
            format!("by the factors, conditioning {}", scientific(motion.conditioning))
        }
        Verify::Factors => "by the estimated errors".into(),
        _ => "not done".into(),
    };
    ("verification", how)
}

/// Figures of the direct method: its estimate, the end, the limits.
fn direct_figures(problem: &Problem, solution: &Solution) -> Vec<(&'static str, String)> {
    let motion = &solution.motion;
    let unit = |unit| units::of_robot(&problem.robot, unit);
    let ends = format!("{}, {}", unit(units::POSITION), unit(units::RATE));
    let mut figures = vec![("end defect", defect(solution.end_defect, motion.verification, &ends))];
    // A saved motion does not have it.
    if let Some(&error) = motion.errors.first() {
        figures.push(("error of the cost", format!("{} relative, estimated", scientific(error))));
    }
    figures.extend(limit_figures(problem, solution));
    figures
}

/// Figures of the hard limits.
fn limit_figures(problem: &Problem, solution: &Solution) -> Vec<(&'static str, String)> {
    let unit = |unit| units::of_robot(&problem.robot, unit);
    let (mut figures, mut active) = (Vec::new(), 0);
    for (kind, usage) in solution.limits.kinds() {
        let Some(usage) = usage else { continue };
        let name = match kind {
            "position" => "beyond position limits",
            "rate" => "beyond rate limits",
            "acceleration" => "beyond acceleration limits",
            _ => "beyond torque limits",
        };
        let unit = unit(limit_units(kind));
        // Torques are cut to their limits.
        let between = match kind {
            "torque" => String::new(),
            _ => format!(", {} between points", scientific(usage.between)),
        };
        figures.push((name, format!("{} {unit}{between}", scientific(usage.at_points))));
        let mut sides: Vec<_> = usage.active.iter().map(|span| (&span.joint, &span.side)).collect();
        sides.sort();
        sides.dedup();
        active += sides.len();
    }
    if !solution.limits.is_empty() {
        figures.push(("active limits", active.to_string()));
    }
    figures
}

/// A defect with its unit; it is not finite if nothing was integrated or if the integration stopped.
fn defect(value: f64, done: Verify, unit: &str) -> String {
    match done {
        _ if value.is_finite() => format!("{} {unit}", scientific(value)),
        Verify::Full => "the integration stopped".into(),
        _ => "not checked".into(),
    }
}

/// Jacobi fields compare motions that take the same time.
fn conjugate(problem: &Problem, motion: &Motion) -> String {
    match (motion.conjugate_time, motion.certificate) {
        (Some(time), _) if motion.conjugate_multiplicity > 1 => {
            format!("{} s, {} fields: not a minimum", short(time, 8), motion.conjugate_multiplicity)
        }
        (Some(time), _) => format!("{} s: not a minimum", short(time, 8)),
        (None, Certificate::LocalMinimum) if time_is_free(problem) => {
            "none: a local minimum in this time".into()
        }
        (None, Certificate::LocalMinimum) => "none: a local minimum".into(),
        _ => "not checked".into(),
    }
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

/// Header of the table of starts.
pub const START_HEADER: [&str; 3] = ["start", "status", "cost and penalties"];

/// A row of the table of starts; `index` counts from 0.
pub fn start_row(index: usize, start: &StartResult) -> Vec<String> {
    vec![(index + 1).to_string(), status(&start.status), short(start.total, 12)]
}

/// Heading, figures, why it is not a solution, and all starts.
pub fn print(
    problem: &Problem,
    solution: &Solution,
    seconds: f64,
    out: &mut impl Write,
) -> std::io::Result<()> {
    let ended = &solution.motion.status;
    writeln!(out, "{}: {}\n", title(&problem.robot), criterion(problem, solution))?;
    let mut table = Table::new(&["status", &status(ended)], 2);
    for (name, value) in figures(problem, solution) {
        table.row(vec![name.into(), value]);
    }
    table.row(vec!["time of solving".into(), format!("{} s", short(seconds, 3))]);
    write!(out, "{table}")?;
    for remark in [explanation(problem, solution), skipped_starts(solution)].into_iter().flatten() {
        writeln!(out, "\n  {}.", escape_hidden(&sentence(&remark)))?;
    }
    if solution.starts.len() > 1 {
        let mut table = Table::new(&START_HEADER, 2);
        solution.starts.iter().enumerate().for_each(|(i, start)| table.row(start_row(i, start)));
        write!(out, "\n{table}")?;
    }
    Ok(())
}

/// With a capital letter.
pub fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The Newton steps.
pub fn print_iterations(solution: &Solution, out: &mut impl Write) -> std::io::Result<()> {
    let mut table = Table::new(&ITERATION_HEADER, 1);
    solution.motion.iterations.iter().for_each(|iteration| table.row(iteration_row(iteration)));
    write!(out, "\n{table}")
}
