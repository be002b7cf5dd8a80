//! Log-log plots as SVG: points, the powers fitted to them, and their exponents.

use crate::fit::Power;
use crate::tables::duration;
use std::fmt::Write;

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 520.0;
/// Room around the axes: left, right (labels of the lines), top, bottom.
const LEFT: f64 = 84.0;
const RIGHT: f64 = 250.0;
const TOP: f64 = 64.0;
const BOTTOM: f64 = 76.0;
/// Height of a label with its second line and the room around it.
const LABEL: f64 = 42.0;

/// One line: dots, and a straight line through those that its power was fitted to.
pub struct Line {
    pub name: String,
    pub points: Vec<(f64, f64)>,
    pub power: Option<Power>,
    pub color: &'static str,
    pub dashed: bool,
}

/// A plot of times (s).
pub struct Plot {
    pub title: String,
    /// Below the horizontal axis, and in small letters below that.
    pub axis: String,
    pub note: String,
    /// Marks of the horizontal axis.
    pub marks: Vec<f64>,
    pub lines: Vec<Line>,
}

/// Logarithmic scale from a range of values to a range of the picture.
struct Scale {
    from: [f64; 2],
    to: [f64; 2],
}

impl Scale {
    fn at(&self, value: f64) -> f64 {
        let [low, high] = self.from.map(f64::ln);
        self.to[0] + (value.ln() - low) / (high - low) * (self.to[1] - self.to[0])
    }
}

/// The next 1, 2 or 5 times a power of ten below.
fn round_down(value: f64) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    let steps = [5.0, 2.0, 1.0].map(|step| step * power);
    steps.into_iter().find(|step| *step <= value).unwrap_or(power)
}

/// The next one above.
fn round_up(value: f64) -> f64 {
    1.0 / round_down(1.0 / value)
}

