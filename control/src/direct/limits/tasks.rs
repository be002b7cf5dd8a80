//! Rows of tasks along a motion and at the ends of its phases.

use super::gait_rows::GaitRows;
use super::quartic::bound_of_quartic;
use super::side::{Limited, Side};
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::Points;
use crate::problem::loop_rows::Loops;
use crate::problem::{Shape, TaskError, ToolOrientation};
use crate::task::accelerations::ToolAccelerations;
use crate::task::build::TaskRows;
use crate::task::collision::move_obstacle;
use crate::task::functions::{PathFunction, Swept, TaskFunctions};
use crate::task::orient::orient;
use crate::task::row::Row;
use costate::EvalError;

/// The functions of a task, and room for one point.
#[derive(Clone, Debug)]
pub(crate) struct Tasks {
    pub(super) along: TaskFunctions,
    pub(super) accelerations: ToolAccelerations,
    /// The first of their rows among the rows h of points.
    pub(super) first: usize,
    /// At each end of a phase.
    pub(super) ends: Vec<TaskFunctions>,
    /// Of a gait: after the rows of the start, and after those along the motion.
    pub(super) gait: Option<Box<GaitRows>>,
    /// 2n x 2n.
    pub(super) hessian: Vec<f64>,
    /// q and v at an end.
    pub(super) state: Vec<f64>,
    /// Those at the end of a step of a gait.
    pub(super) last: Vec<f64>,
    /// Largest |q| and |dq/dx| on an interval.
    pub(super) bounds: [Vec<f64>; 2],
    /// dq/dx of each joint at five places of an interval.
    pub(super) quartics: Vec<[f64; 5]>,
    /// q, v, a.
    pub(super) z: Vec<f64>,
}

impl Tasks {
    /// Those of a robot with n joints whose points have so many rows h of powers.
    pub fn new(rows: &TaskRows, n: usize, powers: usize) -> Self {
        Self {
            gait: None,
            last: Vec::new(),
            along: rows.along.clone(),
            accelerations: rows.accelerations.clone(),
            first: powers,
            ends: rows.at_ends().cloned().collect(),
            hessian: vec![0.0; 4 * n * n],
            state: vec![0.0; 2 * n],
            bounds: [vec![0.0; n], vec![0.0; n]],
            quartics: vec![[0.0; 5]; n],
            z: vec![0.0; 3 * n],
        }
    }

    /// With those of a gait.
    pub fn with_gait(self, loops: Option<&Loops>) -> Self {
        let gait = loops.and_then(|loops| Some(Box::new(GaitRows::new(loops, loops.walk.as_ref()?))));
        Self { last: vec![0.0; self.state.len()], gait, ..self }
    }

    /// What holds for the rows of a gait along the motion, and at its ends.
    fn of_gait(&self) -> [&[Row]; 2] {
        match &self.gait {
            Some(gait) => [gait.along(), gait.bounds()],
            None => [&[], &[]],
        }
    }

    /// What holds for forces on soles, after the accelerations of tools.
    fn forces(&self) -> &[Row] {
        self.gait.as_ref().map_or(&[], |gait| gait.forces())
    }

    /// Number of rows at the start that depend on the end too.
    pub fn rows_of_both_ends(&self) -> usize {
        self.of_gait()[1].len()
    }

    /// Numbers of rows along the motion: g(q, v); h, those of powers and of accelerations of tools.
    pub fn rows(&self) -> [usize; 2] {
        let of_tools = self.first + self.accelerations.bounds().len();
        [self.along.rows() + self.of_gait()[0].len(), of_tools + self.forces().len()]
    }

    /// Number of rows at all ends of phases.
    pub fn end_rows(&self) -> usize {
        self.ends.iter().map(PathFunction::rows).sum::<usize>() + self.rows_of_both_ends()
    }

    /// What holds along the motion.
    pub fn sides(&self) -> impl Iterator<Item = Side> {
        let of = |limited, first: usize| {
            move |(index, row): (usize, &Row)| Side::of_row(limited, first + index, row).collect::<Vec<_>>()
        };
        let rows = self.along.bounds().iter().chain(self.of_gait()[0]);
        let rows = rows.enumerate().flat_map(of(Limited::Task, 0));
        let accelerations = self.accelerations.bounds().iter().chain(self.forces()).enumerate();
        rows.chain(accelerations.flat_map(of(Limited::ToolAcceleration, self.first)))
    }

    /// What holds at each end of a phase.
    pub fn end_sides(&self) -> Vec<Vec<Side>> {
        let sides = |functions: &TaskFunctions| {
            functions
                .bounds()
                .iter()
                .enumerate()
                .flat_map(|(index, row)| Side::of_row(Limited::Task, index, row))
                .collect()
        };
        let mut all: Vec<Vec<Side>> = self.ends.iter().map(sides).collect();
        let (first, bounds) = (self.ends[0].rows(), self.of_gait()[1].iter().enumerate());
        all[0].extend(bounds.flat_map(|(index, row)| Side::of_row(Limited::Task, first + index, row)));
        all
    }

    /// Gives an equation at an end of a phase another right-hand side.
    pub fn set_end_value(&mut self, end: usize, row: usize, value: f64) {
        self.ends[end].set_value(row, value);
    }

