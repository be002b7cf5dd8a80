//! Elimination of almost block diagonal matrices against the sparse LU of faer: the same solutions, and times
//! as ratios.
//!
//! `cargo run --release --manifest-path benches/sparse/Cargo.toml`. Matrices: random ones with entries over
//! six powers of ten, and those of the trapezoidal rule along optimal motions, with the exact Jacobians of
//! their extremals. A solution that differs ends with an error.

use costate_control::{
    AlmostBlockDiagonal, BoundaryValueProblem, ControlLaw, Problem, RobotExtremal, Solver, SolverOptions,
};
use costate::robot::Robot;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{SparseColMat, Triplet};
use std::error::Error;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

/// A matrix row by row: conditions at the start, blocks, conditions at the end.
struct Matrix {
    m: usize,
    first: usize,
    left: Vec<f64>,
    blocks: Vec<Vec<f64>>,
    right: Vec<f64>,
}

impl Matrix {
    fn random(m: usize, first: usize, blocks: usize) -> Self {
        let mut random = fastrand::Rng::with_seed((m * blocks) as u64);
        let mut numbers = |count: usize| -> Vec<f64> {
            (0..count).map(|_| (2.0 * random.f64() - 1.0) * 10.0_f64.powi(random.i32(-3..3))).collect()
        };
        let left = numbers(first * m);
        let blocks = (0..blocks).map(|_| numbers(2 * m * m)).collect();
        Self { m, first, left, blocks, right: numbers((m - first) * m) }
    }

    /// `z_R - z_L - h/2 (g_L + g_R)` along the optimal motion from rest to rest.
    fn of_motion(
        robot: &str,
        ends: (&[f64], &[f64]),
        weights: Option<&[f64]>,
    ) -> Result<Self, Box<dyn Error>> {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots").join(robot);
        let mut problem = Problem::rest_to_rest(Robot::from_file(file)?, ends.0, ends.1, 1.0);
        if let Some(weights) = weights {
            problem.cost.effort = weights.iter().map(|limit| 1.0 / (limit * limit)).collect();
        }
        let motion = Solver::new(&problem, SolverOptions::default().with_tolerance(1e-9))?.solve().trajectory;
        let mut extremal = RobotExtremal::new(problem.check()?, SolverOptions::default().jacobian)?;
        let first = extremal.states();
        let m = 2 * first;
        let mut jacobians = Vec::new();
        let (mut left, mut right) = (vec![0.0; first * m], vec![0.0; first * m]);
        let (mut g, mut residual) = (vec![0.0; m], vec![0.0; first]);
        for i in 0..motion.t.len() {
            let z = [&motion.q[i], &motion.p[i], &motion.y_q[i], &motion.y_p[i]]
                .map(|part| part.as_slice())
                .concat();
            let mut jacobian = vec![0.0; m * m];
            extremal.linearise(&z, ControlLaw::Maximal, &mut g, &mut jacobian)?;
            if i == 0 {
                extremal.start(&z, &mut residual, &mut left)?;
            }
            extremal.end(&z, &mut residual, &mut right)?;
            jacobians.push(jacobian);
        }
        let block = |k: usize| -> Vec<f64> {
            let half = 0.5 * (motion.t[k + 1] - motion.t[k]);
            let entry = |r: usize, c: usize| {
                let one = if r == c % m { 1.0 } else { 0.0 };
                match c < m {
                    true => -one - half * jacobians[k][r * m + c],
                    false => one - half * jacobians[k + 1][r * m + c - m],
                }
            };
            (0..2 * m * m).map(|at| entry(at / (2 * m), at % (2 * m))).collect()
        };
        Ok(Self { m, first, left, blocks: (0..motion.t.len() - 1).map(block).collect(), right })
    }

    fn size(&self) -> usize {
        self.m * (self.blocks.len() + 1)
    }

    fn write(&self, target: &mut AlmostBlockDiagonal) {
        target.left_mut().copy_from_slice(&self.left);
        for (k, block) in self.blocks.iter().enumerate() {
            for (r, row) in block.chunks_exact(2 * self.m).enumerate() {
                target.block_row_mut(k, r).copy_from_slice(row);
            }
        }
        target.right_mut().copy_from_slice(&self.right);
    }

