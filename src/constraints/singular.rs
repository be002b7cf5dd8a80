//! Singular poses: rows that depend on others there alone.

use super::hamiltonian::ConstrainedHamiltonian;
use super::kkt::REDUNDANT;
use super::projection::{ATTEMPTS, NEARLY, Search, largest, nudge};
use crate::error::EvalError;
use crate::matrix::dot;

/// A row counts more elsewhere where what it has beyond the others is so many times as large.
const MORE: f64 = 1e3;

impl ConstrainedHamiltonian<f64> {
    /// The first row that counts at positions with g = 0 near q (nq, with g(q) = 0) but depends on other rows
    /// at q, or nearly so; `None` where q is no singular pose.
    ///
    /// A row that is [redundant](Self::redundant) at a singular pose is none of the motion from there. The
    /// positions are moved along the constraints, so that rows of a linkage with more links than it needs,
    /// which depend on others wherever its loops are closed, are not taken for such. It allocates as
    /// [`close`](Self::close) does.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`].
    pub fn singular_row(&mut self, q: &[f64]) -> Result<Option<usize>, EvalError> {
        self.check(&[("q", q)])?;
        let (free, closed) = (vec![false; self.dof()], vec![0.0; self.rows.count()]);
        let mut search = Search::new(&self.tree, q, closed.len());
        let mut near = q.to_vec();
        for attempt in 1..=ATTEMPTS {
            self.weigh(q, &free, &mut search.weights)?;
            let here = self.strengths();
            // Without what changes the rows, to first order.
            nudge(&mut search.change, &free, attempt);
            for (i, rate) in search.miss.iter_mut().enumerate() {
                *rate = dot(self.rows.jacobian().row(i), &search.change);
            }
            self.kkt.correct(&mut search.miss, &mut search.step);
            search.change.iter_mut().zip(&search.step).for_each(|(change, step)| *change += step);
            search.space.integrate(q, &search.change, &mut near)?;
            self.newton(&mut near, &closed, &free, &mut search)?;
            if largest(&search.miss) > NEARLY {
                continue;
            }
            self.weigh(&near, &free, &mut search.weights)?;
            let there = self.strengths();
            let counts_more = |less: f64, more: f64| less <= REDUNDANT && more > MORE * less;
            let gained = (0..here.len()).filter(|i| counts_more(here[*i], there[*i]));
            let lost = (0..here.len()).filter(|i| counts_more(there[*i], here[*i]));
            if gained.clone().count() > lost.count() {
                return Ok(gained.min());
            }
        }
        Ok(None)
    }

    fn strengths(&self) -> Vec<f64> {
        (0..self.rows.count()).map(|i| self.kkt.strength(i)).collect()
    }
}
