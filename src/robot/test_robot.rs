//! Robots of any tree, for unit tests.

use super::{Friction, JointSpec, LinkInertia, Robot};
use nalgebra::{DMatrix, Matrix3};

/// Joint k stands on joint `parent(k)`, if that is below k. If `coupled`, armature couples the last joint
/// with the one in the middle.
pub(crate) fn robot(n: usize, parent: impl Fn(usize) -> usize, coupled: bool) -> Robot {
    let mut builder = Robot::builder("tree");
    for k in 0..n {
        let x = k as f64;
        let link =
            LinkInertia::about_com(1.0 + x.sin().abs(), [0.1, 0.2 * x.cos(), 0.2], Matrix3::identity());
        let friction = Friction { viscous: 0.2, coulomb: (k % 3) as f64, coulomb_velocity: 0.1 };
        let joint = JointSpec::revolute(format!("j{k}")).axis([x.sin(), 1.0, x.cos()]);
        let joint = joint.carrying(link).friction(friction);
        let on = parent(k);
        builder = builder.joint(if on < k { joint.on(format!("j{on}")) } else { joint });
    }
    if coupled {
        let mut armature = DMatrix::identity(n, n);
        (armature[(n - 1, n / 2)], armature[(n / 2, n - 1)]) = (0.3, 0.3);
        builder = builder.armature_matrix(armature);
    }
    builder.build().unwrap()
}
