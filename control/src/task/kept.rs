//! The rows of what tools keep along a motion.

use super::given::{Given, direction, finite, length, positive_or_zero};
use super::placed::Carried;
use super::row::{Measure, Row, Subject};
use super::tool::{Quantity, ToolFunction};
use super::tool_rows::{KeptRows, Tools, zero};
use crate::problem::error::ProblemError;
use crate::problem::task_error::TaskError;
use crate::problem::tools::{Keep, Kept};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

impl Tools {
    /// The rows of what is kept.
    pub(super) fn keep(&mut self, at: Given, keep: &Keep) -> Result<KeptRows, ProblemError> {
        let tool = self.carried(at, &keep.tool)?;
        let name = |what: &str| format!("{what} of the tool '{}'", keep.tool.frame);
        let point = |name: &'static str, x: &[f64; 3]| {
            finite(at.key(name), x)?;
            Ok::<_, ProblemError>(Vector3::from(*x))
        };
        let distance_key = at.key("distance");
        let (function, rows) = match &keep.kept {
            Kept::Plane { through, normal, distance } => {
                let (x, n) = (point("through", through)?, direction(at.key("normal"), *normal)?);
                positive_or_zero(distance_key, *distance)?;
                let (height, range) = (n.dot(&x), if *distance > 0.0 { *distance } else { 1.0 });
                let (lower, upper) = (height - distance, height + distance);
                let row = Row {
                    lower,
                    upper,
                    range,
                    name: name("distance from the plane"),
                    unit: "m",
                    measure: Measure::Plain,
                    subject: Subject::Task,
                };
                (ToolFunction { tool, quantity: Quantity::Position(vec![n]) }, vec![row])
            }
            Kept::Line { through, along, distance } => {
                let (x, d) = (point("through", through)?, direction(at.key("along"), *along)?);
                positive_or_zero(distance_key, *distance)?;
                let label = name("distance from the line");
                if *distance > 0.0 {
                    let projector = Matrix3::identity() - d * d.transpose();
                    let quantity = Quantity::Distance { from: x, projector, radius: *distance };
                    (
                        ToolFunction { tool, quantity },
                        vec![Row::at_most(Measure::Square(*distance), "m", label)],
                    )
                } else {
                    let across = Quantity::across(d);
                    let rows =
                        across.iter().map(|n| Row::equal(n.dot(&x), 1.0, "m", label.clone())).collect();
                    (ToolFunction { tool, quantity: Quantity::Position(across.to_vec()) }, rows)
                }
            }
            Kept::Box { min, max } => box_rows(at, tool, min, max, &keep.tool.frame)?,
            Kept::Axis { axis, along, angle } => {
                let (axis, along) = (direction(at.key("axis"), *axis)?, direction(at.key("along"), *along)?);
                let label = name("direction");
                match tolerance(at, *angle)? {
                    None => zero(tool, Quantity::direction(axis, along), label),
                    Some(angle) => leaning(tool, Quantity::leaning(axis, along, angle), angle, label),
                }
            }
            Kept::Orientation { rotation, angle } => {
                if !rotation.matrix().iter().all(|entry| entry.is_finite()) {
                    return Err(TaskError::NotARotation.at(at.key("rotation")));
                }
                let label = name("orientation");
                match tolerance(at, *angle)? {
                    None => zero(tool, Quantity::Orientation(*rotation), label),
                    Some(angle) => leaning(tool, Quantity::turned(rotation, angle), angle, label),
                }
            }
            Kept::Acceleration { max } => {
                length(at.key("acceleration"), *max)?;
                let row = Row::at_most(Measure::Square(*max), "m/s^2", name("acceleration"));
                return Ok(KeptRows::OfAcceleration { frame: tool.frame, most: *max, row });
            }
            Kept::Speed { max } => {
                length(at.key("speed"), *max)?;
                let row = Row::at_most(Measure::Square(*max), "m/s", name("speed"));
                (ToolFunction { tool, quantity: Quantity::Speed(*max) }, vec![row])
            }
        };
        Ok(KeptRows::OfState(function, rows))
    }
}

/// At most this angle: `(1 - cos angle) / sin limit <= tan(limit / 2)`.
fn leaning(tool: Carried, quantity: Quantity, limit: f64, name: String) -> (ToolFunction, Vec<Row>) {
    (ToolFunction { tool, quantity }, vec![Row::at_most(Measure::Angle(limit), "rad", name)])
}

/// The largest angle, `None` for zero.
fn tolerance(at: Given, angle: f64) -> Result<Option<f64>, ProblemError> {
    if !(0.0..PI).contains(&angle) {
        let remedy = "must be at least 0 and less than a half turn, 3.14159 rad";
        return Err(TaskError::OutOfRange { value: angle, remedy }.at(at.key("angle")));
    }
    Ok((angle > 0.0).then_some(angle))
}

/// A row for each coordinate with a bound.
fn box_rows(
    at: Given,
    tool: Carried,
    min: &[f64; 3],
    max: &[f64; 3],
    name: &str,
) -> Result<(ToolFunction, Vec<Row>), ProblemError> {
    for (key, corner) in [("min", min), ("max", max)] {
        if let Some(&value) = corner.iter().find(|x| x.is_nan()) {
            return Err(TaskError::OutOfRange { value, remedy: "must be a number" }.at(at.key(key)));
        }
    }
    let (mut directions, mut rows) = (Vec::new(), Vec::new());
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let (lower, upper) = (min[k], max[k]);
        if !(lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY) {
            let remedy = "must not be less than the entry of min";
            return Err(TaskError::OutOfRange { value: upper, remedy }.at(at.key("max")));
        }
        if lower.is_finite() || upper.is_finite() {
            let room = upper - lower;
            let range = if room > 0.0 && room.is_finite() { room } else { 1.0 };
            directions.push(Vector3::ith(k, 1.0));
            let name = format!("{axis} of the tool '{name}'");
            let (unit, measure, subject) = ("m", Measure::Plain, Subject::Task);
            rows.push(Row { lower, upper, range, name, unit, measure, subject });
        }
    }
    if rows.is_empty() {
        return Err(TaskError::NothingAsked { frame: name.into(), remedy: "min or max" }.at(at.key("frame")));
    }
    Ok((ToolFunction { tool, quantity: Quantity::Position(directions) }, rows))
}
