//! Equations with the parameter s as one more unknown.

use crate::bvp::collocation::Collocation;
use crate::bvp::mesh::Mesh;
use crate::bvp::scales::Scales;
use crate::bvp::timed::Timed;
use crate::bvp::values::Values;
use crate::bvp::{Discretised, Failure, Solvable};
use crate::constants::branch::DIFFERENCE;
use crate::extremal::Extremal;

/// Collocation equations `r(x, s) = 0` whose problem depends on s, and one more condition
///
/// $$ c^T (x - x_0) + c_s (s - s_0) = 0 $$
///
/// With `a = -A^-1 r` and `b = dx/ds = -A^-1 r_s` a correction is `a + b ds`, where
///
/// $$ ds = - \frac{c^T a + \rho}{c_s + c^T b} $$
///
/// with the residual rho of the condition. With c along the branch this is regular at a turning point, where
/// A is not. r_s is a central difference.
pub(crate) struct Bordered<F> {
    pub inner: Collocation,
    /// Makes the problem that of a position.
    set: F,
    pub border: Border,
    /// The residual of the condition.
    residual: f64,
    beside: [Values; 2],
}

/// The further row and column.
pub(crate) struct Border {
    /// c, for values as they are.
    slope: Values,
    /// Where the condition holds.
    at: Values,
    /// b, scaled.
    along: Values,
}

impl<F> Bordered<F> {
    /// With s fixed where it is.
    pub fn new(inner: Collocation, position: f64, set: F) -> Self {
        let mut inner = inner;
        inner.current.position = position;
        let zeros = inner.zeros();
        let slope = Values { position: 1.0, ..zeros.clone() };
        let border = Border { slope, at: inner.current.clone(), along: zeros.clone() };
        Self { inner, set, border, residual: 0.0, beside: [zeros.clone(), zeros] }
    }

    /// Moves along the branch to a position, and fixes it there; returns the length. After a linearisation.
    pub fn aim_at(&mut self, position: f64) -> f64 {
        let length = position - self.inner.current.position;
        let from = self.inner.current.clone();
        self.inner.current.set_sum(&from, length, &self.inner.scale, &self.border.along);
        self.inner.current.position = position;
        self.border.at = self.inner.current.clone();
        length.abs() * self.border.along.norm()
    }

    /// Moves by `step` along the unit tangent, whose part in s has the sign of `direction`; the solution is
    /// then looked for in the plane across it. After a linearisation.
    pub fn step(&mut self, step: f64, direction: f64) {
        let Border { slope, along, at } = &mut self.border;
        let scale = &self.inner.scale;
        let count = (along.nodes.len() + along.inner.len()) as f64;
        let length = direction.signum() * along.norm();
        at.set_sum(&self.inner.current, step / length, scale, along);
        let pairs = [(&mut slope.nodes, &along.nodes), (&mut slope.inner, &along.inner)];
        for (slope, along) in pairs {
            for (i, (slope, along)) in slope.iter_mut().zip(along).enumerate() {
                *slope = along / (length * count * scale[i % scale.len()]);
            }
        }
        slope.position = along.position / length;
        self.inner.current.clone_from(at);
    }

    /// Distance of the current values from the last prediction, measured as the length of the branch.
    pub fn deviation(&self) -> f64 {
        let (now, then, scale) = (&self.inner.current, &self.border.at, &self.inner.scale);
        let pairs = [(&now.nodes, &then.nodes), (&now.inner, &then.inner)];
        let sum = |(now, then): (&Vec<f64>, &Vec<f64>)| -> f64 {
            let pairs = now.iter().zip(then).enumerate();
            pairs.map(|(i, (now, then))| ((now - then) / scale[i % scale.len()]).powi(2)).sum()
        };
        let mean = pairs.into_iter().map(sum).sum::<f64>() / (now.nodes.len() + now.inner.len()) as f64;
        (mean + (now.position - then.position).powi(2)).sqrt()
    }

    /// ds/d(length of the branch), positive where the condition and s rise together.
    pub fn slope(&self) -> f64 {
        let Border { slope, along, .. } = &self.border;
        (slope.position + self.border.product(&self.inner.scale, along)).signum() / along.norm()
    }

