//! Where what floats is when gravity alone moves its centre of mass.

use super::Problem;
use super::error::ProblemError;
use super::free_end::{Carried, unknown};
use super::free_joints::{normalised, slides};
use super::key::Key;
use costate::EvalError;
use costate::hamiltonian::Hamiltonian;
use costate::robot::{FreeJoint, FreeKind};
use nalgebra::Vector3;

/// The fall of all that a floating joint on the world carries, in the axes that the joint stands in.
pub(crate) struct FreeFall<'a> {
    free: &'a FreeJoint,
    /// Mass (kg), centre of mass (m) and its velocity (m/s) at the start.
    mass: f64,
    centre: Vector3<f64>,
    speed: Vector3<f64>,
    /// m/s^2.
    gravity: Vector3<f64>,
}

impl Problem {
    /// Whether a joint stands on the world and no force drives it; of a spherical joint, no torque.
    pub(super) fn is_left_alone(&self, free: &FreeJoint) -> bool {
        let is_idle = (0..3).all(|k| self.has_no_motor(free.coordinate + k));
        is_idle && self.first_part(free).parent.is_none()
    }

    /// Gravity in the axes that a joint on the world stands in.
    pub(super) fn gravity_at(&self, free: &FreeJoint) -> Vector3<f64> {
        self.first_part(free).placement.rotation.transpose() * self.robot.gravity()
    }

    /// The falls from the start.
    ///
    /// # Errors
    /// A start that cannot be evaluated.
    pub(crate) fn free_falls(&self) -> Result<Vec<FreeFall<'_>>, ProblemError> {
        let mut model = Hamiltonian::<f64>::new(&self.robot);
        let q = normalised(&self.robot, &self.start.q);
        let floats = |free: &&FreeJoint| free.kind == FreeKind::Floating && self.is_left_alone(free);
        let fall = |free| {
            let start = Carried::new(free, &q, &self.start.v, &mut model);
            let Carried { mass, centre, linear, .. } = start.map_err(|e| unknown(Key::START_Q, e))?;
            Ok(FreeFall { free, mass, centre, speed: linear / mass, gravity: self.gravity_at(free) })
        };
        self.robot.free_joints().iter().filter(floats).map(fall).collect()
    }
}

impl FreeFall<'_> {
    /// Moves the joint to where the centre of mass is at time t (s), and gives it the velocity that makes the
    /// momentum what it is then; turns and joints stay.
    pub fn place(
        &self,
        t: f64,
        q: &mut [f64],
        v: &mut [f64],
        model: &mut Hamiltonian<f64>,
    ) -> Result<(), EvalError> {
        let now = Carried::new(self.free, q, v, model)?;
        let way = self.centre + self.speed * t + self.gravity * (0.5 * t * t) - now.centre;
        let speed = self.speed + self.gravity * t - now.linear / self.mass;
        let speed = now.rotation.transpose() * speed;
        for k in 0..slides(self.free) {
            q[self.free.position + k] += way[k];
            v[self.free.coordinate + k] += speed[k];
        }
        Ok(())
    }
}
