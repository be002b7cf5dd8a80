//! Robots whose loops are closed by constraints, as robots with more coordinates.
//!
//! With the rows g(q) of the constraints, their Jacobian J and the multipliers mu of the constrained Legendre
//! transform as the rates of further coordinates nu,
//!
//! ```text
//! L(q, v) - dnu/dt . J v
//! ```
//!
//! is a Lagrange function of (q, nu) whose equations are `tau = ID(q, v, a) - J' lambda` and
//! `0 = -d2 g/dt2`, with the forces lambda of the constraints as the accelerations of nu. So a robot with
//! constraints moves as an open one with joints without a motor, and what solves motions of those solves its
//! motions: nu and dnu/dt are zero at the start and free at the end, and nothing else depends on them. The
//! matrix of (a, lambda) in these equations is that of [`ConstrainedHamiltonian`], regular where the rows are
//! independent.
//!
//! Along a motion from g = 0, J v = 0 the second derivatives of g vanish at the points; g itself drifts by
//! the error of the mesh, which is told. So at the end no more positions and rates stay given than are
//! independent of the rows: others, which have to fit them, are left free there, and come to where the loops
//! are closed. Rows that depend on others at the start are left out, so that it must be no singular pose.

use super::gait_error::GaitError;
use super::key::Key;
use super::loop_directions::{independent, nearest_rates};
use super::loop_error::{LoopError, UnfitRates};
use super::loop_rows::{LoopRow, Loops};
use super::{BoundaryState, Bounds, MotionLimits, Objective, Penalty, Problem};
use crate::constants::task::OFF;
use crate::numerics::cholesky;
use crate::problem::error::ProblemError;
use costate::EvalError;
use costate::constraints::{ConstrainedHamiltonian, ConstraintError, Constraints};
use costate::hamiltonian::Hamiltonian;
use costate::robot::JointKind;
use std::sync::Arc;

impl Problem {
    /// Number of coordinates of the direct method: joints, and rows of constraints.
    pub(crate) fn coordinates(&self) -> usize {
        self.robot.dof() + self.loops.as_ref().map_or(0, |loops| loops.rows.len())
    }

    /// Their names, and how they move.
    pub(crate) fn named_coordinates(&self) -> (/* names */ Vec<String>, /* kinds */ Vec<JointKind>) {
        let joints = self.robot.independent_joints().map(|joint| (joint.name.clone(), joint.kind));
        let rows = self.loops.iter().flat_map(|loops| &loops.rows);
        joints.chain(rows.map(|row| (row.name.clone(), JointKind::Prismatic))).unzip()
    }

    /// The first constraint is named where a robot with constraints is not taken; a gait neither.
    ///
    /// # Errors
    /// [`ProblemError::Constrained`], [`ProblemError::Gait`].
    pub(crate) fn refuse_constraints(&self) -> Result<(), ProblemError> {
        if self.gait.is_some() {
            return Err(ProblemError::Gait { key: Key::GAIT_STANCE, cause: Box::new(GaitError::NotHere) });
        }
        let first = self.robot.constraints().first();
        first.map_or(Ok(()), |one| Err(ProblemError::Constrained { constraint: one.name.clone() }))
    }

    /// The same motion with the multipliers of the constraints as coordinates; of a robot with constraints,
    /// or of a step of a gait.
    ///
    /// # Errors
    /// [`ProblemError::Loop`]: what such motions do not take, ends that do not satisfy the constraints.
    /// [`ProblemError::Gait`] and others of a gait.
    pub(crate) fn with_multipliers(&self) -> Result<Self, ProblemError> {
        if let Some(gait) = &self.gait {
            return self.walking(gait);
        }
        self.refuse_with_loops()?;
        let unknown = |key: Key| move |error: EvalError| cannot(key, error.into());
        let mut rows = Constraints::new(&self.robot);
        let start = &self.start;
        self.misses(&mut rows, &start.q, Some(&start.v), [Key::START_Q, Key::START_V])?;
        self.refuse_singular(&rows)?;
        let kept = self.independent_rows(&mut rows).map_err(unknown(Key::START_Q))?;
        let end = self.closed_end(&mut rows, kept.len())?;
        let zeros = |list: &[f64]| padded(list, kept.len(), 0.0);
        let start = BoundaryState::fixed(&zeros(&start.q), &zeros(&start.v));
        let loops = Loops::new(self.robot.clone(), kept);
        Ok(self.with_coordinates_of(loops, start, end))
    }

