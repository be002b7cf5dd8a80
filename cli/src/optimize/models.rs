//! The visual models that a report shows.

use super::arguments::Arguments;
use super::task::Task;
use crate::terminal;
use costate::robot::RobotFormat;
use costate_report::models::{LinkModel, of_urdf};
use std::path::Path;

/// Those of the robot's file, with warnings for what cannot be read; none of a file that is no URDF.
pub fn read(task: &Task, arguments: &Arguments) -> Vec<LinkModel> {
    let Some(path) = &task.robot_path else { return Vec::new() };
    if RobotFormat::of_path(path).ok() != Some(RobotFormat::Urdf) {
        return Vec::new();
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    let read = std::fs::read_to_string(path).map_err(|error| error.to_string());
    let models = read
        .and_then(|text| of_urdf(&text, folder, &arguments.package_path).map_err(|error| error.to_string()));
    match models {
        Ok(models) => {
            models
                .warnings
                .iter()
                .for_each(|warning| terminal::warning(format!("{}: {warning}", path.display())));
            models.links
        }
        Err(error) => {
            terminal::warning(format!("{}: visual models are left out: {error}", path.display()));
            Vec::new()
        }
    }
}
