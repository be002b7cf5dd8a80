//! One search.

use crate::counted::Counts;
use crate::problems::problem;
use crate::record::{Record, Search};
use costate::hamiltonian::Hamiltonian;
use costate_control::{
    ControlLaw, Coordinates, Extremal, ExtremalSolution, JacobianRoute, LagrangianExtremal, Method, Motion,
    Problem, RobotExtremal, SolverOptions, Strategy, solve_extremal,
};
use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

/// The same for all: Newton's method from the guess, no other way.
pub fn options(search: &Search) -> SolverOptions {
    SolverOptions::of(Method::Collocation)
        .with_tolerance(1e-9)
        .with_jacobian(search.matrix)
        .with_coordinates(search.coordinates)
        .with_strategy(Strategy::Direct)
        .with_max_iterations(40)
        .with_max_nodes(1001)
}

/// Solves one problem in one way.
pub fn run(search: &Search) -> Result<Record, Box<dyn Error>> {
    let problem = problem(search.robot, search.variant, search.pair)?;
    let checked = problem.check()?;
    match search.coordinates {
        Coordinates::Hamiltonian => {
            let mut momenta = Hamiltonian::<f64>::new(&problem.robot);
            let mut rates = momenta.clone();
            let extremal = RobotExtremal::new(checked, search.matrix)?;
            solve(
                (search, &problem, extremal),
                |q, v| Ok(momenta.momentum(q, v)?.to_vec()),
                |q, p| Ok(rates.velocity(q, p)?.to_vec()),
            )
        }
        Coordinates::Lagrangian => {
            let extremal = LagrangianExtremal::new(checked, search.matrix)?;
            solve((search, &problem, extremal), |_, v| Ok(v.to_vec()), |_, v| Ok(v.to_vec()))
        }
    }
}

/// `into` and `back` lead from (q, v) to the second half of x and from x to v.
fn solve<E: Extremal>(
    (search, problem, mut extremal): (&Search, &Problem, E),
    mut into: impl FnMut(&[f64], &[f64]) -> Result<Vec<f64>, costate::EvalError>,
    mut back: impl FnMut(&[f64], &[f64]) -> Result<Vec<f64>, costate::EvalError>,
) -> Result<Record, Box<dyn Error>> {
    let n = problem.robot.dof();
    let mut failed = None;
    // From rest to rest by a cubic, costates zero.
    let mut guess = |s: f64, z: &mut [f64]| {
        let mut v = vec![0.0; n];
        for j in 0..n {
            let (from, way) = (problem.start.q[j], problem.end.q[j] - problem.start.q[j]);
            z[j] = from + way * s * s * (3.0 - 2.0 * s);
            v[j] = way * 6.0 * s * (1.0 - s) / problem.time.value();
        }
        z[2 * n..].fill(0.0);
        match into(&z[..n], &v) {
            Ok(second) => z[n..2 * n].copy_from_slice(&second),
            Err(error) => failed = Some(error),
        }
    };
    let jacobian_cost = match search.matrix {
        JacobianRoute::Differences => (8 * n + 1) as f64,
        _ => {
            let mut z = vec![0.1; 4 * n];
            guess(0.4, &mut z);
            z[2 * n..].fill(0.1);
            jacobian_cost(&mut extremal, &z)?
        }
    };
    let mut counted = Counts::of(extremal);
    let motion = solve_extremal(&mut counted, problem.time, &options(search), guess);
    let milliseconds = 1e3 * counted.hooks.duration().as_secs_f64();
    if let Some(error) = failed {
        return Err(error.into());
    }
    let ExtremalSolution { motion, nodes, .. } = motion;
    let Motion { status, hamiltonian_drift, cost, penalty_cost, iterations, end_state, .. } = motion;
    let end_defect = match end_state {
        Some(x) => {
            let v = back(&x[..n], &x[n..])?;
            let missed = |j: usize| (x[j] - problem.end.q[j]).abs().max((v[j] - problem.end.v[j]).abs());
            Some((0..n).map(missed).fold(0.0, f64::max))
        }
        None => None,
    };
    Ok(Record {
        search: *search,
        status: status.name().into(),
        end_defect,
        drift: hamiltonian_drift,
        cost: cost + penalty_cost,
        steps: iterations.len(),
        nodes: nodes.t.len(),
        rates: counted.hooks.rates,
        jacobians: counted.hooks.jacobians,
        jacobian_cost,
        milliseconds,
    })
}

/// Time of `linear` in times of `rate`: medians of batches that follow each other.
fn jacobian_cost<E: Extremal>(extremal: &mut E, z: &[f64]) -> Result<f64, costate::EvalError> {
    const BATCHES: usize = 21;
    const CALLS: usize = 20;
    let (mut g, mut jacobian) = (vec![0.0; z.len()], vec![0.0; z.len() * z.len()]);
    let mut ratios = Vec::with_capacity(BATCHES);
    for _ in 0..BATCHES {
        let begun = Instant::now();
        for _ in 0..CALLS {
            black_box(extremal.evaluate(black_box(z), ControlLaw::Maximal, &mut g)?);
        }
        let of_rate = begun.elapsed().as_secs_f64();
        let begun = Instant::now();
        for _ in 0..CALLS {
            black_box(extremal.linearise(black_box(z), ControlLaw::Maximal, &mut g, &mut jacobian)?);
        }
        ratios.push(begun.elapsed().as_secs_f64() / of_rate);
    }
    Ok(crate::statistics::median(&mut ratios))
}
