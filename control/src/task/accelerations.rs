//! Limits on the accelerations of tools.

use super::row::Row;
use costate::EvalError;
use costate::kinematics::{KinematicsSecondOrder, ReferenceFrame};
use costate::robot::Robot;
use costate::spatial::{Force, Vec3};

/// Axes in which the linear part of an acceleration is that of the point.
const AXES: ReferenceFrame = ReferenceFrame::LocalWorldAligned;

/// Rows `|x''|^2 / (2 s)` of z = (q, v, a), x the position of a tool in the world: at the acceleration s it
/// changes as the acceleration does. No call allocates.
#[derive(Clone, Debug)]
pub(crate) struct ToolAccelerations {
    /// `None` without rows.
    kinematics: Option<KinematicsSecondOrder<f64>>,
    /// Frames, and the largest accelerations s (m/s^2).
    tools: Vec<(usize, f64)>,
    rows: Vec<Row>,
}

impl ToolAccelerations {
    /// Of these frames of a robot, with the largest accelerations and what holds for the rows.
    pub(super) fn new(robot: &Robot, rows: Vec<(usize, f64, Row)>) -> Self {
        let kinematics = (!rows.is_empty()).then(|| KinematicsSecondOrder::new(robot));
        let tools = rows.iter().map(|(frame, most, _)| (*frame, *most)).collect();
        Self { kinematics, tools, rows: rows.into_iter().map(|(.., row)| row).collect() }
    }

    /// What holds for each row.
    pub fn bounds(&self) -> &[Row] {
        &self.rows
    }

    /// g at q, v, a; an entry for each row.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub fn values(&mut self, z: &[f64], g: &mut [f64]) -> Result<(), EvalError> {
        let Some(kinematics) = &mut self.kinematics else { return Ok(()) };
        place(kinematics, z)?;
        for (g, &(frame, most)) in g.iter_mut().zip(&self.tools) {
            let a = kinematics.acceleration(frame, AXES)?.linear;
            *g = a.dot(a) / (2.0 * most);
        }
        Ok(())
    }

    /// g and its Jacobian, rows of 3n; `w'g_zz` is added to a Hessian of 3n rows:
    ///
    /// $$ g\_z = \frac{1}{s} A^\top A\_z, \qquad g\_{zz} = \frac{1}{s} (A\_z^\top A\_z + A \cdot A\_{zz}) $$
    ///
    /// # Errors
    /// As [`values`](Self::values).
    pub fn contract(
        &mut self,
        z: &[f64],
        weights: &[f64],
        g: &mut [f64],
        jacobian: &mut [f64],
        hessian: &mut [f64],
    ) -> Result<(), EvalError> {
        self.values(z, g)?;
        let Some(kinematics) = &mut self.kinematics else { return Ok(()) };
        let width = z.len();
        let rows = jacobian.chunks_exact_mut(width).zip(&self.tools).zip(weights);
        for ((row, &(frame, most)), weight) in rows {
            let a = kinematics.acceleration(frame, AXES)?.linear;
            let first = kinematics.acceleration_jacobian(frame, AXES)?;
            let column = |j: usize| Vec3::new(first[(3, j)], first[(4, j)], first[(5, j)]);
            let factor = weight / most;
            for (i, entry) in row.iter_mut().enumerate() {
                let own = column(i);
                *entry = a.dot(own) / most;
                for (j, to) in hessian[width * i..width * (i + 1)].iter_mut().enumerate() {
                    *to += factor * own.dot(column(j));
                }
            }
            let second =
                kinematics.acceleration_hessian(frame, AXES, &Force { moment: Vec3::zero(), force: a })?;
            for (i, to) in hessian.chunks_exact_mut(width).enumerate() {
                to.iter_mut().enumerate().for_each(|(j, to)| *to += factor * second[(i, j)]);
            }
        }
        Ok(())
    }
}

fn place(kinematics: &mut KinematicsSecondOrder<f64>, z: &[f64]) -> Result<(), EvalError> {
    let n = z.len() / 3;
    kinematics.set_motion(&z[..n], &z[n..2 * n], &z[2 * n..])
}
