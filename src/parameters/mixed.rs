//! The mixed derivatives of L by (q, v) and the parameters, and their derivatives along a direction.

use super::bodies::UnitBodies;
use super::layout::{Layout, Source};
use super::set::ParameterSet;
use super::wrenches::Wrenches;
use crate::error::EvalError;
use crate::kernels::{KernelOne, KernelTwo};
use crate::matrix::{Matrix, dot, filled};
use crate::robot::scaled;
use crate::scalar::Scalar;

/// `p_theta`, `L_q,theta` and their derivatives along (dq, dv); n x n_theta each.
///
/// Those by inertial parameters come from [`UnitBodies`]. A displacement is the coordinate of a still joint
/// of an extended tree: its columns are columns of P and L_qq of kernel one, and of kernel two, on that tree.
/// `L_q` is linear in gravity, with the column of M of a still joint that moves everything along the field.
#[derive(Clone, Debug)]
pub(super) struct Mixed<S: Scalar> {
    pub layout: Layout,
    pub bodies: UnitBodies<S>,
    /// Kernel one of the extended tree.
    pub one: KernelOne<S>,
    pub two: KernelTwo<S>,
    wrenches: Option<Wrenches<S>>,
    /// Positions, velocities and directions of the extended tree; zero for still joints.
    q: Vec<S>,
    v: Vec<S>,
    dq: Vec<S>,
    dv: Vec<S>,
    pub p: Matrix<S>,
    pub l_q: Matrix<S>,
    pub d_p: Matrix<S>,
    pub d_l_q: Matrix<S>,
}

impl<S: Scalar> Mixed<S> {
    #[inline(never)]
    pub fn new(set: &ParameterSet) -> Self {
        let layout = Layout::new(set);
        let columns = Matrix::zeros(layout.dof(), layout.len);
        let zeros = filled(S::zero(), layout.extended.dof());
        Self {
            bodies: UnitBodies::new(&layout.tree),
            one: KernelOne::new(&layout.extended),
            two: KernelTwo::new(&layout.extended),
            wrenches: Wrenches::new(&layout),
            q: zeros.clone(),
            v: zeros.clone(),
            dq: zeros.clone(),
            dv: zeros,
            p: columns.clone(),
            l_q: columns.clone(),
            d_p: columns.clone(),
            d_l_q: columns,
            layout,
        }
    }

    /// The first stage of kernel one.
    pub fn set_position(&mut self, q: &[S]) -> Result<(), EvalError> {
        spread(&self.layout.kept, q, &mut self.q);
        self.one.set_position(&self.layout.extended, &self.q)
    }

    /// The other stages of kernel one, and the velocities of bodies, at the position set last.
    pub fn set_velocity(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        spread(&self.layout.kept, v, &mut self.v);
        self.one.set_velocity(&self.layout.extended, &self.v)?;
        self.one.second_order(&self.layout.extended);
        self.bodies.set_state(&self.layout.tree, q, v);
        Ok(())
    }

    /// Kernel two, after [`set_velocity`](Self::set_velocity).
    pub fn differentiate(&mut self, dq: &[S], dv: &[S]) -> Result<(), EvalError> {
        let kept = &self.layout.kept;
        spread(kept, dq, &mut self.dq);
        spread(kept, dv, &mut self.dv);
        self.two.differentiate(&self.layout.extended, &self.one, &self.dq, &self.dv)
    }

    /// Entry (i, j) of the coordinates of the robot in a matrix of the extended tree.
    #[inline(always)]
    pub fn entry(&self, matrix: &Matrix<S>, i: usize, j: usize) -> S {
        matrix[(self.layout.kept[i], self.layout.kept[j])]
    }

    /// Columns of p_theta and L_q,theta, after [`set_velocity`](Self::set_velocity).
    #[inline(never)]
    pub fn take_gradients(&mut self, q: &[S], v: &[S]) {
        let Self { layout, bodies, p, l_q, .. } = self;
        if !layout.bodies.is_empty() {
            bodies.carry_axes(&layout.tree);
            bodies.carry_rates(&layout.tree);
            bodies.gradients(&layout.bodies, p, l_q);
        }
        self.take_source_gradients(q, v);
    }

