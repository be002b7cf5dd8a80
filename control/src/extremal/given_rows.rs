//! Linear functions that are given at an end, and the directions that they leave free.

use crate::constants::checks::given_rows::INDEPENDENT;

/// Rows of given functions in the free components, and what is orthogonal to them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GivenRows {
    /// The rows, without their entries in fixed components.
    pub rows: Vec<Vec<f64>>,
    /// Unit vectors of the free components that are orthogonal to all rows and to each other.
    pub directions: Vec<Vec<f64>>,
    /// The first row that depends on those before it.
    pub dependent: Option<usize>,
}

impl GivenRows {
    pub fn new(given: &[Vec<f64>], free: &[bool]) -> Self {
        let n = free.len();
        let in_free = |row: &Vec<f64>| -> Vec<f64> {
            row.iter().zip(free).map(|(c, free)| if *free { *c } else { 0.0 }).collect()
        };
        let rows: Vec<Vec<f64>> = given.iter().map(in_free).collect();
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let mut dependent = None;
        for (number, row) in rows.iter().enumerate() {
            match independent_part(&basis, row) {
                Some(unit) => basis.push(unit),
                None => dependent = dependent.or(Some(number)),
            }
        }
        let of_rows = basis.len();
        let count = free.iter().filter(|free| **free).count();
        let unit = |i: usize| (0..n).map(|j| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
        // Each time the unit vector of which most is left, the first of several.
        while basis.len() < count {
            let left = |i: &usize| 1.0 - basis.iter().map(|unit| unit[*i] * unit[*i]).sum::<f64>();
            let best = (0..n).rev().filter(|i| free[*i]).max_by(|a, b| left(a).total_cmp(&left(b)));
            let Some(direction) = best.and_then(|best| independent_part(&basis, &unit(best))) else { break };
            basis.push(direction);
        }
        Self { rows, directions: basis.split_off(of_rows), dependent }
    }
}

/// What is left of a row beside orthogonal unit vectors, as a unit vector.
fn independent_part(basis: &[Vec<f64>], row: &[f64]) -> Option<Vec<f64>> {
    let norm = |row: &[f64]| row.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
    let mut left = row.to_vec();
    // Twice, for rounding.
    for unit in basis.iter().chain(basis) {
        let along: f64 = unit.iter().zip(&left).map(|(a, b)| a * b).sum();
        left.iter_mut().zip(unit).for_each(|(entry, unit)| *entry -= along * unit);
    }
    let length = norm(&left);
    // Not true for NaN.
    let is_independent = length > INDEPENDENT * norm(row);
    is_independent.then(|| left.iter().map(|entry| entry / length).collect())
}

#[cfg(test)]
mod tests {
    use super::GivenRows;

    #[test]
    fn directions_are_orthogonal_to_the_rows() {
        let given = [vec![9.0, 0.6, 0.0, 0.8, 0.0], vec![0.0, 1.0, 1.0, 1.0, 0.0]];
        let free = [false, true, true, true, true];
        let found = GivenRows::new(&given, &free);
        assert_eq!((found.rows[0][0], found.dependent, found.directions.len()), (0.0, None, 2));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for (i, direction) in found.directions.iter().enumerate() {
            assert!(found.rows.iter().all(|row| dot(row, direction).abs() < 1e-14));
            assert!((dot(direction, direction) - 1.0).abs() < 1e-14 && direction[0] == 0.0);
            assert!(found.directions[..i].iter().all(|other| dot(other, direction).abs() < 1e-14));
        }
        // In the free components the third row is the first one.
        let given = [given[0].clone(), given[1].clone(), vec![-1.0, 0.6, 0.0, 0.8, 0.0]];
        assert_eq!(GivenRows::new(&given, &free).dependent, Some(2));
        // Without rows the directions are the free components.
        let alone = GivenRows::new(&[], &[true, false, true]).directions;
        assert_eq!(alone.iter().flatten().filter(|entry| **entry == 1.0).count(), 2);
    }
}
