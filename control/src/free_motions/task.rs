//! The problem of a robot in states.

use super::unsolved::Unsolved;
use crate::direct_states::problem::DirectDynamics;
use crate::direct_states::solution::StateMotion;
use crate::extremal::dynamics::problem::{DynamicsProblem, EndState};
use crate::problem::free_end::FreeEnd;
use crate::problem::limits::JointLimits;
use crate::problem::{Bounds, Objective, Problem};
use costate::dynamics::QuaternionDynamics;
use nalgebra::DMatrix;

/// A problem of a robot with floating or spherical joints.
pub(super) struct FreeTask<'a> {
    pub problem: &'a Problem,
    /// Coordinates that something drives: the controls.
    pub driven: Vec<usize>,
    pub limits: Vec<JointLimits>,
    /// How many times as wide the limits of controls are as those of the problem.
    pub widened: f64,
    /// x at the start, and what is given at the end.
    pub start: Vec<f64>,
    pub end: FreeEnd,
}

impl<'a> FreeTask<'a> {
    pub fn new(problem: &'a Problem) -> Result<Self, Unsolved> {
        Ok(Self {
            driven: (0..problem.robot.dof()).filter(|i| !problem.has_no_motor(*i)).collect(),
            limits: problem.joint_limits(),
            widened: 1.0,
            start: problem.free_start()?,
            end: problem.free_end()?,
            problem,
        })
    }

    pub fn nq(&self) -> usize {
        self.problem.robot.nq()
    }

    pub fn dof(&self) -> usize {
        self.problem.robot.dof()
    }

    /// The model, each control times its gain.
    pub fn model(&self) -> Result<QuaternionDynamics<f64>, Unsolved> {
        let n = self.dof();
        let mut b = DMatrix::zeros(n, self.driven.len());
        for (k, &i) in self.driven.iter().enumerate() {
            b[(i, k)] = self.problem.gain[i];
        }
        let model = QuaternionDynamics::new(&self.problem.robot).with_actuation(&b);
        model.map_err(|error| Unsolved::Evaluation(error.into()))
    }

    /// Least and largest control, before the gain.
    pub fn control_range(&self, i: usize) -> [f64; 2] {
        let widened = |torque: f64| if torque == 0.0 { 0.0 } else { self.widened * torque };
        let ends = self.limits[i].torque.map(|torque| widened(torque) / self.problem.gain[i]);
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    }

    /// How many times as wide the limits of the problem would have to be for a motion.
    pub fn needed(&self, motion: &StateMotion) -> f64 {
        let part = |k: usize, u: f64| {
            let torque = self.problem.gain[self.driven[k]] * u;
            let limits = self.limits[self.driven[k]].torque;
            limits.into_iter().filter(|limit| *limit != 0.0).map(|limit| torque / limit).fold(0.0, f64::max)
        };
        let rows = motion.u.iter().flat_map(|u| u.iter().enumerate());
        rows.map(|(k, &u)| part(k, u)).fold(0.0, f64::max)
    }

    pub fn in_states(&self) -> DynamicsProblem {
        let cost = &self.problem.cost;
        let effort = self.driven.iter().map(|&i| cost.effort[i]).collect();
        let of_side = |side: usize| self.driven.iter().map(|&i| self.control_range(i)[side]).collect();
        let end = EndState::fixed(&self.end.x).with_free(&self.end.free).with_given(self.end.given.clone());
        DynamicsProblem::new(EndState::fixed(&self.start), end, self.problem.time, self.driven.len())
            .with_cost(Objective::new(cost.time, effort))
            .with_bounds(Bounds { u_min: of_side(0), u_max: of_side(1) })
    }

    /// For the direct method.
    pub fn direct(&self) -> Result<DirectDynamics<QuaternionDynamics<f64>>, Unsolved> {
        let size = self.nq() + self.dof();
        let (mut x_min, mut x_max) = (vec![f64::NEG_INFINITY; size], vec![f64::INFINITY; size]);
        for (entry, i) in self.problem.robot.plain_entries() {
            [x_min[entry], x_max[entry]] = self.limits[i].q;
        }
        let direct = DirectDynamics::new(self.model()?, &self.in_states())?;
        Ok(direct.with_state_limits(&x_min, &x_max)?)
    }
}
