//! Jacobians and weighted second derivatives of the rows of tasks.

use super::gait_soles::Derivatives;
use super::tasks::Tasks;
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::Points;
use crate::task::functions::{PathFunction, TaskFunctions};
use costate::EvalError;

impl Tasks {
    /// All rows with their Jacobians; their weighted second derivatives are added to the Hessian at the
    /// points.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn contract(&mut self, spline: &Spline, points: &mut Points) -> Result<(), EvalError> {
        self.contract_along(points)?;
        self.contract_gait(spline, points)?;
        let (n, mut first) = (spline.dof, 0);
        for (end, functions) in self.ends.iter_mut().enumerate() {
            if functions.is_empty() {
                continue;
            }
            let rows = first..first + functions.rows();
            first = rows.end;
            spline.end(end, &mut self.state);
            let all = &mut points.ends;
            all.hessian[end].fill(0.0);
            functions.contract(
                &self.state[..n],
                &self.state[n..],
                &all.weights[rows.clone()],
                &mut all.g[rows.clone()],
                &mut all.g_x[2 * n * rows.start..2 * n * rows.end],
                &mut all.hessian[end],
            )?;
        }
        Ok(())
    }

    /// The rows along the motion alone.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn contract_along(&mut self, points: &mut Points) -> Result<(), EvalError> {
        self.contract_points(points)?;
        self.contract_accelerations(points)?;
        let Some(gait) = &mut self.gait else { return Ok(()) };
        gait.contract_heights(points, self.along.rows())?;
        if let Some(soles) = gait.soles() {
            let (width, rows) = (3 * points.dof, points.powers);
            let first = self.first + self.accelerations.bounds().len();
            for p in 0..points.count() {
                let (h, h_z) = (&mut points.h[rows * p..][first..rows], &mut points.h_z[width * rows * p..]);
                soles.contract_loads(
                    &points.z[width * p..][..width],
                    h,
                    &mut h_z[width * first..width * rows],
                );
            }
        }
        Ok(())
    }

    /// The rows of a gait at its ends. Nothing else is asked of these, so they are the first ones there.
    fn contract_gait(&mut self, spline: &Spline, points: &mut Points) -> Result<(), EvalError> {
        let Some(gait) = &mut self.gait else { return Ok(()) };
        let last = spline.mesh.phases();
        spline.end(0, &mut self.state);
        spline.end(last, &mut self.last);
        let all = &mut points.ends;
        let (at_start, others) = all.hessian.split_at_mut(1);
        let (at_start, at_end) = (&mut at_start[0], &mut others[last - 1]);
        for entries in [&mut all.g_x, &mut all.far, &mut *at_start, &mut *at_end] {
            entries.fill(0.0);
        }
        let derivatives = Derivatives { near: &mut all.g_x, far: &mut all.far, at_start, at_end };
        gait.contract([&self.state, &self.last], &all.weights, &mut all.g, derivatives)
    }

    fn contract_points(&mut self, points: &mut Points) -> Result<(), EvalError> {
        if self.along.is_empty() {
            return Ok(());
        }
        let (n, rows) = (points.dof, points.rows);
        let mut phase = 0;
        for p in 0..points.count() {
            while p >= points.phase(phase).end {
                phase += 1;
            }
            self.along.enter(Some(phase));
            let z = &points.z[3 * n * p..][..3 * n];
            self.hessian.fill(0.0);
            self.along.contract(
                &z[..n],
                &z[n..2 * n],
                &points.g_weights[rows * p..][..rows],
                &mut points.g[rows * p..][..rows],
                &mut points.g_x[2 * n * rows * p..][..2 * n * rows],
                &mut self.hessian,
            )?;
            let hessian = &mut points.hessian[9 * n * n * p..][..9 * n * n];
            for (to, from) in hessian.chunks_exact_mut(3 * n).zip(self.hessian.chunks_exact(2 * n)) {
                to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
            }
        }
        Ok(())
    }

    fn contract_accelerations(&mut self, points: &mut Points) -> Result<(), EvalError> {
        if self.accelerations.bounds().is_empty() {
            return Ok(());
        }
        let (width, rows, first) = (3 * points.dof, points.powers, self.first);
        for p in 0..points.count() {
            self.accelerations.contract(
                &points.z[width * p..][..width],
                &points.h_weights[rows * p..][first..rows],
                &mut points.h[rows * p..][first..rows],
                &mut points.h_z[width * rows * p..][width * first..width * rows],
                &mut points.hessian[width * width * p..][..width * width],
            )?;
        }
        Ok(())
    }

    /// The gradients by (q, v) of the rows along the motion and of those at an end, in a state; one after the
    /// other.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn gradients(&mut self, end: usize, state: &[f64]) -> Result<[Vec<f64>; 2], EvalError> {
        let (q, v) = state.split_at(state.len() / 2);
        let hessian = &mut self.hessian;
        self.along.enter(None);
        let mut of = |functions: &mut TaskFunctions| -> Result<Vec<f64>, EvalError> {
            let rows = functions.rows();
            let (mut g, mut g_x) = (vec![0.0; rows], vec![0.0; state.len() * rows]);
            if rows > 0 {
                functions.contract(q, v, &vec![0.0; rows], &mut g, &mut g_x, hessian)?;
            }
            Ok(g_x)
        };
        Ok([of(&mut self.along)?, of(&mut self.ends[end])?])
    }
}
