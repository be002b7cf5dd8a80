//! Newton's equations of a step, whose ends have rows together.

use super::System;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::gait_rows::tests::{
    rabbit, rabbit_on_both_feet, seven_link, seven_link_on_both_feet, walker,
};
use crate::direct::solve::prepare::{Dynamics, interior};
use crate::options::SolverOptions;
use crate::problem::{Problem, SoleContact};
use crate::task::build::TaskRows;

/// A step on a coarse mesh, with its Lagrange function's gradient by all unknowns, shared ones last.
fn begun(problem: &Problem) -> Interior<Dynamics> {
    let rows = TaskRows::new(problem).unwrap();
    let options = SolverOptions::default().with_nodes(7);
    let mut interior = interior(problem, &rows, &options, 0, None);
    interior.start(None).unwrap();
    let count = interior.barrier.count();
    for at in 0..count {
        if !interior.barrier.is_on(at) {
            continue;
        }
        let sign = if interior.barrier.is_limit(at) { 1.0 } else { (0.7 * at as f64).sin() };
        interior.barrier.multiplier[at] = sign * (0.3 + (0.9 * at as f64).cos().abs());
    }
    interior
}

/// The gradient with the multipliers and squares at an iterate that is moved along unknown `at`; of squares
/// of distances from `shift`.
fn gradient(interior: &mut Interior<Dynamics>, shift: &[f64], at: usize, step: f64) -> Vec<f64> {
    let before = interior.spline.clone();
    let last = interior.spline.unknowns.len();
    if at < last {
        interior.spline.unknowns[at] += step;
    } else {
        let count = interior.ends.shared();
        let shared: Vec<f64> = (0..count).map(|i| if last + i == at { step } else { 0.0 }).collect();
        let (mut unknowns, mut times) = (vec![0.0; last], Vec::new());
        interior.ends.expand(&interior.spline.mesh, &shared, &mut unknowns, &mut times);
        interior.spline.unknowns.iter_mut().zip(&unknowns).for_each(|(to, step)| *to += step);
    }
    interior.evaluate().unwrap();
    interior.barrier.distance.iter_mut().zip(shift).for_each(|(d, shift)| *d -= shift);
    interior.refresh().unwrap();
    interior.system.exact = true;
    interior.assemble();
    interior.spline = before;
    let System { gradient, shared_gradient, .. } = &interior.system;
    [&gradient[0][..], &shared_gradient[0]].concat()
}

fn entry(system: &System, size: usize, i: usize, j: usize) -> f64 {
    match (i >= size, j >= size) {
        (true, true) => system.border.corner(i - size, j - size),
        (true, false) => system.border.column(i - size)[j],
        (false, true) => system.border.column(j - size)[i],
        (false, false) => system.matrix.entry(i, j),
    }
}

#[test]
fn the_matrix_is_the_derivative_of_the_gradient() {
    compare(&rabbit(), 7 + 7 + 2);
}

/// Of soles, which have limits at the ends and of forces.
#[test]
fn the_matrix_of_soles_is_the_derivative_of_the_gradient() {
    compare(&seven_link(), 9 + 9 + 3);
}

/// With both feet on the ground at first, where no impulse is shared.
#[test]
fn the_matrix_of_double_support_is_the_derivative_of_the_gradient() {
    compare(&rabbit_on_both_feet(), 7 + 7);
    for trailing in [SoleContact::Toe, SoleContact::Flat] {
        compare(&seven_link_on_both_feet(trailing), 9 + 9);
    }
}

/// In space, where joints change their signs in the mirror.
#[test]
fn the_matrix_in_space_is_the_derivative_of_the_gradient() {
    compare(&walker(), 18 + 18 + 6);
}

fn compare(problem: &Problem, shared: usize) {
    let mut interior = begun(problem);
    let size = interior.spline.unknowns.len();
    let all = size + interior.ends.shared();
    // Positions, velocities and impulses of the start.
    assert_eq!(interior.ends.shared(), shared);
    let removed: Vec<usize> = {
        let node = interior.spline.node();
        interior.ends.removed(&interior.spline.mesh).map(|(k, i)| node * k + i).collect()
    };
    interior.evaluate().unwrap();
    let shift = interior.barrier.distance.clone();
    let whole = gradient(&mut interior, &shift, 0, 0.0);
    let matrix: Vec<Vec<f64>> =
        (0..all).map(|j| (0..all).map(|i| entry(&interior.system, size, i, j)).collect()).collect();
    let scale = matrix.iter().flatten().fold(0.0_f64, |most, entry| most.max(entry.abs()));
    assert!(whole.iter().any(|g| *g != 0.0));
    let h = 1e-6;
    for j in (0..all).filter(|j| !removed.contains(j)) {
        let plus = gradient(&mut interior, &shift, j, h);
        let minus = gradient(&mut interior, &shift, j, -h);
        for i in (0..all).filter(|i| !removed.contains(i)) {
            let expected = (plus[i] - minus[i]) / (2.0 * h);
            let found = matrix[j][i];
            let near = (found - expected).abs() < 1e-7 * scale + 1e-5 * expected.abs();
            assert!(near, "({i}, {j}) of {size}: {found} instead of {expected}, scale {scale}");
        }
    }
}
