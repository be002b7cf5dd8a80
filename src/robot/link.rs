//! Placements of frames and inertias of rigid links.

use super::range::is_moderate;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// Position and orientation of a frame in another one: `x_outer = rotation x_inner + translation` (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Columns are the axes of the inner frame, seen in the outer one.
    pub rotation: Matrix3<f64>,
    /// Origin of the inner frame, seen in the outer one (m).
    pub translation: Vector3<f64>,
}

impl Placement {
    /// The outer frame itself.
    pub fn identity() -> Self {
        Self { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// Translation `xyz` (m), then fixed-axis roll, pitch, yaw: `R = Rz(yaw) Ry(pitch) Rx(roll)`, as in a
    /// URDF.
    pub fn from_xyz_rpy(xyz: [f64; 3], rpy: [f64; 3]) -> Self {
        let [roll, pitch, yaw] = rpy;
        let rotation = rotation_z(yaw) * rotation_y(pitch) * rotation_x(roll);
        Self { rotation, translation: Vector3::from(xyz) }
    }

    /// `self` followed by `inner`: the placement of the innermost frame in the outermost one.
    pub fn then(&self, inner: &Placement) -> Self {
        Self {
            rotation: self.rotation * inner.rotation,
            translation: self.rotation * inner.translation + self.translation,
        }
    }

    /// The same with the rotation, which files give with few digits, replaced by the nearest orthonormal
    /// matrix.
    pub(crate) fn orthonormalised(&self) -> Self {
        let defect = (self.rotation.transpose() * self.rotation - Matrix3::identity()).amax();
        if defect < 4.0 * f64::EPSILON {
            return *self;
        }
        let svd = self.rotation.svd(true, true);
        let nearest = svd.u.zip(svd.v_t).map(|(u, v_t)| u * v_t);
        Self { rotation: nearest.unwrap_or(self.rotation), ..*self }
    }

    /// Whether the rotation is orthonormal and right-handed to 1e-6, and the translation so small that
    /// products stay finite.
    pub(crate) fn is_rigid(&self) -> bool {
        let defect = (self.rotation.transpose() * self.rotation - Matrix3::identity()).amax();
        self.translation.iter().all(|&x| is_moderate(x)) && defect < 1e-6 && self.rotation.determinant() > 0.0
    }
}

impl Default for Placement {
    fn default() -> Self {
        Self::identity()
    }
}

/// Sine and cosine with the rounding of quarter turns removed: what is within 1e-15 of 0 or +-1 is exactly
/// that.
///
/// Orthogonal axes are then exactly orthogonal, which saves operations; the error made is 1e-15 at most.
pub(crate) fn exact_sin_cos(angle: f64) -> (f64, f64) {
    let (sin, cos) = angle.sin_cos();
    (snap(sin), snap(cos))
}

/// `x`, or the integer -1, 0, 1 nearer than 1e-15 to it.
pub(crate) fn snap(x: f64) -> f64 {
    let near = x.round();
    if (x - near).abs() <= 1e-15 && near.abs() <= 1.0 { near } else { x }
}

/// Rotation about x by `angle` (rad).
pub(crate) fn rotation_x(angle: f64) -> Matrix3<f64> {
    let (s, c) = exact_sin_cos(angle);
    Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
}

/// Rotation about y by `angle` (rad).
pub(crate) fn rotation_y(angle: f64) -> Matrix3<f64> {
    let (s, c) = exact_sin_cos(angle);
    Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c)
}

/// Rotation about z by `angle` (rad).
pub(crate) fn rotation_z(angle: f64) -> Matrix3<f64> {
    let (s, c) = exact_sin_cos(angle);
    Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

/// Mass distribution of a rigid link, in the frame of its joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkInertia {
    /// Mass (kg).
    pub mass: f64,
    /// Centre of mass in the joint frame (m).
    pub com: Vector3<f64>,
    /// Inertia matrix about the centre of mass, axes of the joint frame (kg m^2).
    pub inertia: Matrix3<f64>,
}

impl LinkInertia {
    /// A link without mass.
    pub fn massless() -> Self {
        Self { mass: 0.0, com: Vector3::zeros(), inertia: Matrix3::zeros() }
    }

    /// A point of mass `mass` (kg) at `com` (m).
    pub fn point(mass: f64, com: [f64; 3]) -> Self {
        Self { mass, com: Vector3::from(com), inertia: Matrix3::zeros() }
    }

    /// Mass (kg), centre of mass (m) and inertia matrix about the centre of mass (kg m^2).
    pub fn about_com(mass: f64, com: [f64; 3], inertia: Matrix3<f64>) -> Self {
        Self { mass, com: Vector3::from(com), inertia }
    }

