//! Jacobi fields along a motion, and how many of them vanish in each part of it: the inertia of the bracket
//! of [`conjugate`](crate::result::conjugate).

use crate::constants::checks::jacobi_fields::{CLEAR, MOST_ASYMMETRY, ZERO};
use nalgebra::{DMatrix, DVector};

/// Why conjugate times could not be counted.
pub(crate) struct Undecided;

/// The fields at one node, 2N x N, with orthonormal columns: only their span matters.
pub(crate) fn orthonormal(fields: DMatrix<f64>) -> DMatrix<f64> {
    fields.qr().q()
}

/// A symmetric matrix with the signs of the bracket.
struct Bracket {
    form: DMatrix<f64>,
    /// The sizes of the two terms of each entry of its diagonal.
    sizes: DVector<f64>,
}

/// The bracket of a part of the motion, up to a congruence: `fields` at its start, `transition` to its end.
fn bracket(fields: &DMatrix<f64>, transition: &DMatrix<f64>) -> Result<Bracket, Undecided> {
    let n = fields.ncols();
    let (x, y) = (fields.rows(0, n), fields.rows(n, n));
    let (a, b) = (transition.view((0, 0), (n, n)), transition.view((0, n), (n, n)));
    let quotient = b.into_owned().lu().solve(&a.into_owned()).ok_or(Undecided)?;
    let asymmetry = (&quotient - quotient.transpose()).amax() / quotient.amax();
    if asymmetry.is_nan() || asymmetry > MOST_ASYMMETRY {
        return Err(Undecided);
    }
    // A congruence with X keeps the signs, and exists where X is singular too.
    let (of_fields, of_transition) = (x.transpose() * y, x.transpose() * quotient * x);
    let sizes = of_fields.diagonal().abs() + of_transition.diagonal().abs();
    Ok(Bracket { form: of_fields + of_transition, sizes })
}

/// Eigenvalues that are not positive, without a margin: to locate a conjugate time, where one of them
/// vanishes.
pub(crate) fn count(fields: &DMatrix<f64>, transition: &DMatrix<f64>) -> Result<usize, Undecided> {
    let Bracket { form, .. } = bracket(fields, transition)?;
    let eigenvalues = (0.5 * (&form + form.transpose())).symmetric_eigenvalues();
    let bound = ZERO * eigenvalues.amax();
    Ok(eigenvalues.iter().filter(|&&value| value <= bound).count())
}

/// Conjugate times in a part of the motion, by a margin that covers the error of an integration with this
/// tolerance.
///
/// The bracket is scaled by the size of the two terms of its diagonal, which makes its eigenvalues
/// comparable: small ones are differences of large terms.
fn certain_count(
    fields: &DMatrix<f64>,
    transition: &DMatrix<f64>,
    tolerance: f64,
) -> Result<usize, Undecided> {
    let Bracket { mut form, sizes } = bracket(fields, transition)?;
    for (i, j) in (0..sizes.len()).flat_map(|i| (0..sizes.len()).map(move |j| (i, j))) {
        form[(i, j)] /= (sizes[i] * sizes[j]).sqrt();
    }
    if form.iter().any(|entry| !entry.is_finite()) {
        return Err(Undecided);
    }
    let error = CLEAR * (&form - form.transpose()).amax().max(tolerance);
    let eigenvalues = (0.5 * (&form + form.transpose())).symmetric_eigenvalues();
    if eigenvalues.iter().any(|value| value.abs() <= error) {
        return Err(Undecided);
    }
    Ok(eigenvalues.iter().filter(|&&value| value < 0.0).count())
}

/// A part of a mesh interval, in seconds from its start.
#[derive(Clone, Copy)]
pub(crate) struct Part {
    pub span: usize,
    pub from: f64,
    pub to: f64,
}

/// The fields and transition matrices of a motion, from cut to cut: the nodes of the mesh, and more where the
/// mesh is too coarse.
pub(crate) struct Fields {
    /// Times of the cuts (s).
    pub times: Vec<f64>,
    /// Fields at the cuts.
    pub at: Vec<DMatrix<f64>>,
    /// Transition from each cut to the next.
    pub over: Vec<DMatrix<f64>>,
    /// Where each cut and the next are on the mesh.
    pub parts: Vec<Part>,
    /// Cuts that divide the motion into pieces which hold no pair of conjugate times.
    pub borders: Vec<usize>,
    /// Those of them where a longer piece might hold a pair.
    pub needed: Vec<usize>,
}

impl Fields {
    /// Transition from cut i to cut j.
    pub fn transition(&self, i: usize, j: usize) -> DMatrix<f64> {
        let size = self.at[0].nrows();
        self.over[i..j].iter().fold(DMatrix::identity(size, size), |product, next| next * product)
    }

    /// The borders of about half as many pieces, except for the first piece.
    pub fn coarse(&self) -> Vec<usize> {
        let last = self.borders.len() - 1;
        let keep = |&(i, border): &(usize, &usize)| {
            i == 0 || i % 2 == 1 || i == last || self.needed.contains(border)
        };
        self.borders.iter().enumerate().filter(keep).map(|(_, &border)| border).collect()
    }

    /// The number of conjugate times in each piece; none in the first one.
    pub fn counts(&self, borders: &[usize], tolerance: f64) -> Result<Vec<usize>, Undecided> {
        let of_piece = |(piece, ends): (usize, &[usize])| match piece {
            0 => Ok(0),
            _ => certain_count(&self.at[ends[0]], &self.transition(ends[0], ends[1]), tolerance),
        };
        borders.windows(2).enumerate().map(of_piece).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::certain_count;
    use nalgebra::DMatrix;

    /// One state: X = 1, and the bracket is Y + A/B.
    fn counted(y: f64, ratio: f64) -> Option<usize> {
        let fields = DMatrix::from_column_slice(2, 1, &[1.0, y]);
        let transition = DMatrix::from_row_slice(2, 2, &[ratio, 1.0, 0.0, 1.0]);
        certain_count(&fields, &transition, 1e-11).ok()
    }

    #[test]
    fn a_sign_that_the_integration_does_not_determine_decides_nothing() {
        assert_eq!([counted(-1.0, 1.0 + 1e-7), counted(-1.0, 1.0 - 1e-7)], [Some(0), Some(1)]);
        for ratio in [1.0 + 1e-11, 1.0, 1.0 - 1e-11] {
            assert_eq!(counted(-1.0, ratio), None);
        }
    }
}
