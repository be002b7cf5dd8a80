//! Where the derivatives of a motion's torques and costs change within a short time.

use super::path::{POWERS, Path, Piece};
use crate::problem::Problem;
use crate::problem::narrow::{self, Narrow};

/// For each piece of a motion the places in it, rising, with 0 and 1, between which its functions of time are
/// smooth and not narrow.
///
/// These are the places of [`Narrow`], roots of the polynomials of the motion, all of which are found: a rate
/// that crosses zero or three transition velocities of dry friction to either side, or the corner or no-load
/// speed of a motor; knots of references; powers that change their sign.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Splits {
    places: Vec<Vec<f64>>,
}

impl Splits {
    /// Those of a motion of a problem.
    pub fn new(problem: &Problem, path: &Path) -> Self {
        let narrow = Narrow::of(problem);
        let of_piece = |piece: &Piece| {
            let q = piece.coefficients();
            let polynomials =
                narrow::Piece { start: piece.start, length: piece.length, q: &q, count: POWERS, tau: &[] };
            let (mut inner, mut places) = (Vec::new(), vec![0.0]);
            narrow.places(&polynomials, &mut inner);
            places.extend(inner);
            places.push(1.0);
            places
        };
        Self { places: path.pieces.iter().map(of_piece).collect() }
    }

    /// The places in a piece.
    pub fn of(&self, piece: usize) -> &[f64] {
        &self.places[piece]
    }

    /// All segments between neighbouring places: the piece, and the parts of it.
    pub fn segments(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        let of = |(k, places): (usize, &'_ Vec<f64>)| -> Vec<(usize, [f64; 2])> {
            places.windows(2).map(|pair| (k, [pair[0], pair[1]])).collect()
        };
        self.places.iter().enumerate().flat_map(of)
    }
}
