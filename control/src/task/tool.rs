//! Functions of the pose and of the velocity of a tool.

use super::placed::{Carried, Hessian, Placed};
use crate::constants::task::{OPPOSITE, VERTICAL};
use costate::EvalError;
use costate::kinematics::ReferenceFrame;
use costate::spatial::{Force, Vec3};
use nalgebra::{Matrix3, Rotation3, Vector3};

/// What of a tool is a function.
#[derive(Clone, Debug)]
pub(super) enum Quantity {
    /// `n_k . x`, one row for each direction n_k of the world.
    Position(Vec<Vector3<f64>>),
    /// `|P (x - p)|^2 / (2 r)` with a projector P: at the distance r it changes as the distance does.
    Distance { from: Vector3<f64>, projector: Matrix3<f64>, radius: f64 },
    /// `e = log(R_d'R)`, 3 rows (rad).
    Orientation(Rotation3<f64>),
    /// Two components of the rotation vector that turns the axis a of the tool into the direction d:
    /// `(angle / sin angle) t_k . a` with t_1, t_2 normal to d. Both derivatives exist up to a half turn.
    Direction { axis: Vector3<f64>, along: Vector3<f64>, across: [Vector3<f64>; 2] },
    /// `atan2(n . a, d . a)` with x of the tool, a = R e_x, the horizontal direction d of a yaw and n = e_z x
    /// d (rad).
    Yaw { along: Vector3<f64>, across: Vector3<f64> },
    /// `(m - sum d_k . a_k) / s` for axes a_k of the tool and directions d_k of the world.
    Aligned { pairs: Vec<[Vector3<f64>; 2]>, most: f64, scale: f64 },
    /// `|x'|^2 / (2 s)`: at the speed s it changes as the speed does.
    Speed(f64),
}

/// A function of a tool.
#[derive(Clone, Debug)]
pub(super) struct ToolFunction {
    pub tool: Carried,
    pub quantity: Quantity,
}

impl Quantity {
    /// The direction of an axis of the tool.
    pub fn direction(axis: Vector3<f64>, along: Vector3<f64>) -> Self {
        Self::Direction { axis, along, across: Self::across(along) }
    }

    /// The yaw of x of the tool, less this one (rad).
    pub fn yaw(yaw: f64) -> Self {
        let (sin, cos) = yaw.sin_cos();
        Self::Yaw { along: Vector3::new(cos, sin, 0.0), across: Vector3::new(-sin, cos, 0.0) }
    }

    /// Two directions that are normal to one and to each other.
    pub fn across(along: Vector3<f64>) -> [Vector3<f64>; 2] {
        let first = along.cross(&Vector3::ith(along.iamin(), 1.0)).normalize();
        [first, along.cross(&first)]
    }

    /// `(1 - cos angle) / sin limit` of the angle between an axis and a direction, for a limit on the angle.
    pub fn leaning(axis: Vector3<f64>, along: Vector3<f64>, limit: f64) -> Self {
        Self::Aligned { pairs: vec![[axis, along]], most: 1.0, scale: limit.sin() }
    }

    /// The same for the angle of the rotation from a desired orientation.
    pub fn turned(desired: &Rotation3<f64>, limit: f64) -> Self {
        let pair = |k: usize| [Vector3::ith(k, 1.0), desired.matrix().column(k).into_owned()];
        Self::Aligned { pairs: [0, 1, 2].map(pair).to_vec(), most: 3.0, scale: 2.0 * limit.sin() }
    }

    fn rows(&self) -> usize {
        match self {
            Self::Position(directions) => directions.len(),
            Self::Orientation(_) => 3,
            Self::Direction { .. } => 2,
            Self::Yaw { .. } | Self::Distance { .. } | Self::Aligned { .. } | Self::Speed(_) => 1,
        }
    }
}

impl ToolFunction {
    pub fn rows(&self) -> usize {
        self.quantity.rows()
    }

    /// Whether it depends on v.
    pub fn moves(&self) -> bool {
        matches!(self.quantity, Quantity::Speed(_))
    }

