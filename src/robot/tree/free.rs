//! Configurations of a tree with floating and spherical joints.

use super::Tree;
use crate::error::EvalError;
use crate::robot::free::FreeJoint;
use crate::robot::free_entries;
use crate::robot::free_frame::FreeFrame;
use crate::scalar::Scalar;

impl Tree {
    /// Number of entries of q: n, and one more for each floating or spherical joint.
    pub fn nq(&self) -> usize {
        self.dof() + self.free.len()
    }

    /// Index in q of coordinate `i`, which is no angle of a floating or spherical joint.
    pub(crate) fn entry_of(&self, i: usize) -> usize {
        i + self.free.iter().filter(|free| free.joint.coordinate < i).count()
    }

    /// The floating and spherical joints.
    pub(crate) fn free(&self) -> &[FreeFrame] {
        &self.free
    }

    /// The joint whose axis is that of joint `i` in the tangent space, and that to whose link it is fixed:
    /// floating joints are displaced along the axes of the moved frame, those of their angles.
    pub(crate) fn axis_of(&self, i: usize) -> [usize; 2] {
        let place = |free: &FreeFrame| (free.joint.turned - free.joint.kind.slides(), free.joint.turned);
        let own = |&(first, turned): &(usize, usize)| (first..turned + 3).contains(&i);
        let found = self.free.iter().map(place).find(own);
        found.map_or([i, i], |(_, turned)| [if i < turned { i + 3 } else { i }, turned + 2])
    }

    /// Name of the joint that coordinate `i` belongs to: a floating or spherical one as a whole.
    pub(crate) fn joint_name(&self, i: usize) -> &str {
        let free =
            self.free_joints().find(|free| (free.coordinate..free.coordinate + free.kind.dof()).contains(&i));
        free.map_or_else(|| self.name(i), |free| &free.name)
    }

    /// [`EvalError::FreeJoint`] if there are any.
    pub(crate) fn refuse_free(&self) -> Result<(), EvalError> {
        match self.free.first() {
            None => Ok(()),
            Some(free) => Err(EvalError::free_joint(&free.joint.name, free.joint.kind.name())),
        }
    }

    /// [`EvalError::FreeJointAndWrench`] if there are any, and wrenches from outside.
    pub(crate) fn refuse_free_and_wrench(&self) -> Result<(), EvalError> {
        match self.free.first() {
            Some(FreeFrame { joint: FreeJoint { name, kind, .. }, .. }) if !self.wrenches.is_empty() => {
                Err(EvalError::FreeJointAndWrench { joint: name.clone(), kind: kind.name() })
            }
            _ => Ok(()),
        }
    }

    /// q has [`nq`](Self::nq) finite entries, and its quaternions have length 1. With n entries it is refused
    /// by name.
    pub(crate) fn check_configuration<S: Scalar>(&self, q: &[S]) -> Result<(), EvalError> {
        free_entries::check(q, self.dof(), self.free_joints(), |index| self.joint_of_position(index).into())
    }

    /// The n coordinates of the chain of joints: positions of floating joints, angles of free ones zero.
    pub(crate) fn chart_coordinates<S: Scalar>(&self, q: &[S], chart: &mut [S]) {
        free_entries::chart_coordinates(q, self.free_joints(), chart);
    }

    /// As [`Robot::plain_entries`](crate::robot::Robot::plain_entries).
    pub(crate) fn plain_entries(&self) -> impl Iterator<Item = (usize, usize)> {
        free_entries::plain(self.free_joints(), self.dof())
    }

    fn free_joints(&self) -> impl ExactSizeIterator<Item = &FreeJoint> + Clone {
        self.free.iter().map(|free| &free.joint)
    }

    /// The name of the joint that an entry of q belongs to.
    fn joint_of_position(&self, index: usize) -> &str {
        match free_entries::of_position(self.free_joints(), index) {
            Ok(free) => &free.name,
            Err(coordinate) => self.name(coordinate),
        }
    }
}
