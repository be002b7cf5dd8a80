//! How the direct method tells a saddle from a minimum (`direct::interior::inertia`) and leaves it
//! (`direct::solve::saddle`).

/// How stiff active limits are at most, one after the other, where rounding of stiffer ones may hide a
/// minimum: in parts of the cost, for a limit of weight and range one.
pub const SOFTNESSES: [f64; 3] = [1e9, 1e7, 1e5];
/// It goes this part of the extent of the motion away, ..
pub const FIRST_PART: f64 = 0.25;
/// .. or half of that, and so on, at most so many times, while a half costs less than the whole. ..
pub const TRIALS: usize = 12;
/// .. Limits may be exceeded there by this part of their ranges, where the search goes on; ..
pub const OFF: f64 = 1e-2;
/// .. and by this where it is said that a motion there costs less.
pub const LEAST_OFF: f64 = 1e-4;
/// A saddle is as good as a minimum where a motion beside it costs less by this part of the tolerance at
/// most.
pub const FLAT: f64 = 0.1;
/// The direction is found by so many steps of inverse iteration, ..
pub const INVERSE_ITERATIONS: usize = 8;
/// .. with a damping that is bisected so many times.
pub const BISECTIONS: usize = 5;
/// Most saddles that are left one after the other; all but the last cost less than the one before by more
/// than [`FLAT`] tolerances.
pub const MOST: usize = 8;
/// Most times that saddles which show on a finer mesh alone are left, to compare with a finer one again.
pub const FROM_FINER_MESHES: usize = 2;
