//! Random numbers of one motion: they depend on the seed of the study and the number of the motion alone.

use std::ops::Range;

/// The random numbers of one motion.
pub struct Draw(fastrand::Rng);

impl Draw {
    /// Those of motion `number`.
    pub fn new(seed: u64, number: usize) -> Self {
        // Odd constants of splitmix64 keep neighbouring numbers apart.
        let mixed = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15)
            ^ (number as u64 + 1).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        Self(fastrand::Rng::with_seed(mixed))
    }

    /// Evenly distributed.
    pub fn even(&mut self, range: Range<f64>) -> f64 {
        range.start + (range.end - range.start) * self.0.f64()
    }

    /// Evenly distributed in the logarithm.
    pub fn log(&mut self, range: Range<f64>) -> f64 {
        self.even(range.start.ln()..range.end.ln()).exp()
    }

    /// A whole number.
    pub fn whole(&mut self, range: Range<usize>) -> usize {
        self.0.usize(range)
    }

    /// True with this probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.0.f64() < probability
    }

    /// One of a list that is not empty.
    pub fn one<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.0.usize(0..list.len())]
    }

    /// n numbers, evenly distributed.
    pub fn list(&mut self, n: usize, range: Range<f64>) -> Vec<f64> {
        (0..n).map(|_| self.even(range.clone())).collect()
    }
}
