//! Quaternions as fixed-axis angles.

/// Roll, pitch and yaw (rad) of a unit quaternion (x, y, z, w), accurate near pitch = +-pi/2 too: yaw given
/// roll.
pub(super) fn roll_pitch_yaw([x, y, z, w]: [f64; 4]) -> [f64; 3] {
    let r = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ];
    let roll = r[2][1].atan2(r[2][2]);
    let pitch = (-r[2][0]).atan2(r[0][0].hypot(r[1][0]));
    let (sin, cos) = roll.sin_cos();
    let yaw = (sin * r[0][2] - cos * r[0][1]).atan2(cos * r[1][1] - sin * r[1][2]);
    [roll, pitch, yaw]
}
