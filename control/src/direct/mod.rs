//! The direct method: motions as piecewise polynomials, torques from inverse dynamics, limits by an
//! interior-point method.

mod basis;
mod ends;
mod interior;
mod limits;
mod metric;
mod points;
mod refine;
mod running;
mod search;
mod spline;
mod step;
mod system;

#[cfg(test)]
mod experiments;
