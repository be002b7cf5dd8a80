//! Time against the number of joints, both axes logarithmic, one line a method, each labelled at its end.
//!
//! Colour and mark tell the lines apart; those of several states at once are dashed.

use crate::page::{BASELINE, INSTRUCTIONS, ROOT, Row, duration, processor, routes};
use costate_routes::cases::Case;
use costate_routes::routes::Failure;
use costate_routes::{FIRST, SECOND, states};
use plotters::coord::Shift;
use plotters::prelude::*;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Width, height, and the room at the right where the labels stand.
const SIZE: (u32, u32) = (1100, 720);
const LABELS: i32 = 370;
/// Room above the axes, where the title stands.
const TITLE: i32 = 60;
/// Height of a label with the room around it.
const LINE: i32 = 21;

/// Both plots; they show the tables of the section that everybody can reproduce, so only a baseline build
/// draws them.
pub fn draw(cases: &[Case], rows: &[Row]) -> Result<(), Failure> {
    if !BASELINE {
        return Ok(());
    }
    draw_quantity("F and F_x of general chains", FIRST, "scaling_f_x", cases, rows)?;
    draw_quantity("y'F_xx (with F and F_x where they come on the way)", SECOND, "scaling_y_f_xx", cases, rows)
}

/// A method and its points (n, ns).
type Line = (&'static str, Vec<(f64, f64)>);

fn lines(quantity: &str, cases: &[Case], rows: &[Row]) -> Vec<Line> {
    let points = |route: &str| -> Vec<(f64, f64)> {
        let of = |case: &Case| {
            rows.iter().find(|r| (r.quantity, r.route, &r.case) == (quantity, route, &case.title))
        };
        let chains = cases.iter().filter(|case| case.chain);
        chains.filter_map(|case| Some((case.robot.dof() as f64, of(case)?.time?.median))).collect()
    };
    let all = routes(rows, quantity).into_iter().map(|route| (route, points(route)));
    all.filter(|(_, points)| !points.is_empty()).collect()
}

fn draw_quantity(
    title: &str,
    quantity: &str,
    file: &str,
    cases: &[Case],
    rows: &[Row],
) -> Result<(), Failure> {
    let lines = lines(quantity, cases, rows);
    if lines.is_empty() {
        return Ok(());
    }
    let times = || lines.iter().flat_map(|line| &line.1).map(|point| point.1);
    let bottom = 10_f64.powf(times().fold(f64::MAX, f64::min).log10().floor());
    let top = 10_f64.powf(times().fold(0.0, f64::max).log10().ceil());
    let path = format!("{ROOT}/docs/{file}.svg");
    let area = SVGBackend::new(&path, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let style = TextStyle::from(("sans-serif", 22).into_font());
    area.draw(&Text::new(format!("Time of one state: {title}"), (100, TITLE / 2 - 11), style))?;
    let mut chart = ChartBuilder::on(&area)
        .margin(16)
        .margin_top(TITLE)
        .margin_right(LABELS)
        .x_label_area_size(76)
        .y_label_area_size(84)
        .build_cartesian_2d((1.8..53.0).log_scale(), (bottom..top).log_scale())?;
    chart
        .configure_mesh()
        .disable_x_axis()
        .disable_x_mesh()
        .y_desc("time of one state")
        .y_labels(12)
        .y_label_formatter(&|ns| duration(*ns).replace(".00", "").replace(".0", ""))
        .label_style(("sans-serif", 17))
        .axis_desc_style(("sans-serif", 18))
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .draw()?;
    for n in cases.iter().filter(|case| case.chain).map(|case| case.robot.dof()) {
        let [at, above] = [bottom, top].map(|ns| chart.backend_coord(&(n as f64, ns)));
        let style = TextStyle::from(("sans-serif", 17).into_font());
        area.draw(&PathElement::new([at, above], BLACK.mix(0.12)))?;
        area.draw(&PathElement::new([at, (at.0, at.1 + 5)], BLACK))?;
        area.draw(&Text::new(n.to_string(), (at.0 - 5 * n.to_string().len() as i32, at.1 + 10), style))?;
    }
    let below = chart.backend_coord(&(2.0, bottom));
    caption(&area, (below.0, below.1 + 34))?;
    let mut ends = Vec::new();
    for (k, (route, points)) in lines.iter().enumerate() {
        let color = color(k);
        let (points, style) = (points.iter().copied(), color.stroke_width(2));
        if states(route) > 1 {
            chart.draw_series(DashedLineSeries::new(points.clone(), 7, 4, style))?;
        } else {
            chart.draw_series(LineSeries::new(points.clone(), style))?;
        }
        let ends_at = points.clone().last();
        // A disc, a triangle or a cross at each point.
        match k % 3 {
            0 => drop(chart.draw_series(points.map(|at| Circle::new(at, 4, color.filled())))?),
            1 => drop(chart.draw_series(points.map(|at| TriangleMarker::new(at, 6, color.filled())))?),
            _ => drop(chart.draw_series(points.map(|at| Cross::new(at, 4, color.stroke_width(2))))?),
        }
        if let Some(last) = ends_at {
            ends.push((chart.backend_coord(&last), *route, color));
        }
    }
    label(&area, ends)?;
    area.present()?;
    Ok(())
}

fn caption(area: &Area<'_>, at: (i32, i32)) -> Result<(), Failure> {
    let style = TextStyle::from(("sans-serif", 17).into_font());
    area.draw(&Text::new("joints n of serial chains with general axes", at, style))?;
    let grey = BLACK.mix(0.6);
    let style = TextStyle::from(("sans-serif", 13).into_font()).color(&grey);
    let made = format!("{}, one core, {INSTRUCTIONS}; medians: docs/scaling.md", processor());
    area.draw(&Text::new(made, (at.0, at.1 + 24), style))?;
    Ok(())
}

/// Labels in the order of the ends of the lines, far enough apart to be read, each joined to its end.
fn label(area: &Area<'_>, mut ends: Vec<((i32, i32), &'static str, RGBColor)>) -> Result<(), Failure> {
    ends.sort_by_key(|end| (end.0.1, -end.0.0));
    let mut heights: Vec<i32> = ends.iter().map(|end| end.0.1).collect();
    let lowest = SIZE.1 as i32 - 40;
    // Pushed down where two are too close, then up from the lower edge.
    for k in 1..heights.len() {
        heights[k] = heights[k].max(heights[k - 1] + LINE);
    }
    let mut limit = lowest;
    for height in heights.iter_mut().rev() {
        *height = (*height).min(limit);
        limit = *height - LINE;
    }
    let left = SIZE.0 as i32 - LABELS + 30;
    for ((end, route, color), height) in ends.into_iter().zip(heights) {
        let joint = [(end.0 + 5, end.1), (left - 26, end.1), (left - 5, height)];
        let bend = if end.0 + 5 < left - 30 { &joint[..] } else { &joint[1..] };
        area.draw(&PathElement::new(bend.to_vec(), color.mix(0.5)))?;
        let style = TextStyle::from(("sans-serif", 15).into_font()).color(&color);
        area.draw(&Text::new(route, (left, height - 9), style))?;
    }
    Ok(())
}

/// Colours that stay apart for most eyes, dark enough for text on white.
fn color(k: usize) -> RGBColor {
    const COLORS: [(u8, u8, u8); 14] = [
        (0, 90, 160),
        (200, 80, 0),
        (0, 130, 95),
        (110, 40, 140),
        (170, 20, 60),
        (110, 95, 0),
        (0, 120, 150),
        (90, 90, 90),
        (190, 60, 130),
        (60, 110, 20),
        (120, 70, 40),
        (50, 50, 180),
        (20, 20, 20),
        (140, 110, 190),
    ];
    let (r, g, b) = COLORS[k % COLORS.len()];
    RGBColor(r, g, b)
}
