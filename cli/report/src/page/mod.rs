//! The page: what the motion is, the stage, the plots, limits, figures of the solver, the problem.

mod bodies;
mod data;
mod head;
mod limit_table;
mod obstacles;
mod payloads;
mod regions;
mod script;
mod solver;
mod stage;
mod values;

use crate::motion::Motion;
use crate::svg::markup::escaped;

const COLOURS: &str = include_str!("colours.css");
const STYLE: &str = include_str!("page.css");
const PLOT_STYLE: &str = include_str!("plots.css");

/// What the stage shows.
pub fn stage(motion: &Motion<'_>) -> String {
    stage::stage(motion).to_string()
}

/// The parts of the page that its script fills.
const STAGE: &str = include_str!("stage.html");

/// The whole file.
pub fn text(motion: &Motion<'_>) -> String {
    let name = escaped(motion.robot().name());
    let (stage, plots, data) = match motion.exists() {
        true => (STAGE, PLOTS, script::section(motion)),
        false => ("<p class=\"empty\">There is no motion to show.</p>\n", "", String::new()),
    };
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>Optimal motion of {name}</title>\n<style>{COLOURS}{STYLE}{PLOT_STYLE}</style></head>\n<body>\n\
         {head}{stage}{plots}{limits}{solver}{problem}{footer}{data}</body></html>\n",
        head = head::section(motion),
        limits = limit_table::section(motion),
        solver = solver::section(motion),
        problem = problem(motion),
        footer = FOOTER,
    )
}

/// Where the script puts the plots.
const PLOTS: &str = "<section aria-labelledby=\"over-time\"><div class=\"heading\"><h2 id=\"over-time\">Over time</h2>\
    <div class=\"legend\" id=\"joints\" role=\"group\" aria-label=\"joints that are drawn\"></div>\
    <div class=\"downloads\">Download <button type=\"button\" id=\"csv\" title=\"the motion over time\">CSV</button>\
    <button type=\"button\" id=\"json\" title=\"the solution, for [start_from]\">JSON</button></div></div>\
    <p class=\"note\">Click a plot to move the robot there, drag to zoom in, double-click for the whole motion. \
    Dashed: limits that the motion keeps; dotted: limits of the robot that it is only compared with; shaded red: \
    beyond a limit; vertical lines: a control reaches or leaves a bound, or a new phase begins.</p>\
    <div class=\"plots\" id=\"plots\"></div></section>\n";

const FOOTER: &str = concat!(
    "<footer>costate ",
    env!("CARGO_PKG_VERSION"),
    "; H* = y'f - l, y' = -H*_x, <span class=\"formula\">u = clip(R<sup>-1</sup>B'y_p)</span>. Lengths in m, times \
     in s; costates in units of the cost.</footer>\n"
);

/// The problem file, folded.
fn problem(motion: &Motion<'_>) -> String {
    let source = motion.options.source.trim_end();
    if source.is_empty() {
        return String::new();
    }
    format!("<details><summary>Problem file</summary><pre>{}</pre></details>\n", escaped(source))
}
