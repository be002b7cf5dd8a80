//! The ends of motions of robots with floating and spherical joints, in the states x = (q, p) of
//! [`QuaternionDynamics`](costate::dynamics::QuaternionDynamics).
//!
//! At the end the orientation of such a joint is three functions of its quaternion, and a rate `(M^-1 p)_i`
//! a function of the momenta. What nothing can change is no condition: the momentum of all that hangs on a
//! joint which nothing drives, and the way of its centre of mass. It is checked, and left out.

use super::error::ProblemError;
use super::free_error::FreeMotionError;
use super::free_joints::{length, normalised, orientation};
use super::key::Key;
use super::{FinalTime, Problem};
use crate::constants::free_motions::KEPT;
use costate::EvalError;
use costate::hamiltonian::Hamiltonian;
use costate::robot::{FreeJoint, FreeKind, Joint};
use nalgebra::{Matrix3, Vector3};

/// What is given at the end of a motion.
pub(crate) struct FreeEnd {
    /// (q, p), quaternions of length 1.
    pub x: Vec<f64>,
    /// Components of x that are free, but for what is given of them together.
    pub free: Vec<usize>,
    /// Rows of functions of x that are given.
    pub given: Vec<Vec<f64>>,
}

/// `vec(conj(a) o b)` by b, row by row, for a of length 1.
pub(crate) fn orientation_rows(a: [f64; 4]) -> [[f64; 4]; 3] {
    let length = length(&a);
    let [x, y, z, w] = a.map(|entry| entry / length);
    [[w, z, -y, -x], [-z, w, x, -y], [y, -x, w, -z]]
}

/// What is known of a joint on the world, and of all that it carries, at one end.
pub(super) struct Carried {
    pub rotation: Matrix3<f64>,
    /// Position of its frame (m).
    pub position: Vector3<f64>,
    /// Mass (kg) and centre of mass (m), of a floating joint.
    pub mass: f64,
    pub centre: Vector3<f64>,
    /// Momentum, and its moment about the origin of the axes that the joint stands in.
    pub linear: Vector3<f64>,
    angular: Vector3<f64>,
}

impl Carried {
    pub fn new(
        free: &FreeJoint,
        q: &[f64],
        v: &[f64],
        model: &mut Hamiltonian<f64>,
    ) -> Result<Self, EvalError> {
        let i = free.coordinate;
        let rotation = *orientation(free, q).to_rotation_matrix().matrix();
        let p = model.momentum(q, v)?;
        let vector = |list: &[f64], at: usize| Vector3::new(list[at], list[at + 1], list[at + 2]);
        if free.kind.slides() == 0 {
            let (zero, angular) = (Vector3::zeros(), rotation * vector(p, i));
            return Ok(Self { rotation, position: zero, mass: 0.0, centre: zero, linear: zero, angular });
        }
        let (linear, angular) = (rotation * vector(p, i), rotation * vector(p, i + 3));
        let position = vector(q, free.position);
        let inertia = model.mass_matrix(q)?;
        // Its columns are momenta: that of a turn about an axis is the mass times the way of the centre.
        let mass = inertia[(i, i)];
        let arm = Vector3::new(inertia[(i + 1, i + 5)], inertia[(i + 2, i + 3)], inertia[(i, i + 4)]) / mass;
        let centre = position + rotation * arm;
        Ok(Self { rotation, position, mass, centre, linear, angular: angular + position.cross(&linear) })
    }

    /// Angular momentum about the centre of mass (N m s).
    pub fn spin(&self) -> Vector3<f64> {
        self.angular - self.centre.cross(&self.linear)
    }
}

impl Problem {
    /// x at the start.
    ///
    /// # Errors
    /// A state that cannot be evaluated.
    pub(crate) fn free_start(&self) -> Result<Vec<f64>, ProblemError> {
        let q = normalised(&self.robot, &self.start.q);
        let mut model = Hamiltonian::<f64>::new(&self.robot);
        let p = model.momentum(&q, &self.start.v).map_err(|cause| unknown(Key::START_Q, cause))?;
        Ok([&q[..], p].concat())
    }

