//! Energy of a robot that swings freely, over 100 000 steps of every scheme: writes `docs/energy.svg` and the
//! table in `docs/energy.md`.
//!
//! `cargo run --release -p costate-examples --example energy`

mod page;

use costate::EvalError;
use costate::dynamics::{Contraction, Dynamics, Linearisation, Structure};
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::robot::Robot;
use costate::step::{ImplicitMidpoint, RungeKutta4, SemiImplicitEuler, Step, StoermerVerlet, VelocityForm};
use page::{COLORS, ROOT, legend, write_table};
use plotters::prelude::*;
use std::error::Error;
use std::fmt::Write;

/// Duration of a step (s) and number of steps.
const H: f64 = 0.02;
const STEPS: usize = 100_000;
/// Where the arm starts (rad, rad/s).
const Q: [f64; 2] = [0.0, 1.2];
const V: [f64; 2] = [2.0, -3.0];
/// Points of a curve for each power of ten of the time.
const BINS: f64 = 40.0;

/// A model that counts what is asked of it.
struct Counted<D> {
    model: D,
    values: usize,
    linearisations: usize,
}

impl<D> Counted<D> {
    fn new(model: D) -> Self {
        Self { model, values: 0, linearisations: 0 }
    }

    fn counts(&self) -> [usize; 2] {
        [self.values, self.linearisations]
    }
}

impl<D: Dynamics<f64>> Dynamics<f64> for Counted<D> {
    type Error = D::Error;

    fn states(&self) -> usize {
        self.model.states()
    }

    fn controls(&self) -> usize {
        self.model.controls()
    }

    fn structure(&self) -> Structure {
        self.model.structure()
    }

    fn evaluate(&mut self, x: &[f64], u: &[f64]) -> Result<&[f64], D::Error> {
        self.values += 1;
        self.model.evaluate(x, u)
    }

    fn linearise(&mut self, x: &[f64], u: &[f64]) -> Result<Linearisation<'_, f64>, D::Error> {
        self.linearisations += 1;
        self.model.linearise(x, u)
    }

    fn contract(&mut self, x: &[f64], u: &[f64], y: &[f64]) -> Result<Contraction<'_, f64>, D::Error> {
        self.model.contract(x, u, y)
    }
}

impl<D: VelocityForm<f64>> VelocityForm<f64> for Counted<D> {}

/// What became of the energy under one scheme.
struct Run {
    name: &'static str,
    coordinates: &'static str,
    order: usize,
    /// Time (s) and the largest `|H - H0| / H0` up to then.
    envelope: Vec<(f64, f64)>,
    /// Largest `|H - H0| / H0` of the first and of the last tenth of the time, and of all of it.
    largest: [f64; 3],
    /// Mean of `(H - H0) / H0` over the last tenth.
    end: f64,
    /// Evaluations of f a step, and those of f with its Jacobians.
    counts: [f64; 2],
    most_iterations: usize,
}

/// All steps from `x`, with the energy after each and the iterations that it took.
fn run<S: Step<f64>>(
    (name, coordinates, order): (&'static str, &'static str, usize),
    mut step: S,
    mut x: Vec<f64>,
    mut energy: impl FnMut(&[f64]) -> Result<f64, EvalError>,
    iterations: impl Fn(&S) -> usize,
    counts: impl Fn(&S) -> [usize; 2],
) -> Result<Run, Box<dyn Error>> {
    let start = energy(&x)?;
    let (mut envelope, mut bin) = (Vec::new(), None);
    let (mut largest, mut end, mut most_iterations) = ([0.0_f64; 3], 0.0, 0);
    for i in 1..=STEPS {
        let next = step.evaluate(&x, &[0.0; 2], H)?;
        x.copy_from_slice(next);
        most_iterations = most_iterations.max(iterations(&step));
        let error = (energy(&x)? - start) / start;
        largest[2] = largest[2].max(error.abs());
        if i <= STEPS / 10 {
            largest[0] = largest[0].max(error.abs());
        } else if i > STEPS - STEPS / 10 {
            largest[1] = largest[1].max(error.abs());
            end += error / (STEPS / 10) as f64;
        }
        let number = Some(((i as f64).log10() * BINS) as usize);
        if number != bin || i == STEPS {
            envelope.push((i as f64 * H, largest[2]));
            bin = number;
        }
    }
    let counts = counts(&step).map(|count| count as f64 / STEPS as f64);
    Ok(Run { name, coordinates, order, envelope, largest, end, counts, most_iterations })
}

