//! Random computations: simplification keeps their values.

use crate::expr::{at, recorded};
use costate::scalar::{Count, Scalar};
use costate_test_support::rounding::bound;
use costate_test_support::{properties, rounding};
use proptest::prelude::*;

/// A random straight-line computation: pairs of operands and their operations.
fn run<S: Scalar>(x: [S; 3], steps: &[(u8, usize, usize, f64)]) -> Vec<S> {
    let mut values = x.to_vec();
    for &(kind, a, b, c) in steps {
        let (a, b) = (values[a % values.len()], values[b % values.len()]);
        values.push(match kind {
            0 | 1 => a * b,
            2 => a + b,
            3 | 4 => a - b,
            5 => a.times(c),
            6 => a.plus(c),
            7 => -a,
            8 => a / (b * b).plus(1.0),
            9 => a.sin_cos().0 - b.sin_cos().1,
            10 => Scalar::tanh(a),
            11 => S::select(a.less(b), a, -b),
            12 => (a * a).plus(0.5).sqrt(),
            _ => a * b + a * a - b * a,
        });
    }
    values.split_off(3)
}

/// Whether a step depends on a selection between operands so near that rounding decides.
fn near_a_selection(x: &[Count; 3], values: &[Count], steps: &[(u8, usize, usize, f64)]) -> Vec<bool> {
    let values: Vec<Count> = x.iter().chain(values).copied().collect();
    let mut unsure = vec![false; 3];
    for &(kind, a, b, _) in steps {
        let (a, b) = (a % unsure.len(), b % unsure.len());
        let apart = values[a] - values[b];
        let near = apart.value().abs() <= 2.0 * bound(&[apart]);
        unsure.push(unsure[a] || unsure[b] || (kind == 11 && near));
    }
    unsure.split_off(3)
}

properties! {
    300;

    /// Simplification changes nothing but rounding.
    #[test]
    fn random_computations_keep_their_values(
        steps in prop::collection::vec(
            (0..14_u8, 0..40_usize, 0..40_usize, prop::sample::select(vec![-2.0, -1.0, 0.0, 0.5, 1.0, 3.0])), 1..30),
        x in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let program = recorded(|a, b, c| run([a, b, c], &steps));
        let counted = x.map(Count::variable);
        let unsure = near_a_selection(&counted, &run(counted, &steps), &steps);
        let expected = run(x, &steps);
        // Values beyond are about to overflow.
        prop_assume!(expected.iter().all(|value| value.abs() < 1e6));
        rounding!(|S| {
            let x = x.map(S::from_f64);
            let sure = at(&program, &x).into_iter().zip(run(x, &steps)).zip(&unsure);
            sure.filter(|(_, unsure)| !**unsure).map(|((a, b), _)| ("a step", vec![a - b])).collect()
        })?;
    }
}
