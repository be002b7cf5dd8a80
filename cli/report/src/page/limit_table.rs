//! The table of limits: which are kept, by how much each kind is exceeded, and when each is active.

use crate::entries::of_coordinates;
use crate::figures::limit_units;
use crate::limits::{Quantity, Range, kept, only_compared};
use crate::motion::Motion;
use crate::numbers::short;
use crate::svg::markup::escaped;
use crate::text::spaced;
use crate::units::{self, Units};
use costate_control::{ActiveLimit, LimitUse, Method};

/// A part of the distance between two limits within which a motion is at one of them, as in
/// [`LimitUse::active`].
const ACTIVE: f64 = 1e-4;

/// Most spans of time that are listed of one limit.
const MOST_SPANS: usize = 6;

const HEADER: [&str; 5] = ["limits", "kept", "largest excess", "between points", "where"];
const ACTIVE_HEADER: [&str; 4] = ["active limit", "of", "side", "when (s)"];

/// What the motion must keep.
const HARD: &str = "hard";

/// Limits of one kind.
struct Row<'a> {
    /// As in [`HEADER`].
    cells: [String; 5],
    active: Vec<Span<'a>>,
}

/// A span of time in which a joint, a tool or a body is at a limit.
struct Span<'a> {
    name: &'a str,
    side: &'a str,
    from: f64,
    to: f64,
}

/// The section; empty if nothing is limited.
pub fn section(motion: &Motion<'_>) -> String {
    let kinds = motion.solution.limits.kinds();
    let mut rows: Vec<Row<'_>> =
        kinds.filter_map(|(kind, usage)| Some(of_kind(motion, kind, usage?))).collect();
    // The direct method reports on what it keeps; bounds of the others, and what is compared, are looked at
    // here.
    if motion.solution.options.method != Method::Direct {
        rows.extend(at_nodes(motion, Quantity::Control, &kept(motion, Quantity::Control), true));
    }
    for quantity in [Quantity::Position, Quantity::Rate, Quantity::Control] {
        rows.extend(at_nodes(motion, quantity, &only_compared(motion, quantity), false));
    }
    if rows.is_empty() {
        return String::new();
    }
    let all = table(&HEADER, rows.iter().map(|row| row.cells.to_vec()));
    let active: Vec<Vec<String>> = rows
        .iter()
        .flat_map(|row| {
            let [name, kept, ..] = &row.cells;
            let name = if kept == HARD { name.clone() } else { format!("{name}, {kept}") };
            together(&row.active)
                .into_iter()
                .map(move |cells| [std::slice::from_ref(&name), &cells[..]].concat())
        })
        .collect();
    let active = if active.is_empty() { String::new() } else { table(&ACTIVE_HEADER, active.into_iter()) };
    format!(
        "<section><h2>Limits</h2>{all}<p class=\"note\">A hard limit is one that the motion must keep. Limits of \
         the robot that are only compared give warnings; they are compared at the nodes. A limit is active \
         where the motion is beyond it, or nearer than 1e-4 of the distance between both \
         sides.</p>{active}</section>\n"
    )
}

fn table(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let row = |tag: &str, cells: &mut dyn Iterator<Item = &str>| -> String {
        let cells: String = cells.map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell))).collect();
        format!("<tr>{cells}</tr>")
    };
    let rows: String = rows.map(|cells| row("td", &mut cells.iter().map(String::as_str))).collect();
    let header = row("th", &mut header.iter().copied());
    format!(
        "<div class=\"wide\"><table class=\"limits\"><thead>{header}</thead><tbody>{rows}</tbody></table></div>"
    )
}

/// The row of a kind of hard limits of the direct method.
fn of_kind<'a>(motion: &Motion<'a>, kind: &str, usage: &'a LimitUse) -> Row<'a> {
    let unit = match kind {
        "task" => "m, rad or m/s".to_owned(),
        kind => units::of_robot(&motion.problem.robot, limit_units(kind)),
    };
    let place = usage
        .worst
        .as_ref()
        .or(usage.worst_between.as_ref())
        .map_or_else(|| "-".to_owned(), |worst| format!("{}, t = {} s", worst.name, short(worst.time, 4)));
    let between = short(usage.between, 3);
    let name = if kind == "task" { "tools, clearances".into() } else { spaced(kind) };
    let excess = format!("{} {unit}", short(usage.at_points, 3));
    let span = |limit: &'a ActiveLimit| {
        let ActiveLimit { name, side, from, to, .. } = limit;
        Span { name, side, from: *from, to: *to }
    };
    Row {
        cells: [name, HARD.into(), excess, between, place],
        active: usage.active.iter().map(span).collect(),
    }
}