fn all(robot: &Robot) -> Result<[Run; 4], Box<dyn Error>> {
    let momenta = || Counted::new(HamiltonianSecondOrder::<f64>::new(robot));
    let velocities = Counted::new(LagrangianSecondOrder::<f64>::new(robot));
    let mut hamiltonian = Hamiltonian::<f64>::new(robot);
    let mut lagrangian = Lagrangian::<f64>::new(robot);
    let x = [&Q, hamiltonian.momentum(&Q, &V)?].concat();
    let mut h = |x: &[f64]| hamiltonian.hamiltonian(&x[..2], &x[2..]);
    let e = |x: &[f64]| lagrangian.energy(&x[..2], &x[2..]).map(|energy| energy.kinetic + energy.potential);
    Ok([
        run(
            ("semi-implicit Euler", "(q, v)", 1),
            SemiImplicitEuler::new(velocities),
            [Q, V].concat(),
            e,
            |_| 0,
            |step| step.model().counts(),
        )?,
        run(
            ("Runge-Kutta 4", "(q, p)", 4),
            RungeKutta4::new(momenta()),
            x.clone(),
            &mut h,
            RungeKutta4::iterations,
            |step| step.model().counts(),
        )?,
        run(
            ("Störmer-Verlet", "(q, p)", 2),
            StoermerVerlet::new(momenta()),
            x.clone(),
            &mut h,
            StoermerVerlet::iterations,
            |step| step.model().counts(),
        )?,
        run(
            ("implicit midpoint", "(q, p)", 2),
            ImplicitMidpoint::new(momenta()),
            x,
            h,
            ImplicitMidpoint::iterations,
            |step| step.model().counts(),
        )?,
    ])
}

/// One row a scheme.
fn table(runs: &[Run]) -> Result<String, std::fmt::Error> {
    let mut text = String::from(
        "| scheme | x | order | f a step | f and f_x a step | most Newton iterations a step | error, first tenth \
         | last tenth | mean at the end |\n|---|---|---|---|---|---|---|---|---|\n",
    );
    for run in runs {
        let ([first, last, _], [values, linearisations]) = (run.largest, run.counts);
        writeln!(
            text,
            "| {} | {} | {} | {values:.2} | {linearisations:.2} | {} | {first:.1e} | {last:.1e} | {:+.1e} |",
            run.name, run.coordinates, run.order, run.most_iterations, run.end
        )?;
    }
    Ok(text)
}

/// `10^-3` as it is written.
fn power_of_ten(value: f64) -> String {
    let digits = ["⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"];
    let exponent = value.log10().round() as i32;
    let sign = if exponent < 0 { "⁻" } else { "" };
    let raised: String =
        exponent.abs().to_string().bytes().map(|digit| digits[usize::from(digit - b'0')]).collect();
    format!("10{sign}{raised}")
}

fn draw(runs: &[Run]) -> Result<(), Box<dyn Error>> {
    let path = format!("{ROOT}/docs/energy.svg");
    let area = SVGBackend::new(&path, (960, 600)).into_drawing_area();
    area.fill(&WHITE)?;
    let errors = || runs.iter().flat_map(|run| &run.envelope).map(|point| point.1);
    let bottom = 10_f64.powf(errors().fold(1.0, f64::min).log10().floor());
    let top = 10_f64.powf(errors().fold(0.0, f64::max).log10().ceil());
    let mut chart = ChartBuilder::on(&area)
        .caption("Energy error of the two-link arm swinging freely", ("sans-serif", 24))
        .margin(16)
        .x_label_area_size(56)
        .y_label_area_size(84)
        .build_cartesian_2d((H..STEPS as f64 * H).log_scale(), (bottom..top).log_scale())?;
    chart
        .configure_mesh()
        .x_desc(format!("time t (s): {STEPS} steps of h = {H} s"))
        .y_desc("largest |H − H₀| / H₀ up to time t")
        .x_labels(8)
        .y_labels(12)
        .x_label_formatter(&|t| power_of_ten(*t))
        .y_label_formatter(&|error| power_of_ten(*error))
        .label_style(("sans-serif", 18))
        .axis_desc_style(("sans-serif", 20))
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .draw()?;
    for (run, color) in runs.iter().zip(COLORS) {
        let style = ShapeStyle::from(color).stroke_width(2);
        chart
            .draw_series(LineSeries::new(run.envelope.iter().copied(), style))?
            .label(format!("{}, {}", run.name, run.coordinates))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], style));
    }
    legend(&mut chart, SeriesLabelPosition::LowerRight)?;
    area.present()?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let robot = Robot::from_file(format!("{ROOT}/robots/two_link.toml"))?;
    let runs = all(&robot)?;
    draw(&runs)?;
    write_table("energy.md", &table(&runs)?)
}