    fn entries(&self) -> Vec<Triplet<usize, usize, f64>> {
        let (m, first) = (self.m, self.first);
        let mut entries = Vec::new();
        let mut add = |rows: &[f64], width: usize, row: usize, column: usize| {
            for (at, &value) in rows.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                entries.push(Triplet::new(row + at / width, column + at % width, value));
            }
        };
        add(&self.left, m, 0, 0);
        self.blocks.iter().enumerate().for_each(|(k, block)| add(block, 2 * m, first + k * m, k * m));
        add(&self.right, m, first + self.blocks.len() * m, self.blocks.len() * m);
        entries
    }
}

/// The shortest time of several rounds (s).
fn shortest(mut work: impl FnMut() -> Result<(), Box<dyn Error>>) -> Result<f64, Box<dyn Error>> {
    let mut least = f64::INFINITY;
    for _ in 0..ROUNDS {
        let started = Instant::now();
        work()?;
        least = least.min(started.elapsed().as_secs_f64());
    }
    Ok(least)
}

const ROUNDS: usize = 30;

fn main() -> Result<(), Box<dyn Error>> {
    faer::set_global_parallelism(faer::Par::Seq);
    let limits = [56.0, 97.0, 52.0, 11.0, 13.0, 10.0];
    let (from, to) = ([0.0, -0.8, 2.4, 0.0, 0.6, 0.0], [1.2, -0.2, 1.9, 0.4, 0.9, -0.5]);
    let quarter = [std::f64::consts::FRAC_PI_2; 2];
    let cases = [
        ("random", Matrix::random(4, 2, 100)),
        ("random", Matrix::random(24, 12, 50)),
        ("random", Matrix::random(28, 14, 200)),
        ("two-link arm", Matrix::of_motion("two_link.toml", (&[0.0; 2], &quarter), None)?),
        ("PUMA 560", Matrix::of_motion("puma560.toml", (&from, &to), Some(&limits))?),
    ];
    println!("matrix        m  blocks   difference  residual  faer's  time of faer / own");
    for (name, matrix) in &cases {
        let size = matrix.size();
        let b: Vec<f64> = (0..size).map(|i| (i as f64).sin()).collect();
        let mut own = AlmostBlockDiagonal::zeros(matrix.m, matrix.first, matrix.blocks.len());
        let mut x = b.clone();
        let own_time = shortest(|| {
            matrix.write(&mut own);
            own.factor()?;
            x.copy_from_slice(&b);
            own.solve(black_box(&mut x));
            Ok(())
        })?;
        let sparse = SparseColMat::<usize, f64>::try_new_from_triplets(size, size, &matrix.entries())
            .map_err(|error| format!("{error:?}"))?;
        // The order of elimination is found once, as a solver would.
        let symbolic = SymbolicLu::try_new(sparse.symbolic()).map_err(|error| format!("{error:?}"))?;
        let mut other = faer::Mat::<f64>::zeros(size, 1);
        let other_time = shortest(|| {
            let lu = Lu::try_new_with_symbolic(symbolic.clone(), sparse.as_ref())
                .map_err(|error| format!("{error:?}"))?;
            (0..size).for_each(|i| other[(i, 0)] = b[i]);
            lu.solve_in_place(black_box(&mut other));
            Ok(())
        })?;
        let largest = x.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let difference = (0..size).map(|i| (x[i] - other[(i, 0)]).abs()).fold(0.0, f64::max) / largest;
        let residual = |x: &dyn Fn(usize) -> f64| -> f64 {
            let mut rest = b.clone();
            let mut scale = vec![0.0_f64; size];
            for Triplet { row, col, val } in matrix.entries() {
                rest[row] -= val * x(col);
                scale[row] += (val * x(col)).abs();
            }
            // In parts of the terms of a row and of the largest entry of b, which is 1.
            rest.iter().zip(scale).map(|(rest, scale)| rest.abs() / (scale + 1.0)).fold(0.0, f64::max)
        };
        let residuals = [residual(&|i| x[i]), residual(&|i| other[(i, 0)])];
        println!(
            "{name:<12} {:>2}  {:>6}  {difference:>11.1e}  {:>8.1e}  {:>6.1e}  {:>18.1}",
            matrix.m,
            matrix.blocks.len(),
            residuals[0],
            residuals[1],
            other_time / own_time
        );
        if difference > 1e-7 || residuals[0] > 1e-10 {
            return Err(format!("{name}: solutions differ by {difference:e}").into());
        }
    }
    Ok(())
}
