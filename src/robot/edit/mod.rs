//! A loaded robot is changed: joints locked, frames, payloads and wrenches added, figures of joints replaced.
//!
//! Each method returns another robot, checked as a new one is. The original is not changed.

mod constants;
mod joints;
mod limit_change;
mod lock;
mod payload;
mod symmetric;

pub use limit_change::LimitChange;
pub use symmetric::{LargestChange, SymmetryChange};

use super::checks;
use super::constraint::ConstraintSpec;
use super::error::RobotError;
use super::frame::{FrameKind, FrameSpec};
use super::joint::Friction;
use super::link::LinkInertia;
use super::model::Robot;
use super::nearest::resembling;
use super::options::LoadOptions;
use super::warning::{Positivity, Warning};
use super::wrench::Wrench;

/// A change of a robot, as problem files and the command line describe it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RobotEdit {
    /// [`Robot::with_gravity`].
    Gravity([f64; 3]),
    /// [`Robot::with_joint_armature`].
    Armature(String, f64),
    /// [`Robot::with_friction`].
    Friction(String, Friction),
    /// [`Robot::with_limits`], some of them.
    Limits(String, LimitChange),
    /// [`Robot::with_frame`].
    Frame(FrameSpec),
    /// [`Robot::with_payload`].
    Payload(String, LinkInertia),
    /// [`Robot::with_wrench`].
    Wrench(String, Wrench),
    /// [`Robot::with_constraint`].
    Constraint(ConstraintSpec),
    /// [`Robot::lock`].
    Lock(Vec<(String, f64)>),
    /// [`Robot::reduced_to`] with the other joints at 0.
    ReducedTo(Vec<String>),
}

impl Robot {
    /// The robot after these changes, one after the other.
    ///
    /// # Errors
    /// Those of the methods that [`RobotEdit`] names; [`RobotError::Strict`] for warnings about the robot
    /// that results, if the options refuse warnings.
    pub fn edited(&self, edits: &[RobotEdit], options: LoadOptions) -> Result<Self, RobotError> {
        let mut robot = self.clone();
        // Many frames or wrenches in a row are found by their names once.
        let go_together = |a: &_, b: &_| {
            use RobotEdit::{Frame, Wrench};
            matches!((a, b), (Frame(_), Frame(_)) | (Wrench(..), Wrench(..)))
        };
        for run in edits.chunk_by(go_together) {
            robot = match run {
                [edit] => robot.changed(edit)?,
                run => {
                    let frames = run.iter().filter_map(|edit| match edit {
                        RobotEdit::Frame(frame) => Some(frame.clone()),
                        _ => None,
                    });
                    let wrenches = run.iter().filter_map(|edit| match edit {
                        RobotEdit::Wrench(frame, wrench) => Some((frame.as_str(), *wrench)),
                        _ => None,
                    });
                    let framed = robot.with_frames(frames);
                    framed.and_then(|robot| robot.with_wrenches(wrenches)).map_err(|(_, error)| error)?
                }
            };
        }
        options.refuse(&robot.warnings)?;
        Ok(robot)
    }

    fn changed(&self, edit: &RobotEdit) -> Result<Self, RobotError> {
        match edit {
            RobotEdit::Gravity(gravity) => self.with_gravity(*gravity),
            RobotEdit::Armature(joint, armature) => self.with_joint_armature(joint, *armature),
            RobotEdit::Friction(joint, friction) => self.with_friction(joint, *friction),
            RobotEdit::Limits(joint, change) => {
                let index = self.joint_index(joint)?;
                self.with_limits(joint, change.of(self.joints[index].limits))
            }
            RobotEdit::Frame(frame) => self.with_frame(frame.clone()),
            RobotEdit::Payload(frame, payload) => self.with_payload(frame, payload),
            RobotEdit::Wrench(frame, wrench) => self.with_wrench(frame, *wrench),
            RobotEdit::Constraint(spec) => self.with_constraint(spec.clone()),
            RobotEdit::Lock(joints) => {
                let joints: Vec<(&str, f64)> = joints.iter().map(|(joint, q)| (joint.as_str(), *q)).collect();
                self.lock(&joints)
            }
            RobotEdit::ReducedTo(joints) => {
                let joints: Vec<&str> = joints.iter().map(String::as_str).collect();
                self.reduced_to(&joints, &vec![0.0; self.nq()])
            }
        }
    }

    /// Index of the joint of this name in [`joints`](Self::joints).
    ///
    /// # Errors
    /// [`RobotError::StillJoint`] for a joint that is locked, or fixed in the file;
    /// [`RobotError::UnknownJoint`], with the names that resemble it.
    pub fn joint_index(&self, name: &str) -> Result<usize, RobotError> {
        let found = self.joints.iter().position(|joint| joint.name == name);
        found.ok_or_else(|| self.not_a_joint(name))
    }

    /// Why no joint has this name: those that do not move have left their frames.
    fn not_a_joint(&self, name: &str) -> RobotError {
        let joint = name.to_owned();
        if self.frames.iter().any(|frame| frame.kind == FrameKind::Joint && frame.name == name) {
            return RobotError::StillJoint { joint };
        }
        let nearest = resembling(name, self.joints.iter().map(|joint| joint.name.as_str()));
        RobotError::UnknownJoint { joint, nearest }
    }

    /// The same, of a joint that is no part of a floating or spherical one.
    fn single_index(&self, name: &str, what: &'static str) -> Result<usize, RobotError> {
        let index = self.joint_index(name)?;
        match &self.joints[index].free {
            None => Ok(index),
            Some(part) => {
                let (joint, kind) = (part.joint.clone(), part.kind.name());
                Err(RobotError::FreeJoint { joint, kind, what })
            }
        }
    }

    /// The same, of an independent joint.
    fn independent_index(&self, name: &str) -> Result<usize, RobotError> {
        let index = self.single_index(name, "be locked, or have limits")?;
        match self.joints[index].mimic {
            None => Ok(index),
            Some(mimic) => {
                let master = self.joints[mimic.joint].name.clone();
                Err(RobotError::DependentJoint { joint: name.to_owned(), master })
            }
        }
    }

    /// Checks what depends on the whole tree; adds the warnings of the edit and those that are new, and omits
    /// those of the robot before that no longer apply.
    pub(super) fn checked(mut self, before: &Self, of_edit: Vec<Warning>) -> Self {
        let [mut found, mut past] = [Vec::new(), Vec::new()];
        checks::robot(&self.joints, &self.armature, &mut found);
        checks::robot(&before.joints, &before.armature, &mut past);
        let joints = &self.joints;
        let is_joint = |name: &str| joints.iter().any(|joint| joint.name == name);
        let is_massless =
            |link: &str| joints.iter().any(|joint| joint.link == link && joint.inertia.is_massless());
        let applies = |warning: &Warning| match warning {
            Warning::MasslessLink { link } => is_massless(link),
            warning => found.contains(warning) || !past.contains(warning),
        };
        self.warnings.iter_mut().filter_map(Warning::positivity_mut).for_each(|p| *p = Positivity::Untried);
        let left = std::mem::take(&mut self.warnings).into_iter().filter(applies);
        self.warnings = left.filter_map(|warning| warning.about(is_joint)).collect();
        let new = found.into_iter().filter(|warning| !past.contains(warning));
        let idle = self.idle_wrenches();
        of_edit.into_iter().chain(new).chain(idle).for_each(|warning| self.add_warning(warning));
        checks::pass_links_between(&self.joints, &self.armature, &mut self.warnings);
        checks::try_mass_matrix(&self.joints, &self.armature, &mut self.warnings);
        self
    }
}
