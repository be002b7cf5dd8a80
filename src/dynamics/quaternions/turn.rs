//! The orientation of one floating or spherical joint as four plain numbers.

use crate::robot::{FreeJoint, FreeKind};
use crate::scalar::Scalar;
use crate::spatial::{Quaternion, Rotation, Vec3};

/// Derivatives of the orientation `a/|a|` by the entries of a.
///
/// With `conj(a_0) o a = |a_0|^2 (1 + s, w)`, s and w linear in da, the rotation vector from a_0 to a and the
/// displacement rho of the tangent, with `d = R_0' dr`, are to second order
///
/// $$ \theta = 2 w - 2 s w, \qquad \rho = d - w \times d $$
#[derive(Clone, Debug)]
pub(crate) struct Turn<S> {
    /// Its first entries of q and of v.
    pub position: usize,
    pub coordinate: usize,
    /// Whether it moves too.
    pub slides: bool,
    pub rotation: Rotation<S>,
    /// s and w by the entries of a.
    pub s: [S; 4],
    pub w: [Vec3<S>; 4],
    /// `2 a' = rate * omega`, column by column.
    rate: [[S; 4]; 3],
}

impl<S: Scalar> Turn<S> {
    pub fn new(joint: &FreeJoint) -> Self {
        let zero = S::zero();
        Self {
            position: joint.position,
            coordinate: joint.coordinate,
            slides: joint.kind == FreeKind::Floating,
            rotation: Rotation { rows: [Vec3::zero(); 3] },
            s: [zero; 4],
            w: [Vec3::zero(); 4],
            rate: [[zero; 4]; 3],
        }
    }

    /// Its first entry of the quaternion, and its first angular coordinate.
    pub fn quaternion(&self) -> usize {
        self.position + self.slides_count()
    }

    pub fn angular(&self) -> usize {
        self.coordinate + self.slides_count()
    }

    fn slides_count(&self) -> usize {
        if self.slides { 3 } else { 0 }
    }

    /// Takes a from the entries of x, and writes `a/|a|`.
    pub fn set(&mut self, x: &[S], q: &mut [S]) {
        let at = self.quaternion();
        let a = [x[at], x[at + 1], x[at + 2], x[at + 3]];
        let by_length = Quaternion::new(a).length().recip();
        let unit = Quaternion::new(a).unit();
        q[at..at + 4].copy_from_slice(&unit.to_array());
        self.rotation = unit.rotation();
        self.rate = rates(a);
        self.s = unit.to_array().map(|entry| entry * by_length);
        let by_square = rates(self.s);
        for (i, column) in self.w.iter_mut().enumerate() {
            *column = Vec3::from([0, 1, 2].map(|k| by_square[k][i]));
        }
    }

    /// `a' = 1/2 a o (omega, 0)`, or the same of a column of a Jacobian.
    pub fn quaternion_rate(&self, omega: Vec3<S>) -> [S; 4] {
        let [x, y, z] = omega.to_array();
        [0, 1, 2, 3].map(|i| {
            let sum = self.rate[0][i] * x + self.rate[1][i] * y + self.rate[2][i] * z;
            sum.times(0.5)
        })
    }

    /// `l` with `y_a . a' = l . omega`.
    pub fn costate(&self, y: [S; 4]) -> Vec3<S> {
        let row = |k: usize| {
            let row = &self.rate[k];
            (row[0] * y[0] + row[1] * y[1] + row[2] * y[2] + row[3] * y[3]).times(0.5)
        };
        Vec3::new(row(0), row(1), row(2))
    }

    /// A row of derivatives by the tangent, of n entries of (linear, angular), as one by (r, a).
    pub fn spread(&self, from: &[S], to: &mut [S]) {
        if self.slides {
            let linear = vector(from, self.coordinate);
            to[self.position..self.position + 3].copy_from_slice(&self.rotation.apply(linear).to_array());
        }
        let angular = vector(from, self.angular());
        let at = self.quaternion();
        for (to, w) in to[at..at + 4].iter_mut().zip(&self.w) {
            *to = angular.dot(*w).times(2.0);
        }
    }
}

/// `a o (omega, 0)`, column by column of omega.
fn rates<S: Scalar>([x, y, z, w]: [S; 4]) -> [[S; 4]; 3] {
    [[w, z, -y, -x], [-z, w, x, -y], [y, -x, w, -z]]
}

/// Three entries.
pub(crate) fn vector<S: Scalar>(entries: &[S], at: usize) -> Vec3<S> {
    Vec3::new(entries[at], entries[at + 1], entries[at + 2])
}

/// Four entries.
pub(crate) fn four<S: Scalar>(entries: &[S], at: usize) -> [S; 4] {
    [entries[at], entries[at + 1], entries[at + 2], entries[at + 3]]
}

/// The derivative of `a o (omega, 0)` by a, row by row.
pub(super) fn by_quaternion<S: Scalar>(omega: Vec3<S>) -> [[S; 4]; 4] {
    let (zero, [x, y, z]) = (S::zero(), omega.to_array());
    [[zero, z, -y, x], [-z, zero, x, y], [y, -x, zero, z], [-x, -y, -z, zero]]
}

/// The derivative of `2 l`, l the costate of omega, by the entries of a.
pub(super) fn costate_slopes<S: Scalar>([x, y, z, w]: [S; 4]) -> [Vec3<S>; 4] {
    [Vec3::new(-w, z, -y), Vec3::new(-z, -w, x), Vec3::new(y, -x, -w), Vec3::new(x, y, z)]
}
