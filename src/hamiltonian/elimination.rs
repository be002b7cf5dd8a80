//! Where the entries of the matrices of F_x and y'F_xx are, and the products that give F_x.

use crate::kernels::Factor;
use crate::matrix::{Part, Pattern, Terms, Tiles};
use crate::scalar::Scalar;

/// Products with the triangular matrix `R = L^-1 D^-1/2`, `M^-1 = R R'`, that give the conservative part of
/// F_x.
#[derive(Clone, Debug)]
pub(super) struct Elimination {
    /// `Y = R' P`.
    pub upper: Tiles,
    /// `Y' Y`.
    pub square: Tiles,
    /// `W = R Y`.
    pub lower: Tiles,
}

/// Where the entries of the matrices are.
pub(super) struct Patterns {
    /// R, with its diagonal, and R'.
    pub u: Pattern,
    pub u_across: Pattern,
    /// M, P and L_qq, their diagonals included.
    pub pair: Pattern,
    /// `Y = R' P`.
    pub y: Pattern,
}

impl Patterns {
    pub fn new<S: Scalar>(factor: &Factor<S>) -> Self {
        let (u, below) = (factor.inverse_pattern(), factor.pattern());
        let u_across = u.transposed();
        let pair = below.or(&below.transposed()).with_diagonal();
        let y = u_across.times(&pair);
        Self { u, u_across, pair, y }
    }
}

impl Elimination {
    pub fn new<S: Scalar>(factor: &Factor<S>) -> Self {
        let Patterns { u, u_across, pair, y } = Patterns::new(factor);
        let tiles = |a: &Pattern, b: &Pattern, part| Tiles::new::<S>(a, b, part, Terms::All);
        Self {
            upper: tiles(&u_across, &pair, Part::Whole),
            square: tiles(&y.transposed(), &y, Part::Lower),
            lower: tiles(&u, &y, Part::Whole),
        }
    }
}
