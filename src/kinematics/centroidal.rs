//! The centre of mass.

use super::body::Body;
use super::columns::axis_of;
use super::moment::Moment;
use super::{Kinematics, put};
use crate::error::{EvalError, check_length};
use crate::matrix::Matrix;
use crate::robot::JointKind;
use crate::scalar::Scalar;
use crate::spatial::Vec3;

/// The centre of mass of all links that move; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct CentreOfMass<'a, S> {
    /// Mass of all links that move (kg).
    pub mass: f64,
    /// Position c in the world (m).
    pub position: [S; 3],
    /// Velocity `J v` (m/s).
    pub velocity: [S; 3],
    /// Acceleration `J a + Jdot v` (m/s^2): the bias `Jdot v` after [`set_state`](Kinematics::set_state).
    pub acceleration: [S; 3],
    /// `J = c_q`, 3 x n.
    pub jacobian: &'a Matrix<S>,
    /// dJ/dt, 3 x n; it is also the derivative of the velocity by q at fixed v.
    pub jacobian_rate: &'a Matrix<S>,
}

impl<S: Scalar> Kinematics<S> {
    /// The centre of mass of all links that move, with its Jacobian, velocity and acceleration: O(n).
    ///
    /// Links that no joint moves have no share in it.
    ///
    /// # Errors
    /// [`EvalError::Massless`].
    #[inline(never)]
    pub fn centre_of_mass(&mut self) -> Result<CentreOfMass<'_, S>, EvalError> {
        let (mass, total) = self.sum_moments()?;
        for j in 0..self.tree.joints().len() {
            let [motion, rate] = self.moment_column(j).map(|column| column.times(mass.recip()));
            put(&mut self.rows.all, 0, j, motion);
            put(&mut self.rows_rate.all, 0, j, rate);
        }
        self.rows.sum_columns(&self.tree);
        self.rows_rate.sum_columns(&self.tree);
        let [position, velocity, acceleration] = total.centre(mass).map(Vec3::to_array);
        let (jacobian, jacobian_rate) = (self.rows.get(), self.rows_rate.get());
        Ok(CentreOfMass { mass, position, velocity, acceleration, jacobian, jacobian_rate })
    }

    /// `w'c_qq` for the position c of the centre of mass, n x n, symmetric: `w . (w_i x c_,j)` for the joints
    /// j beyond i, O(n d) products for paths of d joints.
    ///
    /// # Errors
    /// [`EvalError::Massless`].
    pub fn centre_of_mass_hessian(&mut self, w: &[S; 3]) -> Result<&Matrix<S>, EvalError> {
        self.pair_moments(w)?;
        Ok(self.fill_pairs())
    }

    /// `(w'c_qq) d` for d of length n, to `product` (n): O(n), without the matrix.
    ///
    /// # Errors
    /// See [`Kinematics`], and [`EvalError::Massless`].
    pub fn centre_of_mass_hessian_product(
        &mut self,
        w: &[S; 3],
        d: &[S],
        product: &mut [S],
    ) -> Result<(), EvalError> {
        self.check(&[("d", d)])?;
        check_length("product", product, self.dof())?;
        self.pair_moments(w)?;
        self.multiply_pairs(d, product);
        Ok(())
    }

    /// `a_i = w x w_i`, `b_j = c_,j`.
    fn pair_moments(&mut self, w: &[S; 3]) -> Result<(), EvalError> {
        let (mass, _) = self.sum_moments()?;
        self.pairs.take_all(&self.tree);
        let w = Vec3::from(*w);
        for j in 0..self.tree.joints().len() {
            let [motion, _] = self.moment_column(j);
            self.pairs.inner[j] = match self.tree.joints()[j].kind {
                JointKind::Revolute => w.cross(self.bodies[j].axis()),
                JointKind::Prismatic => Vec3::zero(),
            };
            self.pairs.outer[j] = motion.times(mass.recip());
        }
        Ok(())
    }

    /// First moments of all subtrees, from the tips inward; the mass of all, and their first moment about the
    /// origin of the world.
    pub(super) fn sum_moments(&mut self) -> Result<(f64, Moment<S>), EvalError> {
        let Self { tree, bodies, moments, .. } = self;
        for (i, joint) in tree.joints().iter().enumerate() {
            moments[i] = Moment::of_link(&bodies[i], joint.inertia.first_moment);
        }
        let (mut mass, mut total, world) = (0.0, Moment::zero(), Body::still());
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            let moment = moments[i];
            match joint.parent {
                Some(parent) => {
                    moments[parent].add(&moment, joint.subtree_mass, &bodies[i], &bodies[parent]);
                }
                None => {
                    mass += joint.subtree_mass;
                    total.add(&moment, joint.subtree_mass, &bodies[i], &world);
                }
            }
        }
        if mass > 0.0 { Ok((mass, total)) } else { Err(EvalError::Massless) }
    }

    /// The derivative of the first moment of all links by q_j, and its rate: of all that joint j carries,
    /// `z x S` with `z' x S + z x S'`, or `m z` with `m z'`.
    pub(super) fn moment_column(&self, j: usize) -> [Vec3<S>; 2] {
        let (joint, moment) = (&self.tree.joints()[j], &self.moments[j]);
        let [axis, turned] = axis_of(&self.tree, &self.bodies, j);
        match joint.kind {
            JointKind::Revolute => {
                [axis.cross(moment.value), turned.cross(moment.value) + axis.cross(moment.rate)]
            }
            JointKind::Prismatic => [axis, turned].map(|axis| axis.times(joint.subtree_mass)),
        }
    }
}
