//! Plots of curves as SVG.

use super::levels::{Level, levels};
use super::markup::{axis_names, cut, escaped, level, upright};
use super::smooth;
use crate::numbers::{decades, range, short, tick, ticks};
use crate::plot::{Curve, Look, NEUTRAL, Plot};

/// Size of a plot in its own units.
const SIZE: (f64, f64) = (640.0, 290.0);
const SMALL: (f64, f64) = (430.0, 230.0);
const LEFT: f64 = 70.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = 44.0;
const RIGHT: f64 = 18.0;
/// Legend: height of a line, width of a letter, most letters.
const LINE: f64 = 17.0;
const LETTER: f64 = 6.7;
const LETTERS: usize = 18;
/// Colours in `figure.css`.
const COLORS: usize = 12;

/// The mapping of values to the picture.
struct Frame {
    x: (f64, f64),
    y: (f64, f64),
    right: f64,
    bottom: f64,
    logarithmic: bool,
}

impl Frame {
    fn x(&self, x: f64) -> f64 {
        LEFT + (self.right - LEFT) * (x - self.x.0) / (self.x.1 - self.x.0)
    }

    fn y(&self, y: f64) -> f64 {
        let place = |y: f64| if self.logarithmic { y.log10() } else { y };
        let (low, high) = (place(self.y.0), place(self.y.1));
        self.bottom - (self.bottom - TOP) * (place(y) - low) / (high - low)
    }
}

fn class_of(look: Look) -> &'static str {
    match look {
        Look::Line | Look::Smooth | Look::Dotted => "curve",
        Look::Kept => "curve kept",
        Look::Compared => "curve compared",
    }
}

/// A plot as it is drawn: its curves and the limits near them.
struct Drawing<'a> {
    plot: &'a Plot,
    levels: Vec<Level>,
    size: (f64, f64),
}

/// The plot as one `<svg>` element.
pub fn svg(plot: &Plot) -> String {
    let size = if plot.is_small { SMALL } else { SIZE };
    Drawing { plot, levels: levels(plot), size }.svg()
}

