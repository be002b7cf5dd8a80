//! Robots under forces and moments from outside.

use super::error::RobotError;
use super::frame_list::FrameList;
use super::model::Robot;
use super::range::is_moderate;
use super::warning::Warning;
use super::wrench::{AppliedWrench, Wrench};

impl Robot {
    /// The wrenches from outside, in the order in which they were added.
    pub fn wrenches(&self) -> &[AppliedWrench] {
        &self.wrenches
    }

    /// The same robot without wrenches.
    pub fn without_wrenches(&self) -> Self {
        let mut robot = Self { wrenches: Vec::new(), ..self.clone() };
        robot.warnings.retain(|warning| !matches!(warning, Warning::IdleWrench { .. }));
        robot
    }

    /// A warning for each frame that no joint moves, and that a wrench acts on.
    pub(super) fn idle_wrenches(&self) -> Vec<Warning> {
        let frames = self.wrenches.iter().map(|applied| &self.frames[applied.frame]);
        let idle = frames.filter(|frame| frame.joint.is_none());
        idle.map(|frame| Warning::IdleWrench { frame: frame.name.clone() }).collect()
    }

    /// The same robot with one more wrench, at a frame that is found as by [`frame`](Self::frame).
    ///
    /// The generalised force `J'W` of the wrench is added to the actuation in every quantity: `dp/dt`, the
    /// accelerations, and with the opposite sign tau of inverse dynamics, with all their derivatives.
    /// A wrench is no part of L, V or H. At a frame that no joint moves it has no effect: a warning. The
    /// workspaces of `hamiltonian`, `lagrangian` and `parameters` change its value by `set_wrench`.
    ///
    /// ```
    /// use costate::lagrangian::Lagrangian;
    /// use costate::robot::{Robot, Wrench, WrenchAxes};
    ///
    /// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
    /// let arm = Robot::from_file("robots/ur5.urdf")?;
    /// let pull = Wrench { force: [0.0, 0.0, -20.0], axes: WrenchAxes::Aligned, ..Wrench::default() };
    /// let loaded = arm.with_wrench("tool0", pull)?;
    /// let q = [0.3, -1.2, 0.8, 0.1, 0.5, 0.0];
    /// let alone = Lagrangian::<f64>::new(&arm).gravity(&q)?[1];
    /// let holding = Lagrangian::<f64>::new(&loaded).inverse_dynamics(&q, &[0.0; 6], &[0.0; 6])?[1];
    /// assert!(holding.abs() > alone.abs());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`RobotError::UnknownFrame`], with the names that resemble it; [`RobotError::BadWrench`] for numbers
    /// that are not finite, or larger than 1e75.
    pub fn with_wrench(&self, frame: &str, wrench: Wrench) -> Result<Self, RobotError> {
        self.clone().with_wrenches(std::iter::once((frame, wrench))).map_err(|(_, error)| error)
    }

    /// The same robot with these wrenches, too.
    ///
    /// # Errors
    /// As [`with_wrench`](Self::with_wrench), with the position of the wrench.
    pub(super) fn with_wrenches<'a>(
        mut self,
        wrenches: impl Iterator<Item = (&'a str, Wrench)>,
    ) -> Result<Self, (usize, RobotError)> {
        let frames = FrameList::from(self.frames);
        for (k, (name, wrench)) in wrenches.enumerate() {
            let frame = frames.position(name).map_err(|error| (k, error))?;
            if wrench.moment.iter().chain(&wrench.force).any(|&entry| !is_moderate(entry)) {
                return Err((k, RobotError::BadWrench { frame: name.to_owned() }));
            }
            self.wrenches.push(AppliedWrench { frame, wrench });
        }
        let mut robot = Self { frames: frames.into_frames(), ..self };
        for warning in robot.idle_wrenches() {
            robot.add_warning(warning);
        }
        Ok(robot)
    }
}
