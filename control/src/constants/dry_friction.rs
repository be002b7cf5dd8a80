//! Guesses of joints that rest for a part of the time (`direct::solve::dry_friction`).

/// A joint waits if its way takes less than this part of the time.
pub const SHORTER: f64 = 0.95;
/// Shares of the time that is left after which joints begin to move: early, late, in the middle.
pub const SHARES: [f64; 3] = [0.0, 1.0, 0.5];
/// A guess that waits costs at most this part of that before: less may be the error of a coarse mesh.
pub const CHEAPER: f64 = 0.999;
/// It keeps this part of the ranges of limits.
pub const ROOM: f64 = 0.05;
/// Rates of its ways are at most this part of their limits.
pub const OF_RATES: f64 = 0.9;
/// How many times of a way are tried ..
pub const TIMES: u32 = 64;
/// .. so many powers of two apart.
pub const OCTAVES: f64 = 0.125;
/// Nodes that are closer than this are one (parts of a phase).
pub const SAME: f64 = 1e-6;
