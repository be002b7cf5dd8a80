//! Random computations: simplification keeps their values.

use crate::expr::{at, recorded};
use costate::scalar::Scalar;
use costate_test_support::properties;
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
fn near_a_selection(x: &[f64; 3], values: &[f64], steps: &[(u8, usize, usize, f64)]) -> Vec<bool> {
    let values: Vec<f64> = x.iter().chain(values).copied().collect();
    let mut unsure = vec![false; 3];
    for &(kind, a, b, _) in steps {
        let (a, b) = (a % unsure.len(), b % unsure.len());
        let near = (values[a] - values[b]).abs() <= 1e-8 * (1.0 + values[a].abs() + values[b].abs());
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
        let (found, expected) = (at(&program, &x), run(x, &steps));
        let unsure = near_a_selection(&x, &expected, &steps);
        let mut size = 1.0_f64;
        for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
            size = size.max(expected.abs());
            prop_assume!(size < 1e6);
            let agree = (found - expected).abs() <= 1e-9 * size;
            prop_assert!(unsure[k] || agree, "step {k}: {found} is not {expected}");
        }
    }
}