    /// Gives a tool at an end of a phase another orientation, whose first row this is.
    ///
    /// # Errors
    /// The cause: no orientation, or one of the other kind.
    pub fn orient_end(&mut self, end: usize, row: usize, to: &ToolOrientation) -> Result<(), TaskError> {
        orient(&mut self.ends[end], row, to)
    }

    /// Moves an obstacle.
    ///
    /// # Errors
    /// The cause: numbers out of range, another shape or size.
    pub fn move_obstacle(&mut self, obstacle: usize, to: &Shape) -> Result<(), TaskError> {
        move_obstacle(&mut self.along, obstacle, to)
    }

    /// The rows along the motion at all points.
    ///
    /// # Errors
    /// Positions or rates that are not finite.
    pub fn evaluate(&mut self, points: &mut Points) -> Result<(), EvalError> {
        let n = points.dof;
        if !self.accelerations.bounds().is_empty() {
            for (z, h) in points.z.chunks_exact(3 * n).zip(points.h.chunks_exact_mut(points.powers)) {
                self.accelerations.values(z, &mut h[self.first..])?;
            }
        }
        if let Some(gait) = &mut self.gait {
            let (rows, first) = (points.rows, self.along.rows());
            for (z, g) in points.z.chunks_exact(3 * n).zip(points.g.chunks_exact_mut(rows)) {
                gait.heights(z, &mut g[first..])?;
            }
            if let Some(soles) = gait.soles() {
                let first = self.first + self.accelerations.bounds().len();
                for (z, h) in points.z.chunks_exact(3 * n).zip(points.h.chunks_exact_mut(points.powers)) {
                    soles.load(&z[2 * n + soles.joints()..], &mut h[first..]);
                }
            }
        }
        if self.along.is_empty() {
            return Ok(());
        }
        let rows = points.rows;
        for phase in 0..points.phases() {
            self.along.enter(Some(phase));
            for p in points.phase(phase) {
                let (z, g) = (&points.z[3 * n * p..][..3 * n], &mut points.g[rows * p..][..rows]);
                self.along.values(&z[..n], &z[n..2 * n], g)?;
            }
        }
        Ok(())
    }

    /// The rows at the ends.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn evaluate_ends(&mut self, spline: &Spline, points: &mut Points) -> Result<(), EvalError> {
        let (n, mut first) = (spline.dof, 0);
        for (end, functions) in self.ends.iter_mut().enumerate() {
            if functions.is_empty() {
                continue;
            }
            let g = &mut points.ends.g[first..first + functions.rows()];
            spline.end(end, &mut self.state);
            functions.values(&self.state[..n], &self.state[n..], g)?;
            first += functions.rows();
        }
        if let Some(gait) = &mut self.gait {
            spline.end(0, &mut self.state);
            spline.end(spline.mesh.phases(), &mut self.last);
            let rows = gait.bounds().len();
            gait.values([&self.state, &self.last], &mut points.ends.g[..rows])?;
        }
        Ok(())
    }

    /// The largest violation of a clearance on interval `k`; no two bodies pass through each other unseen.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn sweep(&mut self, spline: &Spline, k: usize) -> Result<Swept, EvalError> {
        if self.along.is_empty() {
            return Ok(Swept::default());
        }
        let n = spline.dof;
        // dq/dx is a quartic, or a cubic.
        let length = spline.length(k);
        for j in 0..5 {
            spline.in_interval(k, j as f64 / 4.0, &mut self.z);
            self.quartics.iter_mut().zip(&self.z[n..]).for_each(|(quartic, v)| quartic[j] = length * v);
        }
        let [positions, rates] = &mut self.bounds;
        for (i, values) in self.quartics.iter().enumerate() {
            let most = bound_of_quartic(values);
            // z is that of the end of the interval.
            (rates[i], positions[i]) = (most, self.z[i].abs() + most);
        }
        let z = &mut self.z;
        self.along.enter(Some(spline.mesh.phase(k)));
        self.along.sweep([positions, rates], &mut self.state[..n], |x, q| {
            spline.in_interval(k, x, z);
            q.copy_from_slice(&z[..n]);
        })
    }

    /// How far tools are off at an end of a phase in a state (q, v), in m and rad; the largest.
    pub fn miss(&mut self, end: usize, state: &[f64]) -> f64 {
        let (q, v) = state.split_at(state.len() / 2);
        let end = &mut self.ends[end];
        let mut g = vec![0.0; end.rows()];
        if end.values(q, v, &mut g).is_err() {
            return f64::INFINITY;
        }
        end.bounds().iter().zip(g).fold(0.0, |most, (row, g)| most.max(row.excess(g)))
    }

    /// What holds on a side, along the motion (`None`) or at an end.
    pub fn row(&self, end: Option<usize>, side: &Side) -> &Row {
        if side.limited == Limited::ToolAcceleration {
            let (at, tools) = (side.joint - self.first, self.accelerations.bounds());
            return tools.get(at).unwrap_or_else(|| &self.forces()[at - tools.len()]);
        }
        let functions = end.map_or(&self.along, |end| &self.ends[end]);
        let of_gait = self.of_gait()[usize::from(end.is_some())];
        functions.bounds().get(side.joint).unwrap_or_else(|| &of_gait[side.joint - functions.rows()])
    }
}
