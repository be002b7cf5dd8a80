//! Closing loops, and removing drift.

use super::{ConstrainedHamiltonian, ConstraintError};
use crate::error::{EvalError, check_length};

/// g is zero where no entry exceeds this (m, rad).
const CLOSED: f64 = 1e-12;
/// Most steps of Newton's method.
const STEPS: usize = 100;
/// Most halvings of a step.
const HALVINGS: usize = 30;

impl ConstrainedHamiltonian<f64> {
    /// Number of rows that count at the position of the last call: the rank of J. See
    /// [`counted`](Self::counted).
    pub fn rank(&self) -> usize {
        self.kkt.kept.iter().filter(|&&kept| kept == 1.0).count()
    }

    /// The constraints with rows that were redundant at the position of the last call, by name, once for each
    /// row.
    pub fn redundant(&self) -> impl Iterator<Item = &str> {
        let rows = self.kkt.kept.iter().enumerate().filter(|(_, kept)| **kept == 0.0);
        rows.map(|(i, _)| self.rows.name(i))
    }

    /// Moves q (n) to a position with g(q) = 0, the joints that are `held` (n) as they are: Newton's method
    /// with the smallest steps, weighted by the diagonal of M, halved until they lead nearer.
    ///
    /// # Errors
    /// [`ConstraintError::CannotClose`] or [`ConstraintError::Contradiction`], which say what misses by how
    /// much; q is then as near as was found. [`ConstraintError::Evaluation`] as for the other methods.
    pub fn close(&mut self, q: &mut [f64], held: &[bool]) -> Result<(), ConstraintError> {
        check_length("held", held, self.dof())?;
        let target = vec![0.0; self.rows.count()];
        self.move_to(q, &target, held)
    }

    /// Removes the drift of a state: q moves to `g(q) = g(q_0)`, p becomes M v with the velocity v of (q, p),
    /// so that `J v = 0` and mu = 0.
    ///
    /// # Errors
    /// As [`close`](Self::close).
    pub fn project(&mut self, q: &mut [f64], p: &mut [f64], q_0: &[f64]) -> Result<(), ConstraintError> {
        self.check(&[("q", q), ("p", p), ("q_0", q_0)])?;
        self.rows.place(q_0);
        let target = self.rows.values().to_vec();
        self.move_to(q, &target, &vec![false; q.len()])?;
        self.first_order(q, p)?;
        p.copy_from_slice(self.kernel.momentum());
        Ok(())
    }

    fn move_to(&mut self, q: &mut [f64], target: &[f64], held: &[bool]) -> Result<(), ConstraintError> {
        self.check(&[("q", q)])?;
        let (n, k) = (q.len(), target.len());
        let [mut change, mut trial, mut weights] = [(); 3].map(|()| vec![0.0; n]);
        let mut miss = vec![0.0; k];
        let mut size = self.miss(q, target, &mut miss);
        for _ in 0..STEPS {
            if largest(&miss) <= CLOSED {
                return Ok(());
            }
            self.weigh(q, held, &mut weights)?;
            self.kkt.correct(&mut miss, &mut change);
            let mut step = 1.0;
            let nearer = (0..HALVINGS).any(|_| {
                trial.iter_mut().zip(q.iter().zip(&change)).for_each(|(to, (q, dq))| *to = q + step * dq);
                step *= 0.5;
                let found = self.miss(&trial, target, &mut miss);
                let nearer = found < size;
                if nearer {
                    size = found;
                }
                nearer
            });
            if !nearer {
                break;
            }
            q.copy_from_slice(&trial);
        }
        self.miss(q, target, &mut miss);
        if largest(&miss) <= CLOSED { Ok(()) } else { Err(self.why(q, &miss, held, &mut weights)?) }
    }

    /// J, and the factors of its product with the weights: those of held joints are zero.
    fn weigh(&mut self, q: &[f64], held: &[bool], weights: &mut [f64]) -> Result<(), EvalError> {
        self.kernel.set_position(&self.tree, q)?;
        for (i, (weight, &held)) in weights.iter_mut().zip(held).enumerate() {
            let inertia = self.kernel.mass_matrix()[(i, i)];
            *weight = if held { 0.0 } else { inertia.max(f64::MIN_POSITIVE).recip() };
        }
        self.rows.place(q);
        self.kkt.factor_diagonal(weights, self.rows.jacobian());
        Ok(())
    }

    /// `g(q) - target`, and the sum of its squares; infinite where it is not finite.
    fn miss(&mut self, q: &[f64], target: &[f64], miss: &mut [f64]) -> f64 {
        self.rows.place(q);
        for (miss, (g, target)) in miss.iter_mut().zip(self.rows.values().iter().zip(target)) {
            *miss = g - target;
        }
        let square: f64 = miss.iter().map(|miss| miss * miss).sum();
        if square.is_finite() { square } else { f64::INFINITY }
    }

    /// Redundant rows that miss where all others are satisfied contradict them.
    fn why(
        &mut self,
        q: &[f64],
        miss: &[f64],
        held: &[bool],
        weights: &mut [f64],
    ) -> Result<ConstraintError, EvalError> {
        self.weigh(q, held, weights)?;
        let of = |kept: f64| {
            let rows = miss.iter().zip(&self.kkt.kept).enumerate().filter(move |(_, (_, is))| **is == kept);
            let worst = rows.max_by(|(_, (a, _)), (_, (b, _))| a.abs().total_cmp(&b.abs()));
            worst.map_or((0, 0.0), |(i, (miss, _))| (i, miss.abs()))
        };
        let ((_, counted), (row, redundant)) = (of(1.0), of(0.0));
        if counted <= CLOSED.sqrt() && redundant > CLOSED {
            let constraint = self.rows.name(row).to_owned();
            return Ok(ConstraintError::Contradiction { constraint, miss: redundant });
        }
        let (row, miss) = if counted > redundant { of(1.0) } else { (row, redundant) };
        Ok(ConstraintError::CannotClose { constraint: self.rows.name(row).to_owned(), miss })
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| if value.is_nan() { f64::NAN } else { most.max(value.abs()) })
}
