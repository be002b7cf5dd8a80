//! Where what floats is when gravity alone moves its centre of mass.

use super::Problem;
use super::error::ProblemError;
use super::free_end::{Carried, unknown};
use super::free_joints::{normalised, orientation};
use super::key::Key;
use costate::EvalError;
use costate::hamiltonian::Hamiltonian;
use costate::robot::{FreeJoint, FreeKind};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// The fall of all that a floating joint on the world carries, in the axes that the joint stands in.
pub(crate) struct FreeFall<'a> {
    free: &'a FreeJoint,
    /// Mass (kg), centre of mass (m) and its velocity (m/s) at the start.
    mass: f64,
    centre: Vector3<f64>,
    speed: Vector3<f64>,
    /// m/s^2.
    gravity: Vector3<f64>,
    spin: Option<Spin>,
}

/// The turn of what no torque drives either, where its orientation at the end is free.
struct Spin {
    /// Angular momentum about the centre of mass (N m s), which stays.
    angular: Vector3<f64>,
    /// The last time (s), the orientation and the angular velocity in its axes (rad/s) then.
    t: f64,
    turn: UnitQuaternion<f64>,
    rate: Vector3<f64>,
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
            let start = start.map_err(|e| unknown(Key::START_Q, e))?;
            let Carried { mass, centre, linear, .. } = start;
            let turns = |i: usize| self.has_no_motor(i) && self.end.q_free.contains(&i);
            let spin = (3..6).all(|k| turns(free.coordinate + k)).then(|| Spin {
                angular: start.spin(),
                t: 0.0,
                turn: orientation(free, &q),
                rate: Vector3::zeros(),
            });
            let (speed, gravity) = (linear / mass, self.gravity_at(free));
            Ok(FreeFall { free, mass, centre, speed, gravity, spin })
        };
        self.robot.free_joints().iter().filter(floats).map(fall).collect()
    }
}

impl FreeFall<'_> {
    /// Moves the joint to where the centre of mass is at time t (s), and gives it the velocity that makes the
    /// momentum what it is then; joints stay. Where nothing gives its turn, that follows from the angular
    /// momentum, by a step from the time of the last call.
    pub fn place(
        &mut self,
        t: f64,
        q: &mut [f64],
        v: &mut [f64],
        model: &mut Hamiltonian<f64>,
    ) -> Result<(), EvalError> {
        if let Some(spin) = &mut self.spin {
            let (at, i) = (self.free.quaternion(), self.free.coordinate + 3);
            spin.turn *= UnitQuaternion::from_scaled_axis(spin.rate * (t - spin.t));
            q[at..at + 4].copy_from_slice(spin.turn.coords.as_slice());
            let now = Carried::new(self.free, q, v, model)?;
            let inertia = model.mass_matrix(q)?;
            let arm = now.rotation.transpose() * (now.centre - now.position);
            let about_origin = Matrix3::from_fn(|a, b| inertia[(i + a, i + b)]);
            let of_centre = Matrix3::identity() * arm.norm_squared() - arm * arm.transpose();
            let miss = now.rotation.transpose() * (spin.angular - now.spin());
            let inertia = about_origin - of_centre * self.mass;
            let change = inertia.cholesky().map_or_else(Vector3::zeros, |factor| factor.solve(&miss));
            (0..3).for_each(|k| v[i + k] += change[k]);
            (spin.t, spin.rate) = (t, Vector3::from_column_slice(&v[i..i + 3]));
        }
        let now = Carried::new(self.free, q, v, model)?;
        let way = self.centre + self.speed * t + self.gravity * (0.5 * t * t) - now.centre;
        let speed = self.speed + self.gravity * t - now.linear / self.mass;
        let speed = now.rotation.transpose() * speed;
        for k in 0..self.free.kind.slides() {
            q[self.free.position + k] += way[k];
            v[self.free.coordinate + k] += speed[k];
        }
        Ok(())
    }
}
