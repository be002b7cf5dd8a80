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
/// Displacements of the chain of joints are along the axes of the parent, those of the chart along those of
/// the moved frame.
#[derive(Clone, Debug)]
pub(crate) struct ChartFrame<S> {
    free: FreeFrame,
    pub chart: Chart,
    /// From the axes of the moved frame to those of the parent.
    rotation: Rotation<S>,
}

impl<S: Scalar> ChartFrame<S> {
    pub fn new(free: &FreeFrame) -> Self {
        let rotation = Rotation { rows: [Vec3::zero(); 3] };
        Self { free: free.clone(), chart: Chart::new(free.joint.kind), rotation }
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

    fn slides(&self) -> bool {
        self.free.joint.kind == FreeKind::Floating
    }

    /// Takes the orientation from q.
    pub fn set_configuration(&mut self, q: &[S]) {
        self.rotation = self.free.quaternion(q).rotation();
    }

    /// The linear components of a vector of n entries from the axes of the frame to those of the parent.
    pub fn outward(&self, vector: &mut [S]) {
        self.turned(vector, |rotation, linear| rotation.apply(linear));
    }

    /// And back.
    pub fn inward(&self, vector: &mut [S]) {
        self.turned(vector, |rotation, linear| rotation.undo(linear));
    }

    fn turned(&self, vector: &mut [S], turn: impl Fn(&Rotation<S>, Vec3<S>) -> Vec3<S>) {
        let (at, _) = self.place();
        if let (true, [x, y, z]) = (self.slides(), &mut vector[at..at + 3]) {
            [*x, *y, *z] = turn(&self.rotation, Vec3::new(*x, *y, *z)).to_array();
        }
    }

    /// Rows and columns of an n x n block of a matrix, from the axes of the parent to those of the frame.
    pub fn turn_block(&self, matrix: &mut Matrix<S>, [top, left]: [usize; 2], n: usize) {
        if !self.slides() {
            return;
        }
        let (at, _) = self.place();
        for i in top..top + n {
            self.inward(&mut matrix.row_mut(i)[left..left + n]);
        }
        for j in left..left + n {
            let column = [0, 1, 2].map(|k| matrix[(top + at + k, j)]);
            let turned = self.rotation.undo(Vec3::from(column)).to_array();
            turned.into_iter().enumerate().for_each(|(k, entry)| matrix[(top + at + k, j)] = entry);
        }
    }
}
