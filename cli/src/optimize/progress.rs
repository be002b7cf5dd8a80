//! The progress line of a solve.

use costate::robot::{Robot, escape_hidden};
use costate_control::{BranchPoint, Iteration, Parameter};
use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// One line on standard error if that is a terminal; nothing otherwise.
pub struct Line(ProgressBar);

impl Line {
    pub fn new(robot: &Robot) -> Result<Self, indicatif::style::TemplateError> {
        let bar = ProgressBar::new_spinner();
        bar.set_style(ProgressStyle::with_template("{spinner} {prefix}: {wide_msg} {elapsed}")?);
        bar.set_prefix(escape_hidden(robot.name()).into_owned());
        bar.enable_steady_tick(Duration::from_millis(100));
        Ok(Self(bar))
    }

    /// The last step of Newton's method.
    pub fn show_iteration(&self, iteration: &Iteration) {
        let Iteration { phase, nodes, number, residual, .. } = iteration;
        self.0.set_message(format!("{phase}, {nodes} nodes, iteration {number}, residual {residual:.1e}"));
    }

    /// The last point of a continuation.
    pub fn show_point(&self, number: usize, parameter: Parameter, point: &BranchPoint) {
        let BranchPoint { parameter: value, cost, .. } = point;
        self.0.set_message(format!("point {number}, {} {value:.6}, cost {cost:.6}", parameter.name()));
    }

    pub fn clear(&self) {
        self.0.finish_and_clear();
    }
}
