//! Motions of robots with floating and spherical joints ([`crate::free_motions`]).

/// Steps between the places of the first guess.
pub const PLACES: usize = 60;
/// A quaternion of the start or end has length 1 if its square differs from 1 by no more than this; what
/// remains is rounding of printed digits, and is divided out. The dynamics, and `costate eval`, divide
/// nothing and take 1e-9: they may refuse a q that a problem takes.
pub const UNIT: f64 = 1e-6;
/// Momenta and positions that nothing changes may be off by this part of their size, and of 1 in their unit.
pub const KEPT: f64 = 1e-6;
/// A motion with wider limits of torques, which tells what they lack, is solved to this tolerance.
pub const ROUGH: f64 = 1e-3;
/// Limits become narrower so many times, ..
pub const TRIALS: usize = 6;
/// .. or until the motion needs no more than this times those with which none was found.
pub const NEAR: f64 = 1.05;
/// A node belongs to the interval before it: an integration begins this part of an interval after it.
pub const INSIDE: f64 = 1e-12;
