//! Momentum of the whole robot about its centre of mass.

use super::body::Body;
use super::{Kinematics, put};
use crate::error::EvalError;
use crate::kernels::unit_momentum;
use crate::matrix::Matrix;
use crate::scalar::Scalar;
use crate::spatial::{Force, Motion, Vec3};

/// Momentum of all links that move, in axes of the world; borrowed from the workspace.
///
/// Armature is rotor inertia that no link carries, and has no share in it.
#[derive(Clone, Copy, Debug)]
pub struct Momentum<'a, S> {
    /// Linear momentum (kg m/s).
    pub linear: [S; 3],
    /// Angular momentum about the centre of mass (kg m^2/s).
    pub angular: [S; 3],
    /// Derivative of the linear momentum in time (N) for the given accelerations: the sum of all forces that
    /// cause them, gravity and that of the base included. It
    /// is the bias after [`set_state`](Kinematics::set_state).
    pub linear_rate: [S; 3],
    /// Derivative of the angular momentum in time (N m): their moment about the centre of mass.
    pub angular_rate: [S; 3],
    /// The centroidal momentum matrix A, 6 x n, `A v = (angular; linear)`.
    pub matrix: &'a Matrix<S>,
}

impl<S: Scalar> Kinematics<S> {
    /// Momentum of all links that move, its derivative in time and the centroidal momentum matrix; O(n).
    ///
    /// # Errors
    /// [`EvalError::Massless`].
    #[inline(never)]
    pub fn momentum(&mut self) -> Result<Momentum<'_, S>, EvalError> {
        let (mass, total) = self.sum_moments()?;
        let [centre, ..] = total.centre(mass);
        self.sum_inertias();
        for (j, joint) in self.tree.joints().iter().enumerate() {
            // A floating joint is displaced along the axes of its angles, and these carry the same.
            let [k, _] = self.tree.axis_of(j);
            let body = &self.bodies[k];
            let own = unit_momentum(joint.kind, &self.composites[k]);
            let (moment, force) = (body.in_world(own.moment), body.in_world(own.force));
            put(&mut self.jacobian.all, 0, j, moment + (body.position - centre).cross(force));
            put(&mut self.jacobian.all, 3, j, force);
        }
        self.jacobian.sum_columns(&self.tree);
        let (momentum, rate) = self.sum_momenta(centre);
        Ok(Momentum {
            linear: momentum.force.to_array(),
            angular: momentum.moment.to_array(),
            linear_rate: rate.force.to_array(),
            angular_rate: rate.moment.to_array(),
            matrix: self.jacobian.get(),
        })
    }

    /// Inertias of all subtrees, each in the frame of its joint.
    pub(super) fn sum_inertias(&mut self) {
        let Self { tree, bodies, composites, .. } = self;
        for (composite, joint) in composites.iter_mut().zip(tree.joints()) {
            *composite = joint.inertia.lift();
            composite.mass = joint.subtree_mass;
        }
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            if let Some(parent) = joint.parent {
                let moved = joint.transform_at(bodies[i].joint).inertia_up(&composites[i]);
                composites[parent] = composites[parent].with_moments(moved);
            }
        }
    }

    /// Momentum of all links about this point, and its rate, which is that about the centre of mass if the
    /// point is the centre of mass.
    fn sum_momenta(&self, centre: Vec3<S>) -> (Force<S>, Force<S>) {
        let (mut sum, mut sum_of_rates) = (Force::zero(), Force::zero());
        for (joint, body) in self.tree.joints().iter().zip(&self.bodies) {
            let (velocity, acceleration) = body.own_motions();
            let momentum: Force<S> = joint.inertia.apply(velocity);
            let turning = velocity.angular;
            let mut rate: Force<S> = joint.inertia.apply(acceleration);
            rate.moment =
                rate.moment + turning.cross(momentum.moment) + velocity.linear.cross(momentum.force);
            rate.force = rate.force + turning.cross(momentum.force);
            let arm = body.position - centre;
            let about = |own: Force<S>| {
                let force = body.in_world(own.force);
                Force { moment: body.in_world(own.moment) + arm.cross(force), force }
            };
            (sum, sum_of_rates) = (sum + about(momentum), sum_of_rates + about(rate));
        }
        (sum, sum_of_rates)
    }
}

impl<S: Scalar> Body<S> {
    /// Velocity of the link and its spatial acceleration, seen from its own frame: `(R'w ; R'o')` and
    /// `(R'w' ; R'(o'' - w x o'))`.
    fn own_motions(&self) -> (Motion<S>, Motion<S>) {
        let carried = self.angular.cross(self.linear);
        (
            Motion { angular: self.in_frame(self.angular), linear: self.in_frame(self.linear) },
            Motion {
                angular: self.in_frame(self.angular_rate),
                linear: self.in_frame(self.linear_rate - carried),
            },
        )
    }
}
