//! Paths of curves: cubics between the points, without overshoot.

/// Straight lines.
pub(crate) fn straight(points: &[(f64, f64)]) -> String {
    let point =
        |(k, (x, y)): (usize, &(f64, f64))| format!("{}{x:.2} {y:.2}", if k == 0 { "M" } else { "L" });
    points.iter().enumerate().map(point).collect()
}

/// Bezier curves with the slopes of the parabola through three points, limited so that nothing overshoots;
/// vertical lines between two points with the same x.
pub(crate) fn through(points: &[(f64, f64)]) -> String {
    let runs = points.chunk_by(|a, b| a.0 < b.0);
    let run = |(k, run): (usize, &[(f64, f64)])| match k {
        0 => rising(run),
        _ => format!("L{}", &rising(run)[1..]),
    };
    runs.enumerate().map(run).collect()
}

/// The same for points with increasing x.
fn rising(points: &[(f64, f64)]) -> String {
    if points.len() < 3 {
        return straight(points);
    }
    let chords: Vec<f64> = points.windows(2).map(|p| (p[1].1 - p[0].1) / (p[1].0 - p[0].0)).collect();
    let width = |k: usize| points[k + 1].0 - points[k].0;
    let last = chords.len() - 1;
    let inner = |k: usize| (width(k) * chords[k - 1] + width(k - 1) * chords[k]) / (width(k) + width(k - 1));
    let slope = |k: usize| match k {
        0 => limited(2.0 * chords[0] - inner(1), chords[0], chords[0]),
        k if k > last => limited(2.0 * chords[last] - inner(last), chords[last], chords[last]),
        k => limited(inner(k), chords[k - 1], chords[k]),
    };
    let (x, y) = points[0];
    let piece = |k: usize| {
        let (third, (x, y), (x_next, y_next)) = (width(k) / 3.0, points[k], points[k + 1]);
        format!(
            "C{:.2} {:.2} {:.2} {:.2} {x_next:.2} {y_next:.2}",
            x + third,
            y + third * slope(k),
            x_next - third,
            y_next - third * slope(k + 1)
        )
    };
    (0..chords.len()).map(piece).fold(format!("M{x:.2} {y:.2}"), |path, piece| path + &piece)
}

/// A slope between two chords: zero at an edge, at most three times the flatter chord if both have the same
/// sign.
fn limited(slope: f64, before: f64, after: f64) -> f64 {
    let (flat, steep) = (before.abs().min(after.abs()), before.abs().max(after.abs()));
    if before * after > 0.0 {
        return if slope * before <= 0.0 { 0.0 } else { slope.signum() * slope.abs().min(3.0 * flat) };
    }
    if flat > 0.2 * steep { slope } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_not_overshot_and_a_line_stays_straight() {
        assert_eq!(limited(5.0, 0.0, 100.0), 0.0);
        assert_eq!(limited(5.0, 1.0, 100.0), 3.0);
        let line = through(&[(0.0, 0.0), (3.0, 3.0), (9.0, 9.0)]);
        assert_eq!(line, "M0.00 0.00C1.00 1.00 2.00 2.00 3.00 3.00C5.00 5.00 7.00 7.00 9.00 9.00");
        assert_eq!(through(&[(0.0, 0.0), (1.0, 2.0)]), straight(&[(0.0, 0.0), (1.0, 2.0)]));
        let step = through(&[(0.0, 1.0), (1.0, 1.0), (1.0, -1.0), (2.0, -1.0)]);
        assert_eq!(step, "M0.00 1.00L1.00 1.00L1.00 -1.00L2.00 -1.00");
        assert_eq!(through(&[]), "");
    }
}
