//! The rows of a gait: the impact between two steps, and the heights of the feet that swing.

mod heights;

use super::gait_soles::{Derivatives, GaitSoles};
use crate::problem::loop_rows::{Foot, LoopRow, Loops, Walk};
use crate::task::row::{Measure, Row, Subject};
use costate::EvalError;
use costate::constraints::Constraints;
use costate::lagrangian::LagrangianSecondOrder;
use costate::scalar::Tangent;
use std::ops::Range;

/// The unit of violations of the height (m).
const HEIGHT: f64 = 0.1;

/// The rows of a gait in the states x = (q, nu, v, dnu/dt) of both ends, of n joints and k multipliers:
///
/// ```text
/// M v(0) - J'dnu/dt(0) - S M v(T)     n, momenta after the impact
/// J v(0)                              rates of the rows of the feet that stand during the whole step
/// g(q(0))                             place of the first of these feet, z of the others (y in space), angles
/// ```
///
/// then those of [`GaitSoles`]. In a step with double support dnu/dt(0) = 0 is given; the feet that stand
/// behind are at rest by the first rows, since they were on the ground before the landing. Along the motion
/// `z - h (1 - x^2 / L^2) >= 0` of each point of a foot that swings, x from the one whose place it takes.
///
/// `M v` is what inverse dynamics needs for the acceleration v at rest, more than for none; its derivatives
/// are those of inverse dynamics.
#[derive(Clone, Debug)]
pub(crate) struct GaitRows {
    open: LagrangianSecondOrder<f64>,
    rows: Vec<LoopRow>,
    exchange: Vec<(usize, f64)>,
    /// Along a direction.
    stance: Constraints<Tangent<f64>>,
    line: Vec<Tangent<f64>>,
    forces: Vec<Tangent<f64>>,
    /// Number of rows whose rates are zero at the start, the first ones.
    speeds: usize,
    /// The rows whose sum is a place.
    places: Vec<Range<usize>>,
    /// x and z of the points of feet that swing, and of those that stand.
    swing: Constraints<f64>,
    foot: Constraints<f64>,
    /// Weights of x and z of both.
    of_swing: Vec<f64>,
    of_foot: Vec<f64>,
    /// h and L.
    arch: [f64; 2],
    bounds: Vec<Row>,
    heights: Vec<Row>,
    soles: Option<GaitSoles>,
    rest: Vec<f64>,
    weights: Vec<f64>,
    momentum: Vec<f64>,
    /// n x 2 (n + k).
    slope: Vec<f64>,
}

/// All entries of a square matrix.
fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |i| (0..n).map(move |j| (i, j)))
}

impl GaitRows {
    pub fn new(loops: &Loops, walk: &Walk) -> Self {
        let stance = Constraints::<Tangent<f64>>::new(&loops.robot);
        let (n, k) = (stance.dof(), loops.rows.len());
        let places = |(number, foot): (usize, &Foot)| {
            let (first, places) = (foot.rows.start, walk.gait.places_of_foot(number));
            places.into_iter().map(move |rows| first + rows.start..first + rows.end)
        };
        let places: Vec<Range<usize>> = walk.stance().iter().enumerate().flat_map(places).collect();
        let momenta = walk.scales.iter().zip(loops.robot.independent_joints()).map(|(&scale, joint)| {
            let name = format!("momentum of joint '{}' from one step to the next", joint.name);
            Row::equal(0.0, scale, "kg m/s, kg m^2/s", name)
        });
        let of = |[what, turned]: [&str; 2], [unit, of_angles]: [&'static str; 2], first: usize| {
            let (foot, is_angle) = (walk.foot_of(first), walk.is_angle(first));
            let (what, unit) = if is_angle { (turned, of_angles) } else { (what, unit) };
            let foot = foot.map_or("", |foot| &foot.name);
            let name = format!("{what} of '{foot}' at the start of the step");
            Row::equal(0.0, 1.0, unit, name)
        };
        let speeds = walk.stance_rows();
        let of_speeds = (0..speeds).map(|c| of(["velocity", "rate of the angle"], ["m/s", "rad/s"], c));
        let starts = places.iter().map(|rows| of(["place", "angle"], ["m", "rad"], rows.start));
        let soles = GaitSoles::new(loops, walk);
        let of_soles = soles.iter().flat_map(|soles| soles.bounds().iter().cloned());
        let bounds = momenta.chain(of_speeds).chain(starts).chain(of_soles);
        let height = |(swings, corner): (&String, usize)| Row {
            lower: 0.0,
            upper: f64::INFINITY,
            range: HEIGHT,
            name: format!("clearance of {} from the ground", walk.gait.name_of_corner(swings, corner)),
            unit: "m",
            measure: Measure::Plain,
            subject: Subject::Task,
        };
        let points = walk.gait.corners().len();
        let corners = walk.gait.swing.iter().flat_map(|foot| (0..points).map(move |corner| (foot, corner)));
        let heights: Vec<Row> = corners.map(height).collect();
        let zero = Tangent::new(0.0, 0.0);
        Self {
            open: LagrangianSecondOrder::new(&loops.robot.without_constraints()),
            rows: loops.rows.clone(),
            exchange: walk.exchange.clone(),
            line: vec![zero; n],
            forces: vec![zero; stance.count()],
            stance,
            swing: Constraints::new(&walk.corners[0]),
            foot: Constraints::new(&walk.corners[1]),
            of_swing: vec![0.0; 2 * heights.len()],
            of_foot: vec![0.0; 2 * heights.len()],
            arch: [walk.gait.clearance, walk.gait.length],
            bounds: bounds.collect(),
            speeds,
            places,
            heights,
            soles,
            rest: vec![0.0; n],
            weights: vec![0.0; n],
            momentum: vec![0.0; n],
            slope: vec![0.0; 2 * n * (n + k)],
        }
    }

