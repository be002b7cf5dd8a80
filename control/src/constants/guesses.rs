//! Guesses that are looked at (`direct::solve::looks`).

/// Most steps of a look.
pub const STEPS: usize = 40;
/// A guess that seems dearer is given up after so many of them, even where damping hides what is still to be
/// gained.
pub const PATIENT: usize = 12;
/// Most detours around obstacles that are looked at, beside the motion without obstacles, ..
pub const LOOKS: usize = 2;
/// .. and most other positions of the joints where torques cost. With 2 of them 8 of 120 random poses, places
/// and axes of a UR5 cost 3 to 14 % more than the best of 16 starts, with 3 and 4 of them 3 cost 1 to 3 % more.
pub const POSITIONS: usize = 4;
/// Another position of the joints is looked at if the straight motion there costs less than this part of
/// that of the start, ..
pub const PROMISING: f64 = 1.5;
/// .. and exceeds limits by no more than this part of their ranges. The rate of a cubic from rest to rest is
/// at most 3/2 of its mean, so one whose mean is at a limit exceeds it by a quarter of the range from minus
/// to plus the limit; its largest acceleration is 3/2 of what the way takes at least. ..
pub const EXCEEDED_BY_CUBICS: f64 = 0.25;
/// .. and a detour around obstacles if it costs less than this many times as much.
pub const DETOUR: f64 = 3.0;
/// A guess that exceeds limits by less than this part of their ranges exceeds none.
pub const EXCEEDED: f64 = 0.06;
/// Disturbed guesses with other positions that are looked at besides, where places leave joints free.
pub const DRAWN: usize = 3;
/// Disturbed guesses that are tried where all of these end at obstacles.
pub const DETOURS: usize = 4;
/// Waves in the joints (rad, m).
pub const BENDS: [f64; 2] = [0.6, 1.2];
/// A guess whose time makes this part of its cost is one of least time, ..
pub const MOSTLY_TIME: f64 = 0.5;
/// .. of which so many positions are looked at beside its own, those that are reached soonest: as many as the
/// signs of shoulder, elbow and wrist of an arm with a spherical wrist make. ..
pub const BRANCHES: usize = 8;
/// .. Positions that differ by less in all joints are the same (rad, m).
pub const SAME_POSITION: f64 = 1e-2;
