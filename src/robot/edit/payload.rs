//! Payloads.

use crate::robot::body::Body;
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
        let body = Body::Payload(frame.name.clone());
        checks::inertia(&body, payload)?;
        checks::rigid(&body, payload)?;
        let Some(joint) = frame.joint else {
            return Err(RobotError::FixedFrame { frame: frame.name.clone() });
        };
        let about_payload = checks::principal_moments(&body, payload);
        let mut warnings: Vec<Warning> = about_payload.iter().cloned().collect();
        if payload.is_massless() {
            warnings.push(Warning::EmptyPayload { frame: frame.name.clone() });
        }
        let mut robot = self.clone();
        let carrier = &mut robot.joints[joint];
        let placed = payload.placed(&frame.placement);
        carrier.inertia =
            if carrier.inertia.is_massless() { placed } else { carrier.inertia.merged(&placed) };
        let link = Body::link(&carrier.link);
        checks::inertia(&link, &carrier.inertia)?;
        let mut robot = robot.checked(self, warnings);
        if about_payload.is_some() {
            // One warning is enough: a link was fine, and is not with this payload.
            let was_fine = !self.warnings.iter().any(|warning| warning.is_about_moments_of(&link));
            robot.warnings.retain(|warning| !(was_fine && warning.is_about_moments_of(&link)));
        }
        Ok(robot)
    }
}
