//! Figures of the solver, folded: each explained, and coloured where it is bad.

use crate::figures::{FEET, figures};
use crate::motion::Motion;
use crate::svg::markup::escaped;
use crate::text;
use costate_control::{Certificate, Method, Motion as Figures, Status, Verify};

/// Largest drift and mismatch that are good (relative).
const SMALL: f64 = 1e-5;

/// The section: figures, iterations, starts; open where something is bad.
pub fn section(motion: &Motion<'_>) -> String {
    let (problem, solution) = (motion.problem, motion.solution);
    // Red belongs to motions with errors: beside a green status warnings say what to know.
    let is_fit = solution.check(problem).is_ok();
    let mut is_bad = !is_fit;
    let rows: String = figures(problem, solution)
        .iter()
        .map(|(name, value)| {
            let good = is_good(motion, name).filter(|good| *good || !is_fit);
            is_bad |= good == Some(false);
            let class = match good {
                Some(true) => " class=\"good\"",
                Some(false) => " class=\"bad\"",
                None => "",
            };
            let (value, meaning) = (escaped(value), meaning(name));
            format!("<tr><th scope=\"row\">{name}</th><td{class}>{value}</td><td>{meaning}</td></tr>")
        })
        .collect();
    let open = if is_bad { " open" } else { "" };
    let plots = if motion.exists() { "<div class=\"plots\" id=\"solver-plots\"></div>" } else { "" };
    format!(
        "<details{open}><summary>Solver</summary><div class=\"wide\"><table class=\"figures\"><tbody>{rows}</tbody>\
         </table></div>{plots}{}</details>\n",
        iterations(motion)
    )
}

/// What a figure says.
fn meaning(name: &str) -> &'static str {
    match name {
        "cost" => "what was minimised, without penalties",
        "cost of penalties" => "the part of the penalties in what was minimised",
        "smoothing left" => "the controls are this far from those of the problem itself; 0 would be exact",
        "final time" => "how long the motion takes",
        "vias at" => "when one phase ends and the next one begins",
        "shown" => {
            "which of two motions: that of the direct method, or one that solves the maximum principle"
        }
        "H*" => "the maximised Hamiltonian: the cost that one more second would save",
        "drift of the loops" => "how far the motion leaves the constraints of the robot",
        "redundant rows" => "rows of constraints that depend on others at the start",
        "drift of the feet" => "how far feet that stand leave their places",
        "speed" => "length of a step over its duration",
        "cost of transport" => "work of the motors where they drive, over weight times length of the step",
        "work" => "of the motors where they drive, and where they brake, which gives nothing back",
        "double support" => "how long all feet stand on the ground, from the landing on",
        "landing" => "impulse of the ground on the foot that lands, and the energy that this takes",
        "gait" => "how far the state after the landing, legs exchanged, is from that at the start",
        "drift of H*" => "H* is constant on an exact solution; how far this one is from that",
        "end defect" => {
            "how far the robot misses its end when its torques are integrated again from the start"
        }
        "shooting defect" => {
            "largest mismatch when pieces of the motion are integrated again, costates included"
        }
        "guess" => "what the motion began as, and how many guesses were looked at",
        "Newton iterations" => "steps of Newton's method, over all meshes and starts",
        "mesh nodes" => "nodes of the last mesh",
        "mesh" => "the last one; nodes as solver.nodes counts them, inner points included",
        "residual" => "what is left of the conditions of first order: gradient, slacks times multipliers",
        "conjugate time" => "from this time on motions nearby would cost less; none means a local minimum",
        "local minimum" => "what the second derivatives of the direct method show",
        "verification" => "how the motion was checked",
        "error of the cost" => "estimated from the mesh, relative",
        "finer mesh" => "what half the widths would change: the error that this mesh had",
        "active limits" => "limits that the motion reaches",
        "switches" => "times at which a control reaches or leaves a bound",
        "bounds needed" | "at joint" | "at time" | "control there" | "its bound" => {
            "what the bounds would have to be for a motion to exist"
        }
        FEET => "at the points of the mesh, and between them: m, m/s, N, N m, N s or N m s",
        name if name.starts_with("beyond") => "largest violation at the points of the mesh, and between them",
        _ => "",
    }
}

