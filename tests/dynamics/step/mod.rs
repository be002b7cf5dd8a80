//! Steps in time: derivatives, structure, orders, failures, scalars.

mod derivatives;
mod failures;
mod schemes;
mod structure;

use costate::derivative::largest;
use costate::matrix::Block;
use costate::robot::Robot;
use costate::scalar::{Count, Scalar, Tangent};
use costate::step::{ModelFamily, Scheme, Step, StepError};
use costate_test_support::rounding::{apart, bound, lift};
use proptest::test_runner::TestCaseError;

fn flat(block: Block<'_, f64>) -> Vec<f64> {
    block.iter_rows().flatten().copied().collect()
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

/// The end of a step whose equations are solved to rounding: dual numbers take one more iteration of Newton's
/// method, which changes nothing else. As in `costate check`, other cases say nothing.
fn solved<F: ModelFamily, M: Scheme<F>>(
    family: &F,
    [x, u]: [&[f64]; 2],
    h: f64,
) -> Result<Vec<f64>, TestCaseError> {
    fn end<F: ModelFamily, M: Scheme<F>, S: Scalar>(
        family: &F,
        [x, u]: [&[f64]; 2],
        h: f64,
    ) -> Result<Vec<S>, TestCaseError> {
        let mut step = M::step::<S>(family.model());
        Ok(made(step.evaluate(&lift(x), &lift(u), S::from_f64(h)))?.to_vec())
    }
    let found = end::<F, M, f64>(family, [x, u], h)?;
    let again: Vec<f64> = end::<F, M, Tangent<f64>>(family, [x, u], h)?.iter().map(|x| x.re).collect();
    let rounded = end::<F, M, Count>(family, [x, u], h)?;
    if largest(&apart(&found, &again)) <= 2.0 * bound(&rounded) {
        return Ok(found);
    }
    Err(TestCaseError::reject("the step is not solved to rounding"))
}

fn robot(name: &str) -> Robot {
    Robot::from_file(format!("{}/robots/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// (q, p) of the two-link arm on a free swing, and no control.
const SWING: [f64; 4] = [0.3, -0.8, 1.0, 0.5];
const FREE: [f64; 2] = [0.0; 2];
