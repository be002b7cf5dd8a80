//! The beginning of the page: robot, task, how it ended, remarks, time, cost, limits.

use crate::figures::time_is_free;
use crate::forces::FORCES;
use crate::motion::Motion;
use crate::numbers::short;
use crate::panels;
use crate::svg::markup::escaped;
use crate::text;
use costate_control::{LimitViolation, Remark, Severity};

/// A figure with its name, and whether it is good or bad.
struct Card {
    name: &'static str,
    value: String,
    note: String,
    is_good: Option<bool>,
}

/// Most warnings that are not folded.
const MOST_OPEN: usize = 4;

/// Name, status, remarks, cards. The status is green only if no remark is an error.
pub fn section(motion: &Motion<'_>) -> String {
    let (problem, solution) = (motion.problem, motion.solution);
    let remarks = solution.remarks(problem);
    let of = |severity: Severity| -> Vec<&Remark> {
        remarks.iter().filter(|remark| remark.severity == severity).collect()
    };
    let list = |items: &[&Remark], class: &str| match items {
        [] => String::new(),
        items => {
            let item = |remark: &&Remark| format!("<li>{}.</li>", escaped(&text::sentence(&remark.text)));
            let list: String = items.iter().map(item).collect();
            let list = format!("<ul class=\"{class}\">{list}</ul>");
            match items.len() {
                count if count > MOST_OPEN => {
                    format!("<details class=\"folded\"><summary>{count} {class}</summary>{list}</details>")
                }
                _ => list,
            }
        }
    };
    let status = &solution.motion.status;
    let errors = of(Severity::Error);
    let cards: String = cards(motion).iter().map(card).collect();
    format!(
        "<header><h1>{name} <span class=\"status {class}\">{status}</span></h1><p class=\"task\">{task}</p>\
         {errors}{warnings}{notes}<dl class=\"cards\">{cards}</dl></header>\n",
        name = escaped(motion.robot().name()),
        class = if errors.is_empty() { "good" } else { "bad" },
        status = escaped(&text::status(status)),
        task = escaped(&text::sentence(&text::criterion(problem, solution))),
        errors = list(&errors, "remarks"),
        warnings = list(&of(Severity::Warning), "warnings"),
        notes = list(&of(Severity::Note), "warnings"),
    )
}

fn card(card: &Card) -> String {
    let class = match card.is_good {
        Some(true) => " class=\"good\"",
        Some(false) => " class=\"bad\"",
        None => "",
    };
    let note =
        if card.note.is_empty() { String::new() } else { format!("<small>{}</small>", escaped(&card.note)) };
    format!("<div><dt>{}</dt> <dd{class}>{} {note}</dd></div>\n", card.name, escaped(&card.value))
}

fn cards(motion: &Motion<'_>) -> Vec<Card> {
    let solution = motion.solution;
    let plain = |name, value, note: &str| Card { name, value, note: note.into(), is_good: None };
    if !motion.exists() {
        return Vec::new();
    }
    let time = if time_is_free(motion.problem) { "found" } else { "given" };
    let penalties = match solution.motion.penalty_cost {
        cost if motion.problem.penalty.is_some() => format!("and penalties {}", short(cost, 4)),
        _ => String::new(),
    };
    let mut cards = vec![
        plain("final time", format!("{} s", short(solution.motion.final_time, 6)), time),
        plain("cost", short(solution.motion.cost, 6), &penalties),
        limits(motion),
    ];
    let panels = panels::along_the_motion(motion);
    let peak = |id: &str| {
        let (_, plot) = panels.iter().find(|(name, _)| name == id)?;
        let points = plot.curves.iter().flat_map(|curve| &curve.points);
        let largest =
            points.filter(|point| point.1.is_finite()).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let note = format!("at {} s", short(largest.0, 3));
        Some((format!("{} {}", short(largest.1.abs(), 4), plot.unit), note))
    };
    let [of_forces, of_speeds] = match solution.gait {
        Some(_) => ["largest force of the ground", "fastest foot"],
        None => ["largest force of a constraint", "fastest tool"],
    };
    let peaks =
        [("largest power of all joints", "total_power"), (of_forces, FORCES), (of_speeds, "tool_speed")];
    for (name, id) in peaks {
        cards.extend(peak(id).map(|(value, note)| plain(name, value, &note)));
    }
    let phases = solution.trajectory.via_times.len();
    if phases > 0 {
        let times: Vec<String> = solution.trajectory.via_times.iter().map(|&time| short(time, 4)).collect();
        cards.push(plain("phases", (phases + 1).to_string(), &format!("new ones at {} s", times.join(", "))));
    }
    cards
}

/// Whether all limits are kept, and how many are active.
fn limits(motion: &Motion<'_>) -> Card {
    let limits = &motion.solution.limits;
    let name = "limits";
    let named = |(kind, worst): (&str, &LimitViolation)| match kind {
        "task" => worst.name.clone(),
        kind => format!("{} of {}", text::spaced(kind), worst.name),
    };
    let [at_points, between]: [Vec<String>; 2] =
        [limits.violations().map(named).collect(), limits.violations_between().map(named).collect()];
    for (value, exceeded) in [("exceeded", at_points), ("exceeded between points", between)] {
        if !exceeded.is_empty() {
            return Card { name, value: value.into(), note: exceeded.join("; "), is_good: Some(false) };
        }
    }
    if limits.is_empty() && !motion.problem.limit_warnings(&motion.solution.trajectory).is_empty() {
        let note = "those of the robot are exceeded".into();
        return Card { name, value: "not asked for".into(), note, is_good: None };
    }
    if limits.is_empty() {
        let bounded = motion.problem.bounds.is_some();
        let value = if bounded { "bounds kept" } else { "none given" };
        return Card { name, value: value.into(), note: String::new(), is_good: bounded.then_some(true) };
    }
    let mut active: Vec<_> = limits
        .kinds()
        .filter_map(|(kind, usage)| Some((kind, usage?)))
        .flat_map(|(kind, usage)| usage.active.iter().map(move |span| (kind, &span.name, &span.side)))
        .collect();
    active.sort();
    active.dedup();
    let note = if active.is_empty() { "none is reached".into() } else { format!("{} reached", active.len()) };
    Card { name, value: "all kept".into(), note, is_good: Some(true) }
}
