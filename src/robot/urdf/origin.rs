//! `<origin>`: where things are placed, by angles or, since version 1.1 of the format, by a quaternion.

use super::element::Element;
use super::quaternion::roll_pitch_yaw;
use crate::robot::error::RobotError;
use crate::robot::link::Placement;
use roxmltree::Node;

/// Major and minor version of the format.
pub(super) fn version(root: Node<'_, '_>) -> (u32, u32) {
    let number = |text: &str| text.parse::<u32>().ok();
    let version = root.attribute("version").and_then(|text| text.trim().split_once('.'));
    version.and_then(|(major, minor)| Some((number(major)?, number(minor)?))).unwrap_or((1, 0))
}

/// The placement by the `<origin>` inside an element, of a format that has quaternions or not; identity
/// without one.
pub(super) fn placed(of: &Element<'_>, has_quaternions: bool) -> Result<Placement, RobotError> {
    of.child("origin")?.map_or(Ok(Placement::identity()), |origin| placement(&origin, has_quaternions))
}

/// The placement by an `<origin>`, of a format that has quaternions or not.
pub(super) fn placement(origin: &Element<'_>, has_quaternions: bool) -> Result<Placement, RobotError> {
    let xyz = origin.numbers::<3>("xyz")?.unwrap_or_default();
    let angles = origin.numbers::<3>("rpy")?;
    let mut rpy = angles.unwrap_or_default();
    if has_quaternions && origin.attribute("quat_xyzw").is_some() {
        if angles.is_some() {
            return Err(origin.refuse("has both rpy and quat_xyzw; keep one of them"));
        }
        let [x, y, z, w] = origin.numbers::<4>("quat_xyzw")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        let norm = (x * x + y * y + z * z + w * w).sqrt();
        if !(norm.is_finite() && norm > 0.0) {
            return Err(origin.refuse("has a quat_xyzw of length zero; give a unit quaternion"));
        }
        rpy = roll_pitch_yaw([x, y, z, w].map(|part| part / norm));
    }
    Ok(Placement::from_xyz_rpy(xyz, rpy))
}