    /// The same for what is not a body.
    pub fn take_source_gradients(&mut self, q: &[S], v: &[S]) {
        let Self { layout, one, p, l_q, .. } = self;
        for &(column, source) in &layout.sources {
            let kept = layout.kept.iter().enumerate();
            match source {
                Source::Still(at) => kept.for_each(|(i, &k)| {
                    p[(i, column)] = one.l_vq()[(k, at)];
                    l_q[(i, column)] = one.l_qq()[(k, at)];
                }),
                Source::Gravity(at) => {
                    kept.for_each(|(i, &k)| l_q[(i, column)] = one.mass_matrix()[(k, at)]);
                }
                Source::Stiffness(i) => {
                    l_q[(layout.rows[i].coordinate, column)] = -layout.along(i, layout.stretch(i, q));
                }
                Source::Rest(i) => {
                    let stiffness = layout.tree.joints()[i].spring.stiffness * layout.rows[i].ratio;
                    l_q[(layout.rows[i].coordinate, column)] = S::from_f64(stiffness);
                }
                Source::Armature(i, j) => layout.add_armature([i, j], v, column, p),
            }
        }
    }

    /// Columns of D p_theta and D L_q,theta along the direction, after
    /// [`take_gradients`](Self::take_gradients) and [`differentiate`](Self::differentiate).
    #[inline(never)]
    pub fn take_changes(&mut self, dq: &[S], dv: &[S]) {
        let Self { layout, bodies, d_p, d_l_q, .. } = self;
        if !layout.bodies.is_empty() {
            bodies.set_direction(&layout.tree, dq, dv);
            bodies.carry_changes(&layout.tree, dq);
            bodies.changes(&layout.bodies, d_p, d_l_q);
        }
        self.take_source_changes(dq, dv);
    }

    /// The same for what is not a body.
    pub fn take_source_changes(&mut self, dq: &[S], dv: &[S]) {
        let Self { layout, two, d_p, d_l_q, .. } = self;
        for &(column, source) in &layout.sources {
            let kept = layout.kept.iter().enumerate();
            match source {
                Source::Still(at) => kept.for_each(|(i, &k)| {
                    d_p[(i, column)] = two.l_vq()[(k, at)];
                    d_l_q[(i, column)] = two.l_qq()[(k, at)];
                }),
                Source::Gravity(at) => {
                    kept.for_each(|(i, &k)| d_l_q[(i, column)] = two.mass_matrix()[(k, at)]);
                }
                Source::Stiffness(i) => {
                    let row = &layout.rows[i];
                    d_l_q[(row.coordinate, column)] = -layout.along(i, row.rate(dq));
                }
                Source::Rest(_) => {}
                Source::Armature(i, j) => layout.add_armature([i, j], dv, column, d_p),
            }
        }
    }

    /// `D L_theta` along (dq, dv), without kernel two, after [`set_velocity`](Self::set_velocity).
    #[inline(never)]
    pub fn values_along(&mut self, [q, v, dq, dv]: [&[S]; 4], d_l: &mut [S]) {
        spread(&self.layout.kept, dq, &mut self.dq);
        spread(&self.layout.kept, dv, &mut self.dv);
        let Self { layout, bodies, one, .. } = self;
        if !layout.bodies.is_empty() {
            bodies.set_direction(&layout.tree, dq, dv);
            bodies.values_along(&layout.bodies, d_l);
        }
        for &(column, source) in &layout.sources {
            let rate = |i: usize, x: &[S]| layout.rows[i].rate(x);
            d_l[column] = match source {
                Source::Still(at) => {
                    let by_velocity = layout
                        .kept
                        .iter()
                        .zip(dv)
                        .fold(S::zero(), |sum, (&k, &dv)| one.l_vq()[(k, at)].mul_add(dv, sum));
                    dot(one.l_qq().row(at), &self.dq) + by_velocity
                }
                Source::Gravity(at) => dot(one.mass_matrix().row(at), &self.dq),
                Source::Stiffness(i) => -(layout.stretch(i, q) * rate(i, dq)),
                Source::Rest(i) => rate(i, dq).times(layout.tree.joints()[i].spring.stiffness),
                Source::Armature(i, j) if i == j => rate(i, v) * rate(i, dv),
                Source::Armature(i, j) => rate(i, v).mul_add(rate(j, dv), rate(j, v) * rate(i, dv)),
            };
        }
    }

