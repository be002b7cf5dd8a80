//! The cost of the distance from a goal, as a function generic over the scalar, for automatic
//! differentiation.

use costate::EvalError;
use costate::derivative::Function;
use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::Lagrangian;
use costate::robot::{JointKind, Robot};
use costate::scalar::Scalar;
use costate::spatial::Vec3;

/// The second half of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinates {
    /// p = M v.
    Momenta,
    /// v.
    Velocities,
}

/// `distance_weight/2 |r(q) - goal|^2 + energy_weight T`, r the tip and T the kinetic energy: the same in
/// both coordinates.
#[derive(Clone)]
pub struct Reach {
    pub robot: Robot,
    /// The tip in the frame of the last joint (m).
    pub tip: [f64; 3],
    /// In the world (m).
    pub goal: [f64; 3],
    pub distance_weight: f64,
    pub energy_weight: f64,
    pub coordinates: Coordinates,
}

impl Reach {
    /// The position of joint i, which may mimic another one.
    fn position<S: Scalar>(&self, i: usize, q: &[S]) -> S {
        let of = |joint: usize| {
            self.robot
                .independent_indices()
                .binary_search(&joint)
                .map_or(S::zero(), |coordinate| q[coordinate])
        };
        match self.robot.joints()[i].mimic {
            Some(mimic) => of(mimic.joint).times(mimic.ratio).plus(mimic.offset),
            None => of(i),
        }
    }

    /// r(q) in the world (m).
    pub fn tip<S: Scalar>(&self, q: &[S]) -> Vec3<S> {
        let joints = self.robot.joints();
        let mut r = Vec3::constant(self.tip);
        let mut next = joints.len().checked_sub(1);
        while let Some(i) = next {
            let (joint, axis) = (&joints[i], joints[i].axis.into());
            let position = self.position(i, q);
            r = match joint.kind {
                JointKind::Revolute => rotated(r, axis, position),
                JointKind::Prismatic => r + scaled(axis, position),
            };
            let rows = [0, 1, 2].map(|row| {
                let row = joint.placement.rotation.row(row);
                r.dot_constant([row[0], row[1], row[2]])
            });
            r = Vec3::new(rows[0], rows[1], rows[2]).plus(joint.placement.translation.into());
            next = joint.parent;
        }
        r
    }
}

impl Function for Reach {
    type Workspace<S: Scalar> = (Hamiltonian<S>, Lagrangian<S>);
    type Error = EvalError;

    fn inputs(&self) -> usize {
        2 * self.robot.dof()
    }

    fn outputs(&self) -> usize {
        1
    }

    fn workspace<S: Scalar>(&self) -> Self::Workspace<S> {
        (Hamiltonian::new(&self.robot), Lagrangian::new(&self.robot))
    }

    fn evaluate<S: Scalar>(
        &self,
        (hamiltonian, lagrangian): &mut Self::Workspace<S>,
        x: &[S],
        cost: &mut [S],
    ) -> Result<(), EvalError> {
        let (q, second) = x.split_at(self.robot.dof());
        let energy = match self.coordinates {
            Coordinates::Momenta => hamiltonian.energy(q, second)?,
            Coordinates::Velocities => lagrangian.energy(q, second)?,
        };
        let off = self.tip(q).plus(self.goal.map(|x| -x));
        cost[0] = off.dot(off).times(0.5 * self.distance_weight) + energy.kinetic.times(self.energy_weight);
        Ok(())
    }
}

/// `r cos + (a x r) sin + a (a.r) (1 - cos)`: r rotated about the axis a.
fn rotated<S: Scalar>(r: Vec3<S>, axis: [f64; 3], angle: S) -> Vec3<S> {
    let (sin, cos) = angle.sin_cos();
    let across = r.cross_constant(axis);
    let along = scaled(axis, r.dot_constant(axis) * (S::one() - cos));
    let turn = |r: S, across: S| r * cos - across * sin;
    Vec3::new(turn(r.x, across.x), turn(r.y, across.y), turn(r.z, across.z)) + along
}

fn scaled<S: Scalar>([x, y, z]: [f64; 3], factor: S) -> Vec3<S> {
    Vec3::new(factor.times(x), factor.times(y), factor.times(z))
}
