//! Newton's step by condensation and recursion against the dense equations.

use super::interior::Interior;
use super::points::POINTS;
use super::problem::DirectDynamics;
use crate::status::Status;
use crate::{DynamicsProblem, EndState, FinalTime, Objective};
use costate::derivative::Function;
use costate::dynamics::{Automatic, QuadraticCost};
use costate::scalar::Scalar;
use nalgebra::{DMatrix, DVector};

const STATES: usize = 3;
const CONTROLS: usize = 2;

/// Only its sizes matter: derivatives are random.
#[derive(Clone)]
struct Any;

impl Function for Any {
    type Workspace<S: Scalar> = ();
    type Error = std::convert::Infallible;
    fn inputs(&self) -> usize {
        STATES + CONTROLS
    }
    fn outputs(&self) -> usize {
        STATES
    }
    fn workspace<S: Scalar>(&self) {}
    fn evaluate<S: Scalar>(&self, _: &mut (), _: &[S], f: &mut [S]) -> Result<(), Self::Error> {
        f.fill(S::zero());
        Ok(())
    }
}

/// What is given at the end.
const ENDS: [[f64; STATES]; 2] = [[1.0, 0.0, 0.0], [0.0, 0.6, -0.8]];

type Task = DirectDynamics<Automatic<Any>, QuadraticCost>;

/// A mesh of three intervals with random derivatives; one component of the start is free, two of the end, of
/// which a sum is given, and T.
fn random(seed: u64) -> (Task, Interior) {
    let start = EndState::fixed(&[0.1, 0.2, -0.3]).with_free(&[1]);
    let end = EndState::fixed(&[1.0, 0.0, 0.5]).with_free(&[1, 2]).with_given(vec![vec![0.0, 0.6, -0.8]]);
    let problem = DynamicsProblem::new(start, end, FinalTime::Free { guess: 1.5 }, CONTROLS)
        .with_cost(Objective::new(0.4, vec![1.0; CONTROLS]));
    let task = DirectDynamics::new(Automatic::<Any>::new(Any), &problem).unwrap();
    let layout = super::points::Layout { n: STATES, m: CONTROLS, intervals: 3 };
    let guess = task.unknowns(&layout);
    let mut mesh = Interior::new(&task, vec![0.3, 0.5, 0.2], guess, false);
    let mut random = fastrand::Rng::with_seed(seed);
    let mut next = move || random.f64() - 0.5;
    mesh.cost = 1e-3;
    mesh.nu.iter_mut().for_each(|nu| *nu = next());
    let last = layout.node(3);
    mesh.w[last..last + STATES].iter_mut().for_each(|w| *w += 0.1 * next());
    let size = STATES + CONTROLS;
    for interval in &mut mesh.intervals {
        let lists = [
            &mut interval.defect,
            &mut interval.gradient,
            &mut interval.cross,
            &mut interval.by_states,
            &mut interval.by_controls,
            &mut interval.by_time,
        ];
        lists.into_iter().for_each(|list| list.iter_mut().for_each(|entry| *entry = next()));
        interval.gradient_t = next();
        (0..POINTS * STATES).for_each(|i| interval.by_states[i * POINTS * STATES + i] += 2.0);
        for hessian in interval.hessian.chunks_exact_mut(size * size) {
            let half = DMatrix::from_fn(size, size, |_, _| next());
            let whole = &half * half.transpose() + DMatrix::identity(size, size) * 3.0;
            hessian.copy_from_slice(whole.as_slice());
        }
    }
    (task, mesh)
}

