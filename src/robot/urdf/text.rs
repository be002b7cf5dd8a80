//! How the text of a URDF is made readable, and how names and rotations are written into one.

/// The text without what carries nothing: byte order mark, XML declaration, comments. Lines stay where they are.
///
/// Published files have blank lines before the declaration, unknown versions in it and `--` inside comments, which XML
/// forbids and the usual readers do not mind.
pub(super) fn without_comments(text: &str) -> String {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    let start = text.len() - text.trim_start().len();
    if text[start..].starts_with("<?xml") {
        let end = text.find("?>").map_or(text.len(), |end| end + 2);
        blank(&text[..end], &mut out);
        rest = &text[end..];
    }
    while let Some(at) = rest.find("<!") {
        let (before, from) = rest.split_at(at);
        out += before;
        let (is_comment, end) = match (from.starts_with("<!--"), from.starts_with("<![CDATA[")) {
            (true, _) => (true, from[4..].find("-->").map(|end| end + 7)),
            (_, true) => (false, from.find("]]>").map(|end| end + 3)),
            _ => (false, Some(2)),
        };
        let Some(end) = end else {
            rest = from;
            break;
        };
        if is_comment {
            blank(&from[..end], &mut out)
        } else {
            out += &from[..end]
        }
        rest = &from[end..];
    }
    out + rest
}

/// As many lines, with nothing on them.
fn blank(text: &str, out: &mut String) {
    out.extend(text.chars().filter(|&c| c == '\n'));
}

/// The angles of a unit quaternion (x, y, z, w), exact near pitch = +-pi/2 too: yaw is computed given roll.
pub(super) fn roll_pitch_yaw([x, y, z, w]: [f64; 4]) -> [f64; 3] {
    let r = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ];
    let roll = r[2][1].atan2(r[2][2]);
    let pitch = (-r[2][0]).atan2(r[0][0].hypot(r[1][0]));
    let (sin, cos) = roll.sin_cos();
    let yaw = (sin * r[0][2] - cos * r[0][1]).atan2(cos * r[1][1] - sin * r[1][2]);
    [roll, pitch, yaw]
}

/// The text as an attribute value.
pub(super) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            c => out.push(c),
        }
    }
    out
}