    /// With the multipliers of these rows as coordinates, between these states of all coordinates.
    pub(super) fn with_coordinates_of(&self, loops: Loops, start: BoundaryState, end: BoundaryState) -> Self {
        let k = loops.rows.len();
        let zeros = |list: &[f64]| padded(list, k, 0.0);
        let all_of = |list: &Option<Vec<f64>>, value| list.as_ref().map(|list| padded(list, k, value));
        let infinite = f64::INFINITY;
        let (limits, n) = (&self.limits, self.robot.dof());
        let torque_max = limits.torque_max.clone().unwrap_or_else(|| vec![infinite; n]);
        Self {
            robot: self.robot.without_constraints(),
            start,
            end,
            cost: Objective {
                effort: zeros(&self.cost.effort),
                energy: all_of(&self.cost.energy, 0.0),
                ..self.cost.clone()
            },
            gain: padded(&self.gain, k, 1.0),
            bounds: self.bounds.as_ref().map(|Bounds { u_min, u_max }| Bounds {
                u_min: padded(u_min, k, -infinite),
                u_max: padded(u_max, k, infinite),
            }),
            penalty: self.penalty.as_ref().map(|penalty| Penalty {
                weight: penalty.weight,
                q_min: all_of(&penalty.q_min, -infinite),
                q_max: all_of(&penalty.q_max, infinite),
                v_max: all_of(&penalty.v_max, infinite),
            }),
            limits: MotionLimits {
                q_min: all_of(&limits.q_min, -infinite),
                q_max: all_of(&limits.q_max, infinite),
                v_max: all_of(&limits.v_max, infinite),
                a_max: all_of(&limits.a_max, infinite),
                // Nothing drives a multiplier.
                torque_max: Some(padded(&torque_max, k, 0.0)),
                jerk_max: None,
                torque_rate_max: None,
                power_max: all_of(&limits.power_max, infinite),
                corner_speed: all_of(&limits.corner_speed, infinite),
                no_load_speed: all_of(&limits.no_load_speed, infinite),
                total_power_max: limits.total_power_max,
                from_robot: Some(self.keeps_robot_limits()),
            },
            loops: Some(Arc::new(loops)),
            ..self.clone()
        }
    }

    /// What motions with constraints do not take.
    fn refuse_with_loops(&self) -> Result<(), ProblemError> {
        let free = |list: &[usize], key| (!list.is_empty()).then_some(key);
        let terms = (!self.terms.is_empty()).then_some(Key::TERMS);
        let first = self.task.first_key().or_else(|| self.first_of_rates());
        let first = first.or_else(|| self.first_of_phases()).or(terms);
        let first = first.or_else(|| free(&self.start.q_free, Key::START_Q_FREE));
        let first = first.or_else(|| free(&self.start.v_free, Key::START_V_FREE));
        match (first, self.robot.constraints().first()) {
            (Some(key), Some(one)) => {
                let constraint = one.name.clone();
                Err(ProblemError::Loop { cause: LoopError::NotTaken { key, constraint } })
            }
            _ => Ok(()),
        }
    }

    /// The start must be no singular pose: a row that is left out there would be missing on the way.
    fn refuse_singular(&self, rows: &Constraints<f64>) -> Result<(), ProblemError> {
        let mut model = ConstrainedHamiltonian::<f64>::new(&self.robot);
        match model.singular_row(&self.start.q).map_err(|error| cannot(Key::START_Q, error.into()))? {
            None => Ok(()),
            Some(at) => {
                let (constraint, row) = (rows.name(at).to_owned(), rows.component(at));
                Err(ProblemError::Loop { cause: LoopError::Singular { key: Key::START_Q, constraint, row } })
            }
        }
    }

    /// The rows that count at the start, where g and J are known.
    pub(super) fn independent_rows(&self, rows: &mut Constraints<f64>) -> Result<Vec<LoopRow>, EvalError> {
        let (q, n) = (&self.start.q, self.robot.dof());
        let mut closed = ConstrainedHamiltonian::<f64>::new(&self.robot);
        closed.velocity(q, &vec![0.0; n])?;
        let mut open = Hamiltonian::<f64>::new(&self.robot.without_constraints());
        let mut mass = open.linearise_momentum(q, &vec![0.0; n])?.dp_dv.as_slice().to_vec();
        let is_regular = cholesky::factorise(&mut mass, n);
        let row = |(row, _): (usize, &f64)| {
            let jacobian = rows.jacobian().row(row);
            let mut moved = jacobian.to_vec();
            if is_regular {
                cholesky::solve(&mass, n, &mut moved);
            }
            let inverse: f64 = jacobian.iter().zip(&moved).map(|(j, moved)| j * moved).sum();
            LoopRow { row, mass: 1.0 / inverse, name: rows.name(row).to_owned() }
        };
        Ok(closed.counted().iter().enumerate().filter(|(_, counts)| **counts == 1.0).map(row).collect())
    }

