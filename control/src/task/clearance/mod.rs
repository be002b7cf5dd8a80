//! Clearances of spheres and capsules on links from obstacles in the world and from each other.
//!
//! Bodies are cores with a radius ([`cores`]). With the distance D of two cores and the sum R of their radii
//! and the margin, the clearance is
//!
//! $$ c = \sqrt 2 \sqrt{D^2 + R^2} - 2 R $$
//!
//! It is zero where the surfaces touch, grows there as the distance does, farther off up to $\sqrt 2$ times
//! as fast, and is analytic in $D^2$, also where the cores meet (D = 0, c = -0.59 R). How smooth $D^2$ is:
//!
//! - point and point: analytic;
//! - a segment or a box: twice differentiable except where the closest place reaches an end of the segment,
//!   an edge or a corner of the box. There the first derivatives are continuous and the second ones jump:
//!   those of one side are given. The closest place of a segment moves with the poses: its part of the second
//!   derivatives comes from the conditions for the minimum;
//! - two segments, a segment and a box: the closest place is made unique, so that this holds for parallel
//!   ones too. That lowers c by at most a thousandth of R;
//! - inside of a box D = 0 has no slope: the mean depth of some points of the core is subtracted. First
//!   derivatives jump where such a point enters the box, or comes as close to another face; by then c < -0.58
//!   R.
//!
//! Two segments that cross have D = 0 and, if the robot cannot move them out of their plane, no slope. The
//! clearance from a half-space is that of each end of the core, one row each: linear in the position.

mod cores;
mod held;
mod pair;
mod rows;
mod sweep;

#[cfg(test)]
mod tests;

pub(in crate::task) use cores::CoreBox;
pub(in crate::task) use pair::{Body, Bounds, Held, Look, Obstacle, Other};

use super::placed::{Hessian, Placed};
use cores::Core;
use costate::EvalError;
use nalgebra::Vector3;
use pair::Pair;

/// The clearances of some pairs; no call allocates.
#[derive(Clone, Debug)]
pub(super) struct Clearances {
    bodies: Vec<Body>,
    pairs: Vec<Pair>,
    /// The cores in the world.
    cores: Vec<Core>,
    /// For each coordinate what it changes of the vector between the closest places (3), and of the
    /// conditions for them (2); then of phi.
    moved: Vec<[f64; 6]>,
    /// For each pair how fast its distance can change on the piece of a motion that was seen last.
    speeds: Vec<f64>,
}

impl Clearances {
    /// Of these bodies, without pairs.
    pub fn new(bodies: Vec<Body>, placed: &Placed) -> Self {
        let zero = Vector3::zeros();
        let cores =
            bodies.iter().map(|body| Core { from: body.from, way: zero, is_segment: body.to.is_some() });
        Self {
            cores: cores.collect(),
            bodies,
            pairs: Vec::new(),
            moved: vec![[0.0; 6]; placed.dof()],
            speeds: Vec::new(),
        }
    }

    /// Adds a pair that keeps this distance beyond the surfaces, unless the robot does not move the two
    /// against each other; `obstacle` is the number of the other one among the obstacles. The number of its
    /// rows, and R.
    pub fn push(
        &mut self,
        body: usize,
        other: Other,
        obstacle: Option<usize>,
        margin: f64,
        placed: &Placed,
    ) -> Option<(usize, f64)> {
        let path = |body: usize| self.bodies[body].carried.as_ref().map_or(&[][..], |carried| &carried.path);
        let (own, others, radius) = match other {
            Other::Body(b) => (path(body), path(b), self.bodies[b].radius),
            Other::Box(_) | Other::HalfSpace { .. } => (path(body), &[][..], 0.0),
        };
        let alone = |path: &[usize], other: &[usize]| -> Vec<usize> {
            path.iter().copied().filter(|joint| !other.contains(joint)).collect()
        };
        let paths = [alone(own, others), alone(others, own)];
        let mut coordinates: Vec<usize> = paths.iter().flatten().map(|&j| placed.coordinate(j).0).collect();
        coordinates.sort_unstable();
        coordinates.dedup();
        if coordinates.is_empty() {
            return None;
        }
        let radius = self.bodies[body].radius + radius + margin;
        let pair = Pair { body, other, obstacle, radius, paths, coordinates };
        let rows = self.rows_of(&pair);
        self.pairs.push(pair);
        self.speeds.push(0.0);
        Some((rows, radius))
    }

