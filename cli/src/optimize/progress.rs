//! How far a solve is, on a terminal.

use costate::robot::Robot;
use costate_control::Iteration;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// One line on standard error, where that is a terminal; nothing elsewhere.
pub struct Line(ProgressBar);

impl Line {
    pub fn new(robot: &Robot) -> Result<Self, indicatif::style::TemplateError> {
        let bar = ProgressBar::new_spinner();
        bar.set_style(ProgressStyle::with_template("{spinner} {prefix}: {wide_msg} {elapsed}")?);
        bar.set_prefix(robot.name().to_owned());
        bar.enable_steady_tick(Duration::from_millis(100));
        Ok(Self(bar))
    }

    pub fn show(&self, iteration: &Iteration) {
        let Iteration { phase, nodes, number, residual, .. } = iteration;
        self.0.set_message(format!("{phase}, {nodes} nodes, iteration {number}, residual {residual:.1e}"));
    }

    pub fn clear(&self) {
        self.0.finish_and_clear();
    }
}
