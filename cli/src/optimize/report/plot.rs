//! Plots of curves as SVG.

use super::numbers::{decades, range, scientific, short, ticks};
use super::smooth;
use super::svg::{axis_names, cut, escaped, level, upright};

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
/// The colour of what belongs to several joints.
pub const NEUTRAL: usize = usize::MAX;

/// A curve; its colour is that of the joint.
pub struct Curve {
    pub name: String,
    pub color: usize,
    pub points: Vec<(f64, f64)>,
    pub look: Look,
}

#[derive(Clone, Copy, PartialEq)]
pub enum Look {
    /// Straight from point to point.
    Line,
    /// A smooth curve through the points.
    Smooth,
    /// A line with its points.
    Dotted,
    /// A limit that the motion must keep; not in the legend.
    Kept,
    /// A limit of the robot that the motion is only compared with; not in the legend.
    Compared,
}

impl Look {
    fn class(self) -> &'static str {
        match self {
            Self::Line | Self::Smooth | Self::Dotted => "curve",
            Self::Kept => "curve kept",
            Self::Compared => "curve compared",
        }
    }
}

/// Curves in one pair of axes.
pub struct Plot {
    pub title: String,
    pub x_label: &'static str,
    pub y_label: String,
    pub curves: Vec<Curve>,
    /// Whether the y axis is logarithmic.
    pub logarithmic: bool,
    /// Whether x is time; the page then adds a cursor.
    pub over_time: bool,
    /// Marked values on the x axis.
    pub marks: Vec<f64>,
    size: (f64, f64),
}

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

impl Plot {
    /// A plot over the time of the motion.
    pub fn over_time(title: impl Into<String>, y_label: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            x_label: "t (s)",
            y_label: y_label.into(),
            curves: Vec::new(),
            logarithmic: false,
            over_time: true,
            marks: Vec::new(),
            size: SIZE,
        }
    }

    /// A smaller plot, to be shown in a grid.
    pub fn small(self) -> Self {
        Self { size: SMALL, ..self }
    }

    fn shown(&self, y: f64) -> bool {
        y.is_finite() && (!self.logarithmic || y > 0.0)
    }

    fn frame(&self, right: f64, bottom: f64) -> Frame {
        let points =
            || self.curves.iter().flat_map(|curve| &curve.points).filter(|point| self.shown(point.1));
        let x = range(points().map(|point| point.0)).unwrap_or((0.0, 1.0));
        let (low, high) = range(points().map(|point| point.1)).unwrap_or((0.1, 1.0));
        let y = if self.logarithmic {
            (low.abs() / 1.3, high * 1.3)
        } else {
            let margin = 0.06 * (high - low);
            (low - margin, high + margin)
        };
        Frame { x, y, right, bottom, logarithmic: self.logarithmic }
    }

    /// The plot as one `<svg>` element.
    pub fn svg(&self) -> String {
        let named: Vec<&Curve> =
            self.curves.iter().filter(|c| !matches!(c.look, Look::Kept | Look::Compared)).collect();
        let legend = named.len() > 1;
        let letters = named.iter().map(|curve| cut(&curve.name, LETTERS).chars().count()).max().unwrap_or(0);
        let room = if legend { 40.0 + LETTER * letters as f64 } else { 0.0 };
        let (width, height) = self.size;
        let right = width - RIGHT - room;
        let height = if legend { height.max(TOP + BOTTOM + LINE * named.len() as f64) } else { height };
        let frame = self.frame(right, height - BOTTOM);
        let cursor = if self.over_time {
            let Frame { x: (from, to), bottom, .. } = frame;
            format!(" data-time=\"{from} {to} {LEFT} {right} {TOP} {bottom}\"")
        } else {
            String::new()
        };
        let title = escaped(&self.title);
        let mut svg = format!(
            "<svg class=\"plot\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{title}\"{cursor}>\
             <text class=\"title\" x=\"{LEFT}\" y=\"20\">{title}</text>"
        );
        self.axes(&frame, &mut svg);
        self.curves.iter().for_each(|curve| svg.push_str(&self.path(curve, &frame)));
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
        let rows =
            if self.logarithmic { decades(frame.y.0, frame.y.1) } else { ticks(frame.y.0, frame.y.1, 6) };
        for y in rows {
            let class = if y == 0.0 && !self.logarithmic { "grid zero" } else { "grid" };
            let number = if self.logarithmic { scientific(y) } else { short(y, 6) };
            svg.push_str(&level(frame.y(y), (LEFT, right), &number, class));
        }
        for &mark in self.marks.iter().filter(|&&mark| mark >= frame.x.0 && mark <= frame.x.1) {
            svg.push_str(&format!("<path class=\"mark\" d=\"M{:.1} {TOP}V{bottom}\"/>", frame.x(mark)));
        }
        svg.push_str(&axis_names((LEFT, right), (TOP, bottom), [self.x_label, &self.y_label]));
    }

    fn path(&self, curve: &Curve, frame: &Frame) -> String {
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
        let class = curve.look.class();
        format!("<path class=\"{class} {}\" d=\"{d}\"><title>{name}</title></path>{dots}", color(curve.color))
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
