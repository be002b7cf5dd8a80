//! The phases of a motion: what is given at their ends, and the robot in each of them.

use super::error::ProblemError;
use super::key::Key;
use super::tools::ToolPose;
use super::via_error::ViaError;
use super::{BoundaryState, FinalTime, Payload, Problem, Via};
use costate::robot::Robot;
use std::sync::Arc;

impl Problem {
    /// With one more via, after those that were added before.
    #[must_use]
    pub fn with_via(mut self, via: Via) -> Self {
        self.vias.push(via);
        self
    }

    /// With an end that is the start, moved by `shift` (rad, m; n entries): q(T) = q(0) + shift,
    /// v(T) = v(0), and with continuous accelerations a(T) = a(0). What is free at the start is free at the
    /// end too; [`end`](Self::end) does not count.
    #[must_use]
    pub fn with_period(self, shift: Vec<f64>) -> Self {
        Self { periodic: Some(shift), ..self }
    }

    /// Number of phases: one more than vias.
    pub(crate) fn phases(&self) -> usize {
        self.vias.len() + 1
    }

    /// The states at the ends of the phases: start, vias, end.
    pub(crate) fn ends(&self) -> Vec<BoundaryState> {
        if self.gait.is_some() {
            return vec![self.end_of_step(), self.end_of_step()];
        }
        let mut end = self.end.clone();
        if let Some(shift) = &self.periodic {
            end = self.start.clone();
            end.q.iter_mut().zip(shift).for_each(|(q, shift)| *q += shift);
        }
        let vias = self.vias.iter().map(|via| via.state(self.coordinates()));
        std::iter::once(self.start.clone()).chain(vias).chain([end]).collect()
    }

    /// The tools at the ends of the phases.
    pub(crate) fn tools_at_ends(&self) -> impl Iterator<Item = &[ToolPose]> {
        let vias = self.vias.iter().map(|via| &via.tools[..]);
        [&self.task.start_tools[..]].into_iter().chain(vias).chain([&self.task.end_tools[..]])
    }

    /// Whether anything is asked of tools or bodies, which move with links.
    pub(crate) fn asks_for_links(&self) -> bool {
        self.task.moves_with_links() || self.vias.iter().any(|via| !via.tools.is_empty())
    }

    /// The parts of the duration that the phases take, if they are given: of a step with double support.
    pub(crate) fn parts_of_time(&self) -> Option<[f64; 2]> {
        let share = self.loops.as_ref()?.walk.as_ref()?.gait.double_support?;
        Some([share, 1.0 - share])
    }

    /// The times that are given at the ends of the phases (s).
    pub(crate) fn times_at_ends(&self) -> Vec<Option<f64>> {
        let end = match self.time {
            FinalTime::Fixed(time) => Some(time),
            FinalTime::Free { .. } => None,
        };
        [Some(0.0)].into_iter().chain(self.vias.iter().map(|via| via.time)).chain([end]).collect()
    }

    /// Whether a via has a given time.
    pub(crate) fn has_via_times(&self) -> bool {
        self.vias.iter().any(|via| via.time.is_some())
    }

    /// The robot with what a via says that it carries.
    ///
    /// # Errors
    /// [`ProblemError::Via`] for a payload that the robot does not take.
    pub(super) fn loaded(&self, number: usize, payload: &[Payload]) -> Result<Robot, ProblemError> {
        let add = |robot: Robot, payload: &Payload| robot.with_payload(&payload.frame, &payload.inertia);
        payload.iter().try_fold(self.robot.clone(), add).map_err(|error| ProblemError::Via {
            key: Key::via("payload", number),
            cause: ViaError::Payload(Arc::new(error)),
        })
    }

    /// The robot with what it carries in each phase. A payload that the robot does not take, which the check
    /// of the problem refuses, is left out.
    pub(crate) fn robots(&self) -> Vec<Robot> {
        let mut robots = vec![self.robot.clone()];
        for (number, via) in self.vias.iter().enumerate() {
            let before = &robots[number];
            let loaded = via.payload.as_ref().and_then(|payload| self.loaded(number, payload).ok());
            robots.push(loaded.unwrap_or_else(|| before.clone()));
        }
        robots
    }

    /// What makes the motion one that the direct method alone finds: its first via, or that its end follows
    /// its start.
    pub(crate) fn first_of_phases(&self) -> Option<Key> {
        let via = self.vias.first().map(|via| Key::via(if via.q.is_some() { "q" } else { "tool" }, 0));
        via.or(self.periodic.as_ref().map(|_| Key::PERIODIC_SHIFT))
    }
}
