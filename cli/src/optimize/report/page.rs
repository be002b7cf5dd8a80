//! The page: figures, the moving robot, plots, iterations, the problem.

use super::limit_table;
use super::motion::{FRAMES, Motion};
use super::panels::{self, Panel};
use super::plot::Look;
use super::stage_data::{ROTATED, data};
use super::strobe::Stage;
use super::svg::{STYLE, escaped};
use super::views;
use crate::optimize::figures::figures;
use crate::optimize::kinematics::{Skeleton, film};
use crate::optimize::summary;

const PAGE_STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The whole file.
pub fn text(motion: &Motion<'_>) -> String {
    let robot = &motion.problem.robot;
    let name = escaped(robot.name());
    let solver = plots(panels::residuals(&motion.solution.motion.iterations));
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>Optimal motion of {name}</title>\n<style>{STYLE}{PAGE_STYLE}</style></head>\n<body>\n\
         {head}{motion_sections}\
         <section><h2>Solver</h2><div class=\"solver\">{solver}{iterations}</div></section>\n\
         <section><h2>Problem</h2><pre>{source}</pre></section>\n\
         <footer>costate {version}; H* = y'f - l, y' = -H*_x, <span class=\"formula\">u = clip(R<sup>-1</sup>B'y_p)</span>. \
         Angles in rad, lengths in m, times in s; costates in units of the cost.</footer>\n\
         </body></html>\n",
        head = head(motion),
        motion_sections = motion_sections(motion),
        iterations = iterations(motion),
        source = escaped(motion.source.trim_end()),
        version = env!("CARGO_PKG_VERSION"),
    )
}

/// The moving robot, the plots over time and the script; a sentence if there is no motion.
fn motion_sections(motion: &Motion<'_>) -> String {
    if motion.solution.trajectory.t.len() < 2 {
        return "<section><h2>Motion</h2><p>There is no motion to show.</p></section>\n".into();
    }
    let (along, controls) = (panels::along_the_motion(motion), panels::control_by_control(motion));
    let keys = keys(motion, &along);
    let (along, controls) = (plots(along), plots(controls));
    let controls = if controls.is_empty() {
        controls
    } else {
        format!("<h3>Each control</h3><div class=\"grid-of-pictures\">{controls}</div>")
    };
    format!(
        "{pictures}{limits}<section><h2>Along the motion</h2>{keys}\
         <div class=\"grid-of-plots\">{along}</div>{controls}</section>\n<script>{SCRIPT}</script>\n",
        pictures = pictures(motion),
        limits = limit_table::section(motion),
    )
}

fn plots(panels: Vec<Panel>) -> String {
    panels.iter().map(|(_, plot)| format!("<figure>{}</figure>\n", plot.svg())).collect()
}

/// Name, status, figures, warnings.
fn head(motion: &Motion<'_>) -> String {
    let Motion { problem, solution, warnings, .. } = *motion;
    let figures: String = figures(problem, solution)
        .iter()
        .map(|(name, value)| format!("<div><dt>{name}</dt><dd>{}</dd></div>", escaped(value)))
        .collect();
    let warnings: String = warnings.iter().map(|warning| format!("<li>{}</li>", escaped(warning))).collect();
    let warnings =
        if warnings.is_empty() { warnings } else { format!("<ul class=\"warnings\">{warnings}</ul>") };
    let remarks = [summary::explanation(problem, solution), summary::skipped_starts(solution)];
    let remarks: String = remarks
        .iter()
        .flatten()
        .map(|remark| format!("<p class=\"bad\">{}.</p>", escaped(&summary::sentence(remark))))
        .collect();
    let status = &solution.motion.status;
    format!(
        "<header><h1>{} <span class=\"status {}\">{}</span></h1><p>{}</p>{remarks}</header>\n\
         <dl>{figures}</dl>\n{warnings}\n",
        escaped(problem.robot.name()),
        if status.is_solved() { "good" } else { "bad" },
        escaped(&summary::status(status)),
        escaped(&summary::criterion(problem, solution)),
    )
}

