//! Solutions in closed form.

use super::by_duals::{ByDuals, Functions, Number};
use super::collocation::{Collocated, Ocp};
use costate_nlp::{Layout, Scales, Settings, Solver, StagedProblem, Status};

/// Solves it, and returns cost, point and iterations.
pub fn solve<F: Functions>(problem: &mut ByDuals<F>, start: &[f64]) -> (f64, Vec<f64>, usize) {
    let mut solver = Solver::new(problem.layout(), Settings::default());
    let solution = solver.solve(problem, start).unwrap();
    assert_eq!(solution.status, Status::Solved, "{solution:?}");
    (solution.cost, solution.point.to_vec(), solution.iterations)
}

/// Bryson and Denham: a double integrator from (0, 1) to (0, -1) in one second with x <= l, least effort:
/// `4 / (9 l)` for l <= 1/6 (Bryson and Ho, "Applied optimal control", section 3.11).
pub struct BrysonDenham {
    pub height: f64,
    pub intervals: usize,
    /// Units of length and time.
    pub units: [f64; 2],
}

impl Ocp for BrysonDenham {
    const SIZES: [usize; 3] = [2, 1, 0];
    fn intervals(&self) -> usize {
        self.intervals
    }
    fn duration<D: Number>(&self, _: &[D]) -> D {
        D::from(self.units[1])
    }
    fn path<D: Number>(&self, x: &[D], u: &[D], _: &[D]) -> (Vec<D>, D, Vec<D>) {
        (vec![x[1], u[0]], u[0] * u[0] * 0.5, vec![x[0]])
    }
    fn path_bounds(&self) -> Vec<[f64; 2]> {
        vec![[f64::NEG_INFINITY, self.height * self.units[0]]]
    }
    fn ends<D: Number>(&self, x_0: &[D], x_n: &[D], _: &[D]) -> (D, Vec<D>) {
        let rate = self.units[0] / self.units[1];
        (D::from(0.0), vec![x_0[0], x_0[1] - rate, x_n[0], x_n[1] + rate])
    }
    fn end_equations(&self) -> usize {
        4
    }
    fn scales(&self, layout: &Layout) -> Option<Scales> {
        let [length, time] = self.units;
        let of_state = [length, length / time];
        let acceleration = length / time / time;
        let mut steps = Vec::new();
        for _ in 0..self.intervals() {
            steps.extend(of_state);
            (0..3).for_each(|_| steps.extend(of_state));
            steps.extend([acceleration; 3]);
        }
        steps.extend(of_state);
        let mut equalities = of_state.repeat(4 * self.intervals());
        equalities.extend([of_state, of_state].concat());
        let cost = acceleration * acceleration * time;
        Some(Scales { cost, steps, equalities, ranges: vec![length; layout.ranges()] })
    }
}

#[test]
fn a_limit_of_positions_costs_what_bryson_and_denham_say() {
    for height in [0.05, 0.1, 1.0 / 6.0] {
        let mut problem = ByDuals::new(Collocated(BrysonDenham { height, intervals: 60, units: [1.0, 1.0] }));
        let start = problem.functions.start(
            |s| vec![height * 4.0 * s * (1.0 - s), 1.0 - 2.0 * s],
            |_| vec![-2.0],
            &[],
        );
        let (cost, ..) = solve(&mut problem, &start);
        let expected = 4.0 / (9.0 * height);
        // Times of contact lie between nodes: h^2 at most.
        assert!((cost / expected - 1.0).abs() < 1e-3, "{cost} {expected}");
    }
}

#[test]
fn units_change_no_iteration() {
    let solved = |length: f64, time: f64| {
        let mut problem =
            ByDuals::new(Collocated(BrysonDenham { height: 0.1, intervals: 60, units: [length, time] }));
        let rate = length / time;
        let start = problem.functions.start(
            |s| vec![0.4 * length * s * (1.0 - s), rate * (1.0 - 2.0 * s)],
            |_| vec![-2.0 * rate / time],
            &[],
        );
        let (cost, point, iterations) = solve(&mut problem, &start);
        (cost * time.powi(3) / (length * length), point[11 * 10] / length, iterations)
    };
    // Powers of two round nothing.
    let (cost, position, iterations) = solved(1.0, 1.0);
    assert_eq!(solved(1024.0, 0.125), (cost, position, iterations));
    // Others round, no more.
    let (other, _, steps) = solved(1000.0, 1e-3);
    assert!((other / cost - 1.0).abs() < 1e-8 && steps.abs_diff(iterations) <= 1, "{other} {cost} {steps}");
}

/// A chain of this length between two points, least potential energy: a catenary.
struct Chain {
    length: f64,
    ends: [f64; 2],
}

impl Ocp for Chain {
    /// Height, energy, length; slope.
    const SIZES: [usize; 3] = [3, 1, 0];
    fn intervals(&self) -> usize {
        40
    }
    fn duration<D: Number>(&self, _: &[D]) -> D {
        D::from(1.0)
    }
    fn path<D: Number>(&self, x: &[D], u: &[D], _: &[D]) -> (Vec<D>, D, Vec<D>) {
        let along = (u[0] * u[0] + 1.0).sqrt();
        (vec![u[0], x[0] * along, along], D::from(0.0), Vec::new())
    }
    fn ends<D: Number>(&self, x_0: &[D], x_n: &[D], _: &[D]) -> (D, Vec<D>) {
        let [a, b] = self.ends;
        (x_n[1], vec![x_0[0] - a, x_0[1], x_0[2], x_n[0] - b, x_n[2] - self.length])
    }
    fn end_equations(&self) -> usize {
        5
    }
}

