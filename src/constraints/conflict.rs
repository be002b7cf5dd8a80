//! Why constraints could not be satisfied.

use super::error::{Conflict, ConstraintError};
use super::hamiltonian::ConstrainedHamiltonian;
use super::projection::{NEARLY, Search, nudge};
use crate::error::EvalError;

/// A held joint forbids a row where the square of its share in what moves the row exceeds this part.
const SHARE: f64 = 1e-12;

impl ConstrainedHamiltonian<f64> {
    /// Redundant rows that miss where all others are satisfied contradict something, unless they are
    /// redundant by chance: not near this position, at the end of what the robot reaches.
    pub(super) fn why(
        &mut self,
        q: &[f64],
        target: &[f64],
        held: &[bool],
        search: &mut Search,
    ) -> Result<ConstraintError, EvalError> {
        self.weigh(q, held, &mut search.weights)?;
        let (rows, kept) = (&self.rows, &self.kkt.kept);
        let of = |counts: f64| {
            let all = (0..kept.len()).filter(|i| kept[*i] == counts);
            let worst = all.map(|i| (i, rows.miss_of(i, target[i]))).max_by(|a, b| a.1.total_cmp(&b.1));
            worst.unwrap_or((0, 0.0))
        };
        let ((most, counted), (row, redundant)) = (of(1.0), of(0.0));
        let (row, miss) = if counted > redundant { (most, counted) } else { (row, redundant) };
        let constraint = rows.name(row).to_owned();
        if counted > NEARLY.sqrt() || redundant <= NEARLY {
            return Ok(ConstraintError::CannotClose { constraint, miss });
        }
        nudge(&mut search.change, held, 1);
        search.space.integrate(q, &search.change, &mut search.trial)?;
        self.weigh(&search.trial, held, &mut search.weights)?;
        if self.kkt.kept[row] == 1.0 {
            return Ok(ConstraintError::CannotClose { constraint, miss });
        }
        let because = Box::new(self.conflict(q, row, held, search)?);
        Ok(ConstraintError::Contradiction { constraint, miss, because })
    }

    /// What forbids a row that is redundant: with all joints free it would count, or it is still, or it is a
    /// sum of other rows.
    fn conflict(
        &mut self,
        q: &[f64],
        row: usize,
        held: &[bool],
        search: &mut Search,
    ) -> Result<Conflict, EvalError> {
        let free = vec![false; held.len()];
        nudge(&mut search.change, &free, 1);
        search.space.integrate(q, &search.change, &mut search.trial)?;
        self.weigh(&search.trial, &free, &mut search.weights)?;
        if self.kkt.kept[row] == 1.0 {
            return Ok(Conflict::Held { joints: self.holding(row, held, &search.weights) });
        }
        if self.kkt.is_still(row) {
            return Ok(Conflict::Still { row: self.rows.component(row) });
        }
        let own = self.rows.name(row);
        let mut constraints: Vec<String> = Vec::new();
        for other in self.kkt.sum_of(row).into_iter().map(|other| self.rows.name(other)) {
            if other != own && !constraints.iter().any(|name| name == other) {
                constraints.push(other.to_owned());
            }
        }
        Ok(if constraints.is_empty() { Conflict::Itself } else { Conflict::Earlier { constraints } })
    }

    /// The held joints that would move a row; all of them if they do so by way of other rows.
    fn holding(&self, row: usize, held: &[bool], weights: &[f64]) -> Vec<String> {
        let moves: Vec<f64> =
            self.rows.jacobian().row(row).iter().zip(weights).map(|(j, weight)| j * j * weight).collect();
        let all: f64 = moves.iter().sum();
        let names = |counts: &dyn Fn(usize) -> bool| {
            let mut names: Vec<String> = Vec::new();
            for i in (0..held.len()).filter(|i| held[*i] && counts(*i)) {
                let name = self.tree.joint_name(i);
                if !names.iter().any(|known| known == name) {
                    names.push(name.to_owned());
                }
            }
            names
        };
        let found = names(&|i| moves[i] > SHARE * all);
        if found.is_empty() { names(&|_| true) } else { found }
    }
}