impl Plot {
    pub fn svg(&self) -> String {
        let values = || self.lines.iter().flat_map(|line| &line.points);
        let least = |of: fn(&(f64, f64)) -> f64| values().map(of).fold(f64::INFINITY, f64::min);
        let most = |of: fn(&(f64, f64)) -> f64| values().map(of).fold(0.0, f64::max);
        let range = [round_down(0.85 * least(|p| p.1)), round_up(1.15 * most(|p| p.1))];
        let x = Scale { from: [least(|p| p.0) / 1.12, most(|p| p.0) * 1.12], to: [LEFT, WIDTH - RIGHT] };
        let y = Scale { from: range, to: [HEIGHT - BOTTOM, TOP] };
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" \
             height=\"{HEIGHT}\" font-family=\"system-ui, sans-serif\" font-size=\"14\" role=\"img\">\n\
             <title>{title}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
             <text x=\"{LEFT}\" y=\"34\" font-size=\"18\" font-weight=\"600\" fill=\"#222\">{title}</text>\n",
            title = escaped(&self.title),
        );
        self.axes(&mut svg, &x, &y);
        for line in &self.lines {
            draw(&mut svg, line, &x, &y);
        }
        self.labels(&mut svg, &x, &y);
        svg.push_str("</svg>\n");
        svg
    }

    fn axes(&self, svg: &mut String, x: &Scale, y: &Scale) {
        let ([left, right], [bottom, top]) = (x.to, y.to);
        let [low, high] = y.from;
        for power in low.log10().floor() as i32..=high.log10().ceil() as i32 {
            for step in 1..10 {
                let value = f64::from(step) * 10_f64.powi(power);
                if !(0.999 * low..=1.001 * high).contains(&value) {
                    continue;
                }
                let (at, color) = (y.at(value), if step == 1 { "#c8c8c8" } else { "#efefef" });
                put(svg, format_args!("<path d=\"M{left:.1} {at:.1}H{right:.1}\" stroke=\"{color}\"/>"));
                if step == 1 {
                    let (place, text) = (left - 10.0, duration(value));
                    put(
                        svg,
                        format_args!(
                            "<text x=\"{place:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"#444\">{text}</text>",
                            at + 5.0
                        ),
                    );
                }
            }
        }
        for &mark in self.marks.iter().filter(|mark| (x.from[0]..=x.from[1]).contains(*mark)) {
            let at = x.at(mark);
            put(svg, format_args!("<path d=\"M{at:.1} {bottom:.1}V{top:.1}\" stroke=\"#e4e4e4\"/>"));
            put(
                svg,
                format_args!(
                    "<text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"#444\">{mark}</text>",
                    bottom + 21.0
                ),
            );
        }
        put(
            svg,
            format_args!(
                "<path d=\"M{left:.1} {top:.1}V{bottom:.1}H{right:.1}\" fill=\"none\" stroke=\"#444\" stroke-width=\"1.2\"/>"
            ),
        );
        put(
            svg,
            format_args!(
                "<text x=\"{left:.1}\" y=\"{:.1}\" fill=\"#222\">{}</text>",
                bottom + 45.0,
                escaped(&self.axis)
            ),
        );
        put(
            svg,
            format_args!(
                "<text x=\"{left:.1}\" y=\"{:.1}\" font-size=\"11.5\" fill=\"#777\">{}</text>",
                bottom + 64.0,
                escaped(&self.note)
            ),
        );
        put(
            svg,
            format_args!(
                "<text x=\"{left:.1}\" y=\"{:.1}\" font-size=\"12.5\" fill=\"#555\">CPU time</text>",
                top - 9.0
            ),
        );
    }

    /// Name and exponent of each line beside its last point, far enough apart to be read.
    fn labels(&self, svg: &mut String, x: &Scale, y: &Scale) {
        let mut ends: Vec<_> =
            self.lines.iter().filter_map(|line| Some((*line.points.last()?, line))).collect();
        ends.sort_by(|a, b| b.0.1.total_cmp(&a.0.1));
        let mut heights: Vec<f64> = ends.iter().map(|(end, _)| y.at(end.1).max(TOP + 14.0)).collect();
        for k in 1..heights.len() {
            heights[k] = heights[k].max(heights[k - 1] + LABEL);
        }
        let mut limit = HEIGHT - BOTTOM;
        for height in heights.iter_mut().rev() {
            *height = height.min(limit);
            limit = *height - LABEL;
        }
        let left = WIDTH - RIGHT + 30.0;
        for ((end, line), height) in ends.into_iter().zip(heights) {
            let (from, at, color) = (x.at(end.0) + 8.0, y.at(end.1), line.color);
            put(
                svg,
                format_args!(
                    "<path d=\"M{from:.1} {at:.1}L{:.1} {:.1}H{:.1}\" fill=\"none\" stroke=\"{color}\" stroke-opacity=\"0.45\"/>",
                    left - 12.0,
                    height - 4.0,
                    left - 4.0
                ),
            );
            put(
                svg,
                format_args!(
                    "<text x=\"{left:.1}\" y=\"{height:.1}\" font-weight=\"600\" fill=\"{color}\">{}</text>",
                    escaped(&line.name)
                ),
            );
            if let Some(power) = line.power {
                put(
                    svg,
                    format_args!(
                        "<text x=\"{left:.1}\" y=\"{:.1}\" font-size=\"12.5\" fill=\"{color}\">exponent {:.2} \u{b1} {:.2}</text>",
                        height + 16.0,
                        power.exponent,
                        power.error
                    ),
                );
            }
        }
    }
}

fn draw(svg: &mut String, line: &Line, x: &Scale, y: &Scale) {
    let color = line.color;
    if let (Some(power), Some(first), Some(last)) = (line.power, line.points.first(), line.points.last()) {
        let dashes = if line.dashed { " stroke-dasharray=\"7 5\"" } else { "" };
        let [from, to] = [first.0, last.0].map(|at| (x.at(at), y.at(power.at(at))));
        put(
            svg,
            format_args!(
                "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"{color}\" stroke-width=\"2\" stroke-opacity=\"0.6\"{dashes}/>",
                from.0, from.1, to.0, to.1
            ),
        );
    }
    for (value, time) in &line.points {
        let fill = if line.dashed { "#fff" } else { color };
        put(
            svg,
            format_args!(
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"4.2\" fill=\"{fill}\" stroke=\"{color}\" stroke-width=\"2\"/>",
                x.at(*value),
                y.at(*time)
            ),
        );
    }
}

fn put(svg: &mut String, element: std::fmt::Arguments<'_>) {
    // A string takes all that is written to it.
    let _ = writeln!(svg, "{element}");
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