impl Chain {
    /// `y = c + k cosh((x - m) / k)`: the energy, from k by Newton's method on
    /// `sqrt(L^2 - (b - a)^2) = 2 k sinh(1 / (2 k))`.
    fn energy(&self) -> f64 {
        let [a, b] = self.ends;
        let target = (self.length * self.length - (b - a) * (b - a)).sqrt();
        // Convex and falling: from the left Newton's method stays there.
        let mut k = 0.1;
        for _ in 0..100 {
            let (x, f) = (0.5 / k, 2.0 * k * (0.5_f64 / k).sinh() - target);
            k -= f / (2.0 * x.sinh() - x.cosh() / k);
        }
        let m = 0.5 - k * ((b - a) / self.length).atanh();
        let c = a - k * (m / k).cosh();
        // int (c + k cosh) cosh dx
        let at = |x: f64| {
            let z = (x - m) / k;
            c * k * z.sinh() + 0.5 * k * (x - m) + 0.25 * k * k * (2.0 * z).sinh()
        };
        at(1.0) - at(0.0)
    }
}

#[test]
fn a_hanging_chain_is_a_catenary() {
    let chain = Chain { length: 4.0, ends: [1.0, 3.0] };
    let expected = chain.energy();
    // COPS 3.0 (Dolan, More, Munson 2004), problem 4: 5.06848 in the limit.
    assert!((expected - 5.06848).abs() < 1e-4, "{expected}");
    let mut problem = ByDuals::new(Collocated(chain));
    let start = problem.functions.start(
        |s| vec![1.0 + 2.0 * s - 4.0 * s * (1.0 - s), 5.0 * s, 4.0 * s],
        |s| vec![-2.0 + 8.0 * s],
        &[],
    );
    let (cost, ..) = solve(&mut problem, &start);
    assert!((cost / expected - 1.0).abs() < 1e-6, "{cost} {expected}");
}

/// Zermelo's particle of constant thrust: least time to height 5, speed 45 and no climb, by the angle of
/// thrust.
struct Particle;

impl Ocp for Particle {
    const SIZES: [usize; 3] = [4, 1, 1];
    fn intervals(&self) -> usize {
        20
    }
    fn duration<D: Number>(&self, p: &[D]) -> D {
        p[0]
    }
    fn path<D: Number>(&self, x: &[D], u: &[D], p: &[D]) -> (Vec<D>, D, Vec<D>) {
        let (sin, cos) = u[0].sin_cos();
        (vec![x[2], x[3], cos * 100.0, sin * 100.0], D::from(0.0), vec![u[0], p[0]])
    }
    fn path_bounds(&self) -> Vec<[f64; 2]> {
        let right = std::f64::consts::FRAC_PI_2;
        vec![[-right, right], [0.01, f64::INFINITY]]
    }
    fn ends<D: Number>(&self, x_0: &[D], x_n: &[D], p: &[D]) -> (D, Vec<D>) {
        let mut rows = x_0.to_vec();
        rows.extend([x_n[1] - 5.0, x_n[2] - 45.0, x_n[3]]);
        (p[0], rows)
    }
    fn end_equations(&self) -> usize {
        7
    }
}

impl Particle {
    /// The linear tangent law `tan u = tan u_0 (1 - 2 t / T)`: by `v_x = 45` and `y = 5`.
    fn least_time() -> f64 {
        // With s = tan u_0: v_x = 100 T asinh(s) / s / 2 * 2 .. integrals by Gauss's rule in a bisection of
        // s.
        let ends = |s: f64| {
            let count = 20_000;
            let (mut speed, mut slope, mut height) = (0.0, 0.0, 0.0);
            let step = 1.0 / f64::from(count);
            for i in 0..count {
                let t = (f64::from(i) + 0.5) * step;
                let tangent = s * (1.0 - 2.0 * t);
                let cos = (1.0 + tangent * tangent).sqrt().recip();
                speed += 100.0 * cos * step;
                let before = slope;
                slope += 100.0 * tangent * cos * step;
                height += 0.5 * (before + slope) * step;
            }
            (speed, height)
        };
        let (mut low, mut high) = (0.1, 10.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let (speed, height) = ends(middle);
            let time = 45.0 / speed;
            if height * time * time < 5.0 { low = middle } else { high = middle }
        }
        45.0 / ends(low).0
    }
}

#[test]
fn a_particle_is_steered_by_the_linear_tangent_law() {
    let expected = Particle::least_time();
    // COPS 3.0, problem 8: 0.554577 with 200 intervals, 0.554571 in the limit.
    assert!((expected - 0.554571).abs() < 2e-6, "{expected}");
    let mut problem = ByDuals::new(Collocated(Particle));
    let start =
        problem.functions.start(|s| vec![12.0 * s, 5.0 * s, 45.0 * s, 0.0], |s| vec![1.0 - 2.0 * s], &[1.0]);
    let (cost, ..) = solve(&mut problem, &start);
    assert!((cost - expected).abs() < 1e-6, "{cost} {expected}");
}