/// The moving figure and the strobe pictures.
fn pictures(motion: &Motion<'_>) -> String {
    let robot = &motion.problem.robot;
    let skeleton = Skeleton::new(robot);
    let film = film(&skeleton, &motion.solution.trajectory, FRAMES);
    let views = views::views(&film.concat());
    let stages: Vec<Stage<'_>> = views.iter().map(|view| Stage::new(view, &film)).collect();
    let fixed: String = stages
        .iter()
        .map(|stage| format!("<figure class=\"film\">{}</figure>\n", stage.empty(&skeleton, &film)))
        .collect();
    let (width, height) = ROTATED;
    let rotated = format!(
        "<figure class=\"film\"><svg class=\"stage rotated\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
         aria-label=\"drag to rotate\"><text class=\"title\" x=\"16\" y=\"18\">drag to rotate</text>\
         <g class=\"triad\"></g><path class=\"trace\"/><g class=\"pose moving\"></g></svg></figure>\n"
    );
    let rotated = if stages.len() > 1 { &rotated } else { "" };
    let strobes: String = stages
        .iter()
        .map(|stage| format!("<figure>{}</figure>\n", stage.strobe(robot, &skeleton, &film)))
        .collect();
    let data = data(robot, &skeleton, &film, &stages, motion.solution.motion.final_time);
    // The data contain no text from the user's files, so nothing in them can close their element.
    format!(
        "<section><h2>Motion</h2><div class=\"controls\">\
         <button type=\"button\" id=\"play\">Play</button>\
         <input type=\"range\" id=\"slider\" min=\"0\" max=\"1\" step=\"any\" value=\"0\" aria-label=\"time\">\
         <output id=\"clock\"></output>\
         <label>speed <select id=\"speed\"></select></label></div>\
         <div class=\"grid-of-pictures\">{fixed}{rotated}{strobes}</div>\
         <p class=\"note\">Strobe pictures show poses at equal time steps. Lines join the origins of the joint \
         frames and end at the centre of mass of the last link. Circles are revolute joints, rectangles \
         prismatic ones. The thin line is the path of the end.</p>\
         </section>\n\
         <script type=\"application/json\" id=\"data\">{data}</script>\n"
    )
}

/// The meaning of dashed, dotted and vertical lines, if there are any.
fn keys(motion: &Motion<'_>, panels: &[Panel]) -> String {
    let mut keys = Vec::new();
    let has = |look| panels.iter().flat_map(|(_, plot)| &plot.curves).any(|curve| curve.look == look);
    if has(Look::Kept) {
        keys.push("dashed: hard limits, which the motion must keep, where the curves come near");
    }
    if has(Look::Compared) {
        keys.push("dotted: limits of the robot that are only compared, with a warning");
    }
    if !motion.solution.motion.switches.is_empty() {
        keys.push("vertical lines: a control reaches or leaves a bound");
    }
    if keys.is_empty() { String::new() } else { format!("<p class=\"note\">{}.</p>", keys.join("; ")) }
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
        format!("<div class=\"wide\"><table><thead>{header}</thead><tbody>{rows}</tbody></table></div>")
    };
    let rows: String = solution
        .motion
        .iterations
        .iter()
        .map(|iteration| cells("td", &summary::iteration_row(iteration)))
        .collect();
    let mut text = String::new();
    if !rows.is_empty() {
        text += &table(&summary::ITERATION_HEADER, rows);
    }
    if solution.starts.len() > 1 {
        let rows = solution.starts.iter().enumerate();
        let rows = rows.map(|(i, start)| cells("td", &summary::start_row(i, start))).collect();
        text += &format!("<div><h3>Starts</h3>{}</div>", table(&summary::START_HEADER, rows));
    }
    text
}