/// Step and multipliers of the defects by the dense equations, with the squares of the ends and this damping.
fn dense(task: &Task, mesh: &Interior, damping: f64) -> (DVector<f64>, DVector<f64>) {
    let layout = mesh.layout;
    let (count, rows, size) = (layout.count(), 3 * POINTS * STATES, STATES + CONTROLS);
    let time = layout.time();
    let mut matrix = DMatrix::zeros(count + rows, count + rows);
    let mut right = DVector::zeros(count + rows);
    let mut add = |row: usize, column: usize, value: f64| {
        matrix[(row, column)] += value;
        if row != column {
            matrix[(column, row)] += value;
        }
    };
    for (k, interval) in mesh.intervals.iter().enumerate() {
        right[time] -= interval.gradient_t;
        for j in 0..POINTS {
            let at = layout.point(k, j);
            for a in 0..size {
                right[at + a] -= interval.gradient[j * size + a];
                add(at + a, time, interval.cross[j * size + a]);
                add(at + a, at + a, damping);
                (0..=a).for_each(|b| add(at + a, at + b, interval.hessian[(j * size + a) * size + b]));
            }
            for i in 0..STATES {
                let local = j * STATES + i;
                let row = count + k * POINTS * STATES + local;
                right[row] -= interval.defect[local];
                add(row, time, interval.by_time[local]);
                add(row, layout.node(k) + i, mesh.radau.slopes[j][0]);
                (0..CONTROLS)
                    .for_each(|c| add(row, at + STATES + c, interval.by_controls[local * CONTROLS + c]));
                for c in 0..POINTS * STATES {
                    let column = layout.point(k, c / STATES) + c % STATES;
                    add(row, column, interval.by_states[local * POINTS * STATES + c]);
                }
            }
        }
    }
    let last = layout.node(3);
    for (row, (nu, weight)) in ENDS.iter().zip(mesh.nu.iter().zip(&mesh.work.end_weights)) {
        let missed: f64 = (0..STATES).map(|i| row[i] * (mesh.w[last + i] - task.problem.end.x[i])).sum();
        for i in 0..STATES {
            (0..=i).for_each(|j| add(last + i, last + j, weight * row[i] * row[j]));
            right[last + i] -= row[i] * (nu + weight * missed);
        }
    }
    let (curvature, force) = mesh.barrier(time);
    add(time, time, curvature + damping);
    right[time] -= force + task.time_weight();
    add(1, 1, damping);
    for i in [0, 2] {
        // Fixed at the start.
        matrix.row_mut(i).fill(0.0);
        matrix.column_mut(i).fill(0.0);
        matrix[(i, i)] = 1.0;
        right[i] = 0.0;
    }
    let solved = matrix.lu().solve(&right).unwrap();
    (solved.rows(0, count).into_owned(), solved.rows(count, rows).into_owned())
}

fn compare(task: &Task, mesh: &Interior, damping: f64) {
    let (step, lambda) = dense(task, mesh, damping);
    for (name, found, expected) in
        [("step", &mesh.work.step, &step), ("multipliers", &mesh.work.lambda, &lambda)]
    {
        let largest = expected.amax();
        for (i, (found, expected)) in found.iter().zip(expected.iter()).enumerate() {
            assert!((found - expected).abs() < 1e-9 * largest, "{name} {i}: {found} {expected}");
        }
    }
    assert_eq!(mesh.ends.len(), ENDS.len());
    for (i, row) in ENDS.iter().enumerate() {
        let last = mesh.layout.node(3);
        let change: f64 = (0..STATES).map(|k| row[k] * mesh.work.step[last + k]).sum();
        let nu = mesh.nu[i] + mesh.work.end_weights[i] * (mesh.missed(i) + change);
        assert!((mesh.work.nu[i] - nu).abs() < 1e-6 * nu.abs().max(1.0), "{} {nu}", mesh.work.nu[i]);
    }
}

#[test]
fn a_step_is_that_of_the_dense_equations() {
    for seed in 0..5 {
        let (task, mut mesh) = random(seed);
        assert_eq!(mesh.find_step(&task), Ok(()));
        assert!(mesh.definite);
        compare(&task, &mesh, 0.0);
    }
}

#[test]
fn a_damped_step_is_that_of_the_dense_equations() {
    let (task, mut mesh) = random(7);
    let size = STATES + CONTROLS;
    for hessian in mesh.intervals[1].hessian.chunks_exact_mut(size * size) {
        (0..size).for_each(|i| hessian[i * size + i] -= 20.0);
    }
    assert_eq!(mesh.find_step(&task), Ok(()));
    assert!(!mesh.definite && mesh.damping > 0.0);
    compare(&task, &mesh, mesh.damping);
}

/// States that the defects do not determine, or a Hessian that is no number, are told apart.
#[test]
fn what_no_damping_mends_is_told() {
    let (task, mut mesh) = random(3);
    mesh.intervals[1].by_states.fill(0.0);
    assert_eq!(mesh.find_step(&task), Err(Status::Singular));
    let (task, mut mesh) = random(3);
    mesh.intervals[1].hessian[0] = f64::NAN;
    assert_eq!(mesh.find_step(&task), Err(Status::NewtonFailed));
}
