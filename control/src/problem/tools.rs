//! What a problem asks of tools.

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion};

/// A point that is fixed to a link, with the axes of a frame: a frame of the robot and an offset.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Tool {
    /// Name of the frame, as [`Robot::frame`](costate::robot::Robot::frame) finds it.
    pub frame: String,
    /// The point in the axes of the frame (m).
    pub offset: [f64; 3],
}

impl Tool {
    /// The origin of this frame.
    pub fn new(frame: impl Into<String>) -> Self {
        Self { frame: frame.into(), offset: [0.0; 3] }
    }

    /// With this point of the frame (m).
    #[must_use]
    pub fn with_offset(self, offset: [f64; 3]) -> Self {
        Self { offset, ..self }
    }
}

impl From<&str> for Tool {
    /// The origin of the frame of this name.
    fn from(frame: &str) -> Self {
        Self::new(frame)
    }
}

/// An orientation that a tool shall have, in the world.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ToolOrientation {
    /// All three axes: the rotation from the tool to the world.
    Full(Rotation3<f64>),
    /// One axis alone: the tool may turn about it. Neither vector needs to have length one.
    Axis {
        /// The axis of the tool, in axes of its frame.
        axis: [f64; 3],
        /// The direction in the world that it shall have.
        along: [f64; 3],
    },
    /// The yaw alone (rad): of x of the tool, seen from above, from x of the world. With `a = R e_x`
    ///
    /// $$ \operatorname{atan2}(a_y, a_x) = \psi $$
    ///
    /// up to whole turns, one equation: roll and pitch are free. Where x of the tool is vertical it has no
    /// yaw, and the equation no derivatives.
    Yaw(f64),
}

/// Where a tool shall be, in the world: a position, an orientation, or both.
///
/// ```
/// use costate_control::{Tool, ToolPose};
///
/// let above_the_table = ToolPose::of(Tool::new("tool0").with_offset([0.0, 0.0, 0.1]))
///     .with_position([0.4, f64::INFINITY, 0.2])
///     .with_axis([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]);
/// # assert!(above_the_table.orientation.is_some());
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ToolPose {
    /// The tool.
    pub tool: Tool,
    /// Its position (m). A coordinate that is [`f64::INFINITY`] is free.
    pub position: Option<[f64; 3]>,
    /// Its orientation.
    pub orientation: Option<ToolOrientation>,
}

impl ToolPose {
    /// Of this tool; nothing is asked yet.
    pub fn of(tool: impl Into<Tool>) -> Self {
        Self { tool: tool.into(), position: None, orientation: None }
    }

    /// With this position (m); a coordinate that is [`f64::INFINITY`] is free.
    #[must_use]
    pub fn with_position(self, position: [f64; 3]) -> Self {
        Self { position: Some(position), ..self }
    }

    /// With this rotation from the axes of the tool to those of the world.
    #[must_use]
    pub fn with_rotation(self, rotation: Rotation3<f64>) -> Self {
        Self { orientation: Some(ToolOrientation::Full(rotation)), ..self }
    }

    /// With this yaw (rad) alone, of an arm whose joints leave roll and pitch no choice, such as a
    /// palletiser.
    #[must_use]
    pub fn with_yaw(self, yaw: f64) -> Self {
        Self { orientation: Some(ToolOrientation::Yaw(yaw)), ..self }
    }

    /// With an axis of the tool along a direction of the world.
    #[must_use]
    pub fn with_axis(self, axis: [f64; 3], along: [f64; 3]) -> Self {
        Self { orientation: Some(ToolOrientation::Axis { axis, along }), ..self }
    }
}

/// What a tool keeps all along a motion.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Keep {
    /// The tool.
    pub tool: Tool,
    /// What it keeps.
    pub kept: Kept,
}

impl Keep {
    /// This tool keeps this.
    pub fn new(tool: impl Into<Tool>, kept: Kept) -> Self {
        Self { tool: tool.into(), kept }
    }
}

/// What is kept, in the world. Directions need not have length one; a tolerance of zero asks for equality.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Kept {
    /// The tool stays near a plane.
    Plane {
        /// A point of the plane (m).
        through: [f64; 3],
        /// Its normal.
        normal: [f64; 3],
        /// The largest distance from it (m).
        distance: f64,
    },
    /// The tool stays near a line.
    Line {
        /// A point of the line (m).
        through: [f64; 3],
        /// Its direction.
        along: [f64; 3],
        /// The largest distance from it (m).
        distance: f64,
    },
    /// The tool stays in a box along the axes of the world.
    Box {
        /// Least coordinates (m); [`f64::NEG_INFINITY`] for none.
        min: [f64; 3],
        /// Largest coordinates (m); [`f64::INFINITY`] for none.
        max: [f64; 3],
    },
    /// An axis of the tool keeps a direction of the world: a cup stays upright.
    Axis {
        /// The axis, in axes of the tool's frame.
        axis: [f64; 3],
        /// The direction.
        along: [f64; 3],
        /// The largest angle between them (rad), less than a half turn.
        angle: f64,
    },
    /// The tool keeps its orientation.
    Orientation {
        /// From the axes of the tool to those of the world.
        rotation: Rotation3<f64>,
        /// The largest angle of the rotation from it (rad), less than a half turn.
        angle: f64,
    },
    /// The tool is not faster than this.
    Speed {
        /// Largest speed of the point (m/s).
        max: f64,
    },
    /// The acceleration of the tool is not larger than this.
    Acceleration {
        /// Largest magnitude of the second derivative of the position of the point in the world (m/s^2),
        /// without gravity.
        max: f64,
    },
}

/// A running cost of a tool: half a weight times the square of its distance from a position, plus half a
/// weight times the square of its angle (rad) from an orientation.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ToolCost {
    /// The position and orientation at which it costs nothing.
    pub pose: ToolPose,
    /// Weight of the position (cost per second and m^2).
    pub position_weight: f64,
    /// Weight of the orientation (cost per second and rad^2).
    pub orientation_weight: f64,
}

impl ToolCost {
    /// With these weights of position and orientation.
    pub fn new(pose: ToolPose, position_weight: f64, orientation_weight: f64) -> Self {
        Self { pose, position_weight, orientation_weight }
    }
}

/// The rotation of a quaternion (x, y, z, w) whose length is 1 up to [`ROUNDED`].
pub(crate) fn rotation_of_quaternion([x, y, z, w]: [f64; 4]) -> Option<Rotation3<f64>> {
    let quaternion = Quaternion::new(w, x, y, z);
    // Not true for NaN.
    let has_length_one = (quaternion.norm() - 1.0).abs() <= ROUNDED;
    has_length_one.then(|| UnitQuaternion::new_normalize(quaternion).to_rotation_matrix())
}

/// How far the length of a quaternion may be from 1: that of three digits, (0.707, 0, 0, 0.707), is off by
/// 1.5e-4.
const ROUNDED: f64 = 1e-3;

/// A rotation from its matrix, row by row, if it is one to 1e-6: then the nearest exact one.
pub(crate) fn rotation(rows: [[f64; 3]; 3]) -> Option<Rotation3<f64>> {
    let [a, b, c] = rows;
    let matrix = Matrix3::new(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]);
    let defect = (matrix.transpose() * matrix - Matrix3::identity()).amax();
    // Not true for NaN.
    let is_rotation = defect < 1e-6 && matrix.determinant() > 0.0;
    is_rotation.then(|| Rotation3::from_matrix(&matrix))
}