    /// Changes wrench `k` from outside.
    pub fn set_wrench(&mut self, k: usize, moment: &[S; 3], force: &[S; 3]) -> Result<(), EvalError> {
        match &mut self.wrenches {
            Some(wrenches) => wrenches.set(k, moment, force),
            None => Err(EvalError::NoWrench { wrench: k, count: 0 }),
        }
    }

    /// Adds `factor Q_theta` of wrenches from outside to the rows from `first` on, after
    /// [`set_position`](Self::set_position).
    pub fn add_force_slopes(&mut self, factor: f64, first: usize, to: &mut Matrix<S>) {
        if let Some(wrenches) = &mut self.wrenches {
            wrenches.add_slopes(&self.q, factor, first, to);
        }
    }

    /// Adds `factor y'Q_theta`, after [`set_position`](Self::set_position).
    pub fn add_force_products(&mut self, factor: f64, y: &[S], to: &mut [S]) {
        if let Some(wrenches) = &mut self.wrenches {
            wrenches.add_products(&self.q, factor, y, to);
        }
    }

    /// Adds `y'Q_q,theta` to the first n rows, after [`set_position`](Self::set_position).
    pub fn add_force_curvature(&mut self, y: &[S], to: &mut Matrix<S>) {
        if let Some(wrenches) = &mut self.wrenches {
            wrenches.add_curvature(&self.q, y, to);
        }
    }

    /// `L_theta`, after [`set_velocity`](Self::set_velocity).
    pub fn values(&mut self, q: &[S], v: &[S], l: &mut [S]) {
        let Self { layout, bodies, one, .. } = self;
        if !layout.bodies.is_empty() {
            bodies.set_heights(&layout.tree);
            bodies.values(&layout.bodies, l);
        }
        for &(column, source) in &layout.sources {
            let stretch = |i: usize| layout.stretch(i, q);
            let rate = |i: usize| layout.rows[i].rate(v);
            l[column] = match source {
                Source::Still(at) => one.l_q()[at],
                // From the fields below.
                Source::Gravity(_) => S::zero(),
                Source::Stiffness(i) => (stretch(i) * stretch(i)).times(-0.5),
                Source::Rest(i) => stretch(i).times(layout.tree.joints()[i].spring.stiffness),
                Source::Armature(i, j) if i == j => (rate(i) * rate(i)).times(0.5),
                Source::Armature(i, j) => rate(i) * rate(j),
            };
        }
        for (column, field) in &layout.fields {
            l[*column] = -one.potential(field);
        }
    }
}

impl Layout {
    /// How far the spring of a joint is from its rest.
    fn stretch<S: Scalar>(&self, joint: usize, q: &[S]) -> S {
        self.rows[joint].position(q).plus(-self.tree.joints()[joint].spring.rest)
    }

    /// A force of a joint as a force of its coordinate.
    fn along<S: Scalar>(&self, joint: usize, force: S) -> S {
        scaled(self.rows[joint].ratio, force)
    }

    /// The momentum of an entry of the armature matrix and of its mirror image, each 1.
    fn add_armature<S: Scalar>(&self, [i, j]: [usize; 2], v: &[S], column: usize, p: &mut Matrix<S>) {
        let [first, second] = [self.rows[i], self.rows[j]].map(|row| (row.coordinate, column));
        p[first] = self.along(i, self.rows[j].rate(v));
        if i != j {
            let mirrored = self.along(j, self.rows[i].rate(v));
            p[second] = if first == second { p[second] + mirrored } else { mirrored };
        }
    }
}

/// Writes the entries of coordinates to their places in the extended tree.
fn spread<S: Scalar>(kept: &[usize], from: &[S], to: &mut [S]) {
    kept.iter().zip(from).for_each(|(&k, &value)| to[k] = value);
}