    fn set_residual(&mut self, values: &Values) {
        let Border { slope, at, .. } = &self.border;
        let parts = [(&slope.nodes, &values.nodes, &at.nodes), (&slope.inner, &values.inner, &at.inner)];
        let sum = |(slope, values, at): (&Vec<f64>, &Vec<f64>, &Vec<f64>)| -> f64 {
            slope.iter().zip(values).zip(at).map(|((slope, value), at)| slope * (value - at)).sum()
        };
        let of_position = slope.position * (values.position - at.position);
        self.residual = of_position + parts.into_iter().map(sum).sum::<f64>();
    }
}

impl Border {
    /// `c'x` of scaled x, without the position.
    fn product(&self, scale: &[f64], x: &Values) -> f64 {
        let pairs = [(&self.slope.nodes, &x.nodes), (&self.slope.inner, &x.inner)];
        let sum = |(slope, x): (&Vec<f64>, &Vec<f64>)| -> f64 {
            let products = slope.iter().zip(x).enumerate();
            products.map(|(i, (slope, x))| slope * x * scale[i % scale.len()]).sum()
        };
        pairs.into_iter().map(sum).sum()
    }

    /// From a scaled correction at fixed s to one that meets the condition, whose residual is given.
    pub fn bend(&self, scale: &[f64], target: &mut Values, residual: f64) {
        let slope = self.slope.position + self.product(scale, &self.along);
        let ds = -(residual + self.product(scale, target)) / slope;
        let pairs = [(&mut target.nodes, &self.along.nodes), (&mut target.inner, &self.along.inner)];
        for (target, along) in pairs {
            target.iter_mut().zip(along).for_each(|(target, along)| *target += ds * along);
        }
        target.position = ds;
    }
}

impl<F> Discretised for Bordered<F> {
    fn zeros(&self) -> Values {
        self.inner.zeros()
    }

    fn current(&self) -> &Values {
        &self.inner.current
    }

    fn current_mut(&mut self) -> &mut Values {
        &mut self.inner.current
    }

    fn scale(&self) -> &[f64] {
        &self.inner.scale
    }

    fn mesh(&self) -> &Mesh {
        &self.inner.mesh
    }

    fn correction(&mut self, target: &mut Values) {
        self.inner.correction(target);
        self.border.bend(&self.inner.scale, target, self.residual);
    }
}

impl<E: Extremal + ?Sized, F: FnMut(&mut Timed<'_, E>, f64) -> Result<(), Failure>> Solvable<E>
    for Bordered<F>
{
    fn costs(&self, timed: &Timed<'_, E>) -> (f64, f64) {
        self.inner.costs(timed)
    }

    fn set_scales(&mut self, timed: &Timed<'_, E>, with: Option<&Values>) -> Scales {
        self.inner.set_scales(timed, with)
    }

    fn set_coupling(&mut self, timed: &mut Timed<'_, E>) {
        self.inner.set_coupling(timed);
    }

    fn evaluate(&mut self, timed: &mut Timed<'_, E>, values: &Values) -> Result<(), Failure> {
        (self.set)(timed, values.position)?;
        self.set_residual(values);
        self.inner.evaluate(timed, values)
    }

    fn linearise(&mut self, timed: &mut Timed<'_, E>) -> Result<(), Failure> {
        let values = self.inner.current.clone();
        let s = values.position;
        (self.set)(timed, s)?;
        self.inner.linearise(timed)?;
        let mut used = [s; 2];
        for (i, beside) in [s - DIFFERENCE, s + DIFFERENCE].into_iter().enumerate() {
            // Beyond the ends of the continuation the problem may not exist.
            if (self.set)(timed, beside).is_ok() && self.inner.evaluate(timed, &values).is_ok() {
                used[i] = beside;
            } else {
                (self.set)(timed, s)?;
                self.inner.evaluate(timed, &values)?;
            }
            self.inner.correction(&mut self.beside[i]);
        }
        let [before, after] = &self.beside;
        let rate = (used[1] - used[0]).recip();
        let parts = [
            (&mut self.border.along.nodes, &before.nodes, &after.nodes),
            (&mut self.border.along.inner, &before.inner, &after.inner),
        ];
        for (along, before, after) in parts {
            let ends = before.iter().zip(after);
            along.iter_mut().zip(ends).for_each(|(along, (before, after))| *along = rate * (after - before));
        }
        self.border.along.position = 1.0;
        self.evaluate(timed, &values)
    }
}
