//! Cost of transport of RABBIT against its speed, and the best speed: writes `docs/walking.svg` and the table
//! in `docs/walking.md`.
//!
//! `cargo run --release -p costate-examples --example walking`

mod page;

use costate::robot::LoadOptions;
use costate_control::{FinalTime, Objective, Problem, ProblemFile, Solver, SolverOptions};
use page::{COLORS, ROOT, legend, write_table};
use plotters::prelude::*;
use std::error::Error;
use std::fmt::Write;

/// Lengths of steps (m) and speeds (m/s).
const LENGTHS: [f64; 3] = [0.4, 0.5, 0.6];
const SPEEDS: [f64; 7] = [0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];
/// What is taken beside the work of the motors: power at rest (W), and heat of `HEAT / 2` times the squared
/// torques, W/(N m)^2. Both are assumed.
const AT_REST: f64 = 40.0;
const HEAT: f64 = 0.1;
/// Smoothing of the power of a motor (W).
const SMOOTHING: f64 = 0.1;

/// What is told of a step: speed (m/s), cost of transport by all energy, and the mechanical one.
type Told = [f64; 3];

/// Steps of this length that take the least energy.
fn least_energy(file: &ProblemFile, length: f64, time: FinalTime) -> Result<Problem, Box<dyn Error>> {
    let mut problem = file.problem.clone().with_time(time);
    let joints = problem.robot.dof();
    let gait = problem.gait.as_mut().ok_or("the problem has no gait")?;
    gait.length = length;
    let motors = |weight: f64| (0..joints).map(|joint| if joint < 3 { 0.0 } else { weight }).collect();
    let cost = Objective::new(AT_REST, motors(HEAT)).with_energy(motors(1.0));
    Ok(problem.with_cost(cost.with_energy_smoothing(SMOOTHING)))
}

/// Of the motion that solves a problem, if there is one.
fn solved(problem: &Problem) -> Result<Option<Told>, Box<dyn Error>> {
    let solution = Solver::new(problem, SolverOptions::default().with_tolerance(1e-4))?.solve();
    eprintln!("{}: {:.9}, {:?}", solution.motion.status, solution.total(), solution.gait);
    let Some(gait) = solution.gait.as_ref().filter(|_| solution.motion.status.is_converged()) else {
        return Ok(None);
    };
    Ok(Some([gait.speed, solution.total() / gait.weight_times_length, gait.cost_of_transport]))
}

/// Steps of one length: at each speed, and at the best one.
struct Curve {
    length: f64,
    points: Vec<Option<Told>>,
    best: Option<Told>,
}

fn curve(file: &ProblemFile, length: f64) -> Result<Curve, Box<dyn Error>> {
    let at = |speed: f64| solved(&least_energy(file, length, FinalTime::Fixed(length / speed))?);
    let points = SPEEDS.into_iter().map(at).collect::<Result<Vec<_>, _>>()?;
    // The search for the best speed begins at one that is none of the best.
    let free = least_energy(file, length, FinalTime::Free { guess: length / 0.7 })?;
    Ok(Curve { length, points, best: solved(&free)? })
}

/// A row for each speed, and one for the best of each length.
fn table(curves: &[Curve]) -> Result<String, std::fmt::Error> {
    let mut text = String::from("| speed (m/s) |");
    for curve in curves {
        write!(text, " steps of {} m |", curve.length)?;
    }
    writeln!(text, "\n|---|{}", "--:|".repeat(curves.len()))?;
    let both = |[_, all, mechanical]: Told| format!("{all:.4} ({mechanical:.4})");
    for (row, speed) in SPEEDS.iter().enumerate() {
        let cells = curves.iter().map(|curve| curve.points[row].map_or("-".into(), both));
        writeln!(text, "| {speed:.1} | {} |", cells.collect::<Vec<String>>().join(" | "))?;
    }
    let best = |best: Told| format!("{} at {:.3} m/s", both(best), best[0]);
    let cells = curves.iter().map(|curve| curve.best.map_or("-".into(), best));
    writeln!(text, "| free | {} |", cells.collect::<Vec<String>>().join(" | "))?;
    Ok(text)
}

fn draw(curves: &[Curve]) -> Result<(), Box<dyn Error>> {
    let path = format!("{ROOT}/docs/walking.svg");
    let area = SVGBackend::new(&path, (960, 540)).into_drawing_area();
    area.fill(&WHITE)?;
    let place = |&[speed, all, _]: &Told| (speed, all);
    let points = curves.iter().flat_map(|curve| curve.points.iter().flatten());
    let top = points.fold(0.0, |most: f64, point| most.max(point[1]));
    let ends = [SPEEDS[0] - 0.02, SPEEDS[SPEEDS.len() - 1] + 0.02];
    let mut chart = ChartBuilder::on(&area)
        .caption("RABBIT: steps that take the least energy", ("sans-serif", 24))
        .margin(16)
        .x_label_area_size(56)
        .y_label_area_size(84)
        .build_cartesian_2d(ends[0]..ends[1], 0.0..top * 1.05)?;
    chart
        .configure_mesh()
        .x_desc("speed (m/s)")
        .y_desc("energy over weight and distance")
        .x_label_formatter(&|speed| format!("{speed:.1}"))
        .y_label_formatter(&|cost| format!("{cost:.1}"))
        .label_style(("sans-serif", 18))
        .axis_desc_style(("sans-serif", 20))
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .draw()?;
    for (curve, color) in curves.iter().zip(COLORS) {
        let style = ShapeStyle::from(color).stroke_width(2);
        chart
            .draw_series(LineSeries::new(curve.points.iter().flatten().map(place), style))?
            .label(format!("steps of {} m", curve.length))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], style));
        chart.draw_series(curve.best.iter().map(|best| Circle::new(place(best), 6, color.filled())))?;
    }
    legend(&mut chart, SeriesLabelPosition::UpperLeft)?;
    area.present()?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = format!("{ROOT}/examples/problems/rabbit_walk.toml");
    let file = ProblemFile::read(path, LoadOptions::default())?;
    let curves = LENGTHS.into_iter().map(|length| curve(&file, length)).collect::<Result<Vec<_>, _>>()?;
    draw(&curves)?;
    write_table("walking.md", &table(&curves)?)
}
