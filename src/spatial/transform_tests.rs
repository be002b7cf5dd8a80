//! Transforms against dense matrices.

use super::inertia::{ConstantInertia, Symmetric3};
use super::turn::{FixedTurn, Turn};
use super::*;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

fn cases() -> Vec<(FixedScrew, JointPosition<f64>)> {
    let unit = |angle: f64| FixedTurn::new([angle.sin(), angle.cos()]);
    let (turned, slid) = (JointPosition::Rotated(Turn::by(0.4)), JointPosition::Translated(-0.8));
    let free = JointPosition::Oriented(Quaternion::new([0.1, -0.5, 0.7, 0.5]));
    let translation = [0.3, -0.5, 0.7];
    let mut cases = Vec::new();
    for (joint, rise) in [(turned, 0.0), (turned, 0.35), (slid, 0.0), (free, 0.0)] {
        for gamma in [None, Some(unit(2.2))] {
            for alpha in [FixedTurn::new([0.0, 1.0]), FixedTurn::new([-1.0, 0.0]), unit(-1.3)] {
                cases.push((FixedScrew { gamma, alpha, translation, rise }, joint));
            }
        }
    }
    cases
}

/// Rotation and translation as dense arrays, built independently of the staged formulas.
fn dense(t: &Transform<'_, f64>) -> (Matrix3<f64>, Vector3<f64>) {
    let rz = |[s, c]: [f64; 2]| Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
    let [s, c] = t.fixed.alpha.sin_cos();
    let rx = Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c);
    let outer = rz(t.fixed.gamma.map_or([0.0, 1.0], |gamma| gamma.sin_cos()));
    let (turn, slide) = match t.joint {
        JointPosition::Rotated(turn) => (rz([turn.sin, turn.cos]), t.fixed.rise),
        JointPosition::Translated(distance) => (Matrix3::identity(), distance),
        JointPosition::Oriented(orientation) => {
            let of = nalgebra::Quaternion::from_vector(orientation.to_array().into());
            (*UnitQuaternion::new_unchecked(of).to_rotation_matrix().matrix(), 0.0)
        }
    };
    let origin = outer * (Vector3::from(t.fixed.translation) + rx * Vector3::new(0.0, 0.0, slide));
    (outer * rx * turn, origin)
}

fn to_na(a: Vec3<f64>) -> Vector3<f64> {
    Vector3::new(a.x, a.y, a.z)
}

fn close(a: Vec3<f64>, b: Vector3<f64>) {
    assert!((to_na(a) - b).amax() < 1e-14, "{a:?} is not {b:?}");
}

#[test]
fn staged_transforms_agree_with_dense_matrices() {
    let (a, b) = (Vec3::constant([0.9, -0.1, 0.35]), Vec3::constant([-0.6, 0.45, 1.2]));
    for (fixed, joint) in cases() {
        let t = Transform { fixed: &fixed, joint };
        let (r, o) = dense(&t);
        close(t.vector_down(a), r.transpose() * to_na(a));
        let (down, arm) = t.vector_down_with_arm(a);
        close(down, r.transpose() * to_na(a));
        assert!((arm - o.dot(&to_na(a))).abs() < 1e-15);
        let m = t.motion_down(Motion { angular: a, linear: b });
        close(m.angular, r.transpose() * to_na(a));
        close(m.linear, r.transpose() * (to_na(b) + to_na(a).cross(&o)));
        let f = t.force_up(Force { moment: a, force: b });
        close(f.force, r * to_na(b));
        close(f.moment, r * to_na(a) + o.cross(&(r * to_na(b))));
    }
}

#[test]
fn inertia_moves_by_the_parallel_axis_theorem() {
    let (m, com) = (2.0, Vector3::new(0.2, -0.3, 0.1));
    let i_com = Matrix3::new(0.4, 0.02, -0.03, 0.02, 0.5, 0.01, -0.03, 0.01, 0.6);
    let about = |i: Matrix3<f64>, c: Vector3<f64>| {
        i + (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * m
    };
    let j = about(i_com, com);
    let body = ConstantInertia {
        mass: m,
        first_moment: (com * m).into(),
        matrix: [j[(0, 0)], j[(1, 1)], j[(2, 2)], j[(0, 1)], j[(0, 2)], j[(1, 2)]],
    };
    for (fixed, joint) in cases() {
        let t = Transform { fixed: &fixed, joint };
        let (r, o) = dense(&t);
        let moved = t.inertia_up(&body.lift());
        let c = r * com + o;
        close(moved.first_moment, c * m);
        let Symmetric3 { xx, yy, zz, xy, xz, yz } = moved.matrix;
        let ours = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        assert!((ours - about(r * i_com * r.transpose(), c)).amax() < 1e-14);
    }
}

#[test]
fn an_orientation_takes_no_more_room_than_a_turn() {
    // Four numbers and the kind: the kernels keep one for each joint.
    assert_eq!(size_of::<JointPosition<f64>>(), size_of::<Turn<f64>>() + size_of::<f64>());
}