impl Drawing<'_> {
    /// The limits, then the curves before which they lie.
    fn curves(&self) -> impl Iterator<Item = &Curve> {
        self.levels.iter().map(|level| &level.curve).chain(&self.plot.curves)
    }

    fn shown(&self, y: f64) -> bool {
        y.is_finite() && (!self.plot.logarithmic || y > 0.0)
    }

    fn frame(&self, right: f64, bottom: f64) -> Frame {
        let points = || self.curves().flat_map(|curve| &curve.points).filter(|point| self.shown(point.1));
        let x = range(points().map(|point| point.0)).unwrap_or((0.0, 1.0));
        let (low, high) = range(points().map(|point| point.1)).unwrap_or((0.1, 1.0));
        let y = if self.plot.logarithmic {
            (low.abs() / 1.3, high * 1.3)
        } else {
            let margin = 0.06 * (high - low);
            (low - margin, high + margin)
        };
        Frame { x, y, right, bottom, logarithmic: self.plot.logarithmic }
    }

    fn svg(&self) -> String {
        let named = &self.plot.curves;
        let legend = named.len() > 1;
        let letters = named.iter().map(|curve| cut(&curve.name, LETTERS).chars().count()).max().unwrap_or(0);
        let room = if legend { 40.0 + LETTER * letters as f64 } else { 0.0 };
        let (width, height) = self.size;
        let right = width - RIGHT - room;
        let height = if legend { height.max(TOP + BOTTOM + LINE * named.len() as f64) } else { height };
        let frame = self.frame(right, height - BOTTOM);
        let title = escaped(&cut(&self.plot.title, 44));
        let mut svg = format!(
            "<svg class=\"plot\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{title}\">\
             <text class=\"title\" x=\"{LEFT}\" y=\"20\">{title}</text>"
        );
        self.axes(&frame, &mut svg);
        self.levels.iter().for_each(|level| svg.push_str(&self.path(&level.curve, &frame, &dashes(level))));
        self.plot.curves.iter().for_each(|curve| svg.push_str(&self.path(curve, &frame, "")));
        for (k, curve) in named.iter().enumerate().filter(|_| legend) {
            svg.push_str(&entry(curve, right + 14.0, TOP + 10.0 + LINE * k as f64));
        }
        svg + "</svg>"
    }

    /// Grid, ticks, labels and marks.
    fn axes(&self, frame: &Frame, svg: &mut String) {
        let Frame { right, bottom, .. } = *frame;
        for x in ticks(frame.x.0, frame.x.1, (self.size.0 / 100.0) as usize) {
            svg.push_str(&upright(frame.x(x), (TOP, bottom), &short(x, 6)));
        }
        let rows = if self.plot.logarithmic {
            decades(frame.y.0, frame.y.1)
        } else {
            ticks(frame.y.0, frame.y.1, 6)
        };
        for y in rows {
            let class = if y == 0.0 && !self.plot.logarithmic { "grid zero" } else { "grid" };
            let number = if self.plot.logarithmic { tick(y) } else { short(y, 6) };
            svg.push_str(&level(frame.y(y), (LEFT, right), &number, class));
        }
        for &mark in self.plot.marks.iter().filter(|&&mark| mark >= frame.x.0 && mark <= frame.x.1) {
            svg.push_str(&format!("<path class=\"mark\" d=\"M{:.1} {TOP}V{bottom}\"/>", frame.x(mark)));
        }
        svg.push_str(&axis_names((LEFT, right), (TOP, bottom), [self.plot.x_label, &self.plot.y_label()]));
    }

    /// A curve, with further attributes of its line.
    fn path(&self, curve: &Curve, frame: &Frame, line: &str) -> String {
        let shown = |&(x, y): &(f64, f64)| (x.is_finite() && self.shown(y)).then(|| (frame.x(x), frame.y(y)));
        let points: Vec<_> = curve.points.iter().map(shown).collect();
        let pieces =
            points.split(Option::is_none).map(|piece| piece.iter().flatten().copied().collect::<Vec<_>>());
        let outline = if curve.look == Look::Smooth { smooth::through } else { smooth::straight };
        let d: String = pieces.map(|piece| outline(&piece)).collect();
        let dots: String = match curve.look {
            Look::Dotted => points.iter().flatten().map(|(x, y)| dot(curve.color, *x, *y)).collect(),
            _ => String::new(),
        };
        let name = escaped(&curve.name);
        let class = class_of(curve.look);
        let color = color(curve.color);
        format!("<path class=\"{class} {color}\"{line} d=\"{d}\"><title>{name}</title></path>{dots}")
    }
}

/// The dashes of one of several limits that lie on one another; those of a single one are in `figure.css`.
fn dashes(level: &Level) -> String {
    let (dash, gap) = if level.curve.look == Look::Kept { (6.0, 4.0) } else { (1.5, 4.0) };
    let (step, of) = (dash + gap, level.of as f64);
    match level.of {
        1 => String::new(),
        _ => format!(
            " style=\"stroke-dasharray:{dash} {};stroke-dashoffset:{}\"",
            step * of - dash,
            step * (of - level.turn as f64)
        ),
    }
}

/// A line of the legend.
fn entry(curve: &Curve, x: f64, y: f64) -> String {
    let (full, name) = (escaped(&curve.name), escaped(&cut(&curve.name, LETTERS)));
    let (color, line, text) = (color(curve.color), y - 4.0, x + 24.0);
    format!(
        "<path class=\"curve {color}\" d=\"M{x:.1} {line:.1}h18\"/>\
         <text x=\"{text:.1}\" y=\"{y:.1}\">{name}<title>{full}</title></text>"
    )
}

fn dot(number: usize, x: f64, y: f64) -> String {
    format!("<circle class=\"dot {}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.4\"/>", color(number))
}

/// The class of a colour.
fn color(number: usize) -> String {
    if number == NEUTRAL { "neutral".into() } else { format!("c{}", number % COLORS) }
}
