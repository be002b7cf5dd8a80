//! Brackets of the displacements of floating and spherical joints, which do not commute.
//!
//! With linear and angular parts v = (v, w) and p = (f, m), of spherical joints angular ones alone,
//!
//! $$ K(p) = \begin{pmatrix} 0 & \hat f \\\\ \hat f & \hat m \end{pmatrix}, \qquad
//! N(v) = \begin{pmatrix} \hat w & 0 \\\\ \hat v & \hat w \end{pmatrix}, \qquad
//! [e\_i, v] = \sum\_k N\_{ik} e\_k, \qquad K\_{ij} = p \cdot [e\_j, e\_i] $$
//!
//! so that `K(p) v = -N(v) p` is the coadjoint action of v on p (J. E. Marsden, T. S. Ratiu, Introduction to
//! Mechanics and Symmetry (1999), section 13.5), and derivatives of a function along e_j, then of that along
//! e_i, differ from those in the other order by K_ji of its gradient.

use crate::matrix::Entry;
use crate::robot::{FreeKind, Tree};
use crate::scalar::Scalar;

/// The brackets of all floating and spherical joints.
#[derive(Clone, Debug)]
pub(crate) struct Brackets<S> {
    /// First linear coordinate, if there is one, and first angular one.
    places: Vec<(Option<usize>, usize)>,
    /// Those of K or N computed last.
    entries: Vec<Entry<S>>,
}

impl<S: Scalar> Brackets<S> {
    /// Without such joints all methods do nothing.
    pub fn new(tree: &Tree) -> Self {
        let place = |at: usize, kind: FreeKind| ((kind.slides() > 0).then_some(at), at + kind.slides());
        let places: Vec<_> =
            tree.free().iter().map(|free| place(free.joint.coordinate, free.joint.kind)).collect();
        Self { entries: Vec::with_capacity(18 * places.len()), places }
    }

    /// K(p) of a momentum, n.
    pub fn of_momentum(&mut self, p: &[S]) -> &[Entry<S>] {
        self.entries.clear();
        for &(linear, angular) in &self.places {
            cross(&mut self.entries, [angular, angular], &p[angular..]);
            if let Some(linear) = linear {
                cross(&mut self.entries, [linear, angular], &p[linear..]);
                cross(&mut self.entries, [angular, linear], &p[linear..]);
            }
        }
        &self.entries
    }

    /// N(v) of a velocity, n.
    pub fn of_velocity(&mut self, v: &[S]) -> &[Entry<S>] {
        self.entries.clear();
        for &(linear, angular) in &self.places {
            cross(&mut self.entries, [angular, angular], &v[angular..]);
            if let Some(linear) = linear {
                cross(&mut self.entries, [linear, linear], &v[angular..]);
                cross(&mut self.entries, [angular, linear], &v[linear..]);
            }
        }
        &self.entries
    }
}

/// The matrix of `a x` in rows and columns from these on.
fn cross<S: Scalar>(entries: &mut Vec<Entry<S>>, [row, column]: [usize; 2], a: &[S]) {
    for (i, j, value) in
        [(0, 1, -a[2]), (0, 2, a[1]), (1, 0, a[2]), (1, 2, -a[0]), (2, 0, -a[1]), (2, 1, a[0])]
    {
        entries.push(Entry { row: row + i, column: column + j, value });
    }
}
