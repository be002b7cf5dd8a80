//! Limits as lines beside the curves of a figure.

use crate::numbers::short;
use crate::plot::{Curve, Look, Plot};

/// A limit as it is drawn, with its number among those of several joints that lie on one another, and how
/// many these are: their dashes take turns.
pub struct Level {
    pub curve: Curve,
    pub turn: usize,
    pub of: usize,
}

/// The limits that are within half of the size of their curve from it, so that it stays legible, each in the
/// colour of its joint.
pub fn levels(plot: &Plot) -> Vec<Level> {
    let mut levels: Vec<(Level, Option<f64>)> = Vec::new();
    for limit in &plot.limits {
        let Some(curve) = plot.curves.iter().find(|curve| curve.color == limit.color) else { continue };
        if !limit.points.iter().any(|point| is_near(point.1, curve)) {
            continue;
        }
        let (look, what) = match limit.is_kept {
            true => (Look::Kept, "limit"),
            false => (Look::Compared, "limit of the robot, only compared,"),
        };
        let value = limit.constant();
        let number = value.map_or_else(String::new, |value| format!(" {}", short(value, 6)));
        let name = format!("{what}{number} of {}", curve.name);
        let curve = Curve { name, color: curve.color, points: limit.points.clone(), look };
        let same = |(level, other): &&mut (Level, Option<f64>)| {
            value.is_some() && *other == value && level.curve.look == look
        };
        let of = 1 + levels.iter_mut().filter(same).map(|(level, _)| level.of += 1).count();
        levels.push((Level { curve, turn: of - 1, of }, value));
    }
    levels.into_iter().map(|(level, _)| level).collect()
}

/// Whether a limit is finite and close to a curve, or between its points.
fn is_near(value: f64, curve: &Curve) -> bool {
    let values = curve.points.iter().map(|point| point.1).filter(|value| value.is_finite());
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
    let room = 0.5 * (high - low);
    value.is_finite() && low <= high && (low - room..=high + room).contains(&value)
}

#[cfg(test)]
mod tests {
    use super::{Curve, Look, is_near};

    #[test]
    fn limits_far_from_a_curve_would_flatten_it() {
        let points = vec![(0.0, 1.0), (1.0, 3.0)];
        let curve = Curve { name: "q".into(), color: 0, points, look: Look::Smooth };
        let near = [-0.1, 0.0, 2.0, 4.0, 4.1, f64::INFINITY, f64::NAN].map(|value| is_near(value, &curve));
        assert_eq!(near, [false, true, true, true, false, false, false]);
    }
}
