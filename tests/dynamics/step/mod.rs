//! Steps in time: derivatives, structure, orders, failures, scalars.

mod derivatives;
mod failures;
mod schemes;
mod structure;

use costate::derivative::largest;
use costate::matrix::Block;
use costate::robot::Robot;
use costate::step::StepError;
use proptest::test_runner::TestCaseError;

fn flat(block: Block<'_, f64>) -> Vec<f64> {
    block.iter_rows().flatten().copied().collect()
}

/// A block with the zeros that are so by structure, `rows` x `columns`.
fn filled(block: Option<Block<'_, f64>>, rows: usize, columns: usize) -> Vec<f64> {
    let Some(block) = block else { return vec![0.0; rows * columns] };
    block.iter_rows().flat_map(|row| [row, &vec![0.0; columns - row.len()]].concat()).collect()
}

/// `max |a - b| / max(max |b|, natural)`.
fn off(found: &[f64], expected: &[f64], natural: f64) -> f64 {
    assert_eq!(found.len(), expected.len());
    let differences: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
    let worst = largest(&differences);
    if worst == 0.0 { 0.0 } else { worst / largest(expected).max(natural) }
}

/// A step that was made. Where M is nearly singular, forces make steps of 0.01 s too long for Newton's
/// method: such a case, about one in 100 000, says nothing.
fn made<T, E: std::error::Error>(step: Result<T, StepError<E>>) -> Result<T, TestCaseError> {
    step.map_err(|error| match error {
        StepError::NotConverged { .. } => TestCaseError::reject("a shorter step is needed"),
        error => TestCaseError::fail(error.to_string()),
    })
}

fn robot(name: &str) -> Robot {
    Robot::from_file(format!("{}/robots/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// (q, p) of the two-link arm on a free swing, and no control.
const SWING: [f64; 4] = [0.3, -0.8, 1.0, 0.5];
const FREE: [f64; 2] = [0.0; 2];
