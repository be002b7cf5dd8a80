//! Values published by others.

use super::by_duals::{ByDuals, Number};
use super::closed_forms::solve;
use super::collocation::{Collocated, Ocp};

/// Goddard's rocket: the greatest height, with drag and a singular arc of thrust (COPS 3.0, problem 10).
struct Rocket;

impl Ocp for Rocket {
    /// Height, velocity, mass; thrust; duration.
    const SIZES: [usize; 3] = [3, 1, 1];
    fn intervals(&self) -> usize {
        100
    }
    fn duration<D: Number>(&self, p: &[D]) -> D {
        p[0]
    }
    fn path<D: Number>(&self, x: &[D], u: &[D], p: &[D]) -> (Vec<D>, D, Vec<D>) {
        let (height, velocity, mass) = (x[0], x[1], x[2]);
        let drag = velocity * velocity * 310.0 * ((height - 1.0) * -500.0).exp();
        let gravity = (height * height).recip();
        let rates = vec![velocity, (u[0] - drag) / mass - gravity, -u[0] * 2.0];
        (rates, D::from(0.0), vec![u[0], mass, velocity, height, p[0]])
    }
    fn path_bounds(&self) -> Vec<[f64; 2]> {
        vec![[0.0, 3.5], [0.6, 1.0], [0.0, f64::INFINITY], [1.0, f64::INFINITY], [1e-3, f64::INFINITY]]
    }
    fn ends<D: Number>(&self, x_0: &[D], x_n: &[D], _: &[D]) -> (D, Vec<D>) {
        (-x_n[0], vec![x_0[0] - 1.0, x_0[1], x_0[2] - 1.0, x_n[2] - 0.6])
    }
    fn end_equations(&self) -> usize {
        4
    }
}

#[test]
fn goddards_rocket_rises_as_high_as_published() {
    let mut problem = ByDuals::new(Collocated(Rocket));
    let start = problem.functions.start(|s| vec![1.0, s * (1.0 - s), 1.0 - 0.4 * s], |_| vec![1.75], &[0.2]);
    let (cost, ..) = solve(&mut problem, &start);
    // 1.01283 in the limit (COPS 3.0; Bondarenko, Bortz, More 1999).
    assert!((cost + 1.01283).abs() < 2e-5, "{cost}");
}

/// The limit cycle of van der Pol's oscillator: no cost, both ends equal, the period free.
struct LimitCycle;

impl Ocp for LimitCycle {
    const SIZES: [usize; 3] = [2, 0, 1];
    fn intervals(&self) -> usize {
        80
    }
    fn duration<D: Number>(&self, p: &[D]) -> D {
        p[0]
    }
    fn path<D: Number>(&self, x: &[D], _: &[D], _: &[D]) -> (Vec<D>, D, Vec<D>) {
        (vec![x[1], (-(x[0] * x[0]) + 1.0) * x[1] - x[0]], D::from(0.0), Vec::new())
    }
    fn ends<D: Number>(&self, x_0: &[D], x_n: &[D], _: &[D]) -> (D, Vec<D>) {
        (D::from(0.0), vec![x_n[0] - x_0[0], x_n[1] - x_0[1], x_0[1]])
    }
    fn end_equations(&self) -> usize {
        3
    }
}

#[test]
fn the_period_of_van_der_pols_oscillator_is_found() {
    let mut problem = ByDuals::new(Collocated(LimitCycle));
    let turn = std::f64::consts::TAU;
    let start = problem.functions.start(
        |s| vec![2.0 * (turn * s).cos(), -2.0 * (turn * s).sin()],
        |_| Vec::new(),
        &[6.5],
    );
    let (_, point, _) = solve(&mut problem, &start);
    let period = point[point.len() - 1];
    // 6.66328685933 at mu = 1 (Andersen and Geer, SIAM J. Appl. Math. 42 (1982), 678-693).
    assert!((period - 6.66328685933).abs() < 1e-6, "{period}");
}
