//! The assembled gradient and Hessian against central differences.

#[path = "system_case_tests.rs"]
pub(in crate::direct) mod case;

use crate::direct::motion::shape::Shape;
use case::{Case, Kind};

const STEP: f64 = 1e-5;

fn close(found: f64, expected: f64, scale: f64) -> bool {
    (found - expected).abs() < 1e-7 * scale
}

fn gradients_are_those_of_the_lagrange_function(case: &mut Case) {
    case.assemble();
    let gradients = [0, 1].map(|part| case.gradient(part));
    let scales =
        gradients.clone().map(|gradient| gradient.iter().fold(1.0, |most: f64, g| most.max(g.abs())));
    for at in 0..case.size() {
        let mut differences = [0.0; 2];
        if !case.is_removed(at) {
            let saved = case.spline.clone();
            case.shifted(at, STEP);
            let above = case.values();
            case.spline.clone_from(&saved);
            case.shifted(at, -STEP);
            let below = case.values();
            case.spline = saved;
            differences = [0, 1].map(|part| (above[part] - below[part]) / (2.0 * STEP));
        }
        for ((gradient, difference), scale) in gradients.iter().zip(differences).zip(scales) {
            assert!(close(gradient[at], difference, scale), "{at}: {} {difference}", gradient[at]);
        }
    }
}

fn the_matrix_is_the_derivative_of_the_gradient(case: &mut Case) {
    case.evaluate();
    // Without the distances of this motion sigma d does not change the multipliers.
    case.shift.clone_from(&case.barrier.distance);
    case.assemble();
    let size = case.size();
    let expected: Vec<Vec<f64>> = (0..size)
        .map(|j| {
            if case.is_removed(j) {
                return (0..size).map(|i| f64::from(i == j)).collect();
            }
            let saved = case.spline.clone();
            let gradient = |case: &mut Case, step: f64| {
                case.shifted(j, step);
                case.assemble();
                case.spline.clone_from(&saved);
                case.gradient(0)
            };
            let (above, below) = (gradient(case, STEP), gradient(case, -STEP));
            above.iter().zip(&below).map(|(above, below)| (above - below) / (2.0 * STEP)).collect()
        })
        .collect();
    case.assemble();
    let scale = expected.iter().flatten().fold(1.0, |most: f64, entry| most.max(entry.abs()));
    for (j, column) in expected.iter().enumerate() {
        for (i, &expected) in column.iter().enumerate() {
            let found = case.entry(i, j);
            assert!(close(found, expected, scale), "({i}, {j}): {found} instead of {expected}");
        }
    }
}

fn steps_solve_the_bordered_equations(case: &mut Case) {
    // Large curvature of the limits makes the matrix positive definite.
    case.barrier.slack.iter_mut().for_each(|slack| *slack *= 1e-4);
    case.assemble();
    let weights = [1.0; 2];
    case.system.factorise(0.0, &case.ends, &case.spline, &case.points, &weights).unwrap();
    let size = case.size();
    for part in 0..2 {
        let (mut step, mut shared) = (Vec::new(), Vec::new());
        case.system.solve(part, &mut step, &mut shared);
        step.append(&mut shared);
        let gradient = case.gradient(part);
        let scale = gradient.iter().fold(0.0, |most: f64, g| most.max(g.abs()));
        for (i, entry) in gradient.iter().enumerate() {
            let product: f64 = (0..size).map(|j| case.entry(i, j) * step[j]).sum();
            assert!(close(product, -entry, scale), "{part} {i}: {product} {entry}");
        }
    }
}

/// All of them, for all kinds of motions.
fn check(shape: Shape) {
    for kind in Kind::ALL {
        assert_eq!(Case::new(shape, kind).ends.shared(), [1, 2, 3][kind as usize], "{kind:?}");
        for new in [Case::new, Case::with_hulls] {
            gradients_are_those_of_the_lagrange_function(&mut new(shape, kind));
            the_matrix_is_the_derivative_of_the_gradient(&mut new(shape, kind));
            steps_solve_the_bordered_equations(&mut new(shape, kind));
        }
    }
}

#[test]
fn derivatives_where_accelerations_jump() {
    check(Shape::Quartic);
}

#[test]
fn derivatives_where_accelerations_are_continuous() {
    check(Shape::Quintic);
}
