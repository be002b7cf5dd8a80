//! Derivatives against differences, for the tests of all functions.

use super::functions::{PathFunction, TaskFunctions};
use costate::robot::Robot;
use costate_test_support::proptest::prelude::TestCaseError;
use costate_test_support::reach::Reach;
use costate_test_support::rounding::{of_joints, within};

/// Step of the finer differences (rad, m); the coarser ones take twice as much.
const STEP: f64 = 1e-4;

/// Weights of the values at -4, .., 4 steps; the differences are the sums over 12 steps, all of fourth order.
type Weights = [f64; 9];

const COARSE: Weights = [0.5, 0.0, -4.0, 0.0, 0.0, 0.0, 4.0, 0.0, -0.5];
const FINE: Weights = [0.0, 0.0, 1.0, -8.0, 0.0, 8.0, -1.0, 0.0, 0.0];
const AHEAD: Weights = [0.0, 0.0, 0.0, 0.0, -25.0, 48.0, -36.0, 16.0, -3.0];
const BEHIND: Weights = [3.0, -16.0, 36.0, -48.0, 25.0, 0.0, 0.0, 0.0, 0.0];

/// A derivative by finer differences of values with this rounding error, and a bound of its error.
///
/// In smooth functions the error is 1/15 of the difference from the coarser ones. Where the slope jumps by
/// D at a distance of t steps, the error is `(6 - 7t) D / 12` for t < 1 and `(t - 2) D / 12` for t < 2. The
/// bound is larger: by 3.36 to 2.64 at least, at t = 12/25, where both one-sided differences agree by
/// chance. Where the function itself jumps, they differ by more than three times the error.
fn slope(values: &[f64; 9], rounding: f64) -> [f64; 2] {
    let by = |weights: Weights| {
        weights.iter().zip(values).map(|(weight, value)| weight * value).sum::<f64>() / (12.0 * STEP)
    };
    let (fine, of_rounding) = (by(FINE), 18.0 / (12.0 * STEP) * rounding);
    [fine, 2.0 * (by(COARSE) - fine).abs() + (by(AHEAD) - by(BEHIND)).abs() + of_rounding]
}

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

/// Whether the Jacobian of the rows with a weight is that by differences of g, and `w'g_xx` that of `w'g_x`
/// and symmetric.
pub(super) fn are_those_by_differences(
    robot: &Robot,
    functions: &mut TaskFunctions,
    [q, v]: [&[f64]; 2],
    w: &[f64],
) -> Result<(), TestCaseError> {
    let x = [q, v].concat();
    let width = x.len();
    let (g, jacobian, hessian) = contracted(functions, &x, w);
    assert_eq!(g, values(functions, &x), "both calls have one value");
    let weighted = |jacobian: &[f64], j: usize| {
        jacobian.chunks_exact(width).zip(w).map(|(row, w)| w * row[j]).sum::<f64>()
    };
    // Positions are rounded as sums past all joints are, and change a function by its derivatives.
    let reach = Reach::new(robot, [q, v, v], 1.0);
    let far = reach.length * (1.0 + reach.rate);
    let size = |values: &[f64]| values.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
    let rounding = |value: f64, slopes: f64| of_joints(robot, value.abs() + far * (1.0 + slopes));
    let terms = jacobian.chunks_exact(width).zip(w).map(|(row, w)| (w * size(row)).abs()).sum();
    let of_gradient = rounding(terms, size(&hessian));
    for j in 0..width {
        let moved = [-4.0, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0].map(|steps| {
            let mut x = x.clone();
            x[j] += steps * STEP;
            let (_, jacobian, _) = contracted(functions, &x, w);
            (values(functions, &x), jacobian)
        });
        for i in (0..w.len()).filter(|&i| w[i] != 0.0) {
            let row = &jacobian[width * i..width * (i + 1)];
            let along = std::array::from_fn(|k| moved[k].0[i]);
            let [expected, bound] = slope(&along, rounding(g[i], size(row)));
            within(&format!("g_x[{i}][{j}]"), &[row[j] - expected], bound)?;
        }
        for i in 0..width {
            let entry = hessian[width * i + j];
            let along = std::array::from_fn(|k| weighted(&moved[k].1, i));
            let [expected, bound] = slope(&along, of_gradient);
            within(&format!("w'g_xx[{i}][{j}]"), &[entry - expected], bound)?;
            within("w'g_xx and its transpose", &[entry - hessian[width * j + i]], of_gradient)?;
        }
    }
    Ok(())
}
