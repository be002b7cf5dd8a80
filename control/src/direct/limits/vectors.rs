//! Loops over arrays of entries with the widest vectors of the processor.

use crate::numerics::padded::LANES;

/// Whether an entry is a limit that counts, by its slack.
#[inline(always)]
pub(super) fn is_limit(slack: f64) -> bool {
    (slack > 0.0) & (slack < f64::INFINITY)
}

/// Runs `$body` with vectors of the arrays, then with one entry at a time for the rest: `$n` is their length.
macro_rules! for_vectors {
    ($at:ident in $count:expr, $n:ident => $body:expr) => {
        widest_fused(
            #[inline(always)]
            |_| {
                let (mut $at, count) = (0, $count);
                while $at + LANES <= count {
                    const $n: usize = LANES;
                    $body;
                    $at += LANES;
                }
                while $at < count {
                    const $n: usize = 1;
                    $body;
                    $at += 1;
                }
            },
        )
    };
}
pub(super) use for_vectors;

/// `N` entries of an array.
#[inline(always)]
pub(super) fn part<const N: usize>(array: &[f64], at: usize) -> [f64; N] {
    let mut part = [0.0; N];
    part.copy_from_slice(&array[at..at + N]);
    part
}

/// Sums or largest values of lanes.
#[derive(Clone, Copy)]
pub(super) struct Lanes([f64; LANES]);

impl Lanes {
    #[inline(always)]
    pub fn zeros() -> Self {
        Self([0.0; LANES])
    }

    #[inline(always)]
    pub fn add<const N: usize>(&mut self, values: [f64; N]) {
        self.0.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
    }

    #[inline(always)]
    pub fn keep_largest<const N: usize>(&mut self, values: [f64; N]) {
        self.0
            .iter_mut()
            .zip(values)
            .for_each(|(most, value)| *most = if value > *most { value } else { *most });
    }

    pub fn sum(self) -> f64 {
        self.0.iter().sum()
    }

    pub fn largest(self) -> f64 {
        self.0.into_iter().fold(0.0, f64::max)
    }
}
