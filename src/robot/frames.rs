//! Rotates the frames of a robot so that every placement becomes a fixed screw.

use super::frame::Frame;
use super::joint::JointKind;
use super::joint_frame::JointFrame;
use super::link::{LinkInertia, Placement, snap};
use super::model::Robot;
use super::origins::{LEAST_SINE, origins};
use super::tree_frame::TreeFrame;
use crate::spatial::{ConstantInertia, FixedScrew, FixedTurn};
use nalgebra::{Matrix3, Vector3};

/// The aligned frames, joint by joint; `x_aligned = rotation x_original`.
pub(super) struct AlignedFrames<'a> {
    robot: &'a Robot,
    pub(super) world: Matrix3<f64>,
    world_is_fixed: bool,
    rotations: Vec<Matrix3<f64>>,
    is_fixed: Vec<bool>,
    screws: Vec<FixedScrew>,
    /// Rotations from the axes of the parent's original frame to those of the screw.
    arms: Vec<Matrix3<f64>>,
    /// Whether origins may move along their axes.
    moves_origins: bool,
    origins: Vec<Vector3<f64>>,
    offsets: Vec<f64>,
}

impl<'a> AlignedFrames<'a> {
    pub(super) fn new(robot: &'a Robot) -> Self {
        let n = robot.joints().len();
        let is_fixed = robot.joints().iter().map(|joint| joint.kind == JointKind::Prismatic).collect();
        Self {
            robot,
            world: Matrix3::identity(),
            world_is_fixed: false,
            rotations: Vec::with_capacity(n),
            is_fixed,
            screws: Vec::with_capacity(n),
            arms: Vec::with_capacity(n),
            moves_origins: true,
            origins: origins(robot),
            offsets: vec![0.0; n],
        }
    }

    /// Frames that are only rotated, independently of all lengths: each origin remains where it is.
    pub(super) fn rotated_only(robot: &'a Robot) -> Self {
        Self {
            moves_origins: false,
            origins: vec![Vector3::zeros(); robot.joints().len()],
            ..Self::new(robot)
        }
    }

    /// The rotations of the frame of joint `i` and of the translation to it.
    pub(super) fn rotation_and_arm(&self, i: usize) -> [Matrix3<f64>; 2] {
        [self.rotations[i].map(snap), self.arms[i].map(snap)]
    }

    /// The frames of the robot in the aligned ones, after all of those are placed.
    pub(super) fn frames(&self) -> Vec<TreeFrame> {
        let placed =
            |frame: &Frame| frame.joint.map_or(frame.placement, |i| self.original(i).then(&frame.placement));
        self.robot
            .frames()
            .iter()
            .map(|frame| TreeFrame { joint: frame.joint, placement: placed(frame) })
            .collect()
    }

    /// The original frame of joint `i` in the aligned one.
    fn original(&self, i: usize) -> Placement {
        let rotation = self.rotations[i].map(snap);
        let moved = -(rotation * self.origins[i]);
        Placement { rotation, translation: without_rounding(&moved, self.origins[i].norm()) }
    }

    /// Aligns frame `i`, after all frames before it.
    pub(super) fn place(&mut self, i: usize) {
        let joint = &self.robot.joints()[i];
        let axes = axes_with_z_along(joint.axis);
        let outer = joint.parent.map_or(self.world, |p| self.rotations[p]);
        let rotation = (outer * joint.placement.rotation * axes).map(snap);
        let before = joint.parent.map_or(Vector3::zeros(), |p| self.origins[p]);
        let [arm, before, own] =
            [joint.placement.translation, before, joint.placement.rotation * self.origins[i]];
        let size = arm.norm() + before.norm() + own.norm();
        let mut translation = outer * (arm - before + own);
        if joint.kind == JointKind::Prismatic && self.moves_origins {
            // Its part along the joint axis becomes an offset of q; the rest is zero by the choice of the
            // origin.
            self.offsets[i] = without_rounding(&translation, size).dot(&rotation.column(2));
            translation = Vector3::zeros();
        }
        let may_rotate_parent = !joint.parent.map_or(self.world_is_fixed, |p| self.is_fixed[p]);
        let seen = if self.moves_origins { translation } else { Vector3::zeros() };
        let Screw { mut gamma, alpha, delta } = decompose(&rotation, &seen, may_rotate_parent);
        self.arms.push(outer);
        if let Some(turn) = gamma {
            let back = about_z([-turn[0], turn[1]]);
            translation = back * translation;
            self.arms[i] = back * outer;
            if may_rotate_parent {
                match joint.parent {
                    None => self.world = back * self.world,
                    Some(parent) => {
                        self.rotations[parent] = back * self.rotations[parent];
                        self.offsets[parent] += turn[0].atan2(turn[1]);
                    }
                }
                gamma = None;
            }
        }
        match joint.parent {
            None => self.world_is_fixed = true,
            Some(parent) => self.is_fixed[parent] = true,
        }
        self.screws.push(if self.moves_origins {
            screw(gamma, alpha, &translation, size)
        } else {
            let (gamma, alpha) = (gamma.map(FixedTurn::new), FixedTurn::new(alpha));
            FixedScrew { gamma, alpha, translation: translation.into(), rise: 0.0 }
        });
        self.rotations.push(about_z(delta) * axes.transpose());
    }

