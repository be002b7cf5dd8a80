//! Derivatives against differences, for the tests of all functions.

use super::functions::{PathFunction, TaskFunctions};

/// Step of the differences: their error is its fourth power, or rounding over it.
const STEP: f64 = 2e-4;

/// g, the Jacobian and `w'g_xx`, on top of a Hessian that holds ones before.
pub(super) fn contracted(
    functions: &mut TaskFunctions,
    x: &[f64],
    w: &[f64],
) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let (rows, width) = (functions.rows(), x.len());
    let (q, v) = x.split_at(width / 2);
    let mut g = vec![f64::NAN; rows];
    let mut jacobian = vec![f64::NAN; rows * width];
    let mut hessian = vec![1.0; width * width];
    functions.contract(q, v, w, &mut g, &mut jacobian, &mut hessian).unwrap();
    hessian.iter_mut().for_each(|entry| *entry -= 1.0);
    (g, jacobian, hessian)
}

fn values(functions: &mut TaskFunctions, x: &[f64]) -> Vec<f64> {
    let mut g = vec![f64::NAN; functions.rows()];
    let (q, v) = x.split_at(x.len() / 2);
    functions.values(q, v, &mut g).unwrap();
    g
}

/// Of rows with a weight: largest differences of the Jacobian and of the Hessian from those by differences of
/// g and of `w'g_x`, each relative to the largest entry or 1, and of the Hessian from its transpose.
pub(super) fn errors(functions: &mut TaskFunctions, q: &[f64], v: &[f64], w: &[f64]) -> [f64; 3] {
    let x = [q, v].concat();
    let (rows, width) = (functions.rows(), x.len());
    let (g, jacobian, hessian) = contracted(functions, &x, w);
    assert_eq!(g, values(functions, &x), "both calls have one value");
    let mut largest = [0.0_f64; 3];
    let size = |values: &[f64]| values.iter().fold(1.0_f64, |size, value| size.max(value.abs()));
    let counts = |i: usize| w[i] != 0.0;
    let of_rows = (0..rows).filter(|&i| counts(i)).map(|i| size(&jacobian[width * i..width * (i + 1)]));
    let (first, second) = (of_rows.fold(1.0, f64::max), size(&hessian));
    for j in 0..width {
        let moved = |steps: f64| {
            let mut x = x.clone();
            x[j] += steps * STEP;
            x
        };
        // Fourth order: 8 f(h) - 8 f(-h) - f(2h) + f(-2h) over 12 h.
        let stencil = [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)];
        let (mut slope, mut bend) = (vec![0.0; rows], vec![0.0; width]);
        for (steps, factor) in stencil {
            let x = moved(steps);
            let g = values(functions, &x);
            slope.iter_mut().zip(&g).for_each(|(slope, g)| *slope += factor * g / (12.0 * STEP));
            let (_, jacobian, _) = contracted(functions, &x, w);
            for (row, w) in jacobian.chunks_exact(width).zip(w) {
                bend.iter_mut()
                    .zip(row)
                    .for_each(|(bend, entry)| *bend += factor * w * entry / (12.0 * STEP));
            }
        }
        for (i, slope) in slope.iter().enumerate().filter(|&(i, _)| counts(i)) {
            largest[0] = largest[0].max((jacobian[width * i + j] - slope).abs() / first);
        }
        for (i, bend) in bend.iter().enumerate() {
            largest[1] = largest[1].max((hessian[width * i + j] - bend).abs() / second);
            let across = (hessian[width * i + j] - hessian[width * j + i]).abs();
            largest[2] = largest[2].max(across / second);
        }
    }
    largest
}
