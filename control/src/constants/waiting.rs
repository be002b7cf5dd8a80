//! Guesses of long motions, which rest in between (`direct::solve::waiting`).

/// A motion is a long one where holding the robot at the start, in the middle (four times) and at the end
/// costs so many times what the accelerations at start and end do: its time is then about 1.8 times the one
/// that the way would take by itself.
pub const SLOW: f64 = 30.0;
/// A guess that rests in between costs at most this part of the straight one.
pub const CHEAPER: f64 = 0.9;
/// It keeps this part of the ranges of limits.
pub const ROOM: f64 = 0.05;
/// Rates of its ways are at most this part of their limits.
pub const OF_RATES: f64 = 0.9;
/// How many times of a way are tried..
pub const TIMES: u32 = 24;
/// .. so many powers of two apart..
pub const OCTAVES: f64 = 0.25;
/// .. from this part of the whole time on.
pub const LONGEST: f64 = 0.4;
/// Intervals of a way..
pub const INTERVALS: usize = 4;
/// .. and the factor from one interval of the rest to the next one, away from its ends.
pub const WIDER: f64 = 2.0;

/// The search for poses in which it costs little to rest.
pub mod rest_pose {
    /// First damping, in parts of the diagonal of the matrix.
    pub const DAMPING: f64 = 1e-3;
    /// Largest one.
    pub const MOST_DAMPING: f64 = 1e10;
    /// Its factor after a step that was taken, ..
    pub const LESS: f64 = 0.1;
    /// .. and after one that was not.
    pub const MORE: f64 = 10.0;
    /// Diagonal entries count as at least this part of the largest one.
    pub const LEAST_CURVATURE: f64 = 1e-9;
    /// Most steps.
    pub const STEPS: usize = 60;
    /// Steps that are shorter end the search (rad, m).
    pub const STILL: f64 = 1e-6;
}
