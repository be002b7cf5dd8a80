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

pub mod figures;
mod limits;
pub mod models;
mod motion;
pub mod numbers;
mod page;
mod panels;
mod plot;
mod svg;
pub mod text;
mod tools;
mod units;

use costate_control::{Problem, Solution};
use models::LinkModel;
use motion::Motion;

/// What a report shows beside the motion; nothing by default.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct ReportOptions {
    /// The text of the problem file.
    pub source: String,
    /// Sentences above the plots: what is unusual about the motion.
    pub warnings: Vec<String>,
    /// How links look, as [`models::of_urdf`] reads it; links without a model are capsules.
    pub models: Vec<LinkModel>,
}

impl ReportOptions {
    /// With the text of the problem file.
    #[must_use]
    pub fn with_source(self, source: impl Into<String>) -> Self {
        Self { source: source.into(), ..self }
    }

    /// With these warnings.
    #[must_use]
    pub fn with_warnings(self, warnings: Vec<String>) -> Self {
        Self { warnings, ..self }
    }

    /// With these models of links.
    #[must_use]
    pub fn with_models(self, models: Vec<LinkModel>) -> Self {
        Self { models, ..self }
    }
}

/// The report of a solution, the text of one HTML file; `problem` is the one that was solved.
///
/// Quantities over time are those of [`Solution::sample_at`] and [`Solution::rates_at`], at the nodes of the
/// motion, at equal steps between them, and on both sides of each jump. Without a motion the page says why.
pub fn report(problem: &Problem, solution: &Solution, options: &ReportOptions) -> String {
    page::text(&Motion::new(problem, solution, options))
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
