//! Equations whose squares are rounded by more than the cost is curved.

use crate::constants::direct as constants;
use crate::direct::interior::inertia::Inertia;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::limits::gait_rows::tests::rabbit;
use crate::direct::solve::prepare::{Dynamics, interior};
use crate::options::SolverOptions;
use crate::task::build::TaskRows;

/// A step of a gait that is a local minimum on its mesh, assembled.
fn solved() -> Interior<Dynamics> {
    let problem = rabbit();
    let rows = TaskRows::new(&problem).unwrap();
    let mut interior = interior(&problem, &rows, &SolverOptions::default().with_nodes(31), 0, None);
    interior.start(None).unwrap();
    let end = interior.iterate(1e-6, 200, |_, _| None).unwrap();
    assert!(end == End::Solved && interior.figures.is_minimum);
    interior.refresh().unwrap();
    interior.assemble();
    assert!(interior.factorise(0.0));
    interior.softer.learn(true);
    interior
}

/// The same with the least stiffness, in powers of ten, whose rounding hides that.
fn rounded() -> Interior<Dynamics> {
    let mut interior = solved();
    while interior.factorise(0.0) {
        interior.barrier.stiffness *= 10.0;
        interior.assemble();
    }
    assert!(interior.barrier.stiffness < 1e18 * interior.figures.size);
    interior.figures.is_minimum = false;
    interior
}

#[test]
fn equations_become_softer_where_that_needs_less_damping() {
    let mut interior = rounded();
    let stiffness = interior.barrier.stiffness;
    // A little damping does no harm.
    let little = 0.1 * constants::SOFTENS_FROM;
    assert_eq!(interior.soften_equations(little, Some(0.0)), little);
    // What was never indefinite was not damped for that.
    assert_eq!(interior.soften_equations(1.0, None), 1.0);
    assert_eq!(interior.barrier.stiffness, stiffness);
    assert_eq!(interior.soften_equations(1.0, Some(0.0)), 0.0);
    assert_eq!(interior.barrier.stiffness, constants::SOFTER * stiffness);
    assert!(interior.factorise(0.0), "and the matrix is that of softer ones");
}

#[test]
fn equations_stay_as_they_are_where_the_cost_bends_down() {
    let mut interior = solved();
    // Second derivatives of the dynamics, far beyond what the effort is curved by.
    interior.barrier.multiplier.iter_mut().for_each(|multiplier| *multiplier *= -1e3);
    interior.refresh().unwrap();
    interior.assemble();
    assert!(!interior.factorise(0.1));
    let (stiffness, damping) = (interior.barrier.stiffness, constants::MOST_DAMPING);
    assert!(interior.factorise(damping));
    assert_eq!(interior.soften_equations(damping, Some(0.1)), damping);
    assert_eq!(interior.barrier.stiffness, stiffness);
    assert!(!interior.softer.is_due(), "it was tried");
    assert!(!interior.factorise(0.1), "and the matrix is the one before");
}

#[test]
fn rounding_makes_no_saddle() {
    let mut interior = rounded();
    assert_eq!(interior.inertia().unwrap(), Inertia::Positive);
}
