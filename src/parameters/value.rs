//! Values of parameters.

use super::parameter::Parameter;
use crate::robot::{LinkInertia, Placement, Robot};
use nalgebra::{Matrix3, Vector3};

/// The value of a parameter in the model.
pub(super) fn value_of(robot: &Robot, parameter: &Parameter) -> f64 {
    let joint = |joint: usize| &robot.joints()[joint];
    match *parameter {
        Parameter::Link { joint: of, entry } => ten(&joint(of).inertia)[entry as usize],
        Parameter::Translation { joint: of, axis } => joint(of).placement.translation[axis as usize],
        Parameter::Stiffness { joint: of } => joint(of).spring.stiffness,
        Parameter::Rest { joint: of } => joint(of).spring.rest,
        Parameter::Viscous { joint: of } => joint(of).friction.viscous,
        Parameter::Coulomb { joint: of } => joint(of).friction.coulomb,
        Parameter::CoulombVelocity { joint: of } => joint(of).friction.coulomb_velocity,
        Parameter::Armature { joints: [i, j] } => robot.armature_entry(i, j),
        Parameter::Gravity { axis } => robot.gravity()[axis as usize],
        Parameter::Payload { .. } | Parameter::Rotation { .. } | Parameter::Displacement { .. } => 0.0,
    }
}

/// The inertial parameters of a link, in the order of [`Inertial::ALL`].
pub(super) fn ten(link: &LinkInertia) -> [f64; 10] {
    let (h, j) = (link.com * link.mass, link.inertia_about_origin());
    [link.mass, h.x, h.y, h.z, j[(0, 0)], j[(1, 1)], j[(2, 2)], j[(0, 1)], j[(0, 2)], j[(1, 2)]]
}

/// First moment and inertia about the origin.
fn parts(&[_, x, y, z, xx, yy, zz, xy, xz, yz]: &[f64; 10]) -> (Vector3<f64>, Matrix3<f64>) {
    (Vector3::new(x, y, z), Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
}

/// The link with these parameters; a centre of mass that is not finite if there is a first moment without
/// mass.
pub(super) fn link(parameters: &[f64; 10]) -> LinkInertia {
    let (mass, (h, j)) = (parameters[0], parts(parameters));
    let com = if mass == 0.0 && h == Vector3::zeros() { h } else { h / mass };
    LinkInertia::about_origin(mass, com.into(), j)
}

/// The parameters of a body in a frame with this placement, about the origin of the outer frame `o`: with r
/// the translation and `h' = R h`,
///
/// ```text
/// h_o = h' + m r     J_o = R J R' + m (r.r 1 - r r') + 2 (r.h') 1 - r h'' - h' r'
/// ```
pub(super) fn seen(parameters: &[f64; 10], placement: &Placement) -> [f64; 10] {
    let (m, (h, j)) = (parameters[0], parts(parameters));
    let (turn, r) = (placement.rotation, placement.translation);
    let h = turn * h;
    let shifted = Matrix3::identity() * (m * r.norm_squared() + 2.0 * r.dot(&h))
        - r * r.transpose() * m
        - r * h.transpose()
        - h * r.transpose();
    let (h, j) = (h + r * m, turn * j * turn.transpose() + shifted);
    [m, h.x, h.y, h.z, j[(0, 0)], j[(1, 1)], j[(2, 2)], j[(0, 1)], j[(0, 2)], j[(1, 2)]]
}