/// A row for limits of joints that the solver does not report on; none if nothing is limited.
fn at_nodes<'a>(motion: &Motion<'a>, quantity: Quantity, ranges: &[Range], is_hard: bool) -> Option<Row<'a>> {
    let trajectory = &motion.solution.trajectory;
    let (name, rows, unit): (_, _, Units) = match quantity {
        Quantity::Position => ("position", &trajectory.q, units::POSITION),
        Quantity::Rate => ("rate", &trajectory.v, units::RATE),
        _ => ("control", &trajectory.u, units::EFFORT),
    };
    if ranges.iter().flatten().all(|end| end.is_infinite()) {
        return None;
    }
    let (mut worst, mut active) = ((0.0, "-".to_owned()), Vec::new());
    let robot = &motion.problem.robot;
    let entries: Vec<usize> = match quantity {
        Quantity::Position => of_coordinates(robot),
        _ => (0..robot.dof()).collect(),
    };
    for ((joint, &[low, high]), at) in robot.independent_joints().zip(ranges).zip(entries) {
        let width = if (high - low).is_finite() { high - low } else { low.abs().min(high.abs()) };
        let sides = [("min", -1.0, low), ("max", 1.0, high)];
        for (side, sign, limit) in sides.into_iter().filter(|side| side.2.is_finite()) {
            let mut open = false;
            for (&t, row) in trajectory.t.iter().zip(rows) {
                let excess = sign * (row[at] - limit);
                if excess > worst.0 {
                    worst = (excess, format!("{}, t = {} s", joint.name, short(t, 4)));
                }
                let is_active = excess >= -ACTIVE * width;
                match active.last_mut().filter(|_| open && is_active) {
                    Some(Span { to, .. }) => *to = t,
                    None if is_active => active.push(Span { name: &joint.name, side, from: t, to: t }),
                    None => {}
                }
                open = is_active;
            }
        }
    }
    let excess = format!("{} {}", short(worst.0, 3), units::of_robot(&motion.problem.robot, unit));
    let kept = if is_hard { HARD } else { "only compared" };
    Some(Row { cells: [name.into(), kept.into(), excess, "-".into(), worst.1], active })
}

/// Name, side and times of each limit: `elbow`, `max`, `0.1 to 0.3, 0.5`.
fn together(active: &[Span<'_>]) -> Vec<[String; 3]> {
    let mut found = Vec::new();
    let mut rest = active.iter().collect::<Vec<_>>();
    while let Some(&&Span { name, side, .. }) = rest.first() {
        let (same, others): (Vec<_>, Vec<_>) =
            rest.into_iter().partition(|span| span.name == name && span.side == side);
        rest = others;
        let time = |span: &&Span<'_>| match (short(span.from, 4), short(span.to, 4)) {
            (from, to) if from == to => from,
            (from, to) => format!("{from} to {to}"),
        };
        let times: Vec<String> = same.iter().take(MOST_SPANS).map(time).collect();
        let more = same.len().saturating_sub(MOST_SPANS);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        found.push([name.into(), side.into(), times.join(", ") + &more]);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{Span, at_nodes, together};
    use crate::ReportOptions;
    use crate::limits::Quantity;
    use crate::motion::Motion;
    use costate::robot::LoadOptions;
    use costate_control::{ProblemFile, Solver};

    /// What has no limit is at none, whatever it does.
    #[test]
    fn limits_that_are_infinite_are_not_active() {
        let path = "../../examples/problems/two_link.toml";
        let file = ProblemFile::read(path, LoadOptions::default()).unwrap();
        let solution = Solver::new(&file.problem, file.options).unwrap().solve();
        let options = ReportOptions::default();
        let motion = Motion::new(&file.problem, &solution, &options);
        let rates = &solution.trajectory.v;
        let fastest = rates.iter().map(|row| row[1]).fold(f64::NEG_INFINITY, f64::max);
        let infinite = [f64::NEG_INFINITY, f64::INFINITY];
        let active = |ranges: [[f64; 2]; 2]| {
            let row = at_nodes(&motion, Quantity::Rate, &ranges, true).unwrap();
            row.active.iter().map(|span| (span.name.to_owned(), span.side)).collect::<Vec<_>>()
        };
        let name = file.problem.robot.independent_joints().nth(1).unwrap().name.clone();
        assert_eq!(active([infinite, [f64::NEG_INFINITY, fastest]]), [(name, "max")]);
        assert!(active([infinite, [-1e3, 1e3]]).is_empty());
        assert!(at_nodes(&motion, Quantity::Rate, &[infinite; 2], true).is_none());
    }

    #[test]
    fn spans_of_one_limit_stand_together() {
        let span = |name, side, from, to| Span { name, side, from, to };
        assert!(together(&[]).is_empty());
        let active = [
            span("a", "max", 0.0, 0.25),
            span("b", "min", 0.5, 0.5),
            span("a", "max", 0.75, 1.0),
            span("a", "min", 0.3, 0.3),
        ];
        let expected = [["a", "max", "0 to 0.25, 0.75 to 1"], ["b", "min", "0.5"], ["a", "min", "0.3"]];
        assert_eq!(together(&active), expected);
        let many: Vec<_> = (0..8).map(|k| span("a", "max", f64::from(k), f64::from(k))).collect();
        assert_eq!(together(&many)[0][2], "0, 1, 2, 3, 4, 5 and 2 more");
    }
}
