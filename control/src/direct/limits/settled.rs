//! Which equations along a motion hold at an end of a phase whatever the motion is.
//!
//! A row g(q) = 0 holds at an end, and its rate too, where what is given there implies it: to first order,
//! where its gradient is a combination of those of what is given. The point beside the end then has one
//! equation too many; a row that is independent of what is given needs it.

use super::ends::{Ends, Settled};
use super::model::Model;
use crate::constants::direct::IMPLIED;
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::PointDynamics;
use crate::numerics::chain::dot;
use costate::EvalError;

/// Those at all ends, from the gradients of all rows in the states of a guess.
///
/// # Errors
/// States at which rows cannot be evaluated.
pub(crate) fn settled<D: PointDynamics>(
    model: &mut Model<D>,
    spline: &Spline,
    ends: &Ends,
) -> Result<Vec<Settled>, EvalError> {
    let n = spline.dof;
    let mut state = vec![0.0; 2 * n];
    let mut all = Vec::with_capacity(ends.given.len());
    for (end, given) in ends.given.iter().enumerate() {
        spline.end(end, &mut state);
        let [along, at_end] = model.tasks.gradients(end, &state)?;
        let by_q = |rows: &[f64]| rows.chunks_exact(2 * n).map(|row| row[..n].to_vec()).collect::<Vec<_>>();
        let mut place = Span::of_axes(&given[..n]);
        by_q(&at_end).into_iter().for_each(|row| _ = place.takes(row));
        let mut rate = Span::of_axes(&given[n..2 * n]);
        // A row that depends on rates is no place.
        let is_place = |row: &[f64]| row[n..].iter().all(|slope| *slope == 0.0);
        let of_places: Vec<bool> = along.chunks_exact(2 * n).map(is_place).collect();
        let implied = |span: &mut Span| {
            let rows = by_q(&along).into_iter().zip(&of_places);
            rows.map(|(row, &is_place)| is_place && !span.takes(row)).collect()
        };
        all.push(Settled { place: implied(&mut place), rate: implied(&mut rate) });
    }
    Ok(all)
}

/// A space of gradients, by an orthonormal basis.
struct Span {
    basis: Vec<Vec<f64>>,
}

impl Span {
    /// That of the axes that are given.
    fn of_axes(given: &[bool]) -> Self {
        let axis = |i: usize| (0..given.len()).map(|j| f64::from(u8::from(i == j))).collect();
        Self { basis: (0..given.len()).filter(|&i| given[i]).map(axis).collect() }
    }

    /// Takes a gradient. Whether it was outside.
    fn takes(&mut self, mut row: Vec<f64>) -> bool {
        let size = dot(&row, &row).sqrt();
        // Twice, so that rounding does not count as a direction.
        for _ in 0..2 {
            for direction in &self.basis {
                let part = dot(&row, direction);
                row.iter_mut().zip(direction).for_each(|(row, direction)| *row -= part * direction);
            }
        }
        let rest = dot(&row, &row).sqrt();
        if rest <= IMPLIED * size {
            return false;
        }
        row.iter_mut().for_each(|row| *row /= rest);
        self.basis.push(row);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::Span;

    #[test]
    fn combinations_are_inside() {
        let mut span = Span::of_axes(&[false, true, false, false]);
        assert!(span.takes(vec![1.0, 5.0, 2.0, 0.0]));
        assert!(!span.takes(vec![0.0, 3.0, 0.0, 0.0]));
        assert!(!span.takes(vec![-0.5, 1.0, -1.0, 0.0]));
        assert!(span.takes(vec![1.0, 0.0, 0.0, 0.0]));
        // No gradient at all is none.
        assert!(!span.takes(vec![0.0; 4]));
        assert!(span.takes(vec![0.0, 0.0, 1.0, 1e-2]));
        assert!(!span.takes(vec![0.3, 0.2, 0.1, 7.0]));
    }
}
