//! Reports of optimal motions: one HTML file that needs no network.
//!
//! [`report`] draws a [`Solution`] of `costate-control`: the robot moves on a stage in perspective with its
//! path, obstacles and payloads; plots of all quantities over time follow, with their limits; then limits,
//! warnings, figures of the solver and the problem. [`figures_as_svg`] gives the plots as files.
//!
//! ```
//! use costate::robot::{JointSpec, LinkInertia, Robot};
//! use costate_control::{Problem, Solver, SolverOptions};
//! use costate_report::{ReportOptions, report};
//!
//! let hinge = JointSpec::revolute("hinge").axis([0.0, 1.0, 0.0]);
//! let hinge = hinge.carrying(LinkInertia::point(1.0, [0.0, 0.0, -0.5]));
//! let robot = Robot::builder("pendulum").joint(hinge).build()?;
//! let problem = Problem::rest_to_rest(robot, &[0.0], &[1.0], 1.0);
//! let solution = Solver::new(&problem, SolverOptions::default())?.solve();
//! let page = report(&problem, &solution, &ReportOptions::default());
//! assert!(page.starts_with("<!doctype html>") && page.contains("pendulum"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod criterion;
mod entries;
pub mod figures;
mod forces;
mod limits;
pub mod models;
mod motion;
pub mod numbers;
mod options;
mod page;
mod panels;
mod plot;
mod shape;
mod soles;
mod svg;
pub mod text;
mod tools;
mod units;
mod work;

pub use options::ReportOptions;

use costate_control::{Problem, Solution};
use motion::Motion;

/// The report of a solution, the text of one HTML file; `problem` is the one that was solved.
///
/// Quantities over time are those of [`Solution::sample_at`] and [`Solution::rates_at`], at the nodes of the
/// motion, at equal steps between them, and on both sides of each jump. Without a motion the page says why.
pub fn report(problem: &Problem, solution: &Solution, options: &ReportOptions) -> String {
    page::text(&Motion::new(problem, solution, options))
}

/// What the stage of the report shows, as JSON, for other viewers.
///
/// `joints` is the tree with placements and axes. `q` is the entry of q of each: of joints of kind
/// `quaternion` the first of four, and those of kind `fixed` have none. A floating or spherical joint is a
/// chain of them, which are `free`. `bodies` have the `joint` that moves each, their placement
/// `at` in its frame (rotation column by column, translation; m), `shape` and `colour`. `obstacles` and
/// `regions` are those of the world, `meshes` the meshes of shapes by number, with bytes in base 64;
/// `payloads` and `tools` follow.
pub fn stage_json(problem: &Problem, solution: &Solution, options: &ReportOptions) -> String {
    page::stage(&Motion::new(problem, solution, options))
}

/// Name and text of each figure as SVG: quantities over time, residuals, strobe pictures. Without a motion,
/// only the residuals.
pub fn figures_as_svg(problem: &Problem, solution: &Solution) -> Vec<(String, String)> {
    svg::files(&Motion::new(problem, solution, &ReportOptions::default()))
}

/// Whether [`figures_as_svg`] gives figures with such a name.
pub fn is_name_of_figure(name: &str) -> bool {
    svg::is_name_of_figure(name)
}

/// Whether a text is that of a figure of [`figures_as_svg`].
pub fn is_figure(text: &str) -> bool {
    svg::markup::is_figure(text)
}