    /// What is given at the end.
    ///
    /// # Errors
    /// [`ProblemError::Free`]: what no motion can meet, or what cannot be said about its end.
    pub(crate) fn free_end(&self) -> Result<FreeEnd, ProblemError> {
        let (end, n, nq) = (&self.end, self.robot.dof(), self.robot.nq());
        let q = normalised(&self.robot, &end.q);
        let mut model = Hamiltonian::<f64>::new(&self.robot);
        let p = model.momentum(&q, &end.v).map_err(|cause| unknown(Key::END_Q, cause))?.to_vec();
        let mut found = FreeEnd { x: [q, p].concat(), free: Vec::new(), given: Vec::new() };
        let plain = self.robot.plain_entries();
        found.free.extend(plain.filter(|(_, i)| end.q_free.contains(i)).map(|(entry, _)| entry));
        for free in self.robot.free_joints() {
            self.turns_of(free, &mut found)?;
        }
        let v_free = |i: &usize| end.v_free.contains(i);
        let given: Vec<usize> = (0..n).filter(|i| !v_free(i)).collect();
        let rests = given.len() == n && end.v.iter().all(|v| *v == 0.0);
        if let Some(&first) = end.q_free.first().filter(|_| !given.is_empty() && !rests) {
            return Err(FreeMotionError::RatesNeedPositions { joint: self.name(first) }.into());
        }
        if given.len() < n {
            found.free.extend(nq..nq + n);
            self.rates(&given, &mut model, &mut found)?;
        }
        for free in self.robot.free_joints() {
            let idle = |from: usize, to: usize| (from..to).all(|k| self.has_no_motor(free.coordinate + k));
            let (forces, dof) = (free.kind.slides(), free.kind.dof());
            if self.is_left_alone(free) {
                self.leave_out_kept(free, idle(forces, dof), given.len(), &mut model, &mut found)?;
            }
        }
        found.free.sort_unstable();
        found.free.dedup();
        Ok(found)
    }

    /// The first of the joints that a free one consists of.
    pub(super) fn first_part(&self, free: &FreeJoint) -> &Joint {
        let is_first = |joint: &&Joint| {
            joint.free.as_ref().is_some_and(|part| part.joint == free.name && part.place == 0)
        };
        self.robot.joints().iter().find(is_first).unwrap_or(&self.robot.joints()[free.turned])
    }

    /// Displacement and orientation of a joint.
    fn turns_of(&self, free: &FreeJoint, found: &mut FreeEnd) -> Result<(), ProblemError> {
        let is_free = |k: &usize| self.end.q_free.contains(&(free.coordinate + k));
        let of_angles = free.kind.slides();
        found.free.extend((0..of_angles).filter(is_free).map(|k| free.position + k));
        let at = free.quaternion();
        found.free.extend(at..at + 4);
        let turns: Vec<usize> = (0..3).filter(|k| is_free(&(of_angles + k))).collect();
        if turns.len() == 2 {
            return Err(FreeMotionError::TwoAxes { joint: free.name.clone() }.into());
        }
        let a = [0, 1, 2, 3].map(|k| found.x[at + k]);
        for (_, row) in orientation_rows(a).iter().enumerate().filter(|(k, _)| !turns.contains(k)) {
            let mut whole = vec![0.0; found.x.len()];
            whole[at..at + 4].copy_from_slice(row);
            found.given.push(whole);
        }
        Ok(())
    }

    /// Rows of rates that are given, others being free.
    fn rates(
        &self,
        given: &[usize],
        model: &mut Hamiltonian<f64>,
        found: &mut FreeEnd,
    ) -> Result<(), ProblemError> {
        let (nq, n) = (self.robot.nq(), self.robot.dof());
        let q = found.x[..nq].to_vec();
        let inverse = model.inverse_mass_matrix(&q).map_err(|cause| unknown(Key::END_Q, cause))?;
        for &i in given {
            let mut whole = vec![0.0; nq + n];
            whole[nq..].copy_from_slice(inverse.row(i));
            found.given.push(whole);
        }
        Ok(())
    }