    pub(super) fn joint(&self, i: usize, subtree_mass: f64) -> JointFrame {
        let joint = &self.robot.joints()[i];
        let turn = self.rotations[i];
        let size = joint.inertia.com.norm() + self.origins[i].norm();
        let com = without_rounding(&(turn * (joint.inertia.com - self.origins[i])), size);
        let link =
            LinkInertia { com, inertia: turn * joint.inertia.inertia * turn.transpose(), ..joint.inertia };
        let j = link.inertia_about_origin();
        let inertia = ConstantInertia {
            mass: link.mass,
            first_moment: (com * link.mass).into(),
            matrix: [j[(0, 0)], j[(1, 1)], j[(2, 2)], j[(0, 1)], j[(0, 2)], j[(1, 2)]],
        };
        JointFrame {
            kind: joint.kind,
            parent: joint.parent,
            screw: self.screws[i],
            offset: self.offsets[i],
            inertia,
            subtree_mass,
            lumped: inertia,
            lumped_mass: 0.0,
            reach: 0.0,
            carries_slides: false,
            spring: joint.spring,
            friction: joint.friction,
        }
    }
}

/// The vector with components below 1e-15 of `size` set to zero: they are rounding errors.
fn without_rounding(a: &Vector3<f64>, size: f64) -> Vector3<f64> {
    a.map(|x| if x.abs() <= 1e-15 * size { 0.0 } else { x })
}

/// `Rz(gamma) (r + Rx(alpha) rise e_z)`, with a rise in place of the y component of r unless r has none
/// or the axes are orthogonal or nearly parallel.
fn screw(gamma: Option<[f64; 2]>, alpha: [f64; 2], r: &Vector3<f64>, size: f64) -> FixedScrew {
    let (gamma, turn, [sin, cos]) = (gamma.map(FixedTurn::new), FixedTurn::new(alpha), alpha);
    let r = without_rounding(r, size);
    let splits = !turn.is_right() && sin.abs() >= LEAST_SINE && r.y != 0.0;
    let rise = if splits { -r.y / sin } else { 0.0 };
    let rest = if splits { Vector3::new(r.x, 0.0, r.z - cos * rise) } else { r };
    let translation = without_rounding(&rest, 4.0 * size).into();
    FixedScrew { gamma, alpha: turn, translation, rise }
}

/// A rotation as `Rz(gamma) Rx(alpha) Rz(delta)`, each by its sine and cosine.
struct Screw {
    gamma: Option<[f64; 2]>,
    alpha: [f64; 2],
    delta: [f64; 2],
}

/// The third column of `Rz(gamma) Rx(alpha) Rz(delta)` is `(sin gamma sin alpha, -cos gamma sin alpha, cos
/// alpha)`. Gamma is free for parallel axes: x is then along the common perpendicular, if the parent may be
/// rotated.
fn decompose(r: &Matrix3<f64>, translation: &Vector3<f64>, may_rotate_parent: bool) -> Screw {
    let horizontal = r[(0, 2)].hypot(r[(1, 2)]);
    let gamma = if horizontal > 0.0 {
        (r[(0, 2)] != 0.0).then(|| [r[(0, 2)] / horizontal, -r[(1, 2)] / horizontal])
    } else {
        let (x, y) = (translation.x, translation.y);
        (may_rotate_parent && y != 0.0).then(|| [y / x.hypot(y), x / x.hypot(y)])
    };
    let unrotated = gamma.map_or(*r, |[sin, cos]| about_z([-sin, cos]) * r);
    let unit = |sin: f64, cos: f64| [sin / sin.hypot(cos), cos / sin.hypot(cos)].map(snap);
    Screw {
        gamma,
        alpha: unit(-unrotated[(1, 2)], unrotated[(2, 2)]),
        delta: unit(-unrotated[(0, 1)], unrotated[(0, 0)]),
    }
}

pub(super) fn about_z([sin, cos]: [f64; 2]) -> Matrix3<f64> {
    Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
}

/// A right-handed frame (its axes are the columns) with z along the unit vector `axis`.
fn axes_with_z_along(axis: Vector3<f64>) -> Matrix3<f64> {
    let helper = match axis.iamin() {
        0 => Vector3::x(),
        1 => Vector3::y(),
        _ => Vector3::z(),
    };
    let x = (helper - axis * axis.dot(&helper)).normalize();
    Matrix3::from_columns(&[x, axis.cross(&x), axis])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_along_any_axis_are_right_handed() {
        for axis in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.6, 0.0, -0.8]] {
            let axes = axes_with_z_along(Vector3::from(axis));
            assert!((axes.determinant() - 1.0).abs() < 1e-15 && axes.column(2) == Vector3::from(axis));
        }
    }
}
