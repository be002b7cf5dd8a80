//! Running costs of the distance from references over time.

use super::check_references::given;
use super::functions::{PathFunction, TaskFunctions};
use super::turns::Turns;
use crate::numerics::knots::Knots;
use crate::problem::references::{Reference, ToolReference};
use crate::problem::tools::Tool;
use costate::EvalError;
use nalgebra::Vector3;

/// `l(t, q) = 1/2 sum_k w_k (g_k(q) - r_k(t))^2`, and the same of angles of orientations, with all
/// derivatives up to the second ones; no call allocates.
#[derive(Clone, Debug)]
pub(crate) struct References {
    /// One for each reference.
    tracks: Vec<Track>,
    /// Positions, then orientations of each tool.
    functions: TaskFunctions,
    /// The time at which the motion starts (s).
    pub start: f64,
    dof: usize,
    g: Vec<f64>,
    /// `w_k (g_k - r_k)`.
    slopes: Vec<f64>,
    /// w_k.
    weights: Vec<f64>,
    /// c_k in `l_xt = sum_k w_k c_k g_k,x`: derivatives of `g_k - r_k` by the time, but of orientations
    /// angular velocities.
    rates: Vec<f64>,
    /// rows x 2n.
    jacobian: Vec<f64>,
    pub found: Tracking,
}

/// l and its derivatives in t and x = (q, v).
#[derive(Clone, Debug, Default)]
pub(crate) struct Tracking {
    /// l, in cost per second.
    pub value: f64,
    /// l_t and l_tt.
    pub by_time: [f64; 2],
    /// l_x, 2n.
    pub gradient: Vec<f64>,
    /// l_xt, 2n.
    pub mixed: Vec<f64>,
    /// l_xx, 2n x 2n.
    pub hessian: Vec<f64>,
}

#[derive(Clone, Debug)]
enum Track {
    Joints { knots: Knots, weights: Vec<f64> },
    Tool { tool: Tool, position: Option<Position>, orientation: Option<Orientation> },
}

/// A reference of the position of a tool.
#[derive(Clone, Debug)]
struct Position {
    knots: Knots,
    /// Its coordinates that are given have rows from the first one on.
    given: [bool; 3],
    first: usize,
    weight: f64,
}

/// A reference of the orientation of a tool: three rows, e = log(R_r'R).
#[derive(Clone, Debug)]
struct Orientation {
    turns: Turns,
    first: usize,
    /// The part that computes them.
    part: usize,
    weight: f64,
}

/// A reference that cannot take the place of another one: of something else, or with other coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OtherKind;

impl References {
    /// Those of a task for n joints; `functions` are those of their tools
    /// ([`TaskRows`](super::build::TaskRows)).
    pub fn new(references: &[Reference], functions: TaskFunctions, n: usize) -> Self {
        let (mut row, mut part) = (0, 0);
        let mut of_tool = |reference: &ToolReference| {
            let (given, first) = (given(reference), row);
            row += given.iter().filter(|given| **given).count();
            let knots =
                |rows: &Vec<[f64; 3]>| Knots::new(3, &reference.times, rows, reference.velocities.as_deref());
            let position = reference.positions.as_ref().filter(|_| row > first).map(|rows| {
                part += 1;
                Position { knots: knots(rows), given, first, weight: reference.position_weight }
            });
            let orientation = reference.orientations.as_ref().map(|rotations| {
                (row, part) = (row + 3, part + 1);
                let turns = Turns::new(&reference.times, rotations);
                Orientation { turns, first: row - 3, part: part - 1, weight: reference.orientation_weight }
            });
            Track::Tool { tool: reference.tool.clone(), position, orientation }
        };
        let track = |reference: &Reference| match reference {
            Reference::Joints(joints) => Track::Joints {
                knots: Knots::new(n, &joints.times, &joints.positions, joints.velocities.as_deref()),
                weights: joints.weights.clone(),
            },
            Reference::Tool(tool) => of_tool(tool),
        };
        let tracks = references.iter().map(track).collect();
        let list = |length: usize| vec![0.0; length];
        let count = functions.rows();
        Self {
            tracks,
            functions,
            start: 0.0,
            dof: n,
            g: list(count),
            slopes: list(count),
            weights: list(count),
            rates: list(count),
            jacobian: list(2 * n * count),
            found: Tracking {
                gradient: list(2 * n),
                mixed: list(2 * n),
                hessian: list(4 * n * n),
                ..Tracking::default()
            },
        }
    }

