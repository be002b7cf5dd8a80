//! The armature matrix: constant rotor inertia that is added to the mass matrix.

use super::error::RobotError;
use super::range::is_moderate;
use nalgebra::{DMatrix, SymmetricEigen};

/// Relative rounding that published figures are allowed.
const ROUNDING: f64 = 1e-9;

/// A symmetric matrix by its entries `(i, j, A_ij)`, i >= j, that are not zero, row by row.
///
/// Most robots have a diagonal one, or none: memory grows with the entries, not with n^2.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Armature {
    n: usize,
    entries: Vec<(usize, usize, f64)>,
}

impl Armature {
    /// A diagonal matrix; its entries have been checked.
    pub(super) fn diagonal(of_joints: impl ExactSizeIterator<Item = f64>) -> Self {
        let n = of_joints.len();
        let entries = of_joints.enumerate().map(|(i, value)| (i, i, value)).filter(|entry| entry.2 != 0.0);
        Self { n, entries: entries.collect() }
    }

    /// # Errors
    /// [`RobotError::BadArmature`] unless the matrix is symmetric and positive semidefinite.
    pub(super) fn from_matrix(matrix: &DMatrix<f64>) -> Result<Self, RobotError> {
        check(matrix)?;
        let lower = (0..matrix.nrows()).flat_map(|i| (0..=i).map(move |j| (i, j)));
        let entries = lower.map(|(i, j)| (i, j, matrix[(i, j)])).filter(|entry| entry.2 != 0.0);
        Ok(Self { n: matrix.nrows(), entries: entries.collect() })
    }

    /// The same among n joints, joint `i` being number `numbers[i]` of them, in the same order.
    pub(super) fn spread(&self, n: usize, numbers: &[usize]) -> Self {
        let entries = self.entries.iter().map(|&(i, j, value)| (numbers[i], numbers[j], value));
        Self { n, entries: entries.collect() }
    }

    pub(super) fn entries(&self) -> &[(usize, usize, f64)] {
        &self.entries
    }

    /// The same with another entry `A_ii`.
    ///
    /// # Errors
    /// [`RobotError::BadArmature`] where entries beside it would make the matrix indefinite.
    pub(super) fn with_diagonal(&self, i: usize, value: f64) -> Result<Self, RobotError> {
        if self.entries.iter().all(|(i, j, _)| i == j) {
            let diagonal = (0..self.n).map(|k| if k == i { value } else { self.entry(k, k) });
            return Ok(Self::diagonal(diagonal));
        }
        let mut matrix = self.matrix();
        matrix[(i, i)] = value;
        Self::from_matrix(&matrix)
    }

    /// Rows and columns of these joints, which rise.
    pub(super) fn restricted_to(&self, joints: &[usize]) -> Self {
        let new = |old: usize| joints.binary_search(&old).ok();
        let entries = self.entries.iter().filter_map(|&(i, j, value)| Some((new(i)?, new(j)?, value)));
        Self { n: joints.len(), entries: entries.collect() }
    }

    /// `A_ij`.
    pub(super) fn entry(&self, i: usize, j: usize) -> f64 {
        let key = (i.max(j), i.min(j));
        let found = self.entries.binary_search_by_key(&key, |&(row, column, _)| (row, column));
        found.map_or(0.0, |at| self.entries[at].2)
    }

    pub(super) fn matrix(&self) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.n, self.n);
        for &(i, j, value) in &self.entries {
            (matrix[(i, j)], matrix[(j, i)]) = (value, value);
        }
        matrix
    }
}

/// Symmetric and positive semidefinite.
fn check(matrix: &DMatrix<f64>) -> Result<(), RobotError> {
    let n = matrix.nrows();
    let bad = |problem: String| Err(RobotError::BadArmature { problem, n });
    if matrix.iter().any(|x| !x.is_finite()) {
        return bad("has an entry that is not finite".into());
    }
    let size = matrix.amax();
    if !is_moderate(size) {
        return bad(format!("has an entry of {size:e}, larger than 1e75"));
    }
    if (matrix - matrix.transpose()).amax() > ROUNDING * size {
        return bad("is not symmetric".into());
    }
    let diagonal = matrix.diagonal();
    let is_diagonal = (matrix - DMatrix::from_diagonal(&diagonal)).iter().all(|x| *x == 0.0);
    let smallest =
        if is_diagonal { diagonal.min() } else { SymmetricEigen::new(matrix.clone()).eigenvalues.min() };
    if smallest < -ROUNDING * size {
        return bad(format!("has the negative eigenvalue {smallest:.3e}"));
    }
    Ok(())
}
