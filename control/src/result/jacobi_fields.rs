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
/// comparable: small ones are differences of large terms. Where there is a `rough` transition too, the margin
/// also covers the difference that it makes.
fn certain_count(
    fields: &DMatrix<f64>,
    transition: &DMatrix<f64>,
    rough: Option<&DMatrix<f64>>,
    tolerance: f64,
) -> Result<usize, Undecided> {
    let Bracket { form, sizes } = bracket(fields, transition)?;
    let scaled = |form: &DMatrix<f64>| {
        DMatrix::from_fn(sizes.len(), sizes.len(), |i, j| form[(i, j)] / (sizes[i] * sizes[j]).sqrt())
    };
    let form = scaled(&form);
    let difference = match rough {
        Some(rough) => (scaled(&bracket(fields, rough)?.form) - &form).amax(),
        None => 0.0,
    };
    if form.iter().any(|entry| !entry.is_finite()) || difference.is_nan() {
        return Err(Undecided);
    }
    let error = (CLEAR * (&form - form.transpose()).amax().max(tolerance)).max(difference);
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
    /// Transition from each cut to the next ..
    pub over: Vec<DMatrix<f64>>,
    /// .. and a rougher one, where these are collocated.
    pub rough: Vec<DMatrix<f64>>,
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
        self.product(&self.over[i..j])
    }

    fn product(&self, transitions: &[DMatrix<f64>]) -> DMatrix<f64> {
        let size = self.at[0].nrows();
        transitions.iter().fold(DMatrix::identity(size, size), |product, next| next * product)
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
        let of_piece = |(piece, ends): (usize, &[usize])| {
            let (from, to) = (ends[0], ends[1]);
            let rough = self.rough.get(from..to).map(|rough| self.product(rough));
            match piece {
                0 => Ok(0),
                _ => certain_count(&self.at[from], &self.transition(from, to), rough.as_ref(), tolerance),
            }
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
        certain_count(&fields, &transition, None, 1e-11).ok()
    }

    /// A rough transition that differs by as much as the bracket decides nothing.
    #[test]
    fn a_sign_that_a_rough_transition_does_not_share_decides_nothing() {
        let fields = DMatrix::from_column_slice(2, 1, &[1.0, -1.0]);
        let of = |ratio: f64| DMatrix::from_row_slice(2, 2, &[ratio, 1.0, 0.0, 1.0]);
        let count = |rough: f64| certain_count(&fields, &of(1.01), Some(&of(rough)), 1e-11).ok();
        assert_eq!([1.012, 0.995].map(count), [Some(0), None]);
    }

    #[test]
    fn a_sign_that_the_integration_does_not_determine_decides_nothing() {
        assert_eq!([counted(-1.0, 1.0 + 1e-7), counted(-1.0, 1.0 - 1e-7)], [Some(0), Some(1)]);
        for ratio in [1.0 + 1e-11, 1.0, 1.0 - 1e-11] {
            assert_eq!(counted(-1.0, ratio), None);
        }
    }
}