/// Whether a figure is good; `None` where it does not matter.
fn is_good(motion: &Motion<'_>, name: &str) -> Option<bool> {
    let (solution, figures) = (motion.solution, &motion.solution.motion);
    let checked = figures.verification == Verify::Full;
    let bound = Figures::verification_bound(solution.options.tolerance);
    let polished = solution.polish.as_ref().is_some_and(|report| report.outcome.is_polished());
    let direct = solution.options.method == Method::Direct && !polished;
    match name {
        "smoothing left" | "bounds needed" => Some(false),
        "drift of H*" => Some(figures.hamiltonian_drift < SMALL),
        // The direct method is verified by another bound, by parts where motions forget their torques.
        "end defect" | "shooting defect" if direct => match (checked, figures.status.is_solved()) {
            // Of an unstable motion parts are verified, not its end.
            (true, true) if name == "end defect" && figures.shooting_defect.is_finite() => None,
            (true, true) => Some(true),
            (true, false) if figures.status == Status::NotVerified => Some(false),
            _ => None,
        },
        "end defect" if checked || solution.end_defect.is_finite() => {
            let size = |rows: &[Vec<f64>]| rows.iter().flatten().fold(0.0_f64, |all, x| all.max(x.abs()));
            let size = size(&solution.trajectory.q).max(size(&solution.trajectory.v));
            Some(solution.end_defect <= bound * size.max(1.0))
        }
        "shooting defect" if checked || figures.shooting_defect.is_finite() => {
            Some(figures.status.is_solved() || figures.shooting_defect < bound.max(SMALL))
        }
        "conjugate time" if figures.conjugate_time.is_some() => Some(false),
        "local minimum" => Some(figures.certificate != Certificate::SaddleOnMesh),
        "verification" => Some(figures.verification != Verify::None),
        name if name == FEET || name.starts_with("beyond") => {
            let limits = name.strip_prefix("beyond ").and_then(|name| name.strip_suffix(" limits"));
            let kind = limits.unwrap_or("task");
            let kind = kind.replace(['-', ' '], "_");
            let usage = solution.limits.kinds().find(|(name, _)| *name == kind)?.1?;
            // Torques between the points are cut to their limits.
            Some(usage.worst.is_none() && (usage.worst_between.is_none() || kind == "torque"))
        }
        _ => None,
    }
}

/// The table of iterations and the other starts.
fn iterations(motion: &Motion<'_>) -> String {
    let solution = motion.solution;
    let cells = |tag: &str, cells: &[String]| -> String {
        let cells: String = cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell))).collect();
        format!("<tr>{cells}</tr>")
    };
    let table = |header: &[&str], rows: String| {
        let header = cells("th", &header.iter().map(ToString::to_string).collect::<Vec<_>>());
        format!("<div class=\"wide tall\"><table><thead>{header}</thead><tbody>{rows}</tbody></table></div>")
    };
    let iterations = solution.motion.iterations.iter();
    let rows: String = iterations.map(|iteration| cells("td", &text::iteration_row(iteration))).collect();
    let mut sections = String::new();
    if !rows.is_empty() {
        sections += &format!("<h3>Newton steps</h3>{}", table(&text::ITERATION_HEADER, rows));
    }
    if solution.starts.len() > 1 {
        let rows = solution.starts.iter().enumerate();
        let rows = rows.map(|(i, start)| cells("td", &text::start_row(i, start))).collect();
        sections += &format!("<h3>Starts</h3>{}", table(&text::start_header(solution), rows));
    }
    sections
}
