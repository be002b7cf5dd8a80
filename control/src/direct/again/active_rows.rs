//! Limits that are active along a motion, and what the gains of the optimal feedback make of them.
//!
//! While a limit of the state g(x) <= 0 is active, motions nearby that are optimal keep g = 0 from where they
//! are: the gain acts on deviations dx with N dx = 0, N the gradients of the active rows and of their
//! derivatives in time up to the one that the control moves. The other deviations have no derivative: towards
//! the outside there is no motion, towards the inside the limit is left for a time that grows as a root of
//! the deviation. The gain is zero along the rows of N.

use super::feedback::Feedback;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::motion::shape::{LOBATTO_PLACES, PLACES, POINTS, Shape};
use crate::direct::newton::rests::Rest;
use crate::direct::newton::side_terms::add_row;
use crate::direct::points::values::PointDynamics;
use crate::numerics::chain::dot;
use crate::numerics::lagrange::{slopes, values};
use crate::numerics::lu;

/// A row is one of those before it where no more than this part of it is left: rounding of gradients.
const LEAST_NORMAL: f64 = 1e-9;

impl<D> Interior<D> {
    /// The sides that are active at Gauss's point `j` of interval `k`; where accelerations are continuous at
    /// Lobatto's point there, which is behind the node.
    pub(super) fn active_sides(&self, k: usize, j: usize) -> impl Iterator<Item = &Side> {
        let (mesh, barrier) = (&self.spline.mesh, &self.barrier);
        let inner = usize::from(mesh.shape.is_smooth());
        let at_point = barrier.at_point(mesh.first_point(k) + j + inner);
        let rates = if mesh.shape.is_smooth() { barrier.at_gauss_point(POINTS * k + j) } else { 0..0 };
        at_point.chain(rates).filter(|at| self.is_active(*at)).map(|at| barrier.side(at))
    }

    /// Whether a side limits the state, not the control: what it limits cannot jump.
    fn is_of_state(&self, side: &Side) -> bool {
        !side.limited.jumps(self.spline.mesh.shape)
    }

    /// Whether a limit of the state is active somewhere in an interval.
    pub(super) fn keeps_states(&self, k: usize) -> bool {
        (0..POINTS).any(|j| self.active_sides(k, j).any(|side| self.is_of_state(side)))
    }
}

impl<D: PointDynamics> Interior<D> {
    /// Restricts the gains of an interval to what active limits leave. Those of the next one are known.
    pub(super) fn keep_active_rows(&self, k: usize, rest: &mut Rest, feedback: &mut Feedback) {
        let (n, m) = (self.spline.dof, self.spline.node());
        let exact = self.take_normals(k, feedback);
        let Feedback { node_gains, gains, normals, work, exchanges, rows, .. } = feedback;
        let node_gain = &mut node_gains[n * m * k..][..n * m];
        let (exact, others) = normals.split_at(exact);
        keep_others(node_gain, others, m, rest, work, exchanges);
        for normal in exact.chunks_exact(m).chain(others.chunks_exact(m)) {
            take_off(node_gain, normal);
        }
        self.keep_controls([k, 0], node_gain, rows, exchanges);
        let size = n * m;
        if self.keeps_states(k) {
            let is_end = self.spline.mesh.is_end(k + 1);
            let next = if is_end { k } else { k + 1 };
            for (j, x) in PLACES.into_iter().enumerate() {
                for i in 0..size {
                    let [a, b] = [k, next].map(|node| node_gains[size * node + i]);
                    gains[size * (POINTS * k + j) + i] = (1.0 - x) * a + x * b;
                }
            }
        }
        for j in 0..POINTS {
            let gain = &mut gains[size * (POINTS * k + j)..][..size];
            self.keep_controls([k, j], gain, rows, exchanges);
        }
    }

