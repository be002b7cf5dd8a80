//! Guesses that are looked at (`direct::solve::looks`).

/// Most steps of a look.
pub const STEPS: usize = 40;
/// A guess that seems dearer is given up after so many of them, even where damping hides what is still to be
/// gained.
pub const PATIENT: usize = 12;
/// Most detours around obstacles that are looked at, beside the motion without obstacles.
pub const LOOKS: usize = 2;
/// Most other positions of the joints that are looked at where torques cost. Fewer lose cheaper motions of a
/// UR5, more win none: `cargo test --release -p costate-control --test control -- --ignored random_poses`.
pub const POSITIONS: usize = 8;
/// Another position of the joints is looked at if the straight motion there costs less than this part of
/// that of the start, and exceeds limits by no more than [`EXCEEDED_BY_CUBICS`].
pub const PROMISING: f64 = 1.5;
/// Another position of the joints is looked at if the straight motion there exceeds limits by no more than
/// this part of their ranges, or by no more than that of the start does. The rate of a cubic from rest to
/// rest is at most 3/2 of its mean: one whose mean is at a limit exceeds it by a quarter of the range from
/// minus to plus the limit. Its largest acceleration is 3/2 of what the way takes at least.
pub const EXCEEDED_BY_CUBICS: f64 = 0.25;
/// A detour around obstacles is looked at if it costs less than this many times as much.
pub const DETOUR: f64 = 3.0;
/// A guess that exceeds limits by less than this part of their ranges exceeds none.
pub const EXCEEDED: f64 = 0.06;
/// Disturbed guesses with other positions that are looked at besides, where places leave joints free.
pub const DRAWN: usize = 3;
/// Disturbed guesses that are tried where all of these end at obstacles.
pub const DETOURS: usize = 4;
/// Waves in the joints (rad, m).
pub const BENDS: [f64; 2] = [0.6, 1.2];
/// A guess whose time makes this part of its cost is one of least time.
pub const MOSTLY_TIME: f64 = 0.5;
/// Most positions of the joints that are looked at beside that of a guess of least time, those that are
/// reached soonest: as many as the signs of shoulder, elbow and wrist of an arm with a spherical wrist make.
pub const BRANCHES: usize = 8;
