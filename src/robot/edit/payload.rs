//! Payloads.

use crate::robot::checks;
use crate::robot::error::RobotError;
use crate::robot::link::LinkInertia;
use crate::robot::model::Robot;
use crate::robot::warning::Warning;

impl Robot {
    /// The same robot with a rigid body on one of its [`frames`](Self::frames): mass, centre of mass and
    /// inertia in the axes of the frame.
    ///
    /// ```
    /// use costate::robot::{LinkInertia, Robot};
    ///
    /// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
    /// let arm = Robot::from_file("robots/ur5.urdf")?;
    /// let load = LinkInertia::from_entries(2.0, [0.0, 0.0, 0.1], [0.01, 0.01, 0.01, 0.0, 0.0, 0.0]);
    /// let loaded = arm.with_payload("tool0", &load)?;
    /// assert_eq!(loaded.joints()[5].inertia.mass, arm.joints()[5].inertia.mass + 2.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`RobotError::UnknownFrame`], [`RobotError::FixedFrame`] for a frame that no joint moves,
    /// [`RobotError::NonFiniteInertia`], [`RobotError::NegativeMass`], [`RobotError::OutOfRange`] and
    /// [`RobotError::IndefiniteInertia`] for a body that cannot be. Principal moments that violate the
    /// triangle inequality are a warning, as those of links are, and so is a body without mass and inertia.
    pub fn with_payload(&self, frame: &str, payload: &LinkInertia) -> Result<Self, RobotError> {
        let frame = self.frame(frame)?;
        let name = format!("payload of {}", frame.name);
        checks::inertia(&name, payload)?;
        checks::rigid(&name, payload)?;
        let Some(joint) = frame.joint else {
            return Err(RobotError::FixedFrame { frame: frame.name.clone() });
        };
        let mut warnings: Vec<Warning> = checks::principal_moments(&name, payload).into_iter().collect();
        if payload.is_massless() {
            warnings.push(Warning::EmptyPayload { frame: frame.name.clone() });
        }
        let mut robot = self.clone();
        let carrier = &mut robot.joints[joint];
        let body = payload.placed(&frame.placement);
        carrier.inertia = if carrier.inertia.is_massless() { body } else { carrier.inertia.merged(&body) };
        checks::inertia(&carrier.link, &carrier.inertia)?;
        Ok(robot.checked(self, warnings))
    }
}