    /// The gain at Gauss's point `j` of interval `k` that is nearest to this one with the active limits h of
    /// the control kept: with the accelerations that it makes, `A = tau_a^-1 (K - tau_x)`,
    ///
    /// $$ h_a A + h_x = 0, \quad\text{so}\quad R K = R \tau_x - h_x, \qquad R = h_a \tau_a^{-1} $$
    ///
    /// Rows of torques are zero, and where jerks are the controls those of jerks. Of more rows than joints
    /// the first ones count.
    fn keep_controls(
        &self,
        [k, j]: [usize; 2],
        gain: &mut [f64],
        rows: &mut Vec<f64>,
        exchanges: &mut [usize],
    ) {
        let (n, m, p) = (self.spline.dof, self.spline.node(), POINTS * k + j);
        if self.spline.mesh.shape.is_smooth() {
            for side in self.active_sides(k, j).filter(|side| side.limited == Limited::Jerk) {
                gain[m * side.joint..m * (side.joint + 1)].fill(0.0);
            }
            return;
        }
        let is_control = |side: &&Side| !self.is_of_state(side) && !side.is_law();
        let count = self.active_sides(k, j).filter(is_control).take(n).count();
        if count == 0 {
            return;
        }
        // h_z, tau_a, R', R R' and what is missing.
        rows.clear();
        rows.resize(n * (3 * n + n + n + n + m), 0.0);
        let (h_z, rest) = rows.split_at_mut(3 * n * n);
        let (mass, rest) = rest.split_at_mut(n * n);
        let (by_torque, rest) = rest.split_at_mut(n * n);
        let (square, missing) = rest.split_at_mut(n * n);
        let sides = self.active_sides(k, j).filter(is_control).take(n);
        for (row, side) in h_z.chunks_exact_mut(3 * n).zip(sides) {
            add_row(&self.points, p, side, 1.0, row);
        }
        let tau_z = self.points.tau_z(p);
        for i in 0..n {
            mass[n * i..n * (i + 1)].copy_from_slice(&tau_z[3 * n * i + 2 * n..3 * n * (i + 1)]);
            (0..count).for_each(|r| by_torque[count * i + r] = h_z[3 * n * r + 2 * n + i]);
        }
        if !lu::eliminate(mass, n, n, exchanges) {
            return;
        }
        let by_torque = &mut by_torque[..count * n];
        lu::solve(mass, n, exchanges, by_torque, count);
        let (square, missing) = (&mut square[..count * count], &mut missing[..count * m]);
        for r in 0..count {
            for c in 0..count {
                square[count * r + c] =
                    (0..n).map(|i| by_torque[count * i + r] * by_torque[count * i + c]).sum();
            }
            for (l, missing) in missing[m * r..m * (r + 1)].iter_mut().enumerate() {
                let kept = |i: usize| by_torque[count * i + r] * (tau_z[3 * n * i + l] - gain[m * i + l]);
                *missing = (0..n).map(kept).sum::<f64>() - h_z[3 * n * r + l];
            }
        }
        if !lu::eliminate(square, count, count, exchanges) {
            return;
        }
        lu::solve(square, count, exchanges, missing, m);
        for i in 0..n {
            for r in 0..count {
                for l in 0..m {
                    gain[m * i + l] += by_torque[count * i + r] * missing[m * r + l];
                }
            }
        }
    }

    /// The gradients of the active rows at a node, with those of their derivatives in time, orthonormal.
    /// First those of coordinates, which a spline keeps exactly; returns the number of their entries.
    fn take_normals(&self, k: usize, feedback: &mut Feedback) -> usize {
        let (n, m, mesh) = (self.spline.dof, self.spline.node(), &self.spline.mesh);
        let Feedback { normals, gradients, .. } = feedback;
        normals.clear();
        let (count, first) = (mesh.shape.places().len(), mesh.first_point(k));
        let rate = 1.0 / self.spline.length(k);
        let is_coordinate =
            |side: &&Side| matches!(side.limited, Limited::Position | Limited::Rate | Limited::Acceleration);
        let of_state = || self.active_sides(k, 0).filter(|side| self.is_of_state(side));
        let mut exact = 0;
        for side in of_state().filter(is_coordinate).chain(of_state().filter(|side| !is_coordinate(side))) {
            // The gradient at all points of the interval, then its derivative in time as one of x.
            gradients.clear();
            gradients.resize(2 * 3 * n * count, 0.0);
            let (own, next) = gradients.split_at_mut(3 * n * count);
            for (j, own) in own.chunks_exact_mut(3 * n).enumerate() {
                add_row(&self.points, first + j, side, 1.0, own);
            }
            for order in (1..=m / n).rev() {
                let start = normals.len();
                normals.resize(start + m, 0.0);
                let (before, row) = normals.split_at_mut(start);
                for (j, own) in own.chunks_exact(3 * n).enumerate() {
                    let factor = at_node(mesh.shape, j);
                    row.iter_mut().zip(own).for_each(|(to, from)| *to += factor * from);
                }
                let size = dot(row, row).sqrt();
                // Twice, so that rounding does not matter.
                for earlier in before.chunks_exact(m).chain(before.chunks_exact(m)) {
                    let part = dot(earlier, row);
                    row.iter_mut().zip(earlier).for_each(|(to, from)| *to -= part * from);
                }
                let left = dot(row, row).sqrt();
                // The control moves the rate of what depends on the highest derivative in the state.
                let is_last = own.chunks_exact(3 * n).any(|own| own[m - n..m].iter().any(|x| *x != 0.0));
                if left > LEAST_NORMAL * size {
                    row.iter_mut().for_each(|entry| *entry /= left);
                } else {
                    normals.truncate(start);
                }
                if is_last || order == 1 {
                    break;
                }
                next.fill(0.0);
                for (j, next) in next.chunks_exact_mut(3 * n).enumerate() {
                    for (l, own) in own.chunks_exact(3 * n).enumerate() {
                        let slope = rate * slope_at(mesh.shape, l, j);
                        next.iter_mut().zip(own).for_each(|(to, from)| *to += slope * from);
                    }
                    let own = &own[3 * n * j..3 * n * (j + 1)];
                    next[n..].iter_mut().zip(own).for_each(|(to, from)| *to += from);
                }
                own.copy_from_slice(next);
            }
            if is_coordinate(&side) {
                exact = normals.len();
            }
        }
        exact
    }
}

