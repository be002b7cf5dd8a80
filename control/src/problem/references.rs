//! References over time that a motion shall follow.

use super::tools::Tool;
use nalgebra::Rotation3;

/// A reference over time, whose distance costs something all along a motion.
///
/// Times are those since the start of the motion (s), in vias of all phases together. Before the first knot
/// the reference holds its first value, after the last knot its last one, with derivatives of zero: with a
/// free final time let it end at rest, or after the end of the motion.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reference {
    /// Of positions of joints.
    Joints(JointReference),
    /// Of the pose of a tool.
    Tool(ToolReference),
}

/// The running cost $\frac12 \sum_i w_i (q_i - q_{r,i}(t))^2$.
///
/// With velocities the reference is the cubic between neighbouring knots with these positions and
/// velocities, so it is C1. Without them it is the cubic spline through the positions, C2 between the first
/// and the last knot, where it rests; it is C1 everywhere.
///
/// ```
/// use costate_control::{JointReference, Task};
///
/// // Both joints go to and fro within a second, the second one with half the way.
/// let knots = vec![vec![0.0, 0.0], vec![0.4, 0.2], vec![0.0, 0.0]];
/// let task = Task::default()
///     .with_reference(JointReference::new(vec![0.0, 0.5, 1.0], knots, vec![100.0, 100.0]));
/// # assert!(!task.is_empty());
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct JointReference {
    /// Times of the knots (s), each later than the one before; one at least.
    pub times: Vec<f64>,
    /// $q_r$ at each knot (rad, m), n entries each.
    pub positions: Vec<Vec<f64>>,
    /// Its derivative at each knot (rad/s, m/s), n entries each; `None` for the spline.
    pub velocities: Option<Vec<Vec<f64>>>,
    /// $w_i$ (cost per second and rad^2, m^2), n entries. Zero for a joint that follows nothing.
    pub weights: Vec<f64>,
}

impl JointReference {
    /// The spline through these positions, with a weight for each joint.
    pub fn new(times: Vec<f64>, positions: Vec<Vec<f64>>, weights: Vec<f64>) -> Self {
        Self { times, positions, velocities: None, weights }
    }

    /// With these velocities at the knots.
    #[must_use]
    pub fn with_velocities(self, velocities: Vec<Vec<f64>>) -> Self {
        Self { velocities: Some(velocities), ..self }
    }
}

/// The running cost $\frac12 w |x - x_r(t)|^2 + \frac12 \bar w \theta^2$ of a tool: x is its position,
/// $\theta$ the angle of the rotation $R_r(t)^\top R$ from the reference to its orientation (rad).
///
/// Positions are interpolated as those of a [`JointReference`]. Orientations are C1: between neighbouring
/// knots
///
/// $$ R_r = R_a \exp(\beta_1 \hat w_1) \exp(\beta_2 \hat w_2) \exp(\beta_3 \hat w_3) $$
///
/// with the cumulative Bernstein polynomials $\beta$ of degree three and constant vectors, so that the
/// angular velocity at a knot is the mean of those of the rotations to both neighbours, each weighed by the
/// length of the other interval, and zero at the first and last knot (M.-J. Kim, M.-S. Kim, S. Y. Shin, A
/// general construction scheme for unit quaternion curves, SIGGRAPH 1995).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ToolReference {
    /// The tool.
    pub tool: Tool,
    /// Times of the knots (s), each later than the one before; one at least.
    pub times: Vec<f64>,
    /// $x_r$ at each knot (m), in the world; `None` for a position that follows nothing. A coordinate that is
    /// [`f64::INFINITY`] at each knot is free.
    pub positions: Option<Vec<[f64; 3]>>,
    /// Its derivative at each knot (m/s); `None` for the spline.
    pub velocities: Option<Vec<[f64; 3]>>,
    /// $R_r$ at each knot, from the axes of the tool to those of the world; less than half a turn from knot
    /// to knot. `None` for an orientation that follows nothing.
    pub orientations: Option<Vec<Rotation3<f64>>>,
    /// w (cost per second and m^2).
    pub position_weight: f64,
    /// $\bar w$ (cost per second and rad^2).
    pub orientation_weight: f64,
}

impl ToolReference {
    /// Of this tool, with knots at these times (s); it follows nothing yet.
    pub fn of(tool: impl Into<Tool>, times: Vec<f64>) -> Self {
        Self {
            tool: tool.into(),
            times,
            positions: None,
            velocities: None,
            orientations: None,
            position_weight: 0.0,
            orientation_weight: 0.0,
        }
    }

    /// Follows the spline through these positions (m), with this weight.
    #[must_use]
    pub fn with_positions(self, positions: Vec<[f64; 3]>, weight: f64) -> Self {
        Self { positions: Some(positions), position_weight: weight, ..self }
    }

    /// With these velocities at the knots (m/s).
    #[must_use]
    pub fn with_velocities(self, velocities: Vec<[f64; 3]>) -> Self {
        Self { velocities: Some(velocities), ..self }
    }

    /// Follows these orientations, with this weight.
    #[must_use]
    pub fn with_orientations(self, orientations: Vec<Rotation3<f64>>, weight: f64) -> Self {
        Self { orientations: Some(orientations), orientation_weight: weight, ..self }
    }
}

impl Reference {
    /// Times of the knots (s).
    pub fn times(&self) -> &[f64] {
        match self {
            Self::Joints(JointReference { times, .. }) | Self::Tool(ToolReference { times, .. }) => times,
        }
    }

    /// Whether any distance costs anything.
    pub(crate) fn costs(&self) -> bool {
        match self {
            Self::Joints(reference) => reference.weights.iter().any(|&weight| weight > 0.0),
            Self::Tool(ToolReference { position_weight, orientation_weight, .. }) => {
                position_weight.max(*orientation_weight) > 0.0
            }
        }
    }
}

impl From<JointReference> for Reference {
    fn from(reference: JointReference) -> Self {
        Self::Joints(reference)
    }
}

impl From<ToolReference> for Reference {
    fn from(reference: ToolReference) -> Self {
        Self::Tool(reference)
    }
}
