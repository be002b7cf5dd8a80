//! Orientation errors by the logarithm.

use super::frame::Placed;
use super::logarithm::{curvature, quaternion, rotation_vector};
use super::{Kinematics, ReferenceFrame, put};
use crate::error::{EvalError, check_length};
use crate::matrix::Matrix;
use crate::scalar::Scalar;
use crate::spatial::Vec3;
use nalgebra::Rotation3;

/// Cosine of half the angle below which the error is reported to be at its jump: the angle is then within
/// 2e-6 of a half turn. The rotation of a long chain is known to about 1e-14, its sign there much better than
/// this.
const JUMP: f64 = 1e-6;

/// The rotation from a desired orientation to that of a frame, as a rotation vector.
#[derive(Clone, Copy, Debug)]
pub struct OrientationError<S> {
    /// `e = log(R_d'R)` (rad), in axes of the desired orientation or, which is the same, of the frame.
    pub vector: [S; 3],
    /// Whether the angle |e| is within 2e-6 of a half turn, in any lane. There e jumps to -e: its value and
    /// derivatives are those of one side, and a small motion can lead to the other. Not known (false) for
    /// numbers that are not checked ([`Scalar::CHECKED`]).
    pub at_jump: bool,
}

/// An orientation error with its derivatives; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct OrientationContraction<'a, S> {
    /// e.
    pub error: OrientationError<S>,
    /// `e_q`, 3 x n.
    pub jacobian: &'a Matrix<S>,
    /// `w'e_qq`, n x n, symmetric.
    pub hessian: &'a Matrix<S>,
}

/// An orientation error e, the derivative `G(e)` of the logarithm and what its derivative needs.
struct Error<S> {
    e: Vec3<S>,
    /// `c` and its derivative by the square of the angle.
    c: S,
    slope: S,
    at_jump: bool,
}

impl<S: Scalar> Error<S> {
    fn new(desired: &Rotation3<f64>, frame: &Placed<S>) -> Self {
        let rows = &frame.frame.rows;
        let turned = [0, 1, 2].map(|k| {
            let axis = desired.matrix().column(k);
            rows[0].times(axis[0]) + rows[1].times(axis[1]) + rows[2].times(axis[2])
        });
        let (cos, sin) = quaternion(turned);
        let e = rotation_vector(cos, sin);
        let (c, slope) = curvature(e.dot(e));
        let at_jump = S::CHECKED && !S::all(S::from_f64(JUMP).less(cos));
        Self { e, c, slope, at_jump }
    }

    /// `G(e) b = b + 1/2 e x b + c (e (e . b) - |e|^2 b)`: de for an angular velocity b in axes of the frame.
    fn derivative(&self, b: Vec3<S>) -> Vec3<S> {
        let across = self.e.cross(b);
        b + across.times(0.5) + self.e.cross(across).scaled(self.c)
    }

    /// The vector u with `u . b = w . (dG b)` for every b, where e changes by `change`.
    fn second(&self, w: Vec3<S>, change: Vec3<S>) -> Vec3<S> {
        let Self { e, c, slope, .. } = *self;
        let (along, weight) = (e.dot(change), w.dot(e));
        let both = e.scaled(w.dot(change)) + change.scaled(weight) - w.scaled(along + along);
        let outer = e.scaled(weight) - w.scaled(e.dot(e));
        w.cross(change).times(0.5) + both.scaled(c) + outer.scaled(slope * (along + along))
    }

    fn value(&self) -> OrientationError<S> {
        OrientationError { vector: self.e.to_array(), at_jump: self.at_jump }
    }
}

impl<S: Scalar> Kinematics<S> {
    /// The orientation error `e = log(R_d'R)` of a frame (rad): R of the frame, R_d the desired one, both in
    /// the world.
    ///
    /// It is analytic for all angles below a half turn, 0 among them, so that dual numbers differentiate it
    /// everywhere; at a half turn it jumps, see [`OrientationError::at_jump`].
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn orientation_error(
        &self,
        frame: usize,
        desired: &Rotation3<f64>,
    ) -> Result<OrientationError<S>, EvalError> {
        let (_, placed) = self.placed(frame)?;
        Ok(Error::new(desired, &placed).value())
    }

    /// e and its Jacobian, 3 x n: `e_q = G(e) J`, J the angular rows in axes of the frame.
    ///
    /// # Errors
    /// See [`Kinematics`].
    #[inline(never)]
    pub fn linearise_orientation_error(
        &mut self,
        frame: usize,
        desired: &Rotation3<f64>,
    ) -> Result<(OrientationError<S>, &Matrix<S>), EvalError> {
        let error = self.differentiate_orientation(frame, desired, &[S::zero(); 3])?;
        Ok((error, &self.rows))
    }

    /// e, e_q and `w'e_qq`, n x n, symmetric: one product for each pair of joints on the path of the frame.
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn contract_orientation_error(
        &mut self,
        frame: usize,
        desired: &Rotation3<f64>,
        w: &[S; 3],
    ) -> Result<OrientationContraction<'_, S>, EvalError> {
        let error = self.differentiate_orientation(frame, desired, w)?;
        self.pairs.fill(&self.tree, &mut self.square);
        Ok(OrientationContraction { error, jacobian: &self.rows, hessian: &self.square })
    }

    /// `(w'e_qq) d` for d of length n, to `product` (n), without the matrix.
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn orientation_error_hessian_product(
        &mut self,
        frame: usize,
        desired: &Rotation3<f64>,
        w: &[S; 3],
        d: &[S],
        product: &mut [S],
    ) -> Result<(), EvalError> {
        self.check(&[("d", d)])?;
        check_length("product", product, self.dof())?;
        self.differentiate_orientation(frame, desired, w)?;
        self.pairs.multiply(&self.tree, d, product);
        Ok(())
    }

    /// e_q, and the pairs of `w'e_qq`: with `b_j` the columns of J in axes of the frame, which turning a
    /// joint nearer to the base leaves, `w'e_,ij = w . (dG b_j)` where e changes by `e_,i`.
    #[inline(never)]
    fn differentiate_orientation(
        &mut self,
        frame: usize,
        desired: &Rotation3<f64>,
        w: &[S; 3],
    ) -> Result<OrientationError<S>, EvalError> {
        let (frame, placed) = self.see(frame, ReferenceFrame::LocalWorldAligned)?;
        let (error, w) = (Error::new(desired, &placed), Vec3::from(*w));
        self.rows.fill_zero();
        self.pairs.take_path(&self.tree, frame.joint);
        for j in self.tree.path(frame.joint) {
            let b = placed.frame.in_frame(self.columns[j].motion.angular);
            let change = error.derivative(b);
            put(&mut self.rows, 0, j, change);
            (self.pairs.inner[j], self.pairs.outer[j]) = (error.second(w, change), b);
        }
        Ok(error.value())
    }
}