/// The factor of the value at point `j` in that at the left end of an interval.
fn at_node(shape: Shape, j: usize) -> f64 {
    match shape {
        Shape::Quartic => values(&PLACES, 0.0)[j],
        Shape::Quintic => values(&LOBATTO_PLACES, 0.0)[j],
    }
}

/// The factor of the value at point `l` in the slope at point `j`.
fn slope_at(shape: Shape, l: usize, j: usize) -> f64 {
    match shape {
        Shape::Quartic => slopes(&PLACES, PLACES[j])[l],
        Shape::Quintic => slopes(&LOBATTO_PLACES, LOBATTO_PLACES[j])[l],
    }
}

/// K on the tangent space of the orthonormal rows N of tasks, before it is made zero along them,
///
/// $$ K (1 - N^\top (N S N^\top)^{-1} N S) $$
///
/// S are the second derivatives of the least cost of the rest by the state. The points of a mesh keep a row
/// in directions that are those of N up to the error of the mesh; across them K and S are as stiff as the
/// limit is, and this factor takes the part of a tangent that is across, where S is least.
fn keep_others(
    gain: &mut [f64],
    normals: &[f64],
    m: usize,
    rest: &Rest,
    work: &mut Vec<f64>,
    exchanges: &mut [usize],
) {
    let count = normals.len() / m;
    if count == 0 {
        return;
    }
    let normal = |i: usize| &normals[m * i..m * (i + 1)];
    // N S N' and N S.
    if work.len() < count * (count + m) {
        work.resize(count * (count + m), 0.0);
    }
    let (left, right) = work[..count * (count + m)].split_at_mut(count * count);
    for (i, row) in right.chunks_exact_mut(m).enumerate() {
        for (j, to) in row.iter_mut().enumerate() {
            *to = (0..m).map(|l| normal(i)[l] * rest.cost_hessian(m, l, j)).sum();
        }
        (0..count).for_each(|j| left[count * i + j] = dot(normal(j), row));
    }
    if !lu::eliminate(left, count, count, exchanges) {
        return;
    }
    lu::solve(left, count, exchanges, right, m);
    let products = &mut left[..count];
    for gain in gain.chunks_exact_mut(m) {
        // Products first: all of them are with the gain as it was.
        products.iter_mut().enumerate().for_each(|(i, product)| *product = dot(normal(i), gain));
        for (product, row) in products.iter().zip(right.chunks_exact(m)) {
            gain.iter_mut().zip(row).for_each(|(to, from)| *to -= product * from);
        }
    }
}

/// Makes a gain zero along a row of unit length.
fn take_off(gain: &mut [f64], normal: &[f64]) {
    for gain in gain.chunks_exact_mut(normal.len()) {
        let part = dot(normal, gain);
        gain.iter_mut().zip(normal).for_each(|(to, from)| *to -= part * from);
    }
}