    /// What holds at the ends, together.
    pub fn bounds(&self) -> &[Row] {
        &self.bounds
    }

    /// What holds along the motion.
    pub fn along(&self) -> &[Row] {
        &self.heights
    }

    /// Forces in their cones, in the accelerations of multipliers, and what holds for them.
    pub fn soles(&self) -> Option<&GaitSoles> {
        self.soles.as_ref()
    }

    /// The same, no more than these rows.
    pub fn forces(&self) -> &[Row] {
        self.soles.as_ref().map_or(&[], GaitSoles::forces)
    }

    /// The rows at the ends in these states of them.
    ///
    /// # Errors
    /// States that cannot be evaluated.
    pub fn values(&mut self, [start, end]: [&[f64]; 2], g: &mut [f64]) -> Result<(), EvalError> {
        let (n, k) = (self.rest.len(), self.rows.len());
        let (momenta, others) = g.split_at_mut(n);
        self.momenta(end)?;
        for (to, &(from, sign)) in momenta.iter_mut().zip(&self.exchange) {
            *to = -sign * self.momentum[from];
        }
        self.momenta(start)?;
        momenta.iter_mut().zip(&self.momentum).for_each(|(to, p)| *to += p);
        let (q, v, rates) = (&start[..n], &start[n + k..2 * n + k], &start[2 * n + k..]);
        self.place(q, v)?;
        let (speeds, others) = others.split_at_mut(self.speeds);
        let (places, of_soles) = others.split_at_mut(self.places.len());
        let values = self.stance.values();
        for (place, rows) in places.iter_mut().zip(&self.places) {
            *place = self.rows[rows.clone()].iter().map(|one| values[one.row].re).sum();
        }
        for (speed, LoopRow { row, .. }) in speeds.iter_mut().zip(&self.rows) {
            *speed = values[*row].eps;
        }
        for (LoopRow { row, mass, .. }, rate) in self.rows.iter().zip(rates) {
            let slopes = self.stance.jacobian().row(*row);
            momenta.iter_mut().zip(slopes).for_each(|(to, j)| *to -= mass * rate * j.re);
        }
        match &mut self.soles {
            Some(soles) => soles.values([start, end], of_soles),
            None => Ok(()),
        }
    }