    /// Whether there are any.
    pub fn any(&self) -> bool {
        !self.tracks.is_empty()
    }

    /// Their number.
    pub fn count(&self) -> usize {
        self.tracks.len()
    }

    /// The first knot of any reference after a time since the start of the motion (s); infinite where there
    /// is none.
    pub fn next_knot(&self, time: f64) -> f64 {
        let time = self.start + time;
        let after = |times: &[f64]| times.get(times.partition_point(|&knot| knot <= time)).copied();
        let of_track = |track: &Track| match track {
            Track::Joints { knots, .. } => after(knots.times()),
            Track::Tool { position, orientation, .. } => {
                let knots = position.as_ref().and_then(|position| after(position.knots.times()));
                knots
                    .or_else(|| orientation.as_ref().and_then(|orientation| after(orientation.turns.times())))
            }
        };
        self.tracks.iter().filter_map(of_track).fold(f64::INFINITY, f64::min) - self.start
    }

    /// Puts a reference, which was checked, in the place of number `k`. Allocates only if it has more knots
    /// than any before it.
    ///
    /// # Errors
    /// [`OtherKind`], and nothing changes.
    pub fn set(&mut self, k: usize, reference: &Reference) -> Result<(), OtherKind> {
        match (&mut self.tracks[k], reference) {
            (Track::Joints { knots, weights }, Reference::Joints(joints)) => {
                knots.set(&joints.times, &joints.positions, joints.velocities.as_deref());
                weights.copy_from_slice(&joints.weights);
            }
            (Track::Tool { tool, position, orientation }, Reference::Tool(reference)) => {
                let before = position.as_ref().map_or([false; 3], |position| position.given);
                let turns = orientation.is_some() == reference.orientations.is_some();
                if *tool != reference.tool || before != given(reference) || !turns {
                    return Err(OtherKind);
                }
                if let (Some(position), Some(rows)) = (position, &reference.positions) {
                    position.knots.set(&reference.times, rows, reference.velocities.as_deref());
                    position.weight = reference.position_weight;
                }
                if let (Some(orientation), Some(rotations)) = (orientation, &reference.orientations) {
                    orientation.turns.set(&reference.times, rotations);
                    orientation.weight = reference.orientation_weight;
                }
            }
            _ => return Err(OtherKind),
        }
        Ok(())
    }

    /// l at a time since the start of the motion (s).
    ///
    /// # Errors
    /// Positions that are not finite.
    pub fn evaluate(&mut self, time: f64, q: &[f64]) -> Result<f64, EvalError> {
        self.follow(time, q)?;
        Ok(self.found.value)
    }

