//! Derivatives against differences, for the tests of all functions.

use super::functions::{PathFunction, TaskFunctions};
use costate::derivative::{SAFETY, largest};
use costate_test_support::proptest::prelude::TestCaseError;
use costate_test_support::rounding::{UNIT, apart, times, transposed_times, within};

/// Step of the differences; their error is its fourth power, or rounding over it.
const STEP: f64 = 2e-4;

/// Factors of g at so many steps, over 12 steps: 8 f(h) - 8 f(-h) - f(2h) + f(-2h).
const STENCIL: [(f64, f64); 4] = [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)];

/// The steps that [`check`] takes along each coordinate.
pub(super) const STEPS: [f64; 6] = [-4.0 * STEP, -2.0 * STEP, -STEP, STEP, 2.0 * STEP, 4.0 * STEP];

/// How many neighbouring numbers show the rounding of a result.
const NEIGHBOURS: usize = 8;

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

/// Derivatives of g and of `w'g_x` along coordinate j, by differences.
fn by_differences(
    functions: &mut TaskFunctions,
    x: &[f64],
    w: &[f64],
    (j, step): (usize, f64),
) -> [Vec<f64>; 2] {
    let width = x.len();
    let (mut slope, mut bend) = (vec![0.0; w.len()], vec![0.0; width]);
    for (steps, factor) in STENCIL {
        let mut moved = x.to_vec();
        moved[j] += steps * step;
        let factor = factor / (12.0 * step);
        slope.iter_mut().zip(values(functions, &moved)).for_each(|(slope, g)| *slope += factor * g);
        let (_, jacobian, _) = contracted(functions, &moved, w);
        let weighted = transposed_times(&jacobian, w);
        bend.iter_mut().zip(weighted).for_each(|(bend, entry)| *bend += factor * entry);
    }
    [slope, bend]
}

/// Standard deviations of the rounding errors of g, `w'g_x` and `w'g_xx`, the largest of each: how far they
/// are from their linear change at neighbouring numbers. Places, sums of differences and the ones under a
/// Hessian are rounded, too.
fn rounding(functions: &mut TaskFunctions, x: &[f64], w: &[f64]) -> [f64; 3] {
    let mut random = fastrand::Rng::with_seed(1);
    let (g, jacobian, hessian) = contracted(functions, x, w);
    let weighted = transposed_times(&jacobian, w);
    let mut squares = [vec![0.0; g.len()], vec![0.0; x.len()], vec![0.0; hessian.len()]];
    for _ in 0..NEIGHBOURS {
        let mut near = |x: &f64| x + f64::EPSILON * x.abs().max(1.0) * f64::from(random.i32(-4..=4));
        let moved: Vec<f64> = x.iter().map(&mut near).collect();
        let step = apart(&moved, x);
        let (g_there, jacobian_there, hessian_there) = contracted(functions, &moved, w);
        let off = [
            apart(&apart(&g_there, &g), &times(&jacobian, &step)),
            apart(&apart(&transposed_times(&jacobian_there, w), &weighted), &times(&hessian, &step)),
            apart(&hessian_there, &hessian),
        ];
        for (squares, off) in squares.iter_mut().zip(off) {
            squares.iter_mut().zip(off).for_each(|(square, off)| *square += off * off / NEIGHBOURS as f64);
        }
    }
    let size = |values: &[f64], slopes: &[f64]| {
        largest(values) + x.iter().map(|x| x.abs()).sum::<f64>() * largest(slopes)
    };
    let once = [size(&g, &jacobian), size(&weighted, &hessian), 1.0 + largest(&hessian)];
    std::array::from_fn(|k| largest(&squares[k]).sqrt().max(UNIT * once[k]))
}

/// Whether the Jacobian and the Hessian of rows with a weight are those by differences of g and of `w'g_x`,
/// and the Hessian is symmetric: as far as the differences with twice the step are, and rounding explains.
pub(super) fn check(
    functions: &mut TaskFunctions,
    q: &[f64],
    v: &[f64],
    w: &[f64],
) -> Result<(), TestCaseError> {
    let x = [q, v].concat();
    let width = x.len();
    let (g, jacobian, hessian) = contracted(functions, &x, w);
    assert_eq!(g, values(functions, &x), "both calls have one value");
    let counted: Vec<usize> = (0..w.len()).filter(|&i| w[i] != 0.0).collect();
    let (mut off, mut steps) = ([0.0_f64; 3], [0.0_f64; 2]);
    for j in 0..width {
        let [near, far] = [STEP, 2.0 * STEP].map(|step| by_differences(functions, &x, w, (j, step)));
        for &i in &counted {
            off[0] = off[0].max((jacobian[width * i + j] - near[0][i]).abs());
            steps[0] = steps[0].max((far[0][i] - near[0][i]).abs());
        }
        for i in 0..width {
            off[1] = off[1].max((hessian[width * i + j] - near[1][i]).abs());
            steps[1] = steps[1].max((far[1][i] - near[1][i]).abs());
            off[2] = off[2].max((hessian[width * i + j] - hessian[width * j + i]).abs());
        }
    }
    let of_sum = STENCIL.map(|(_, factor)| factor * factor).iter().sum::<f64>().sqrt() / (12.0 * STEP);
    let rounding = rounding(functions, &x, w).map(|deviation| SAFETY * deviation);
    within("g_x", &[off[0]], steps[0] + of_sum * rounding[0])?;
    within("w'g_xx", &[off[1]], steps[1] + of_sum * rounding[1])?;
    within("asymmetry", &[off[2]], rounding[2])
}
