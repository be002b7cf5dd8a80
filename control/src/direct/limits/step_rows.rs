//! A step of a gait: the impact between two steps, and the height of the foot that swings.

use crate::direct::points::values::Points;
use crate::problem::loop_rows::{LoopRow, Loops, Walk};
use crate::task::row::{Measure, Row};
use costate::EvalError;
use costate::constraints::Constraints;
use costate::lagrangian::LagrangianSecondOrder;
use costate::scalar::Tangent;

/// The unit of violations of the height (m).
const HEIGHT: f64 = 0.1;

/// The rows of a step in the states x = (q, nu, v, dnu/dt) of both ends, of n joints and k multipliers:
///
/// ```text
/// M v(0) - J'dnu/dt(0) - S M v(T)     n, momenta after the impact
/// J v(0)                              k, rates of the rows of the foot that stands
/// g(q(0))                             k, their values
/// ```
///
/// and one along the motion, `z - h (1 - x^2 / L^2) >= 0` of the foot that swings.
///
/// `M v` is what inverse dynamics needs for the acceleration v at rest, more than for none; its derivatives
/// are those of inverse dynamics.
#[derive(Clone, Debug)]
pub(crate) struct StepRows {
    open: LagrangianSecondOrder<f64>,
    rows: Vec<LoopRow>,
    exchange: Vec<usize>,
    /// Along a direction.
    stance: Constraints<Tangent<f64>>,
    line: Vec<Tangent<f64>>,
    forces: Vec<Tangent<f64>>,
    swing: Constraints<f64>,
    /// Its Jacobian, 2 x n.
    foot: Vec<f64>,
    /// h and L.
    arch: [f64; 2],
    bounds: Vec<Row>,
    height: [Row; 1],
    rest: Vec<f64>,
    weights: Vec<f64>,
    momentum: Vec<f64>,
    /// n x 2 (n + k).
    slope: Vec<f64>,
}

/// Derivatives of the rows: by the state at the start and at the end, and second ones of the weighted sum.
pub(crate) struct Derivatives<'a> {
    pub near: &'a mut [f64],
    pub far: &'a mut [f64],
    pub at_start: &'a mut [f64],
    pub at_end: &'a mut [f64],
}