    pub fn values(&self, placed: &Placed, g: &mut [f64]) -> Result<(), EvalError> {
        let (rotation, x) = placed.frame(self.tool.frame)?;
        match &self.quantity {
            Quantity::Position(directions) => {
                g.iter_mut().zip(directions).for_each(|(g, direction)| *g = direction.dot(&x));
            }
            Quantity::Distance { from, projector, radius } => {
                g[0] = (projector * (x - from)).norm_squared() / (2.0 * radius);
            }
            Quantity::Orientation(desired) => {
                let error = placed.kinematics.orientation_error(self.tool.frame, desired)?;
                g.copy_from_slice(&error.vector);
            }
            Quantity::Direction { axis, along, across } => {
                let a = rotation * axis;
                let [f, ..] = over_sine(&a, along, across);
                g.iter_mut().zip(across).for_each(|(g, across)| *g = f * across.dot(&a));
            }
            Quantity::Yaw { along, across } => {
                let a = rotation * Vector3::x();
                g[0] = across.dot(&a).atan2(along.dot(&a));
            }
            Quantity::Aligned { pairs, most, scale } => {
                let sum: f64 = pairs.iter().map(|[axis, along]| (rotation * axis).dot(along)).sum();
                g[0] = (most - sum) / scale;
            }
            Quantity::Speed(unit) => {
                let twist = placed.kinematics.twist(self.tool.frame, ReferenceFrame::LocalWorldAligned)?;
                g[0] = twist.linear.dot(twist.linear) / (2.0 * unit);
            }
        }
        Ok(())
    }

    /// Writes g and its Jacobian, rows of 2n that are zero before, and adds `w'g_xx`.
    pub fn contract(
        &self,
        placed: &mut Placed,
        w: &[f64],
        g: &mut [f64],
        jacobian: &mut [f64],
        hessian: &mut Hessian<'_>,
    ) -> Result<(), EvalError> {
        self.values(placed, g)?;
        let (path, width) = (&self.tool.path[..], hessian.width);
        let (rotation, x) = placed.frame(self.tool.frame)?;
        match &self.quantity {
            Quantity::Position(directions) => {
                placed.see_point(path, &x);
                let mut f = Vector3::zeros();
                for ((direction, &w), row) in directions.iter().zip(w).zip(jacobian.chunks_exact_mut(width)) {
                    placed.add_gradient(path, direction, row);
                    f += direction * w;
                }
                placed.add_second(path, &f, None, hessian);
            }
            Quantity::Distance { from, projector, radius } => {
                placed.see_point(path, &x);
                let f = projector * (x - from) / *radius;
                placed.add_gradient(path, &f, jacobian);
                placed.add_second(path, &(f * w[0]), Some(&(projector * (w[0] / radius))), hessian);
            }
            Quantity::Orientation(desired) => {
                self.contract_orientation(placed, desired, w, jacobian, hessian)?
            }
            Quantity::Direction { axis, along, across } => {
                let a = rotation * axis;
                placed.see_direction(path, &a);
                let [f, slope, bend] = over_sine(&a, along, across);
                let mut t = Vector3::zeros();
                for ((across, &w), row) in across.iter().zip(w).zip(jacobian.chunks_exact_mut(width)) {
                    placed.add_gradient(path, &(along * (slope * across.dot(&a)) + across * f), row);
                    t += across * w;
                }
                let mixed = along * t.transpose() * slope;
                let second = along * along.transpose() * (bend * t.dot(&a)) + mixed + mixed.transpose();
                placed.add_second(path, &(along * (slope * t.dot(&a)) + t * f), Some(&second), hessian);
            }
            Quantity::Yaw { along, across } => {
                // With s = n . a, c = d . a and r^2 = s^2 + c^2: slopes c / r^2 and -s / r^2.
                let a = rotation * Vector3::x();
                placed.see_direction(path, &a);
                let (s, c) = (across.dot(&a), along.dot(&a));
                let square = (s * s + c * c).max(VERTICAL);
                let f = (across * c - along * s) / square;
                placed.add_gradient(path, &f, jacobian);
                let mixed = across * along.transpose() * ((s * s - c * c) / (square * square));
                let own = along * along.transpose() - across * across.transpose();
                let second = own * (2.0 * s * c / (square * square)) + mixed + mixed.transpose();
                placed.add_second(path, &(f * w[0]), Some(&(second * w[0])), hessian);
            }
            Quantity::Aligned { pairs, scale, .. } => {
                for [axis, along] in pairs {
                    placed.see_direction(path, &(rotation * axis));
                    let f = along / -*scale;
                    placed.add_gradient(path, &f, jacobian);
                    placed.add_second(path, &(f * w[0]), None, hessian);
                }
            }
            Quantity::Speed(unit) => self.contract_speed(placed, w[0] / unit, *unit, jacobian, hessian)?,
        }
        Ok(())
    }

