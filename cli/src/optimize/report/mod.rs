//! The report of a motion: one HTML file, and its pictures as SVG files.

pub mod numbers;
mod page;
mod panels;
mod plot;
mod smooth;
mod stage_data;
mod strobe;
mod svg;
mod units;
mod views;

use super::kinematics::{Skeleton, film};
use costate_control::{Problem, Solution};
use strobe::Stage;

/// What a report is about.
pub struct Motion<'a> {
    pub problem: &'a Problem,
    pub solution: &'a Solution,
    /// The problem file.
    pub source: &'a str,
    pub warnings: &'a [String],
}

/// Pictures of the film of a motion.
const FRAMES: usize = 133;

/// The page, with everything it needs inside.
pub fn page(motion: &Motion<'_>) -> String {
    page::text(motion)
}

/// Name and text of each picture.
pub fn files(motion: &Motion<'_>) -> Vec<(String, String)> {
    let robot = &motion.problem.robot;
    let skeleton = Skeleton::new(robot);
    let film = film(&skeleton, &motion.solution.trajectory, FRAMES);
    let panels = [
        panels::along_the_motion(motion),
        panels::control_by_control(motion),
        panels::residuals(&motion.solution.motion.iterations),
    ];
    let panels = panels.into_iter().flatten();
    let plots = panels.map(|(name, plot)| (format!("{name}.svg"), svg::alone(&plot.svg())));
    let views = views::views(&film.concat());
    let strobe = |view| svg::alone(&Stage::new(view, &film).strobe(robot, &skeleton, &film));
    plots.chain(views.iter().map(|view| (format!("strobe_{}.svg", view.name), strobe(view)))).collect()
}