impl StepRows {
    pub fn new(loops: &Loops, walk: &Walk) -> Self {
        let stance = Constraints::<Tangent<f64>>::new(&loops.robot);
        let (n, k) = (stance.dof(), loops.rows.len());
        let name = &walk.step.stance;
        let momenta = walk.scales.iter().enumerate();
        let momenta = momenta.map(|(i, &scale)| {
            Row::equal(0.0, scale, "kg m/s, kg m^2/s", format!("momentum {i} through the impact"))
        });
        let of = |what: &str, unit| {
            let name = format!("{what} of '{name}' at the start of the step");
            (0..k).map(move |_| Row::equal(0.0, 1.0, unit, name.clone())).collect::<Vec<_>>()
        };
        let bounds = momenta.chain(of("velocity", "m/s")).chain(of("place", "m")).collect();
        let height = Row {
            lower: 0.0,
            upper: f64::INFINITY,
            range: HEIGHT,
            name: format!("clearance of '{}' from the ground", walk.step.swing),
            unit: "m",
            measure: Measure::Plain,
        };
        let zero = Tangent::new(0.0, 0.0);
        Self {
            open: LagrangianSecondOrder::new(&loops.robot.without_constraints()),
            rows: loops.rows.clone(),
            exchange: walk.exchange.clone(),
            line: vec![zero; n],
            forces: vec![zero; stance.count()],
            stance,
            swing: Constraints::new(&walk.swing),
            foot: vec![0.0; 2 * n],
            arch: [walk.step.clearance, walk.step.length],
            bounds,
            height: [height],
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
        &self.height
    }

    /// The rows at the ends in these states of them.
    ///
    /// # Errors
    /// States that cannot be evaluated.
    pub fn values(&mut self, [start, end]: [&[f64]; 2], g: &mut [f64]) -> Result<(), EvalError> {
        let (n, k) = (self.rest.len(), self.rows.len());
        let (momenta, others) = g.split_at_mut(n);
        self.momenta(end)?;
        for (to, &from) in momenta.iter_mut().zip(&self.exchange) {
            *to = -self.momentum[from];
        }
        self.momenta(start)?;
        momenta.iter_mut().zip(&self.momentum).for_each(|(to, p)| *to += p);
        let (q, v, rates) = (&start[..n], &start[n + k..2 * n + k], &start[2 * n + k..]);
        self.place(q, v)?;
        let (speeds, places) = others.split_at_mut(k);
        let found = speeds.iter_mut().zip(places).zip(self.rows.iter().zip(rates));
        for ((speed, place), (LoopRow { row, mass, .. }, rate)) in found {
            let value = self.stance.values()[*row];
            (*speed, *place) = (value.eps, value.re);
            let slopes = self.stance.jacobian().row(*row);
            momenta.iter_mut().zip(slopes).for_each(|(to, j)| *to -= mass * rate * j.re);
        }
        Ok(())
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
        for (&from, weight) in self.exchange.iter().zip(weights) {
            self.weights[from] = -weight;
        }
        self.add_momenta(end, at_end)?;
        for (to, &from) in far.chunks_exact_mut(width).zip(&self.exchange) {
            let row = &self.slope[width * from..width * (from + 1)];
            to.iter_mut().zip(row).for_each(|(to, slope)| *to -= slope);
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
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
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
        for (of_speeds, first) in [(true, n), (false, all)] {
            for (c, LoopRow { row, .. }) in self.rows.iter().enumerate() {
                self.forces[*row] = Tangent::new(weights[first + c], 0.0);
                let to = &mut near[width * (first + c)..][..width];
                for (i, j) in self.stance.jacobian().row(*row).iter().enumerate() {
                    match of_speeds {
                        true => (to[i], to[all + i]) = (to[i] + j.eps, to[all + i] + j.re),
                        false => to[i] += j.re,
                    }
                }
            }
            let bent = self.stance.hessian(&self.forces)?;
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let entry = bent[(i, j)];
                if of_speeds {
                    at_start[width * i + j] += entry.eps;
                    at_start[width * i + all + j] += entry.re;
                    at_start[width * (all + i) + j] += entry.re;
                } else {
                    at_start[width * i + j] += entry.re;
                }
            }
        }
        Ok(())
    }

    /// The height of the foot that swings above its parabola, at the position q of the joints.
    ///
    /// # Errors
    /// A position that cannot be evaluated.
    pub fn height(&mut self, q: &[f64]) -> Result<f64, EvalError> {
        self.swing.set_position(&q[..self.rest.len()])?;
        let ([h, length], [x, z]) = (self.arch, [self.swing.values()[0], self.swing.values()[1]]);
        let part = x / length;
        Ok(z - h * (1.0 - part * part))
    }

    /// The same in row `row` of the points, with derivatives; second ones are added to those of the points.
    ///
    /// # Errors
    /// As [`height`](Self::height).
    pub fn contract_heights(&mut self, points: &mut Points, row: usize) -> Result<(), EvalError> {
        let (n, all, rows) = (self.rest.len(), points.dof, points.rows);
        let [h, length] = self.arch;
        let bend = 2.0 * h / (length * length);
        for p in 0..points.count() {
            points.g[rows * p + row] = self.height(&points.z[3 * all * p..][..n])?;
            let weight = points.g_weights[rows * p + row];
            let slope = bend * self.swing.values()[0];
            self.foot.copy_from_slice(self.swing.jacobian().as_slice());
            let second = self.swing.hessian(&[weight * slope, weight])?;
            let g_x = &mut points.g_x[2 * all * (rows * p + row)..][..2 * all];
            g_x.fill(0.0);
            let hessian = &mut points.hessian[9 * all * all * p..][..9 * all * all];
            for i in 0..n {
                let (x, z) = self.foot.split_at(n);
                g_x[i] = z[i] + slope * x[i];
                for j in 0..n {
                    hessian[3 * all * i + j] += second[(i, j)] + weight * bend * x[i] * x[j];
                }
            }
        }
        Ok(())
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
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
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
#[path = "step_rows_tests.rs"]
pub(in crate::direct) mod tests;
