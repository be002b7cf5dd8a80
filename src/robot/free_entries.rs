//! The entries of q of a robot with floating and spherical joints.

use super::free::FreeJoint;
use crate::error::{EvalError, PowerOfTen, check_length};
use crate::scalar::Scalar;
use crate::spatial::Quaternion;

/// How far the squared length of a quaternion may be from 1: errors of results are of this size. Motions take
/// those of their start and end with more, 1e-6, and divide them by their length.
pub(crate) const UNIT: PowerOfTen = PowerOfTen(-9);

impl FreeJoint {
    /// Its quaternion in a configuration.
    pub(crate) fn quaternion_in<S: Scalar>(&self, q: &[S]) -> Quaternion<S> {
        let at = self.quaternion();
        Quaternion::new([q[at], q[at + 1], q[at + 2], q[at + 3]])
    }
}

/// Whose entry `index` of q is: a free joint, or else the joint of a coordinate.
pub(crate) fn of_position<'a>(
    free: impl IntoIterator<Item = &'a FreeJoint>,
    index: usize,
) -> Result<&'a FreeJoint, usize> {
    let mut before = 0;
    for joint in free {
        if (joint.position..joint.position + joint.kind.positions()).contains(&index) {
            return Ok(joint);
        }
        // A quaternion has one entry more than there are angles.
        before += usize::from(joint.position < index);
    }
    Err(index - before)
}

/// Entries of q and v of joints of one degree of freedom, for n coordinates.
pub(super) fn plain<'a>(
    free: impl Iterator<Item = &'a FreeJoint>,
    n: usize,
) -> impl Iterator<Item = (usize, usize)> {
    let mut start = 0;
    let ends = free.map(|joint| (joint.coordinate, joint.coordinate + joint.kind.dof())).chain([(n, n)]);
    // A quaternion has one entry more than there are angles.
    ends.enumerate().flat_map(move |(before, (end, next))| {
        (std::mem::replace(&mut start, next)..end).map(move |i| (i + before, i))
    })
}

/// q has an entry for each of the n coordinates and one more for each free joint, all finite, and its
/// quaternions have length 1. With n entries it is refused by the name of the first free joint. `name` is
/// that of the joint of an entry of q.
pub(super) fn check<'a, S: Scalar>(
    q: &[S],
    n: usize,
    free: impl ExactSizeIterator<Item = &'a FreeJoint> + Clone,
    name: impl FnOnce(usize) -> String,
) -> Result<(), EvalError> {
    if let Some(first) = free.clone().next().filter(|_| q.len() == n) {
        // What knows nothing of quaternions passes as many entries as v has.
        return Err(EvalError::free_joint(&first.name, first.kind.name()));
    }
    check_length("q", q, n + free.len())?;
    if !S::CHECKED {
        return Ok(());
    }
    if let Some(index) = q.iter().position(|value| !value.is_finite()) {
        return Err(EvalError::NonFinite { what: "q", index, joint: name(index) });
    }
    for joint in free {
        let error = joint.quaternion_in(q).square().plus(-1.0).abs();
        let exceeds = |by: PowerOfTen| !S::all(error.less(S::from_f64(by.value())));
        if exceeds(UNIT) {
            let by = (UNIT.0..).map(PowerOfTen).take_while(|&by| by.0 < 16 && exceeds(by)).last();
            return Err(EvalError::NotUnit { joint: joint.name.clone(), by: by.unwrap_or(UNIT) });
        }
    }
    Ok(())
}

/// The n coordinates of the chains of joints: positions of floating joints, angles of free ones zero.
pub(super) fn chart_coordinates<'a, S: Scalar>(
    q: &[S],
    free: impl Iterator<Item = &'a FreeJoint>,
    chart: &mut [S],
) {
    let (mut from, mut to) = (0, 0);
    for joint in free {
        let before = joint.coordinate + joint.kind.slides() - to;
        chart[to..to + before].copy_from_slice(&q[from..from + before]);
        chart[to + before..to + before + 3].fill(S::zero());
        (from, to) = (from + before + 4, to + before + 3);
    }
    chart[to..].copy_from_slice(&q[from..]);
}
