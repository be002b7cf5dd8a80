//! The plane normal to an axis.

use nalgebra::Vector3;

/// Two directions that form a right-handed frame with `normal` (of length 1): x and y for z.
pub(super) fn plane(normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let within = |direction: Vector3<f64>| direction - normal * normal.dot(&direction);
    let x = within(Vector3::x());
    let first = if x.norm() >= 0.5 { x } else { within(Vector3::y()) };
    let first = first / first.norm();
    [first, normal.cross(&first)]
}