    fn contract_orientation(
        &self,
        placed: &mut Placed,
        desired: &Rotation3<f64>,
        w: &[f64],
        jacobian: &mut [f64],
        hessian: &mut Hessian<'_>,
    ) -> Result<(), EvalError> {
        let (n, w) = (placed.dof(), [w[0], w[1], w[2]]);
        let all = placed.kinematics.contract_orientation_error(self.tool.frame, desired, &w)?;
        for (i, row) in jacobian.chunks_exact_mut(2 * n).enumerate() {
            for (j, entry) in row[..n].iter_mut().enumerate() {
                *entry = all.jacobian[(i, j)];
            }
        }
        for i in 0..n {
            (0..n).for_each(|j| hessian.add(i, j, all.hessian[(i, j)]));
        }
        Ok(())
    }

    /// With the velocity V of the tool, 3 rows: `V'V_x / s` and, with the weight, `V_x'V_x + V.V_xx`.
    fn contract_speed(
        &self,
        placed: &mut Placed,
        weight: f64,
        unit: f64,
        jacobian: &mut [f64],
        hessian: &mut Hessian<'_>,
    ) -> Result<(), EvalError> {
        const AXES: ReferenceFrame = ReferenceFrame::LocalWorldAligned;
        let (n, frame) = (placed.dof(), self.tool.frame);
        let kinematics = &mut placed.kinematics;
        let velocity = kinematics.twist(frame, AXES)?.linear;
        for (first, of_rates) in [(0, false), (n, true)] {
            // The rows by q or by v, one after the other: each is borrowed from the workspace.
            let rows = if of_rates {
                kinematics.jacobian(frame, AXES)?
            } else {
                kinematics.twist_jacobian(frame, AXES)?
            };
            for j in 0..n {
                let column = Vec3::new(rows[(3, j)], rows[(4, j)], rows[(5, j)]);
                jacobian[first + j] = velocity.dot(column) / unit;
                placed.rates[first + j] = column.to_array().into();
            }
        }
        for i in 0..2 * n {
            (0..2 * n).for_each(|j| hessian.add(i, j, weight * placed.rates[i].dot(&placed.rates[j])));
        }
        let force = Force { moment: Vec3::zero(), force: velocity };
        let bend = placed.kinematics.twist_hessian(frame, AXES, &force)?;
        for i in 0..2 * n {
            (0..2 * n).for_each(|j| hessian.add(i, j, weight * bend[(i, j)]));
        }
        Ok(())
    }
}

/// `f = angle / sin angle` as a function of `c = cos angle`, with df/dc and its derivative; the square of the
/// sine is given too, since it is not known from c near a half turn.
///
/// f obeys `(1 - c^2) f' = c f - 1`, so its Taylor coefficients at c = 1 are `a_k = -k/(2 k + 1) a_(k-1)`.
fn angle_over_sine(c: f64, sine_square: f64) -> [f64; 3] {
    // Terms of the series; (0.1 / 2)^TERMS is below rounding.
    const TERMS: usize = 14;
    let x = c - 1.0;
    if x > -0.1 {
        let mut coefficients = [1.0; TERMS];
        for k in 1..TERMS {
            coefficients[k] = coefficients[k - 1] * -(k as f64) / (2 * k + 1) as f64;
        }
        let horner = |[f, slope, bend]: [f64; 3], a: &f64| [f * x + a, slope * x + f, bend * x + slope];
        let [f, slope, half_bend] = coefficients.iter().rev().fold([0.0; 3], horner);
        return [f, slope, 2.0 * half_bend];
    }
    let square = sine_square.max(OPPOSITE);
    let f = square.sqrt().atan2(c) / square.sqrt();
    let slope = (c * f - 1.0) / square;
    [f, slope, (3.0 * c * slope + f) / square]
}

/// The angle of an axis over its sine, from the components across and along the direction.
fn over_sine(a: &Vector3<f64>, along: &Vector3<f64>, across: &[Vector3<f64>; 2]) -> [f64; 3] {
    let sine_square = across.iter().map(|across| across.dot(a).powi(2)).sum();
    angle_over_sine(a.dot(along), sine_square)
}

#[cfg(test)]
#[path = "tool_tests.rs"]
mod tests;
