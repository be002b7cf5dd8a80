//! A spline as polynomials of time.

use super::spline::Spline;
use crate::verify::path::{Path, Piece};

impl Spline {
    /// The same motion as the verification takes it: polynomials of time between the nodes.
    pub fn path(&self) -> Path {
        let n = self.dof;
        let (mut left, mut right) = (vec![0.0; 4 * n], vec![0.0; 3 * n]);
        let mut start = 0.0;
        let pieces = (0..self.mesh.intervals()).map(|k| {
            self.in_interval(k, 0.0, &mut left);
            self.in_interval(k, 1.0, &mut right);
            let piece = Piece::through(start, self.length(k), self.mesh.phase(k), &left, &right);
            start += self.length(k);
            piece
        });
        Path { dof: n, pieces: pieces.collect() }
    }
}