    /// l with all derivatives.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn contract(&mut self, time: f64, q: &[f64]) -> Result<&Tracking, EvalError> {
        self.follow(time, q)?;
        let Self { functions, dof, g, slopes, weights, rates, jacobian, found, .. } = self;
        if functions.is_empty() {
            return Ok(&self.found);
        }
        let width = 2 * *dof;
        functions.contract_at_rest(q, slopes, g, jacobian, &mut found.hessian)?;
        for (k, row) in jacobian.chunks_exact(width).enumerate() {
            for (i, &entry) in row.iter().enumerate().filter(|(_, entry)| **entry != 0.0) {
                found.gradient[i] += slopes[k] * entry;
                found.mixed[i] += weights[k] * rates[k] * entry;
                for (to, other) in found.hessian[width * i..].iter_mut().zip(row) {
                    *to += weights[k] * entry * other;
                }
            }
        }
        Ok(&self.found)
    }

    /// l, l_t, l_tt, what the joints have in the other derivatives, and the slopes of the rows.
    fn follow(&mut self, time: f64, q: &[f64]) -> Result<(), EvalError> {
        let (time, width) = (self.start + time, 2 * self.dof);
        let Self { tracks, functions, g, slopes, weights, rates, found, .. } = self;
        let Tracking { value, by_time, gradient, mixed, hessian } = found;
        (*value, *by_time) = (0.0, [0.0; 2]);
        for list in [&mut *gradient, mixed, hessian] {
            list.fill(0.0);
        }
        for track in &*tracks {
            if let Track::Tool { orientation: Some(orientation), .. } = track {
                functions.set_orientation(orientation.part, orientation.turns.at(time).rotation);
            }
        }
        if !functions.is_empty() {
            functions.values_at_rest(q, g)?;
        }
        // l, l_t, l_tt.
        let mut add = |terms: [f64; 3]| {
            *value += terms[0];
            by_time.iter_mut().zip(&terms[1..]).for_each(|(to, term)| *to += term);
        };
        for track in &*tracks {
            match track {
                Track::Joints { knots, weights } => {
                    for (i, &weight) in weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
                        let [reference, rate, bend] = knots.at(time, i);
                        add(square(weight, q[i] - reference, [rate, bend]));
                        gradient[i] += weight * (q[i] - reference);
                        mixed[i] -= weight * rate;
                        hessian[width * i + i] += weight;
                    }
                }
                Track::Tool { position, orientation, .. } => {
                    if let Some(Position { knots, given, first, weight }) = position {
                        for (row, k) in (*first..).zip((0..3).filter(|&k| given[k])) {
                            let [reference, rate, bend] = knots.at(time, k);
                            let off = g[row] - reference;
                            add(square(*weight, off, [rate, bend]));
                            (weights[row], slopes[row], rates[row]) = (*weight, weight * off, -rate);
                        }
                    }
                    if let Some(Orientation { turns, first, weight, .. }) = orientation {
                        let turn = turns.at(time);
                        let e = Vector3::new(g[*first], g[first + 1], g[first + 2]);
                        let rate = rate_of_error(&e, &turn.velocity);
                        let bend = rate.dot(&turn.velocity) + e.dot(&turn.acceleration);
                        add([0.5 * e.norm_squared(), -e.dot(&turn.velocity), -bend].map(|term| weight * term));
                        for k in 0..3 {
                            let row = first + k;
                            (weights[row], slopes[row]) = (*weight, weight * e[k]);
                            // From l_t = -w e . velocity.
                            rates[row] = -turn.velocity[k];
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

/// `1/2 w (g - r)^2` with its derivatives by the time, from `g - r` and the derivatives of r.
fn square(weight: f64, off: f64, [rate, bend]: [f64; 2]) -> [f64; 3] {
    [0.5 * off * off, -off * rate, rate * rate - off * bend].map(|term| weight * term)
}

/// Derivative of `e = log(R_r'R)` where R_r turns with the angular velocity w, in its own axes:
///
/// $$ e' = -\left( w - \tfrac12 e \times w + c \\, e \times (e \times w) \right), \qquad
///    c = \frac{1}{\theta^2} \left( 1 - \frac{\theta}{2} \cot \frac{\theta}{2} \right), \quad \theta = |e| $$
///
/// The part across e drops out of $e \cdot e' = -e \cdot w$.
fn rate_of_error(e: &Vector3<f64>, w: &Vector3<f64>) -> Vector3<f64> {
    let square = e.norm_squared();
    // The series has an error below rounding there.
    let c = if square < 1e-4 {
        1.0 / 12.0 + square / 720.0 + square * square / 30240.0
    } else {
        let half = 0.5 * square.sqrt();
        (1.0 - half / half.tan()) / square
    };
    let across = e.cross(w);
    -(w - 0.5 * across + c * e.cross(&across))
}

#[cfg(test)]
#[path = "references_tests.rs"]
mod tests;
