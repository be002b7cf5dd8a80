//! The rates at which the corners of feet leave the ground after a landing, and come to it before the next.

use crate::task::row::{Measure, Row, Subject};
use costate::EvalError;
use costate::constraints::Constraints;
use costate::robot::Robot;
use costate::scalar::{Scalar, Tangent};

/// The unit of violations of these rates (m/s).
const RATE: f64 = 1.0;

/// The rates of the heights `H = z - h (1 - x^2 / L^2)` of the corners of feet that swing, x from the corner
/// whose place it takes, at both ends of a step: `dH/dt >= 0` at the start, and `dH/dt <= 0` at the end.
///
/// At the ends all corners are on the ground, H = 0, whatever the motion is. So between an end and the first
/// point beside it H may be negative where it is positive at all points; these rows say that it is not, for
/// intervals that are short enough.
#[derive(Clone, Debug)]
pub(super) struct GaitLifts {
    /// x and z of the corners that swing and of those that stand, along a direction.
    swing: Constraints<Tangent<f64>>,
    foot: Constraints<Tangent<f64>>,
    line: Vec<Tangent<f64>>,
    of_swing: Vec<Tangent<f64>>,
    of_foot: Vec<Tangent<f64>>,
    /// H_q of a corner, and the derivative of x.
    slope: Vec<Tangent<f64>>,
    across: Vec<Tangent<f64>>,
    /// h and L.
    arch: [f64; 2],
    /// At the start, then at the end.
    bounds: Vec<Row>,
}

impl GaitLifts {
    /// Those of corners with these names.
    pub fn new([swing, foot]: &[Robot; 2], arch: [f64; 2], names: &[String]) -> Self {
        let (swing, foot) = (Constraints::<Tangent<f64>>::new(swing), Constraints::new(foot));
        let (n, zero) = (swing.dof(), Tangent::new(0.0, 0.0));
        let row = |name: &String, end: &str, [lower, upper]: [f64; 2]| Row {
            lower,
            upper,
            range: RATE,
            name: format!("rate at which {name} {end}"),
            unit: "m/s",
            measure: Measure::Plain,
            subject: Subject::Task,
        };
        let lifts = names.iter().map(|name| row(name, "leaves the ground", [0.0, f64::INFINITY]));
        let lands = names.iter().map(|name| row(name, "comes to the ground", [f64::NEG_INFINITY, 0.0]));
        Self {
            line: vec![zero; n],
            of_swing: vec![zero; 2 * names.len()],
            of_foot: vec![zero; 2 * names.len()],
            slope: vec![zero; n],
            across: vec![zero; n],
            arch,
            bounds: lifts.chain(lands).collect(),
            swing,
            foot,
        }
    }

    /// What holds at the start, then at the end.
    pub fn bounds(&self) -> &[Row] {
        &self.bounds
    }

    /// The rates at both ends, in positions and rates of the joints there.
    ///
    /// # Errors
    /// States that cannot be evaluated.
    pub fn values(&mut self, ends: [(&[f64], &[f64]); 2], g: &mut [f64]) -> Result<(), EvalError> {
        let count = g.len() / 2;
        if count == 0 {
            return Ok(());
        }
        for ((q, v), g) in ends.into_iter().zip(g.chunks_exact_mut(count)) {
            self.place(q, v)?;
            for (i, g) in g.iter_mut().enumerate() {
                *g = self.height(i).eps;
            }
        }
        Ok(())
    }

    /// Derivatives of the rates at one end: rows of the width of a state with the joints' q from its start
    /// on and v from `first`; second ones of the weighted sum are added to `hessian`.
    ///
    /// # Errors
    /// As [`values`](Self::values).
    pub fn contract(
        &mut self,
        (q, v, first): (&[f64], &[f64], usize),
        weights: &[f64],
        rows: &mut [f64],
        hessian: &mut [f64],
    ) -> Result<(), EvalError> {
        if weights.is_empty() {
            return Ok(());
        }
        self.place(q, v)?;
        let (n, width) = (q.len(), rows.len() / weights.len());
        let [h, length] = self.arch;
        let bend = 2.0 * h / (length * length);
        let entry = |hessian: &mut [f64], a: usize, b: usize, value: Tangent<f64>| {
            hessian[width * a + b] += value.eps;
            hessian[width * a + first + b] += value.re;
            hessian[width * (first + a) + b] += value.re;
        };
        for (i, (weight, row)) in weights.iter().zip(rows.chunks_exact_mut(width)).enumerate() {
            let slope = self.distance(i).times(bend);
            self.of_swing[2 * i] = slope.times(*weight);
            self.of_swing[2 * i + 1] = Tangent::new(*weight, 0.0);
            self.of_foot[2 * i] = slope.times(-weight);
            let [swing, foot] = [self.swing.jacobian(), self.foot.jacobian()];
            for a in 0..n {
                let across = swing[(2 * i, a)] - foot[(2 * i, a)];
                self.slope[a] = swing[(2 * i + 1, a)] + slope * across;
                self.across[a] = across;
                row[a] += self.slope[a].eps;
                row[first + a] += self.slope[a].re;
            }
            for a in 0..n {
                for b in 0..n {
                    let square = self.across[a] * self.across[b];
                    entry(hessian, a, b, square.times(bend * weight));
                }
            }
        }
        let [swing, foot] = [self.swing.hessian(&self.of_swing)?, self.foot.hessian(&self.of_foot)?];
        for a in 0..n {
            for b in 0..n {
                entry(hessian, a, b, swing[(a, b)] + foot[(a, b)]);
            }
        }
        Ok(())
    }

    fn place(&mut self, q: &[f64], v: &[f64]) -> Result<(), EvalError> {
        let line = self.line.iter_mut().zip(q.iter().zip(v));
        line.for_each(|(to, (&q, &v))| *to = Tangent::new(q, v));
        self.swing.set_position(&self.line)?;
        self.foot.set_position(&self.line)
    }

    fn distance(&self, i: usize) -> Tangent<f64> {
        self.swing.values()[2 * i] - self.foot.values()[2 * i]
    }

    fn height(&self, i: usize) -> Tangent<f64> {
        let [h, length] = self.arch;
        let part = self.distance(i).times(1.0 / length);
        self.swing.values()[2 * i + 1] + (part * part).plus(-1.0).times(h)
    }
}
