//! The coefficients of a path, and which of them are unknowns.

use super::spline::Basis;
use crate::problem::Problem;

/// The coefficients of a path and its duration T (s).
#[derive(Clone, Debug)]
pub(crate) struct Unknowns {
    pub theta: Vec<f64>,
    pub time: f64,
}

/// A coefficient of one joint: `constant + slope T`, plus an unknown if there is one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub unknown: Option<usize>,
    constant: f64,
    /// A given rate v at an end moves the coefficient next to the end by `v T / (3 N)`.
    pub slope: f64,
}

/// Places of all coefficients: entry `k n + j` for coefficient k of joint j.
#[derive(Clone, Debug)]
pub(crate) struct Coefficients {
    pub places: Vec<Place>,
    /// Number of unknowns.
    pub count: usize,
}

impl Coefficients {
    /// Positions and rates that the ends fix are not unknowns.
    pub fn new(problem: &Problem, basis: &Basis) -> Self {
        let (n, last) = (problem.robot.dof(), basis.len() - 1);
        let mut places = vec![Place { unknown: None, constant: 0.0, slope: 0.0 }; basis.len() * n];
        let mut count = 0;
        let mut next = || {
            count += 1;
            Some(count - 1)
        };
        let step = 1.0 / (3.0 * basis.intervals as f64);
        let (start, end) = (&problem.start, &problem.end);
        for k in 0..basis.len() {
            for j in 0..n {
                let (at, beside, q, v, free, sign) = if k < 2 {
                    let free = (start.q_free.contains(&j), start.v_free.contains(&j));
                    (j, n + j, start.q[j], start.v[j], free, 1.0)
                } else {
                    let free = (end.q_free.contains(&j), end.v_free.contains(&j));
                    (last * n + j, (last - 1) * n + j, end.q[j], end.v[j], free, -1.0)
                };
                let slope = sign * v * step;
                let (q_free, v_free) = free;
                let here = k * n + j;
                places[here] = if (2..last - 1).contains(&k) {
                    Place { unknown: next(), constant: 0.0, slope: 0.0 }
                } else if here == at {
                    // With a given rate the two coefficients of a free position are one unknown.
                    let unknown = if !q_free {
                        None
                    } else if v_free || places[beside].unknown.is_none() {
                        next()
                    } else {
                        places[beside].unknown
                    };
                    Place { unknown, constant: if q_free { 0.0 } else { q }, slope: 0.0 }
                } else if v_free {
                    Place { unknown: next(), constant: 0.0, slope: 0.0 }
                } else if !q_free {
                    Place { unknown: None, constant: q, slope }
                } else {
                    let unknown = if here > at { places[at].unknown } else { next() };
                    Place { unknown, constant: 0.0, slope }
                };
            }
        }
        Self { places, count }
    }

    /// Value of coefficient `place` for unknowns theta and a duration.
    pub fn value(&self, place: usize, theta: &[f64], time: f64) -> f64 {
        let Place { unknown, constant, slope } = self.places[place];
        unknown.map_or(0.0, |unknown| theta[unknown]) + constant + slope * time
    }

    /// Unknowns for given coefficients.
    pub fn unknowns(&self, mut value: impl FnMut(usize) -> f64) -> Vec<f64> {
        let mut theta = vec![0.0; self.count];
        for (place, of) in self.places.iter().enumerate() {
            if let Some(unknown) = of.unknown
                && of.slope == 0.0
            {
                theta[unknown] = value(place);
            }
        }
        theta
    }
}
