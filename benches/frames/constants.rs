//! What the common frame needs to know of a robot before it moves.

use costate::robot::{JointFrame, Tree};
use costate::scalar::Scalar;
use costate::spatial::{Inertia, Symmetric3, Vec3};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use std::array::from_fn;

/// Axes and origin of a body frame, seen from the common frame.
#[derive(Clone, Copy)]
pub struct Pose<S> {
    pub axes: [Vec3<S>; 3],
    pub origin: Vec3<S>,
}

impl<S: Scalar> Pose<S> {
    /// A constant vector of the body.
    #[inline(always)]
    pub fn turn(&self, [x, y, z]: [f64; 3]) -> Vec3<S> {
        let [a, b, c] = self.axes;
        a.times(x) + b.times(y) + c.times(z)
    }
}

/// Constants of a link: centre of mass and `J = middle 1 + u w' + w u'` about it, by the middle principal
/// moment and two vectors; turning them takes 27 products, turning a matrix 45.
pub struct Link {
    mass: f64,
    com: [f64; 3],
    middle: f64,
    u: [f64; 3],
    w: [f64; 3],
}

impl Link {
    pub fn new(joint: &JointFrame) -> Self {
        let mass = joint.inertia.mass;
        let com =
            if mass == 0.0 { Vector3::zeros() } else { Vector3::from(joint.inertia.first_moment) / mass };
        let [xx, yy, zz, xy, xz, yz] = joint.inertia.matrix;
        let about_origin = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let eigen = SymmetricEigen::new(
            about_origin - (Matrix3::identity() * com.norm_squared() - com * com.transpose()) * mass,
        );
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let [low, middle, high] = order.map(|k| eigen.eigenvalues[k]);
        let a = eigen.eigenvectors.column(order[2]) * (high - middle).sqrt();
        let b = eigen.eigenvectors.column(order[0]) * (middle - low).sqrt();
        let clean = |v: Vector3<f64>| v.map(|x| if x.abs() <= 1e-14 * v.amax() { 0.0 } else { x }).into();
        Self { mass, com: com.into(), middle, u: clean(a + b), w: clean((a - b) / 2.0) }
    }

    /// Inertia about the origin of the common frame.
    #[inline(always)]
    pub fn place<S: Scalar>(&self, pose: &Pose<S>) -> Inertia<S> {
        let c = pose.origin + pose.turn(self.com);
        let h = c.times(self.mass);
        let (u, w) = (pose.turn(self.u), pose.turn(self.w));
        let (xx, yy, zz) = (c.x * h.x, c.y * h.y, c.z * h.z);
        let double = |a: S| a + a;
        let matrix = Symmetric3 {
            xx: double(u.x * w.x).plus(self.middle) + (yy + zz),
            yy: double(u.y * w.y).plus(self.middle) + (xx + zz),
            zz: double(u.z * w.z).plus(self.middle) + (xx + yy),
            xy: u.x * w.y + u.y * w.x - c.x * h.y,
            xz: u.x * w.z + u.z * w.x - c.x * h.z,
            yz: u.y * w.z + u.z * w.y - c.y * h.z,
        };
        Inertia { mass: self.mass, first_moment: h, matrix }
    }
}

/// Joints on the world, and gravity, seen from the first joint before it moves.
pub fn roots(tree: &Tree) -> (Vec<Option<Pose<f64>>>, [f64; 3]) {
    let place = |joint: &JointFrame| {
        let about = |axis, [sin, cos]: [f64; 2]| {
            let angle = sin.atan2(cos);
            nalgebra::Rotation3::from_axis_angle(&axis, angle).into_inner()
        };
        let gamma = joint.screw.gamma.map(|gamma| gamma.sin_cos());
        let outer = gamma.map_or(Matrix3::identity(), |gamma| about(Vector3::z_axis(), gamma));
        let turn = about(Vector3::x_axis(), joint.screw.alpha.sin_cos());
        let arm = Vector3::from(joint.screw.translation) + turn * Vector3::z() * joint.screw.rise;
        (outer * turn, outer * arm)
    };
    let (turn, start) = place(&tree.joints()[0]);
    let clean = |v: Vector3<f64>| v.map(|x| if (x - x.round()).abs() < 1e-15 { x.round() } else { x }).into();
    let pose = |joint: &JointFrame| {
        let (axes, origin) = place(joint);
        let (axes, origin) = (turn.transpose() * axes, turn.transpose() * (origin - start));
        let vector = |v: Vector3<f64>| Vec3::constant(clean(v));
        Pose { axes: from_fn(|c| vector(axes.column(c).into_owned())), origin: vector(origin) }
    };
    let roots = tree.joints().iter().map(|joint| joint.parent.is_none().then(|| pose(joint))).collect();
    (roots, clean(turn.transpose() * Vector3::from(tree.gravity())))
}
