//! Directions that closed loops leave to the coordinates.

use crate::constants::checks::loops::INDEPENDENT;
use costate::constraints::Constraints;

/// At most `most` of the given coordinates that are independent of each other and of the rows, at the
/// position of the rows: each time the one of which most is left.
pub(super) fn independent(rows: &Constraints<f64>, given: &[bool], most: usize) -> Vec<usize> {
    let n = given.len();
    let mut basis = basis_of(rows);
    let mut kept: Vec<usize> = Vec::new();
    while kept.len() < most {
        let left = |i: &usize| 1.0 - basis.iter().map(|unit| unit[*i] * unit[*i]).sum::<f64>();
        let open = (0..n).filter(|i| given[*i] && !kept.contains(i));
        let best = open.max_by(|a, b| left(a).total_cmp(&left(b)));
        let Some(best) = best.filter(|best| left(best) > INDEPENDENT) else { break };
        add(&mut basis, axis(best, n));
        kept.push(best);
    }
    kept
}

/// Rates with `J v = 0` at the position of the rows that are nearest to the given ones: the sum of squares of
/// what those differ by is least.
pub(super) fn nearest_rates(rows: &Constraints<f64>, v: &[f64], given: &[bool]) -> Vec<f64> {
    let n = v.len();
    let mut basis = basis_of(rows);
    let bound = basis.len();
    (0..n).for_each(|i| add(&mut basis, axis(i, n)));
    // Directions with J v = 0 whose given entries are orthonormal.
    let dot = |a: &[f64], b: &[f64]| -> f64 { (0..n).filter(|i| given[*i]).map(|i| a[i] * b[i]).sum() };
    let mut allowed: Vec<Vec<f64>> = Vec::new();
    for mut direction in basis.split_off(bound) {
        for unit in allowed.iter().chain(allowed.iter()) {
            let along = dot(unit, &direction);
            direction.iter_mut().zip(unit).for_each(|(to, unit)| *to -= along * unit);
        }
        let left = dot(&direction, &direction).sqrt();
        if left > INDEPENDENT {
            direction.iter_mut().for_each(|entry| *entry /= left);
            allowed.push(direction);
        }
    }
    let mut nearest = vec![0.0; n];
    for direction in &allowed {
        let along = dot(direction, v);
        nearest.iter_mut().zip(direction).for_each(|(to, entry)| *to += along * entry);
    }
    nearest
}

/// An orthonormal basis of the rows of J.
fn basis_of(rows: &Constraints<f64>) -> Vec<Vec<f64>> {
    let mut basis = Vec::new();
    (0..rows.count()).for_each(|row| add(&mut basis, rows.jacobian().row(row).to_vec()));
    basis
}

/// Adds what of a row is orthogonal to the others, if there is anything.
fn add(basis: &mut Vec<Vec<f64>>, mut row: Vec<f64>) {
    let size = norm(&row);
    // Twice, for rounding.
    for unit in basis.iter().chain(basis.iter()) {
        let along: f64 = unit.iter().zip(&row).map(|(a, b)| a * b).sum();
        row.iter_mut().zip(unit).for_each(|(to, unit)| *to -= along * unit);
    }
    let left = norm(&row);
    if left > INDEPENDENT * size {
        row.iter_mut().for_each(|entry| *entry /= left);
        basis.push(row);
    }
}

fn axis(i: usize, n: usize) -> Vec<f64> {
    (0..n).map(|j| f64::from(u8::from(j == i))).collect()
}

fn norm(row: &[f64]) -> f64 {
    row.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use costate::robot::Robot;

    fn rows_at(q: &[f64]) -> Constraints<f64> {
        let mut rows = Constraints::new(&Robot::from_file("../robots/four_bar.toml").unwrap());
        rows.set_position(q).unwrap();
        rows
    }

    fn leads(rows: &Constraints<f64>, v: &[f64]) -> f64 {
        let rate = |row| rows.jacobian().row(row).iter().zip(v).map(|(j, v)| j * v).sum::<f64>();
        (0..rows.count()).map(rate).fold(0.0, |most, rate| most.max(rate.abs()))
    }

    /// With one direction u of motion, (v.u) u / (u.u) over the given entries.
    #[test]
    fn nearest_rates_are_those_of_the_one_motion_that_is_left() {
        let rows = rows_at(&[1.0, -0.591_737_918_7, -2.058_615_394]);
        let unit = nearest_rates(&rows, &[1.0, 0.0, 0.0], &[true, false, false]);
        assert!((unit[0] - 1.0).abs() < 1e-12 && leads(&rows, &unit) < 1e-12, "{unit:?}");
        assert!(unit[1].abs() > 0.1 && unit[2].abs() > 0.1, "{unit:?}");
        let found = nearest_rates(&rows, &[1.0, 5.0, 9.0], &[true, true, false]);
        let along = (1.0 + 5.0 * unit[1]) / (1.0 + unit[1] * unit[1]);
        assert!(found.iter().zip(&unit).all(|(found, unit)| (found - along * unit).abs() < 1e-12));
        // Nothing is given: nothing is asked for.
        assert_eq!(nearest_rates(&rows, &[1.0, 5.0, 9.0], &[false; 3]), [0.0; 3]);
    }

    #[test]
    fn as_many_coordinates_stay_given_as_motions_are_left() {
        let rows = rows_at(&[1.0, -0.591_737_918_7, -2.058_615_394]);
        assert_eq!(independent(&rows, &[true; 3], 3).len(), 1);
        assert_eq!(independent(&rows, &[false, true, false], 1), [1]);
        assert_eq!(independent(&rows, &[false; 3], 1), [0; 0]);
    }
}