    /// The end, of which as many positions and rates stay given as are independent of `k` rows; all loops are
    /// closed there.
    fn closed_end(&self, rows: &mut Constraints<f64>, k: usize) -> Result<BoundaryState, ProblemError> {
        let (end, n) = (&self.end, self.robot.dof());
        let mut q = end.q.clone();
        let given = |free: &[usize]| (0..n).map(|i| !free.contains(&i)).collect::<Vec<bool>>();
        let (q_given, v_given) = (given(&end.q_free), given(&end.v_free));
        if end.q_free.is_empty() {
            self.misses(rows, &q, None, [Key::END_Q, Key::END_V])?;
        } else {
            let mut closed = ConstrainedHamiltonian::<f64>::new(&self.robot);
            match closed.close(&mut q, &q_given) {
                // To the digits that are given; what has to be closed is checked below.
                Err(
                    ConstraintError::CannotClose { miss, .. } | ConstraintError::Contradiction { miss, .. },
                ) if miss <= OFF => {}
                outcome => outcome.map_err(|cause| cannot(Key::END_Q, cause))?,
            }
        }
        let rates = end.v_free.is_empty().then_some(&end.v[..]);
        self.misses(rows, &q, rates, [Key::END_Q, Key::END_V])?;
        self.fits(rows, &v_given)?;
        let free = |given: &[bool]| {
            let kept = independent(rows, given, n.saturating_sub(k));
            (0..n).filter(|i| !kept.contains(i)).chain(n..n + k).collect::<Vec<usize>>()
        };
        let (q_free, v_free) = (free(&q_given), free(&v_given));
        let state = BoundaryState::fixed(&padded(&q, k, 0.0), &padded(&end.v, k, 0.0));
        Ok(state.with_q_free(&q_free).with_v_free(&v_free))
    }

    /// Whether a position satisfies the constraints, and rates keep them.
    fn misses(
        &self,
        rows: &mut Constraints<f64>,
        q: &[f64],
        v: Option<&[f64]>,
        [of_q, of_v]: [Key; 2],
    ) -> Result<(), ProblemError> {
        rows.set_position(q).map_err(|error| cannot(of_q, error.into()))?;
        let largest = |values: &mut dyn Iterator<Item = f64>| {
            let found = values.map(f64::abs).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
            found
                .filter(|(_, miss)| *miss > OFF || miss.is_nan())
                .map(|(row, miss)| (rows.name(row).to_owned(), miss))
        };
        if let Some((constraint, miss)) = largest(&mut (0..rows.count()).map(|row| rows.miss(row))) {
            let closed = Box::new(self.closed_near(q));
            return Err(ProblemError::Loop {
                cause: LoopError::Open { key: of_q, constraint, miss, closed },
            });
        }
        let Some(v) = v else { return Ok(()) };
        let rate = |row: usize| rows.jacobian().row(row).iter().zip(v).map(|(j, v)| j * v).sum::<f64>();
        match largest(&mut (0..rows.count()).map(rate)) {
            Some((constraint, rate)) => {
                Err(ProblemError::Loop { cause: LoopError::Leads { key: of_v, constraint, rate } })
            }
            None => Ok(()),
        }
    }

    /// Whether some rates that keep the loops closed have those that are given at the end, at the position of
    /// the rows.
    fn fits(&self, rows: &Constraints<f64>, given: &[bool]) -> Result<(), ProblemError> {
        let v = &self.end.v;
        let nearest = nearest_rates(rows, v, given);
        let off = |i: &usize| (nearest[*i] - v[*i]).abs();
        let worst = (0..v.len()).filter(|i| given[*i]).max_by(|a, b| off(a).total_cmp(&off(b)));
        let Some(worst) = worst.filter(|i| off(i) > OFF) else { return Ok(()) };
        let joint =
            self.robot.independent_joints().nth(worst).map_or_else(String::new, |one| one.name.clone());
        let unfit = Box::new(UnfitRates { joint, entry: worst, rate: v[worst], nearest });
        Err(ProblemError::Loop { cause: LoopError::Rates { key: Key::END_V, unfit } })
    }

    /// The position near q that satisfies all constraints: with the joints that have motors as they are, or
    /// else with all joints free.
    fn closed_near(&self, q: &[f64]) -> Result<Vec<f64>, ConstraintError> {
        let mut closed = ConstrainedHamiltonian::<f64>::new(&self.robot);
        let mut near = q.to_vec();
        let driven: Vec<bool> = (0..self.robot.dof()).map(|i| !self.has_no_motor(i)).collect();
        if driven.contains(&false) && closed.close(&mut near, &driven).is_ok() {
            return Ok(near);
        }
        near.copy_from_slice(q);
        closed.close(&mut near, &vec![false; driven.len()])?;
        Ok(near)
    }
}

fn padded(list: &[f64], more: usize, value: f64) -> Vec<f64> {
    list.iter().copied().chain(std::iter::repeat_n(value, more)).collect()
}

fn cannot(key: Key, cause: ConstraintError) -> ProblemError {
    ProblemError::Loop { cause: LoopError::CannotClose { key, cause } }
}
