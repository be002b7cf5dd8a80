//! The direct method: motions as piecewise polynomials, torques from inverse dynamics, limits by an
//! interior-point method.

mod basis;
mod ends;
mod interior;
mod limits;
mod points;
mod refine;
mod running;
mod spline;
mod system;

#[cfg(test)]
mod experiments;