    /// As [`about_com`](Self::about_com), with the entries xx, yy, zz, xy, xz, yz of the inertia matrix.
    pub fn from_entries(mass: f64, com: [f64; 3], [xx, yy, zz, xy, xz, yz]: [f64; 6]) -> Self {
        Self::about_com(mass, com, Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
    }

    /// As [`about_com`](Self::about_com), with the inertia matrix given about the origin of the joint frame.
    pub fn about_origin(mass: f64, com: [f64; 3], inertia: Matrix3<f64>) -> Self {
        let com = Vector3::from(com);
        Self { mass, com, inertia: inertia - parallel_axis(mass, &com) }
    }

    /// The inertia matrix about the origin of the joint frame (kg m^2), by the parallel-axis theorem.
    pub fn inertia_about_origin(&self) -> Matrix3<f64> {
        self.inertia + parallel_axis(self.mass, &self.com)
    }

    /// The same link in a frame in which its own frame has this placement.
    pub fn placed(&self, placement: &Placement) -> Self {
        Self {
            mass: self.mass,
            com: placement.rotation * self.com + placement.translation,
            inertia: placement.rotation * self.inertia * placement.rotation.transpose(),
        }
    }

    /// Both links as one rigid body (same frame).
    pub fn merged(&self, other: &LinkInertia) -> Self {
        let mass = self.mass + other.mass;
        if mass == 0.0 {
            return Self { mass, com: Vector3::zeros(), inertia: self.inertia + other.inertia };
        }
        let com = (self.com * self.mass + other.com * other.mass) / mass;
        let about = |link: &Self| link.inertia + parallel_axis(link.mass, &(link.com - com));
        Self { mass, com, inertia: about(self) + about(other) }
    }

    /// Whether it has neither mass nor inertia.
    pub fn is_massless(&self) -> bool {
        self.mass == 0.0 && self.inertia.iter().all(|x| *x == 0.0)
    }

    /// Principal moments of inertia about the centre of mass, in rising order (kg m^2).
    pub fn principal_moments(&self) -> [f64; 3] {
        let mut moments: [f64; 3] = SymmetricEigen::new(self.inertia).eigenvalues.into();
        moments.sort_by(f64::total_cmp);
        moments
    }
}

/// `m (r.r 1 - r r')`: what moving the reference point by `r` away from the centre of mass adds to an
/// inertia.
fn parallel_axis(mass: f64, r: &Vector3<f64>) -> Matrix3<f64> {
    (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * mass
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn merging_two_halves_gives_the_whole_rod() {
        let half = |centre| LinkInertia::about_com(0.5, [centre, 0.0, 0.0], rod_inertia(0.5, 0.5));
        let whole = half(0.25).merged(&half(0.75));
        let expected = LinkInertia::about_com(1.0, [0.5, 0.0, 0.0], rod_inertia(1.0, 1.0));
        assert!(
            (whole.inertia - expected.inertia).amax() < 1e-16 && (whole.com - expected.com).amax() < 1e-16
        );
        assert!((whole.inertia_about_origin()[(2, 2)] - 1.0 / 3.0).abs() < 1e-16);
        let back = LinkInertia::about_origin(1.0, [0.5, 0.0, 0.0], whole.inertia_about_origin());
        assert!((back.inertia - whole.inertia).amax() < 1e-16);
    }

    fn rod_inertia(mass: f64, length: f64) -> Matrix3<f64> {
        let i = mass * length * length / 12.0;
        Matrix3::from_diagonal(&Vector3::new(0.0, i, i))
    }

    #[test]
    fn quarter_turns_are_exact() {
        let p = Placement::from_xyz_rpy(
            [1.0, 2.0, 3.0],
            [std::f64::consts::FRAC_PI_2, 0.0, -std::f64::consts::PI],
        );
        assert_eq!(p.rotation, Matrix3::new(-1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0));
        assert!(p.is_rigid());
        assert_eq!(exact_sin_cos(1e-9).0, 1e-9_f64.sin());
    }

    #[test]
    fn placements_chain() {
        let a = Placement::from_xyz_rpy([0.1, -0.4, 2.0], [0.3, -1.2, 0.7]);
        let b = Placement::from_xyz_rpy([1.1, 0.2, -0.3], [-2.0, 0.4, 3.0]);
        let x = Vector3::new(0.5, -0.6, 0.7);
        let stepwise = a.rotation * (b.rotation * x + b.translation) + a.translation;
        let at_once = a.then(&b).rotation * x + a.then(&b).translation;
        assert!((stepwise - at_once).amax() < 1e-15);
    }
}