    /// The same with derivatives, second ones weighted; all of them are added.
    ///
    /// # Errors
    /// As [`values`](Self::values).
    pub fn contract(
        &mut self,
        [start, end]: [&[f64]; 2],
        weights: &[f64],
        g: &mut [f64],
        Derivatives { near, far, at_start, at_end }: Derivatives<'_>,
    ) -> Result<(), EvalError> {
        self.values([start, end], g)?;
        let (n, k) = (self.rest.len(), self.rows.len());
        let (all, width) = (n + k, 2 * (n + k));
        for (&(from, sign), weight) in self.exchange.iter().zip(weights) {
            self.weights[from] = -sign * weight;
        }
        self.add_momenta(end, at_end)?;
        for (to, &(from, sign)) in far.chunks_exact_mut(width).zip(&self.exchange) {
            let row = &self.slope[width * from..width * (from + 1)];
            to.iter_mut().zip(row).for_each(|(to, slope)| *to -= sign * slope);
        }
        self.weights.copy_from_slice(&weights[..n]);
        self.add_momenta(start, at_start)?;
        near.iter_mut().zip(&self.slope).for_each(|(to, slope)| *to += slope);
        // -J'Lambda, along its weights.
        let (q, v, rates) = (&start[..n], &start[all..all + n], &start[all + n..]);
        self.place(q, &weights[..n])?;
        for (LoopRow { row, mass, .. }, rate) in self.rows.iter().zip(rates) {
            self.forces[*row] = Tangent::new(mass * rate, 0.0);
        }
        let bent = self.stance.hessian(&self.forces)?;
        for (i, j) in pairs(n) {
            near[width * i + j] -= bent[(i, j)].re;
            at_start[width * i + j] -= bent[(i, j)].eps;
        }
        for (c, LoopRow { row, mass, .. }) in self.rows.iter().enumerate() {
            let rate = all + n + c;
            for (i, j) in self.stance.jacobian().row(*row).iter().enumerate() {
                near[width * i + rate] -= mass * j.re;
                at_start[width * i + rate] -= mass * j.eps;
                at_start[width * rate + i] -= mass * j.eps;
            }
        }
        // J v and g, along v.
        self.place(q, v)?;
        self.forces.fill(Tangent::new(0.0, 0.0));
        for (c, LoopRow { row, .. }) in self.rows[..self.speeds].iter().enumerate() {
            self.forces[*row] = Tangent::new(weights[n + c], 0.0);
            let to = &mut near[width * (n + c)..][..width];
            for (i, j) in self.stance.jacobian().row(*row).iter().enumerate() {
                (to[i], to[all + i]) = (to[i] + j.eps, to[all + i] + j.re);
            }
        }
        let bent = self.stance.hessian(&self.forces)?;
        for (i, j) in pairs(n) {
            let entry = bent[(i, j)];
            at_start[width * i + j] += entry.eps;
            at_start[width * i + all + j] += entry.re;
            at_start[width * (all + i) + j] += entry.re;
        }
        let first = n + self.speeds;
        for (number, rows) in self.places.iter().enumerate() {
            let to = &mut near[width * (first + number)..][..width];
            for LoopRow { row, .. } in &self.rows[rows.clone()] {
                self.forces[*row] = Tangent::new(weights[first + number], 0.0);
                let slopes = self.stance.jacobian().row(*row);
                to.iter_mut().zip(slopes).for_each(|(to, j)| *to += j.re);
            }
        }
        let bent = self.stance.hessian(&self.forces)?;
        for (i, j) in pairs(n) {
            at_start[width * i + j] += bent[(i, j)].re;
        }
        let first = first + self.places.len();
        let (near, far) = (&mut near[width * first..], &mut far[width * first..]);
        match &mut self.soles {
            Some(soles) => {
                let derivatives = Derivatives { near, far, at_start, at_end };
                soles.contract([start, end], &weights[first..], derivatives)
            }
            None => Ok(()),
        }
    }

    /// Places the rows at q, along a direction.
    fn place(&mut self, q: &[f64], direction: &[f64]) -> Result<(), EvalError> {
        let line = self.line.iter_mut().zip(q.iter().zip(direction));
        line.for_each(|(to, (&q, &d))| *to = Tangent::new(q, d));
        self.stance.set_position(&self.line)
    }

    /// `M v` of a state.
    fn momenta(&mut self, state: &[f64]) -> Result<(), EvalError> {
        let Self { open, rest, momentum, .. } = self;
        let n = rest.len();
        let (q, v) = (&state[..n], &state[state.len() / 2..][..n]);
        momentum.copy_from_slice(open.first().inverse_dynamics(q, rest, v)?);
        let still = open.first().inverse_dynamics(q, rest, rest)?;
        momentum.iter_mut().zip(still).for_each(|(p, still)| *p -= still);
        Ok(())
    }

    /// Takes the Jacobian of `M v` by a state, and adds the second derivatives of `w.M v`, w the weights.
    fn add_momenta(&mut self, state: &[f64], hessian: &mut [f64]) -> Result<(), EvalError> {
        let Self { open, rest, weights, slope, .. } = self;
        let (n, width) = (rest.len(), state.len());
        let (q, v) = (&state[..n], &state[width / 2..][..n]);
        slope.fill(0.0);
        for moves in [true, false] {
            let found = open.contract_inverse_dynamics(q, rest, if moves { v } else { rest }, weights)?;
            let (first, zz, sign) = (found.inverse_dynamics(), found.zz(), if moves { 1.0 } else { -1.0 });
            for (i, j) in pairs(n) {
                slope[width * i + j] += sign * first.tau_q[(i, j)];
                hessian[width * i + j] += sign * zz[(i, j)];
                if moves {
                    slope[width * i + width / 2 + j] = first.tau_a[(i, j)];
                    let mixed = zz[(i, 2 * n + j)];
                    hessian[width * i + width / 2 + j] += mixed;
                    hessian[width * (width / 2 + j) + i] += mixed;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "gait_rows_tests.rs"]
pub(in crate::direct) mod tests;
