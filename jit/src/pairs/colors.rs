//! Colours of steps: equal for steps that compute the same from inputs of any position.

use super::terms::Sums;
use crate::step::{Op, Steps};

/// Bits of a constant that do not count: sums in another order differ there.
const ROUNDED: u32 = 24;

/// A number that depends on both, and on their order.
fn mixed(a: u64, b: u64) -> u64 {
    let product =
        u128::from(a ^ 0x9e37_79b9_7f4a_7c15) * u128::from(b.rotate_left(23) ^ 0xd6e8_feb8_6659_fd93);
    (product as u64) ^ ((product >> 64) as u64).rotate_left(29) ^ a.rotate_left(7)
}

/// Colours of all steps that are heads. They depend on operations and on the magnitudes of constants, not on
/// the order of terms and factors.
///
/// The numbers of a left and a right side differ in sign at most, so mirror images have equal colours; steps
/// that differ in constants only have different ones.
pub(super) fn colors(program: &Steps, sums: &Sums) -> Vec<u64> {
    let mut colors: Vec<u64> = vec![0; program.steps.len()];
    for (k, step) in program.steps.iter().enumerate().filter(|(k, _)| sums.heads[*k] == *k) {
        let own = step.op as u64;
        colors[k] = match step.op {
            Op::Constant => {
                let magnitude = program.constants[step.operands[0] as usize][0].abs().to_bits();
                mixed(own, magnitude.wrapping_add(1 << (ROUNDED - 1)) >> ROUNDED)
            }
            _ if !sums.terms[k].is_empty() => {
                let color = |term: &super::terms::Term| {
                    let mut factors: Vec<u64> = term.factors.iter().map(|f| colors[f.value]).collect();
                    factors.sort_unstable();
                    factors.into_iter().fold(u64::from(term.negative), mixed)
                };
                sums.terms[k].iter().map(color).fold(1, u64::wrapping_add)
            }
            _ => {
                let mut operands: Vec<u64> = step.operands().map(|value| colors[value]).collect();
                if step.op == Op::Mul {
                    operands.sort_unstable();
                }
                operands.into_iter().fold(own, mixed)
            }
        };
    }
    colors
}
