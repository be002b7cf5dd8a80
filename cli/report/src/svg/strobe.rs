//! The motion as a strobe picture.

use super::markup::{axis_names, cut, escaped, level, upright};
use super::skeleton::{Part, Point, Skeleton, moved};
use super::views::{View, dot};
use crate::entries::is_last;
use crate::numbers::{short, ticks};
use crate::shape::moves_freely;
use costate::robot::{JointKind, Robot};

/// Width of a drawing, its smallest and largest height, and the margins for axes.
const WIDTH: f64 = 460.0;
const HEIGHTS: (f64, f64) = (200.0, 400.0);
const LEFT: f64 = 58.0;
const TOP: f64 = 30.0;
const RIGHT: f64 = 16.0;
const BOTTOM: f64 = 46.0;
/// Smallest distance between ticks.
const TICK: f64 = 55.0;
/// Number of poses between start and end.
const BETWEEN: usize = 10;

/// The mapping of a view to a picture.
pub struct Stage<'a> {
    view: &'a View,
    /// Picture units per metre.
    scale: f64,
    /// The point of the view at the lower left corner of the axes (m).
    low: [f64; 2],
    high: [f64; 2],
    height: f64,
}

impl<'a> Stage<'a> {
    /// A stage that holds all points, with a margin.
    pub fn new(view: &'a View, film: &[Vec<Point>]) -> Self {
        let (mut low, mut high) = ([f64::MAX; 2], [f64::MIN; 2]);
        for point in film.iter().flatten() {
            for (k, axis) in [view.right, view.up].into_iter().enumerate() {
                low[k] = low[k].min(dot(axis, *point));
                high[k] = high[k].max(dot(axis, *point));
            }
        }
        let size = (high[0] - low[0]).max(high[1] - low[1]);
        if !(size.is_finite() && size > 0.0) {
            (low, high) = ([-0.5; 2], [0.5; 2]);
        }
        let margin = 0.07 * size.clamp(1e-9, f64::MAX);
        low = low.map(|x| x - margin);
        high = high.map(|x| x + margin);
        let room = [WIDTH - LEFT - RIGHT, HEIGHTS.1 - TOP - BOTTOM];
        let scale = (room[0] / (high[0] - low[0])).min(room[1] / (high[1] - low[1]));
        let height = (scale * (high[1] - low[1]) + TOP + BOTTOM).max(HEIGHTS.0);
        // Spare room is shared between both sides.
        for (k, room) in [room[0], height - TOP - BOTTOM].into_iter().enumerate() {
            let spare = 0.5 * (room / scale - (high[k] - low[k]));
            low[k] -= spare;
            high[k] += spare;
        }
        Self { view, scale, low, high, height }
    }

    fn place(&self, point: Point) -> [f64; 2] {
        let (x, y) = (dot(self.view.right, point), dot(self.view.up, point));
        [LEFT + self.scale * (x - self.low[0]), self.height - BOTTOM - self.scale * (y - self.low[1])]
    }

    /// `<svg …>` with title and axes, not closed.
    fn open(&self, class: &str, title: &str) -> String {
        let (right, bottom, height) = (WIDTH - RIGHT, self.height - BOTTOM, self.height);
        let title = escaped(title);
        let mut svg = format!(
            "<svg class=\"{class}\" viewBox=\"0 0 {WIDTH} {height:.1}\" role=\"img\" aria-label=\"{title}\">\
             <text class=\"title\" x=\"{LEFT}\" y=\"18\">{title}</text>"
        );
        let many = |k: usize| (self.scale * (self.high[k] - self.low[k]) / TICK) as usize;
        for x in ticks(self.low[0], self.high[0], many(0)) {
            svg.push_str(&upright(LEFT + self.scale * (x - self.low[0]), (TOP, bottom), &short(x, 4)));
        }
        for y in ticks(self.low[1], self.high[1], many(1)) {
            svg.push_str(&level(
                bottom - self.scale * (y - self.low[1]),
                (LEFT, right),
                &short(y, 4),
                "grid",
            ));
        }
        svg.push_str(&axis_names(
            (LEFT, right),
            (TOP, bottom),
            self.view.labels.each_ref().map(String::as_str),
        ));
        svg
    }

    /// Poses at equal time steps, darker with time.
    pub fn strobe(&self, robot: &Robot, skeleton: &Skeleton<'_>, film: &[Vec<Point>]) -> String {
        let mut svg = self.open("strobe", &format!("{}: {}", cut(robot.name(), 26), self.view.title));
        svg.push_str(&self.traces(skeleton, film));
        let last = film.len().saturating_sub(1);
        let poses = BETWEEN + 2;
        for k in (1..poses - 1).chain([0, poses - 1]) {
            let frame = (k * last) / (poses - 1);
            let (class, opacity) = match k {
                0 => ("first", 1.0),
                k if k == poses - 1 => ("last", 1.0),
                k => ("", 0.25 + 0.45 * k as f64 / poses as f64),
            };
            if let Some(points) = film.get(frame) {
                svg.push_str(&self.pose(robot, skeleton, points, class, opacity));
            }
        }
        let legend = WIDTH - RIGHT;
        svg.push_str(&format!(
            "<text x=\"{legend}\" y=\"18\" text-anchor=\"end\"><tspan style=\"fill:var(--c0)\">start</tspan> \
             \u{2192} <tspan style=\"fill:var(--c1)\">end</tspan></text>"
        ));
        svg + "</svg>"
    }

    fn pose(
        &self,
        robot: &Robot,
        skeleton: &Skeleton<'_>,
        points: &[Point],
        class: &str,
        opacity: f64,
    ) -> String {
        let mut svg = format!("<g class=\"pose\" opacity=\"{opacity:.2}\">");
        for &(from, to, part) in &skeleton.lines {
            let ([x, y], [x_to, y_to]) = (self.place(points[from]), self.place(points[to]));
            let class = if part == Part::Link { class } else { "" };
            svg.push_str(&format!(
                "<path class=\"{} {class}\" d=\"M{x:.1} {y:.1}L{x_to:.1} {y_to:.1}\"/>",
                part.name()
            ));
        }
        // A base that moves freely slides on nothing; of a floating or spherical joint its link is shown.
        let is_free = |i: usize| match &robot.joints()[i].free {
            Some(part) => !is_last(part),
            None => robot.joints()[i].kind == JointKind::Prismatic && moves_freely(robot, i),
        };
        for (i, joint) in robot.joints().iter().enumerate().filter(|(i, _)| !is_free(*i)) {
            let [x, y] = self.place(points[moved(i)]);
            svg.push_str(&match joint.kind {
                JointKind::Revolute => {
                    format!("<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.2\"/>")
                }
                JointKind::Prismatic => {
                    let (x, y) = (x - 5.0, y - 4.0);
                    format!("<rect class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"10\" height=\"8\"/>")
                }
            });
        }
        svg + "</g>"
    }

    /// The paths of the tips.
    fn traces(&self, skeleton: &Skeleton<'_>, film: &[Vec<Point>]) -> String {
        let trace = |&tip: &usize| {
            let points = film.iter().map(|points| self.place(points[tip]));
            let points: Vec<_> = points.map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
            format!("<path class=\"trace\" d=\"M{}\"/>", points.join("L"))
        };
        if film.is_empty() { String::new() } else { skeleton.tips.iter().map(trace).collect() }
    }
}