    /// Moves an obstacle. False, and nothing changes, if it is another shape or has another size: a capsule
    /// may have another length.
    pub fn move_obstacle(&mut self, obstacle: usize, to: &Obstacle) -> bool {
        let Self { bodies, pairs, .. } = self;
        let mut own = pairs.iter_mut().filter(|pair| pair.obstacle == Some(obstacle)).peekable();
        let fits = own.peek().is_none_or(|pair| match (&pair.other, to) {
            (Other::Body(b), Obstacle::Body(body)) => {
                bodies[*b].radius == body.radius && bodies[*b].to.is_some() == body.to.is_some()
            }
            (Other::Box(before), Obstacle::Box(after)) => before.half == after.half,
            (Other::HalfSpace { .. }, Obstacle::HalfSpace { .. }) => true,
            _ => false,
        });
        for pair in own.filter(|_| fits) {
            match (&mut pair.other, to) {
                (Other::Body(b), Obstacle::Body(body)) => {
                    (bodies[*b].from, bodies[*b].to) = (body.from, body.to);
                }
                (Other::Box(place), Obstacle::Box(to)) => place.clone_from(to),
                (Other::HalfSpace { normal, height }, Obstacle::HalfSpace { normal: n, height: h }) => {
                    (*normal, *height) = (*n, *h);
                }
                _ => {}
            }
        }
        fits
    }

    pub fn rows(&self) -> usize {
        self.pairs.iter().map(|pair| self.rows_of(pair)).sum()
    }

    fn rows_of(&self, pair: &Pair) -> usize {
        let has_ends = matches!(pair.other, Other::HalfSpace { .. }) && self.bodies[pair.body].to.is_some();
        if has_ends { 2 } else { 1 }
    }

    /// The cores where the robot is.
    fn place(&mut self, placed: &Placed) -> Result<(), EvalError> {
        for (body, core) in self.bodies.iter().zip(&mut self.cores) {
            let way = body.to.map_or_else(Vector3::zeros, |to| to - body.from);
            (core.from, core.way) = match &body.carried {
                None => (body.from, way),
                Some(carried) => {
                    let (rotation, x) = placed.frame(carried.frame)?;
                    (x + rotation * body.from, rotation * way)
                }
            };
        }
        Ok(())
    }

    pub fn values(&mut self, placed: &Placed, g: &mut [f64]) -> Result<(), EvalError> {
        self.place(placed)?;
        let mut first = 0;
        for pair in &self.pairs {
            let rows = self.rows_of(pair);
            let core = &self.cores[pair.body];
            match &pair.other {
                Other::HalfSpace { normal, height } => {
                    for (end, g) in g[first..first + rows].iter_mut().enumerate() {
                        *g = normal.dot(&core.at(end as f64)) - height - pair.radius;
                    }
                }
                other => {
                    let closest = rows::closest(core, other, &self.cores, pair.radius);
                    g[first] =
                        rows::clearance(closest.half_square, pair.radius)[0] + rows::depth(core, other);
                }
            }
            first += rows;
        }
        Ok(())
    }

    /// Writes g and its Jacobian, rows of 2n that are zero before, and adds `w'g_xx`.
    pub fn contract(
        &mut self,
        placed: &mut Placed,
        w: &[f64],
        g: &mut [f64],
        jacobian: &mut [f64],
        hessian: &mut Hessian<'_>,
    ) -> Result<(), EvalError> {
        self.place(placed)?;
        let (mut first, width) = (0, hessian.width);
        for k in 0..self.pairs.len() {
            let rows = first..first + self.rows_of(&self.pairs[k]);
            let jacobian = &mut jacobian[width * rows.start..width * rows.end];
            let (w, g) = (&w[rows.clone()], &mut g[rows.clone()]);
            if let Other::HalfSpace { normal, height } = &self.pairs[k].other {
                let (pair, core) = (&self.pairs[k], &self.cores[self.pairs[k].body]);
                for (end, row) in jacobian.chunks_exact_mut(width).enumerate() {
                    let x = core.at(end as f64);
                    g[end] = normal.dot(&x) - height - pair.radius;
                    placed.see_point(&pair.paths[0], &x);
                    placed.add_gradient(&pair.paths[0], normal, row);
                    placed.add_second(&pair.paths[0], &(normal * w[end]), None, hessian);
                }
            } else {
                let Self { pairs, cores, moved, .. } = self;
                g[0] = rows::contract_distance(&pairs[k], cores, moved, placed, w[0], jacobian, hessian);
            }
            first = rows.end;
        }
        Ok(())
    }
}
