//! How a robot is read.

use super::error::RobotError;
use super::warning::Warning;

/// How a robot is read.
///
/// ```
/// use costate::robot::LoadOptions;
/// assert!(LoadOptions::default().strict(true).strict);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LoadOptions {
    /// Warnings that suggest a mistake become errors:
    /// [`Warning::is_refused_when_strict`](super::Warning::is_refused_when_strict).
    pub strict: bool,
    /// Load `<dynamics damping friction>` of a URDF as viscous and smooth Coulomb friction.
    pub friction: bool,
    /// Joints of type `floating` of a URDF are floating joints, their orientation a quaternion; unless set,
    /// they become six joints of one degree of freedom.
    pub quaternions: bool,
    /// The root link of a URDF is the link of a floating joint `root_joint`, its orientation a quaternion,
    /// that stands in the world; unless set, it is the base and does not move.
    pub floating_base: bool,
}

impl LoadOptions {
    /// Sets [`strict`](Self::strict).
    #[must_use]
    pub fn strict(self, strict: bool) -> Self {
        Self { strict, ..self }
    }

    /// [`RobotError::Strict`] for warnings that strict loading refuses.
    pub(super) fn refuse(self, warnings: &[Warning]) -> Result<(), RobotError> {
        let refused = warnings.iter().filter(|warning| self.strict && warning.is_refused_when_strict());
        let warnings: Vec<Warning> = refused.cloned().collect();
        if warnings.is_empty() { Ok(()) } else { Err(RobotError::Strict { warnings }) }
    }

    /// Sets [`quaternions`](Self::quaternions).
    #[must_use]
    pub fn quaternions(self, quaternions: bool) -> Self {
        Self { quaternions, ..self }
    }

    /// Sets [`floating_base`](Self::floating_base).
    #[must_use]
    pub fn floating_base(self, floating_base: bool) -> Self {
        Self { floating_base, ..self }
    }

    /// Sets [`friction`](Self::friction).
    #[must_use]
    pub fn friction(self, friction: bool) -> Self {
        Self { friction, ..self }
    }
}