    /// Momentum and centre of mass of what hangs on a joint that no force drives, and no torque where it
    /// `turns` by itself: checks what is given of them, and takes it out of the conditions.
    fn leave_out_kept(
        &self,
        free: &FreeJoint,
        turns: bool,
        rates: usize,
        model: &mut Hamiltonian<f64>,
        found: &mut FreeEnd,
    ) -> Result<(), ProblemError> {
        let (n, nq, end) = (self.robot.dof(), self.robot.nq(), &self.end);
        let start = normalised(&self.robot, &self.start.q);
        let start = Carried::new(free, &start, &self.start.v, model).map_err(|e| unknown(Key::START_Q, e))?;
        let last = Carried::new(free, &found.x[..nq], &end.v, model).map_err(|e| unknown(Key::END_Q, e))?;
        let gravity = self.gravity_at(free);
        let (floats, falls) = (free.kind == FreeKind::Floating, gravity.norm() > 0.0);
        let (fixed, time) = (matches!(self.time, FinalTime::Fixed(_)), self.time.value());
        let joint = || free.name.clone();
        let speed = if floats { start.linear / start.mass } else { Vector3::zeros() };
        let places_given = end.q_free.is_empty();
        if floats && places_given {
            if !fixed && (falls || !is_small(&speed, 0.0)) {
                return Err(FreeMotionError::Falls { joint: joint() }.into());
            }
            let centre = start.centre + speed * time + gravity * (0.5 * time * time);
            let way = centre - last.centre;
            if !is_small(&way, centre.norm()) {
                let position = (last.position + way).into();
                return Err(FreeMotionError::CentreOfMass { joint: joint(), position }.into());
            }
            found.free.extend(free.position..free.position + 3);
        }
        let kept = match (floats, turns, falls) {
            (true, true, _) => 6,
            (true, false, _) | (false, _, false) => 3,
            (false, _, true) => 1,
        };
        if rates < n {
            let most = n - kept;
            return match rates > most {
                true => Err(FreeMotionError::TooManyRates { joint: joint(), given: rates, most }.into()),
                false => Ok(()),
            };
        }
        if floats && falls && !fixed {
            return Err(FreeMotionError::Falls { joint: joint() }.into());
        }
        // The momentum at the end, in the axes that the joint stands in.
        let (linear, angular) = match floats {
            true => {
                let (weight, way) = (gravity * start.mass, start.centre * time + speed * (0.5 * time * time));
                (start.linear + weight * time, start.angular + way.cross(&weight))
            }
            false => (Vector3::zeros(), start.angular),
        };
        // Rates of zero have none, wherever the motion ends.
        let found_there = if places_given { [last.linear, last.angular] } else { [Vector3::zeros(); 2] };
        let mut miss = [found_there[0] - linear, found_there[1] - angular];
        if floats && !turns {
            miss[1] = Vector3::zeros();
        }
        let along = gravity.try_normalize(0.0).filter(|_| !floats);
        if let Some(along) = along {
            miss[1] = along * along.dot(&miss[1]);
        }
        let sizes = [linear.norm(), angular.norm()];
        if let Some((miss, _)) = miss.iter().zip(sizes).find(|(miss, size)| !is_small(miss, *size)) {
            return Err(FreeMotionError::Momentum { joint: joint(), miss: miss.amax() }.into());
        }
        let first = nq + free.coordinate;
        found.free.extend(first..first + if along.is_some() { 3 } else { kept });
        let Some(along) = along else { return Ok(()) };
        if let Some(k) = (0..3).find(|k| end.q_free.contains(&(free.coordinate + k))) {
            return Err(FreeMotionError::RatesNeedPositions { joint: self.name(free.coordinate + k) }.into());
        }
        // Gravity changes what is across it.
        let axis = last.rotation.transpose() * along;
        let across = axis.cross(&Matrix3::identity().column(axis.iamin()).into_owned()).normalize();
        for direction in [across, axis.cross(&across)] {
            let mut whole = vec![0.0; nq + n];
            whole[first..first + 3].copy_from_slice(direction.as_slice());
            found.given.push(whole);
        }
        Ok(())
    }
}

fn is_small(difference: &Vector3<f64>, size: f64) -> bool {
    difference.norm() <= KEPT * (1.0 + size)
}

pub(super) fn unknown(key: Key, cause: EvalError) -> ProblemError {
    FreeMotionError::Evaluation { key, cause }.into()
}
