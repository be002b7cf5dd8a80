//! SVG text: escaping, grid lines, and figures as files.

use costate::robot::escape_hidden;

/// Colours and line styles of all figures, light and dark.
pub const STYLE: &str = include_str!("figure.css");

/// Text that is safe between tags and in attributes. Hidden characters other than line ends and tabs become
/// escapes: marks of direction would turn around what surrounds a name.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(c),
            c => out.push_str(&escape_hidden(c.encode_utf8(&mut [0; 4]))),
        }
    }
    out
}

/// The first `most` characters, with an ellipsis in place of the others; hidden characters become escapes.
pub fn cut(text: &str, most: usize) -> String {
    let text = escape_hidden(text);
    if text.chars().count() <= most {
        return text.into_owned();
    }
    text.chars().take(most - 1).chain(['\u{2026}']).collect()
}

/// A vertical grid line and the number below it.
pub fn upright(at: f64, (top, bottom): (f64, f64), number: &str) -> String {
    format!(
        "<path class=\"grid\" d=\"M{at:.1} {top:.1}V{bottom:.1}\"/>\
         <text class=\"tick\" x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{number}</text>",
        bottom + 16.0
    )
}

/// A horizontal grid line of this class and the number to its left.
pub fn level(at: f64, (left, right): (f64, f64), number: &str, class: &str) -> String {
    format!(
        "<path class=\"{class}\" d=\"M{left:.1} {at:.1}H{right:.1}\"/>\
         <text class=\"tick\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{number}</text>",
        left - 6.0,
        at + 4.0
    )
}

/// The names of both axes of the rectangle `(left, right)` x `(top, bottom)`.
pub fn axis_names((left, right): (f64, f64), (top, bottom): (f64, f64), [x, y]: [&str; 2]) -> String {
    let (centre, middle, below) = (0.5 * (left + right), 0.5 * (top + bottom), bottom + 36.0);
    let label = "class=\"label\" text-anchor=\"middle\"";
    format!(
        "<text {label} x=\"{centre:.1}\" y=\"{below:.1}\">{}</text>\
         <text {label} transform=\"translate(14 {middle:.1}) rotate(-90)\">{}</text>",
        escaped(x),
        escaped(y)
    )
}

/// The background of a figure in a file of its own; figures are recognised by it.
const BACKGROUND: &str = "<rect class=\"ground\" width=\"100%\" height=\"100%\"/>";

/// Whether [`alone`] wrote this text.
pub fn is_figure(text: &str) -> bool {
    text.starts_with("<svg xmlns=") && text.contains(BACKGROUND)
}

/// A figure of the page as a file of its own, with the size of its view box.
pub fn alone(picture: &str) -> String {
    let style = format!("<style>{STYLE}</style>{BACKGROUND}");
    let view_box = picture.split("viewBox=\"0 0 ").nth(1).and_then(|rest| rest.split('"').next());
    let (width, height) = view_box.and_then(|size| size.split_once(' ')).unwrap_or(("100%", "100%"));
    let head = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" ");
    let picture = picture.replacen("<svg ", &head, 1);
    let opened = picture.find('>').map_or(0, |end| end + 1);
    format!("{}{style}{}\n", &picture[..opened], &picture[opened..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_escaped_and_shortened() {
        assert_eq!(escaped("a<b>\"c\" & 'd'\u{7}"), "a&lt;b&gt;&quot;c&quot; &amp; &#39;d&#39;\\u{7}");
        assert_eq!(escaped("a\u{202e}\n\tb"), "a\\u{202e}\n\tb");
        assert_eq!(cut("a\u{202e}\nb", 40), "a\\u{202e}\\nb");
        assert_eq!((cut("short", 5), cut("shoulder_lift", 6)), ("short".into(), "shoul\u{2026}".into()));
    }

    #[test]
    fn a_figure_file_has_a_name_space_and_its_style() {
        let picture = alone("<svg viewBox=\"0 0 30 20.5\"><g/></svg>");
        let head = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"30\" height=\"20.5\" ";
        assert!(picture.starts_with(&format!("{head}viewBox=\"0 0 30 20.5\"><style>")), "{picture}");
        assert!(picture.ends_with("<g/></svg>\n"));
        assert!(is_figure(&picture) && !is_figure("<svg xmlns=\"http://www.w3.org/2000/svg\"/>"));
    }
}
