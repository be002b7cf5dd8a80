//! Where limits give in the direct method: its elastic phase, and slower motions
//! ([`crate::direct::interior::relaxation`]).

/// Steps in which the largest violation of a limit does not fall..
pub const PATIENCE: usize = 40;
/// .. below this part of what it was, before the elastic phase is entered.
pub const PROGRESS: f64 = 0.9;
/// Most elastic phases.
pub const RESTORATIONS: usize = 3;
/// It begins at the first guess if that violates limits less, and the iterate by more than this part of a
/// range.
pub const WILD: f64 = 0.5;
/// Room of limits at the start of the elastic phase, in parts of ranges and of what they must give, and
/// the gap there in parts of cost and price..
pub const COLD: (f64, f64) = (0.3, 0.1);
/// .. and near a minimum of a coarser mesh.
pub const WARM: (f64, f64) = (0.02, 1e-3);
/// Price of what limits give, of all of a range, in parts of the cost..
pub const PRICE: f64 = 100.0;
/// .. and the factor by which it rises..
pub const DEARER: f64 = 100.0;
/// .. so that at most so many prices are tried, ..
pub const PRICES: usize = 3;
/// .. until what limits give is more than this part of what it was.
pub const SAME_PRICE: f64 = 0.95;
/// Around zero the price is rounded by this, in parts of ranges.
pub const ROUNDED_PRICE: f64 = 1e-3;
/// Slacks after the elastic phase and in it are at least this part of a range.
pub const LEAST_ROOM: f64 = 1e-3;
/// The elastic problem is solved to this part of its cost..
pub const PRECISION: f64 = 1e-3;
/// .. in at most so many steps.
pub const STEPS: usize = 200;
/// Equations may be left off by this part of their range: Newton's method mends that.
pub const OFF_EQUATIONS: f64 = 1e-3;
/// Meshes of the elastic phase, ..
pub const MESHES: usize = 4;
/// .. each with intervals of half the width, until what limits give is more than this part of what it
/// was.
pub const SAME_RELIEF: f64 = 0.8;
/// Finer meshes than this are not divided in the elastic phase.
pub const INTERVALS: usize = 100;
/// Limits that give are told if that is more than this part of what another one gives.
pub const NOTICED_RELIEF: f64 = 1e-2;
/// A motion that cannot keep its limits is tried in these multiples of its time..
pub const SLOWER: [f64; 8] = [1.2, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0];
/// .. before its time is minimised with this cost of it, in parts of the cost.
pub const HURRY: f64 = 100.0;
