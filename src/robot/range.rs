//! How small and how large figures may be.

/// Least and largest size of a mass, inertia, armature or ratio (SI units) that is not zero: products of two
/// of them with velocities and lengths neither vanish nor overflow.
pub(super) const RANGE: std::ops::RangeInclusive<f64> = 1e-75..=1e75;

/// Whether a length, force, acceleration or another figure is finite, and so small that products stay so.
pub(super) fn is_moderate(figure: f64) -> bool {
    figure.abs() <= *RANGE.end()
}
