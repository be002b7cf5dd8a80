//! The figures of a motion as SVG files.

mod levels;
pub mod markup;
mod plot;
mod skeleton;
mod smooth;
mod strobe;
mod views;

use crate::motion::Motion;
use crate::panels;
use crate::plot::Panel;
use crate::soles::soles;
pub(crate) use skeleton::Skeleton;
use skeleton::film;
use strobe::Stage;

/// Number of poses that are computed along a motion.
const FRAMES: usize = 133;

/// Name and text of each figure. Without a motion, only that of the residuals.
pub fn files(motion: &Motion<'_>) -> Vec<(String, String)> {
    let residuals = panels::residuals(&motion.solution.motion.iterations);
    if !motion.exists() {
        return plots(residuals).collect();
    }
    let robot = motion.robot();
    let soles = soles(motion.problem);
    let skeleton = Skeleton::new(robot, &soles);
    let film = film(&skeleton, &motion.solution.trajectory, FRAMES);
    let panels = [panels::along_the_motion(motion), panels::control_by_control(motion), residuals];
    let views = views::views(&film.concat());
    let strobe = |view| markup::alone(&Stage::new(view, &film).strobe(robot, &skeleton, &film));
    let strobes = views.iter().map(|view| (format!("strobe_{}.svg", view.name), strobe(view)));
    plots(panels.into_iter().flatten().collect()).chain(strobes).collect()
}

fn plots(panels: Vec<Panel>) -> impl Iterator<Item = (String, String)> {
    panels.into_iter().map(|(name, plot)| (format!("{name}.svg"), markup::alone(&plot::svg(&plot))))
}

/// Whether [`files`] writes files with such a name.
pub fn is_name_of_figure(name: &str) -> bool {
    let Some(name) = name.strip_suffix(".svg") else { return false };
    let fixed = ["strobe_xy", "strobe_xz", "strobe_yz", "strobe_plane"];
    fixed.contains(&name) || panels::NAMES.contains(&name) || name.starts_with(panels::CONTROL)
}
