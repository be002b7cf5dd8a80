//! Closing loops, and removing drift.

use super::{ConstrainedHamiltonian, ConstraintError};
use crate::configuration::ConfigurationSpace;
use crate::error::{EvalError, check_length};
use crate::robot::Tree;

/// No step is tried where no row misses by more than this (m, rad).
const CLOSED: f64 = 1e-13;
/// What rounding may leave where no step leads nearer (m, rad).
pub(super) const NEARLY: f64 = 1e-10;
/// Most searches from different positions, how far the second one is from the end of the first (rad, m), and
/// how many times as far each further one is from that before it.
pub(super) const ATTEMPTS: usize = 5;
const NUDGE: f64 = 0.1;
const FARTHER: f64 = 3.0;
/// Most steps of Newton's method.
const STEPS: usize = 100;
/// Most halvings of a step.
const HALVINGS: usize = 30;
/// Most that a step turns any joint (rad): near a singular pose full steps lead many turns away.
const TURN: f64 = 0.5;

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
    /// with the smallest steps, weighted by the diagonal of M, of half a radian at most, halved until they
    /// lead nearer. It allocates the buffers of its search.
    ///
    /// # Errors
    /// [`ConstraintError::CannotClose`] or [`ConstraintError::Contradiction`], which say what misses by how
    /// much; q is then as near as was found. [`ConstraintError::Evaluation`] as for the other methods.
    pub fn close(&mut self, q: &mut [f64], held: &[bool]) -> Result<(), ConstraintError> {
        check_length("held", held, self.dof())?;
        let target = vec![0.0; self.rows.count()];
        self.move_to(q, &target, held)
    }

    /// Removes the drift of a state: q moves to `g(q) = g(q_0)`, p becomes M v, v the velocity of (q, p)
    /// without what the constraints do not allow at the new position: `J v = 0` and mu = 0. It allocates as
    /// `close` does.
    ///
    /// # Errors
    /// As [`close`](Self::close).
    pub fn project(&mut self, q: &mut [f64], p: &mut [f64], q_0: &[f64]) -> Result<(), ConstraintError> {
        self.check(&[("q", q), ("p", p), ("q_0", q_0)])?;
        let v = self.velocity(q, p)?.0.to_vec();
        self.rows.place(q_0);
        let target = self.rows.values().to_vec();
        self.move_to(q, &target, &vec![false; self.dof()])?;
        p.copy_from_slice(self.momentum(q, &v)?);
        let v = self.velocity(q, p)?.0.to_vec();
        p.copy_from_slice(self.momentum(q, &v)?);
        Ok(())
    }

    /// Several attempts: from q, then from near where the last one ended, where rows that depend on each
    /// other by chance no longer do.
    fn move_to(&mut self, q: &mut [f64], target: &[f64], held: &[bool]) -> Result<(), ConstraintError> {
        self.check(&[("q", q)])?;
        let mut search = Search::new(&self.tree, q, target.len());
        for attempt in 0..ATTEMPTS {
            if attempt > 0 {
                nudge(&mut search.change, held, attempt);
                let farther = FARTHER.powi(attempt as i32 - 1);
                search.change.iter_mut().for_each(|change| *change *= farther);
                search.space.integrate(q, &search.change, &mut search.trial)?;
                q.copy_from_slice(&search.trial);
            }
            self.newton(q, target, held, &mut search)?;
            if largest(&search.miss) <= NEARLY {
                return Ok(());
            }
            search.keep_nearest(q);
        }
        q.copy_from_slice(&search.nearest);
        Err(self.why(q, target, held, &mut search)?)
    }

    /// Newton's method for the rows that count, to a position that no step improves.
    pub(super) fn newton(
        &mut self,
        q: &mut [f64],
        target: &[f64],
        held: &[bool],
        search: &mut Search,
    ) -> Result<(), EvalError> {
        let Search { space, turns, change, step, trial, weights, miss, .. } = search;
        self.miss(q, target, miss);
        for _ in 0..STEPS {
            if largest(miss) <= CLOSED {
                break;
            }
            self.weigh(q, held, weights)?;
            let size = self.counted_square(miss);
            self.kkt.correct(miss, change);
            let turned = turns.iter().zip(&*change).filter(|(turns, _)| **turns);
            let turned = turned.fold(0.0_f64, |most, (_, change)| most.max(change.abs()));
            let mut length = if turned > TURN { TURN / turned } else { 1.0 };
            let nearer = (0..HALVINGS).any(|_| {
                step.iter_mut().zip(&*change).for_each(|(to, dq)| *to = length * dq);
                length *= 0.5;
                let moved = space.integrate(q, step, trial).is_ok();
                self.miss(trial, target, miss);
                moved && self.counted_square(miss) < size
            });
            if !nearer {
                break;
            }
            q.copy_from_slice(trial);
        }
        self.miss(q, target, miss);
        Ok(())
    }

    /// J, and the factors of its product with the weights: those of held joints are zero.
    pub(super) fn weigh(&mut self, q: &[f64], held: &[bool], weights: &mut [f64]) -> Result<(), EvalError> {
        self.kernel.body.set_position(&self.tree, q)?;
        for (i, (weight, &held)) in weights.iter_mut().zip(held).enumerate() {
            let inertia = self.kernel.body.mass_matrix()[(i, i)];
            *weight = if held { 0.0 } else { inertia.max(f64::MIN_POSITIVE).recip() };
        }
        self.rows.place(q);
        self.kkt.set_sizes(self.rows.sizes(), self.kernel.body.mass_matrix());
        self.kkt.factor_diagonal(weights, self.rows.jacobian());
        Ok(())
    }

    /// `g(q) - target`.
    pub(super) fn miss(&mut self, q: &[f64], target: &[f64], miss: &mut [f64]) {
        self.rows.place(q);
        for (miss, (g, target)) in miss.iter_mut().zip(self.rows.values().iter().zip(target)) {
            *miss = g - target;
        }
    }

    /// The sum of squares of the rows that count.
    fn counted_square(&self, miss: &[f64]) -> f64 {
        miss.iter().zip(&self.kkt.kept).map(|(miss, kept)| kept * miss * miss).sum()
    }
}

