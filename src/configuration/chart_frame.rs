//! Where the chart of a floating or spherical joint is, and between which axes.

use super::chart::Chart;
use crate::matrix::Matrix;
use crate::robot::{FreeFrame, FreeKind};
use crate::scalar::Scalar;
use crate::spatial::{Rotation, Vec3};

/// A joint has at most six degrees of freedom.
pub(crate) const MOST: usize = 6;

/// The chart of one joint at a configuration.
///
/// Displacements of the chart are along the axes of the moved frame, those of the chain of joints along the
/// axes of the parent, or [along the same](Self::set_own_axes).
#[derive(Clone, Debug)]
pub(crate) struct ChartFrame<S> {
    free: FreeFrame,
    pub chart: Chart,
    /// From the axes of the moved frame to those of the parent, where displacements of the chain are along
    /// these.
    rotation: Option<Rotation<S>>,
}

impl<S: Scalar> ChartFrame<S> {
    pub fn new(free: &FreeFrame) -> Self {
        Self { free: free.clone(), chart: Chart::new(free.joint.kind), rotation: None }
    }

    /// Its first coordinate and how many there are.
    pub fn place(&self) -> (usize, usize) {
        (self.free.joint.coordinate, self.free.joint.kind.dof())
    }

    /// Its entries of a vector of n entries; zeros beyond.
    pub fn entries(&self, vector: &[S]) -> [S; MOST] {
        let (at, m) = self.place();
        let mut own = [S::zero(); MOST];
        own[..m].copy_from_slice(&vector[at..at + m]);
        own
    }

    /// Takes the orientation from q.
    pub fn set_configuration(&mut self, q: &[S]) {
        let slides = self.free.joint.kind == FreeKind::Floating;
        self.rotation = slides.then(|| self.free.quaternion(q).rotation());
    }

    /// The chain is displaced along the axes of the moved frame, whatever its orientation: nothing is turned.
    pub fn set_own_axes(&mut self) {
        self.rotation = None;
    }

    /// The linear components of a vector of n entries from the axes of the frame to those of the parent.
    pub fn outward(&self, vector: &mut [S]) {
        self.turned(vector, |rotation, linear| rotation.apply(linear));
    }

    /// And back.
    pub fn inward(&self, vector: &mut [S]) {
        self.turned(vector, |rotation, linear| rotation.undo(linear));
    }

    /// The same for the entries of the joint alone.
    pub fn outward_own(&self, own: &mut [S; MOST]) {
        if let (Some(rotation), [x, y, z, ..]) = (&self.rotation, own) {
            [*x, *y, *z] = rotation.apply(Vec3::new(*x, *y, *z)).to_array();
        }
    }

    fn turned(&self, vector: &mut [S], turn: impl Fn(&Rotation<S>, Vec3<S>) -> Vec3<S>) {
        let (at, _) = self.place();
        if let (Some(rotation), [x, y, z]) = (&self.rotation, &mut vector[at..at + 3]) {
            [*x, *y, *z] = turn(rotation, Vec3::new(*x, *y, *z)).to_array();
        }
    }

    /// Rows `top` to `top + 2` of a matrix, the linear components, from the axes of the parent to those of
    /// the frame.
    fn turn_rows(&self, matrix: &mut Matrix<S>, top: usize) {
        let Some(Rotation { rows: [a, b, c] }) = self.rotation else { return };
        let undo = |i: fn(Vec3<S>) -> S| [i(a), i(b), i(c)];
        let [to_x, to_y, to_z] = [undo(|row| row.x), undo(|row| row.y), undo(|row| row.z)];
        let [first, second, third] = matrix.three_rows_mut(top);
        for ((x, y), z) in first.iter_mut().zip(second).zip(third) {
            let along = |[a, b, c]: [S; 3]| a.mul_add(*x, b.mul_add(*y, c * *z));
            [*x, *y, *z] = [along(to_x), along(to_y), along(to_z)];
        }
    }

    /// The linear components of rows and columns of a symmetric matrix, which begin at these places, from the
    /// axes of the parent to those of the frame. The matrix stays symmetric to the last digit.
    pub fn turn_symmetric(&self, matrix: &mut Matrix<S>, places: &[usize]) {
        if self.rotation.is_none() {
            return;
        }
        places.iter().for_each(|&top| self.turn_rows(matrix, top));
        self.turn_corners(matrix, places);
        for row in places.iter().flat_map(|&top| top..top + 3) {
            for j in 0..matrix.rows() {
                matrix[(j, row)] = matrix[(row, j)];
            }
        }
    }

    /// The same for an F_x without friction: with J = (0, 1; -1, 0), J F_x is symmetric.
    pub fn turn_symplectic(&self, f_x: &mut Matrix<S>) {
        if self.rotation.is_none() {
            return;
        }
        let (n, at) = (f_x.rows() / 2, self.free.joint.coordinate);
        let places = [at, n + at];
        places.iter().for_each(|&top| self.turn_rows(f_x, top));
        self.turn_corners(f_x, &places);
        for row in at..at + 3 {
            for j in (0..at).chain(at + 3..n) {
                f_x[(j, row)] = -f_x[(n + row, n + j)];
                f_x[(j, n + row)] = f_x[(row, n + j)];
                f_x[(n + j, row)] = f_x[(n + row, j)];
                f_x[(n + j, n + row)] = -f_x[(row, j)];
            }
        }
    }

    /// The entries of both rows and columns that begin at these places, where the rows are turned already.
    fn turn_corners(&self, matrix: &mut Matrix<S>, places: &[usize]) {
        let Some(rotation) = &self.rotation else { return };
        for row in places.iter().flat_map(|&top| top..top + 3) {
            for &left in places {
                if let [x, y, z] = &mut matrix.row_mut(row)[left..left + 3] {
                    [*x, *y, *z] = rotation.undo(Vec3::new(*x, *y, *z)).to_array();
                }
            }
        }
    }

    /// Rows and columns of an n x n block of a matrix, from the axes of the parent to those of the frame.
    pub fn turn_block(&self, matrix: &mut Matrix<S>, [top, left]: [usize; 2], n: usize) {
        let Some(rotation) = &self.rotation else { return };
        let (at, _) = self.place();
        for i in top..top + n {
            self.inward(&mut matrix.row_mut(i)[left..left + n]);
        }
        for j in left..left + n {
            let column = [0, 1, 2].map(|k| matrix[(top + at + k, j)]);
            let turned = rotation.undo(Vec3::from(column)).to_array();
            turned.into_iter().enumerate().for_each(|(k, entry)| matrix[(top + at + k, j)] = entry);
        }
    }
}
