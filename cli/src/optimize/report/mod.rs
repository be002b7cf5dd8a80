//! The report of a motion: one HTML file, and its figures as SVG files.

mod limit_table;
mod limits;
mod motion;
pub mod numbers;
mod page;
mod panels;
mod plot;
mod smooth;
mod stage_data;
mod strobe;
mod svg;
pub mod units;
mod views;

use super::kinematics::{Skeleton, film};
use motion::FRAMES;
pub use motion::Motion;
use strobe::Stage;

/// The page, as one self-contained HTML file.
pub fn page(motion: &Motion<'_>) -> String {
    page::text(motion)
}

/// Name and text of each figure. Without a motion, only that of the residuals.
pub fn files(motion: &Motion<'_>) -> Vec<(String, String)> {
    let residuals = panels::residuals(&motion.solution.motion.iterations);
    if motion.solution.trajectory.t.len() < 2 {
        return plots(residuals).collect();
    }
    let robot = &motion.problem.robot;
    let skeleton = Skeleton::new(robot);
    let film = film(&skeleton, &motion.solution.trajectory, FRAMES);
    let panels = [panels::along_the_motion(motion), panels::control_by_control(motion), residuals];
    let views = views::views(&film.concat());
    let strobe = |view| svg::alone(&Stage::new(view, &film).strobe(robot, &skeleton, &film));
    let strobes = views.iter().map(|view| (format!("strobe_{}.svg", view.name), strobe(view)));
    plots(panels.into_iter().flatten().collect()).chain(strobes).collect()
}

fn plots(panels: Vec<panels::Panel>) -> impl Iterator<Item = (String, String)> {
    panels.into_iter().map(|(name, plot)| (format!("{name}.svg"), svg::alone(&plot.svg())))
}

/// Whether [`files`] writes files with such a name.
pub fn is_name_of_figure(name: &str) -> bool {
    let Some(name) = name.strip_suffix(".svg") else { return false };
    let fixed = ["residuals", "strobe_xy", "strobe_xz", "strobe_yz", "strobe_plane"];
    fixed.contains(&name) || panels::NAMES.contains(&name) || name.starts_with(panels::CONTROL)
}

/// Whether a text is that of a figure.
pub fn is_figure(text: &str) -> bool {
    svg::is_figure(text)
}
