//! The data from which the script of the page draws the moving figure.

use super::strobe::Stage;
use super::views::dot;
use crate::optimize::kinematics::{Point, Skeleton, moved};
use costate::robot::Robot;
use serde_json::{Value, json};

/// Width and height of the stage that can be rotated.
pub const ROTATED: (f64, f64) = (460.0, 360.0);

/// Points of every frame, lines, joints, stages; times in s, lengths in m.
pub fn data(
    robot: &Robot,
    skeleton: &Skeleton<'_>,
    film: &[Vec<Point>],
    stages: &[Stage<'_>],
    time: f64,
) -> Value {
    let frames = film.iter().map(|points| points.iter().flatten().map(|&x| rounded(x)).collect::<Vec<_>>());
    let lines = skeleton.lines.iter().map(|&(from, to, part)| json!([from, to, part.name()]));
    let joints = robot.joints().iter().enumerate().map(|(i, joint)| json!([moved(i), joint.kind.name()]));
    let fixed = stages.iter().map(|stage| {
        let view = stage.view;
        let (scale, origin) = (stage.scale, stage.origin());
        json!({ "right": view.right, "up": view.up, "scale": scale, "origin": origin, "centre": [0, 0, 0] })
    });
    json!({
        "time": if time.is_finite() { time } else { 0.0 },
        "frames": frames.collect::<Vec<_>>(),
        "lines": lines.collect::<Vec<_>>(),
        "joints": joints.collect::<Vec<_>>(),
        "tips": skeleton.tips,
        "stages": fixed.chain((stages.len() > 1).then(|| rotated(film))).collect::<Vec<_>>(),
    })
}

/// The stage that can be rotated: a ball around all points fills it.
fn rotated(film: &[Vec<Point>]) -> Value {
    let points = || film.iter().flatten();
    let middle = [0, 1, 2].map(|k| {
        let (low, high) =
            points().fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(p[k]), high.max(p[k])));
        0.5 * (low + high)
    });
    let away = |p: &Point| {
        let d = [p[0] - middle[0], p[1] - middle[1], p[2] - middle[2]];
        dot(d, d).sqrt()
    };
    let radius = points().map(away).fold(1e-9, f64::max);
    let scale = 0.46 * ROTATED.1 / radius;
    let origin = [0.5 * ROTATED.0, 0.5 * ROTATED.1];
    json!({ "view": [0.6, 0.35], "scale": scale, "origin": origin, "centre": middle })
}

/// Rounded to 0.01 mm.
fn rounded(x: f64) -> f64 {
    (x * 1e5).round() / 1e5
}
