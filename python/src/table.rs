//! A robot as a table in HTML, for notebooks.

use costate::robot::{Joint, JointKind, Robot};

/// Text without what HTML reads as markup.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\'' => out += "&#39;",
            other => out.push(other),
        }
    }
    out
}

/// A limit with four digits and its unit; a dash where there is none.
fn with_unit(value: f64, unit: &str) -> String {
    if value.is_infinite() { "–".into() } else { format!("{value:.4} {unit}") }
}

fn row(robot: &Robot, joint: &Joint) -> String {
    let limits = &joint.limits;
    let [position, velocity, effort] = match joint.kind {
        JointKind::Revolute => ["rad", "rad/s", "N m"],
        JointKind::Prismatic => ["m", "m/s", "N"],
    };
    let parent = joint.parent.map_or("world", |parent| robot.joints()[parent].name.as_str());
    let follows = joint
        .mimic
        .map_or(String::new(), |mimic| format!(" (mimics {})", escaped(&robot.joints()[mimic.joint].name)));
    // The parts of a free joint are rows of their own.
    let kind = match &joint.free {
        Some(part) => format!("{}, {} of {}", part.kind.name(), part.place + 1, part.kind.dof()),
        None => joint.kind.name().into(),
    };
    let cells = [
        format!("{}{follows}", escaped(&joint.name)),
        kind,
        escaped(parent),
        escaped(&joint.link),
        format!("{:.4}", joint.inertia.mass),
        with_unit(limits.lower, position),
        with_unit(limits.upper, position),
        with_unit(limits.velocity, velocity),
        with_unit(limits.effort, effort),
    ];
    format!("<tr>{}</tr>", cells.map(|cell| format!("<td>{cell}</td>")).concat())
}

/// Name, number of joints, one row for each joint, and the warnings.
pub fn html(robot: &Robot) -> String {
    let head = ["joint", "type", "on", "link", "mass (kg)", "lower", "upper", "max |v|", "max |tau|"];
    let head = head.map(|title| format!("<th>{title}</th>")).concat();
    let rows: String = robot.joints().iter().map(|joint| row(robot, joint)).collect();
    let warnings: String = robot
        .warnings()
        .iter()
        .map(|warning| format!("<li>{}</li>", escaped(&warning.to_string())))
        .collect();
    let warnings = if warnings.is_empty() { warnings } else { format!("<ul>{warnings}</ul>") };
    format!(
        "<div><b>{}</b>: n = {}<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{warnings}</div>",
        escaped(robot.name()),
        robot.dof()
    )
}
