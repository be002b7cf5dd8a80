//! Iterations side by side.

use super::compare::{Comparison, FLOOR, orders};
use super::problem::{Curvature, Solution};

/// Longest table that is printed in full; longer ones are shortened to their first and last lines.
const LONGEST: usize = 24;
const FIRST: usize = 8;
const LAST: usize = 12;
/// Number of lines printed after the gradient has reached rounding.
const ROUNDING: usize = 2;

/// Explanation of the columns.
pub const LEGEND: &str = "\
it        iteration, 0 being the controls that the search starts from
cost      what the cost exceeds that of the better of the two solutions by
gradient  largest component of the projected gradient, relative to the terms that cancel in it
g/g-      gradient over that of the iteration before: constant if convergence is linear, falling to 0 if faster
order     ln(g/g-) over the same of the iteration before: 1 if convergence is linear, 2 if it is quadratic
share     how much of the second derivatives of the step was kept; 1 is all
mu        added to the diagonal of Q_uu
step      length alpha of the step that was then made
held      controls held at a bound";

/// The logs of both, side by side.
pub fn side_by_side(comparison: &Comparison) -> String {
    let best = comparison.exact.trajectory.cost.min(comparison.twin.trajectory.cost);
    let left = lines(&comparison.exact, Curvature::Exact, best);
    let right = lines(&comparison.twin, Curvature::GaussNewton, best);
    let width = left.iter().map(String::len).max().unwrap_or(0);
    let row = |k: usize| {
        let [left, right] = [&left, &right].map(|lines| lines.get(k).map_or("", String::as_str));
        format!("{left:width$}  |  {right}").trim_end().to_owned() + "\n"
    };
    (0..left.len().max(right.len())).map(row).collect()
}

/// Head, and one line for each iteration.
fn lines(solution: &Solution, curvature: Curvature, best: f64) -> Vec<String> {
    let exact = curvature == Curvature::Exact;
    let (name, share) = if exact { ("exact DDP", " share ") } else { ("iLQR", " ") };
    let head = format!(" it     cost  gradient     g/g-  order{share}     mu   step  held");
    let rule = "-".repeat(head.len());
    let width = head.len();
    let mut lines = vec![format!("{name:width$}"), head, rule];
    let orders = orders(&solution.log);
    let accurate = solution.log.iter().position(|line| line.gradient <= FLOOR);
    let shown = accurate.map_or(solution.log.len(), |k| (k + 1 + ROUNDING).min(solution.log.len()));
    for (k, line) in solution.log[..shown].iter().enumerate() {
        if shown > LONGEST && (FIRST..shown - LAST).contains(&k) {
            if k == FIRST {
                lines.push("...".to_owned());
            }
            continue;
        }
        let ratio = k.checked_sub(1).map(|k| format!("{:.1e}", line.gradient / solution.log[k].gradient));
        let order = orders[k].map(|order| format!("{order:.1}"));
        let last = line.alpha == 0.0;
        let unless_last = |text: String| if last { String::new() } else { text };
        let share = if exact { unless_last(format!("{}", line.share)) } else { String::new() };
        let share_width = if exact { 7 } else { 1 };
        lines.push(format!(
            "{k:3} {:8.1e}  {:8.1e} {:>8} {:>6}{share:>share_width$} {:>6} {:>6} {:5}",
            (line.cost - best).max(0.0),
            line.gradient,
            ratio.unwrap_or_default(),
            order.unwrap_or_default(),
            unless_last(if line.mu == 0.0 { "0".to_owned() } else { format!("{:.0e}", line.mu) }),
            unless_last(format!("{:.4}", line.alpha).trim_end_matches('0').trim_end_matches('.').to_owned()),
            line.held,
        ));
    }
    if shown < solution.log.len() {
        lines.push(format!("and {} more, in rounding", solution.log.len() - shown));
    }
    lines
}
