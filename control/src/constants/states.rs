//! The direct method for models of a user ([`crate::direct_states`]). It shares with [`super::direct`] what
//! both need: the filter, the descent that is asked for, narrowest intervals, verification.

/// Intervals of the first mesh.
pub const INTERVALS: usize = 20;
/// Most meshes.
pub const MESHES: usize = 14;
/// How often a motion that fails between its points is solved again on a finer mesh.
pub const ROUNDS: usize = 3;
/// The problem on a mesh is solved to this part of the tolerance.
pub const PART_OF_TOLERANCE: f64 = 0.05;
/// First barrier, in parts of the size of the cost along the guess, ..
pub const BARRIER: f64 = 1.0;
/// .. that on later meshes, ..
pub const WARM: f64 = 1e-3;
/// .. and the last one: all logarithms together cost at most this part of the tolerance of the mesh.
pub const LEAST_BARRIER: f64 = 0.1;
/// The barrier falls when the error of its problem is below this many times the barrier, ..
pub const CENTRED: f64 = 10.0;
/// .. by this factor, ..
pub const BARRIER_DOWN: f64 = 0.2;
/// .. or to this power where that is less.
pub const BARRIER_POWER: f64 = 1.2;
/// A step goes at least this part of the way to a limit (Waechter and Biegler, equation 8).
pub const BOUNDARY: f64 = 0.99;
/// Part of a range, or of the size of a limit, that a guess keeps from it; ..
pub const ROOM: f64 = 0.01;
/// .. on later meshes.
pub const WARM_ROOM: f64 = 1e-5;
/// Weight of the squares of what fixed ends are missed by, in parts of the cost over the square of the size
/// of the component: their multipliers converge by about the reciprocal of it in a step.
pub const END_WEIGHT: f64 = 1e7;
/// The cost counts as at least this, in parts of its size along the guess.
pub const LEAST_COST: f64 = 1e-4;
/// Multipliers of this size count as one in the error of stationarity.
pub const LARGE_MULTIPLIERS: f64 = 100.0;
/// Damping of a Hessian that is not positive definite rises by this factor, ..
pub const DAMPING_UP: f64 = 8.0;
/// .. from the last one divided by this, ..
pub const DAMPING_DOWN: f64 = 3.0;
/// .. to at most this.
pub const MOST_DAMPING: f64 = 1e12;
/// Infeasibility below which cost and barrier must descend where a step promises that.
pub const NEARLY_FEASIBLE: f64 = 1e-4;
/// Infeasibility that is rounding.
pub const FEASIBLE: f64 = 1e-11;
/// Shortest part of a step that is tried.
pub const SHORTEST: f64 = 1e-8;
/// Most corrections of second order of a step; ..
pub const CORRECTIONS: usize = 4;
/// .. the next one only if the last one leaves at most this part of the infeasibility.
pub const CORRECTED: f64 = 0.99;
/// Times that multipliers begin anew where no step is accepted; ..
pub const RESTARTS: usize = 5;
/// .. with this many times the barrier.
pub const RESTART_BARRIER: f64 = 10.0;
/// Where no step is accepted, the iterate counts as solved within this many times the tolerance: the rest
/// is rounding.
pub const ACCEPTABLE: f64 = 100.0;
/// Sizes of components of x count as at least this.
pub const LEAST_SIZE: f64 = 1e-3;
/// Largest excess of a limit of x between points, in parts of the size of the component.
pub const EXCESS: f64 = 1e-4;
/// An interval is divided into [`MORE`] (error / allowed)^ORDER parts: errors fall with the fourth power of
/// its width.
pub const ORDER: f64 = 0.25;
/// Somewhat more parts than that takes.
pub const MORE: f64 = 1.2;
/// Intervals are divided until their estimated errors of the cost are this part of the tolerance together.
pub const ENOUGH: f64 = 0.3;
/// Ends that are missed by less than this part of the size of their component are met.
pub const MET: f64 = 1e-9;
/// Newton steps for which room is made on a mesh at once.
pub const MOST_RESERVED: usize = 1000;