/// Buffers of a search, and the nearest position that it has found.
pub(super) struct Search {
    pub(super) space: ConfigurationSpace,
    /// Which coordinates are angles.
    turns: Vec<bool>,
    pub(super) change: Vec<f64>,
    /// A part of the change.
    pub(super) step: Vec<f64>,
    pub(super) trial: Vec<f64>,
    pub(super) weights: Vec<f64>,
    pub(super) miss: Vec<f64>,
    nearest: Vec<f64>,
    least: f64,
}

impl Search {
    pub(super) fn new(tree: &Tree, q: &[f64], rows: usize) -> Self {
        let (zeros, mut turns) = (vec![0.0; tree.dof()], vec![false; tree.dof()]);
        for &joint in tree.revolute() {
            turns[tree.joint_map().map_or(joint, |map| map.rows()[joint].coordinate)] = true;
        }
        Self {
            space: ConfigurationSpace::from_tree(tree.clone()),
            turns,
            change: zeros.clone(),
            step: zeros.clone(),
            trial: q.to_vec(),
            weights: zeros,
            miss: vec![0.0; rows],
            nearest: q.to_vec(),
            least: f64::INFINITY,
        }
    }

    fn keep_nearest(&mut self, q: &[f64]) {
        let found = largest(&self.miss);
        if found < self.least {
            self.least = found;
            self.nearest.copy_from_slice(q);
        }
    }
}

/// A small change of all joints that are not held, another one for each number.
pub(super) fn nudge(change: &mut [f64], held: &[bool], number: usize) {
    for (i, (change, held)) in change.iter_mut().zip(held).enumerate() {
        let by = NUDGE * (1.0 + 2.0 * i as f64 + number as f64).sin();
        *change = if *held { 0.0 } else { by };
    }
}

pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| if value.is_nan() { f64::NAN } else { most.max(value.abs()) })
}
