//! How the direct method leaves a saddle (`direct::solve::saddle`).

/// It goes this part of the extent of the motion away, ..
pub const FIRST_PART: f64 = 0.25;
/// .. or half of that, and so on, so many times, where that does not cost less. ..
pub const TRIALS: usize = 12;
/// .. Limits may be exceeded there by this part of their ranges.
pub const OFF: f64 = 1e-2;
/// The direction is found by so many steps of inverse iteration, ..
pub const INVERSE_ITERATIONS: usize = 8;
/// .. with a damping that is bisected so many times.
pub const BISECTIONS: usize = 5;
/// Most saddles that are left.
pub const MOST: usize = 2;
