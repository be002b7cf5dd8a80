//! The linear-quadratic problem of one Newton step, solved by a Riccati recursion from the end to the start.
//!
//! Minimise `sum_k 1/2 d_k'H_k d_k + g_k'd_k` over node steps d_k = (dx_k, du_k), subject to
//! `dx_(k+1) = J_k d_k + c_k`, dx_0 = 0 and, if the end is given, dx_N = 0. At each node the recursion
//! factorises the Hessian in du_k of the cost to go. It is positive definite at every node if and only if the
//! whole Hessian is positive definite on the solutions of the linear dynamics: the inertia condition of
//! Newton's method.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// A given end adds `weight/2 |dx_N|^2`, which is zero at the solution, so that only curvature with the end
/// fixed counts.
#[derive(Clone, Copy, Debug)]
pub enum End {
    Free,
    Given { weight: f64 },
}

/// The matrices of the recursion, factorised once for any number of right-hand sides.
pub struct Factor {
    nodes: Vec<NodeFactor>,
    /// Hessian of the cost to go at the last node.
    last: DMatrix<f64>,
    /// The sensitivity of the end to its costate; factorised.
    reach: Option<Cholesky<f64, Dyn>>,
}

struct NodeFactor {
    /// Hessian of the cost to go in dx_k.
    to_go: DMatrix<f64>,
    /// Hessian in du_k, factorised.
    control: Cholesky<f64, Dyn>,
    /// du_k = gain dx_k + ...
    gain: DMatrix<f64>,
}

/// A step of every node and the costate of every defect.
pub struct Step {
    pub nodes: Vec<DVector<f64>>,
    pub costates: Vec<DVector<f64>>,
}

/// The Hessian has no positive curvature in the controls of this node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotConvex {
    pub node: usize,
}

/// Runs the recursion over the matrices.
pub fn factorise(hessian: &[DMatrix<f64>], jacobian: &[DMatrix<f64>], end: End) -> Result<Factor, NotConvex> {
    let (intervals, n) = (jacobian.len(), jacobian[0].nrows());
    let m = jacobian[0].ncols() - n;
    let last = match end {
        End::Free => hessian[intervals].clone(),
        End::Given { weight } => DMatrix::identity(n, n) * weight,
    };
    // How dx_N follows from dx_(k+1), transposed.
    let mut to_end = DMatrix::identity(n, n);
    let mut reach = DMatrix::zeros(n, n);
    let mut to_go = last.clone();
    let mut nodes = Vec::with_capacity(intervals);
    for k in (0..intervals).rev() {
        let q = &hessian[k] + jacobian[k].tr_mul(&(&to_go * &jacobian[k]));
        let cross = q.view((n, 0), (m, n)).into_owned();
        let Some(control) = Cholesky::new(q.view((n, n), (m, m)).into_owned()) else {
            return Err(NotConvex { node: k });
        };
        let gain = -control.solve(&cross);
        to_go = q.view((0, 0), (n, n)) + cross.tr_mul(&gain);
        to_go.fill_upper_triangle_with_lower_triangle();
        let closed = jacobian[k].columns(0, n) + jacobian[k].columns(n, m) * &gain;
        let pushed = jacobian[k].columns(n, m).tr_mul(&to_end);
        reach += pushed.tr_mul(&control.solve(&pushed));
        to_end = closed.tr_mul(&to_end);
        nodes.push(NodeFactor { to_go: to_go.clone(), control, gain });
    }
    nodes.reverse();
    let reach = match end {
        End::Free => None,
        // Not positive definite: the end is not controllable.
        End::Given { .. } => Some(Cholesky::new(reach).ok_or(NotConvex { node: intervals })?),
    };
    Ok(Factor { nodes, last, reach })
}

impl Factor {
    /// The solution for gradients g and offsets c.
    pub fn solve(
        &self,
        jacobian: &[DMatrix<f64>],
        gradient: &[DVector<f64>],
        offset: &[DVector<f64>],
    ) -> Step {
        let n = self.last.nrows();
        let free = DVector::zeros(n);
        let Some(reach) = &self.reach else {
            return self.solve_with_end_costate(jacobian, gradient, offset, &gradient[offset.len()]);
        };
        let missed = self.solve_with_end_costate(jacobian, gradient, offset, &free);
        let costate = reach.solve(&missed.nodes[offset.len()]);
        let mut step = self.solve_with_end_costate(jacobian, gradient, offset, &costate);
        step.nodes[offset.len()].fill(0.0);
        step
    }

    fn solve_with_end_costate(
        &self,
        jacobian: &[DMatrix<f64>],
        gradient: &[DVector<f64>],
        offset: &[DVector<f64>],
        end: &DVector<f64>,
    ) -> Step {
        let (intervals, n) = (offset.len(), self.last.nrows());
        let m = jacobian[0].ncols() - n;
        // Backwards: the gradient of the cost to go.
        let mut slope = end.clone();
        let mut slopes = vec![slope.clone()];
        let mut feedforward = Vec::with_capacity(intervals);
        for k in (0..intervals).rev() {
            let after = self.after(k);
            let both = &gradient[k] + jacobian[k].tr_mul(&(&slope + after * &offset[k]));
            let controls = both.rows(n, m).into_owned();
            slope = both.rows(0, n) + self.nodes[k].gain.tr_mul(&controls);
            feedforward.push(-self.nodes[k].control.solve(&controls));
            slopes.push(slope.clone());
        }
        slopes.reverse();
        feedforward.reverse();
        // Forwards: the steps, and the costates that hold them to the dynamics.
        let mut x = DVector::zeros(n);
        let mut step =
            Step { nodes: Vec::with_capacity(intervals + 1), costates: Vec::with_capacity(intervals) };
        for k in 0..intervals {
            let u = &self.nodes[k].gain * &x + &feedforward[k];
            let mut node = DVector::zeros(n + m);
            node.rows_mut(0, n).copy_from(&x);
            node.rows_mut(n, m).copy_from(&u);
            x = &jacobian[k] * &node + &offset[k];
            step.costates.push(self.after(k) * &x + &slopes[k + 1]);
            step.nodes.push(node);
        }
        step.nodes.push(x);
        step
    }

    /// Hessian of the cost to go after node k.
    fn after(&self, k: usize) -> &DMatrix<f64> {
        self.nodes.get(k + 1).map_or(&self.last, |node| &node.to_go)
    }

    /// `solve` with iterative refinement: with the barrier, the entries of H differ by many orders of
    /// magnitude.
    pub fn solve_refined(
        &self,
        hessian: &[DMatrix<f64>],
        jacobian: &[DMatrix<f64>],
        gradient: &[DVector<f64>],
        offset: &[DVector<f64>],
        rounds: usize,
    ) -> Step {
        let (intervals, n) = (offset.len(), self.last.nrows());
        let mut step = self.solve(jacobian, gradient, offset);
        for _ in 0..rounds {
            let mut slopes: Vec<_> =
                (0..=intervals).map(|k| &gradient[k] + &hessian[k] * &step.nodes[k]).collect();
            let mut defects = Vec::with_capacity(intervals);
            for k in 0..intervals {
                slopes[k].gemv_tr(1.0, &jacobian[k], &step.costates[k], 1.0);
                let mut next = slopes[k + 1].rows_mut(0, n);
                next -= &step.costates[k];
                defects.push(&offset[k] + &jacobian[k] * &step.nodes[k] - step.nodes[k + 1].rows(0, n));
            }
            let change = self.solve(jacobian, &slopes, &defects);
            step.nodes.iter_mut().zip(&change.nodes).for_each(|(node, change)| *node += change);
            step.costates.iter_mut().zip(&change.costates).for_each(|(costate, change)| *costate += change);
        }
        step
    }
}

#[cfg(test)]
mod tests {
    use super::{End, NotConvex, factorise};
    use nalgebra::{DMatrix, DVector};

    const INTERVALS: usize = 4;
    const STATES: usize = 2;
    const CONTROLS: usize = 2;
    const NODE: usize = STATES + CONTROLS;

    /// A symmetric Hessian with curvature `controls` in du and any sign in dx, and Jacobians without
    /// structure.
    fn random(seed: u64, controls: f64) -> (Vec<DMatrix<f64>>, Vec<DMatrix<f64>>) {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut entries = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| random.f64() - 0.5);
        let mut hessian = Vec::new();
        for k in 0..=INTERVALS {
            let size = if k == INTERVALS { STATES } else { NODE };
            let block = entries(size, size);
            let mut block = &block + block.transpose();
            (STATES..size).for_each(|i| block[(i, i)] += controls);
            hessian.push(block);
        }
        (hessian, (0..INTERVALS).map(|_| entries(STATES, NODE)).collect())
    }

    /// The linear constraints as one matrix: dx_0 = 0, the dynamics, and dx_N = 0 if the end is given.
    fn constraints(jacobian: &[DMatrix<f64>], given: bool) -> DMatrix<f64> {
        let variables = INTERVALS * NODE + STATES;
        let rows = STATES * (INTERVALS + 1 + usize::from(given));
        let mut all = DMatrix::zeros(rows, variables);
        for (k, jacobian) in jacobian.iter().enumerate() {
            all.view_mut((k * STATES, k * NODE), (STATES, NODE)).copy_from(jacobian);
            let mut next = all.view_mut((k * STATES, (k + 1) * NODE), (STATES, STATES));
            next -= DMatrix::identity(STATES, STATES);
        }
        let ends = [0, INTERVALS * NODE];
        for (i, left) in ends.into_iter().take(1 + usize::from(given)).enumerate() {
            all.view_mut(((INTERVALS + i) * STATES, left), (STATES, STATES)).fill_with_identity();
        }
        all
    }

    fn dense(hessian: &[DMatrix<f64>]) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(INTERVALS * NODE + STATES, INTERVALS * NODE + STATES);
        for (k, block) in hessian.iter().enumerate() {
            all.view_mut((k * NODE, k * NODE), block.shape()).copy_from(block);
        }
        all
    }

    /// The smallest eigenvalue of the Hessian on the solutions of the homogeneous constraints.
    fn least_curvature(hessian: &DMatrix<f64>, constraints: &DMatrix<f64>) -> f64 {
        let gram = (constraints.tr_mul(constraints)).symmetric_eigen();
        let null: Vec<_> = (0..gram.eigenvalues.len())
            .filter(|&i| gram.eigenvalues[i].abs() < 1e-10)
            .map(|i| gram.eigenvectors.column(i).into_owned())
            .collect();
        let null = DMatrix::from_columns(&null);
        null.tr_mul(&(hessian * &null)).symmetric_eigen().eigenvalues.min()
    }

    #[test]
    fn steps_and_costates_are_those_of_the_dense_system() {
        for (seed, given) in (0..20).zip([false, true].into_iter().cycle()) {
            let (hessian, jacobian) = random(seed, 4.0);
            let mut random = fastrand::Rng::with_seed(seed);
            let mut vector = |length| DVector::from_fn(length, |_, _| random.f64() - 0.5);
            let gradient: Vec<_> = hessian.iter().map(|block| vector(block.nrows())).collect();
            let offset: Vec<_> = jacobian.iter().map(|_| vector(STATES)).collect();
            let end = if given { End::Given { weight: 100.0 } } else { End::Free };
            let step = factorise(&hessian, &jacobian, end)
                .unwrap()
                .solve_refined(&hessian, &jacobian, &gradient, &offset, 2);

            let (h, c) = (dense(&hessian), constraints(&jacobian, given));
            let (n, m) = (h.nrows(), c.nrows());
            let mut system = DMatrix::zeros(n + m, n + m);
            system.view_mut((0, 0), (n, n)).copy_from(&h);
            system.view_mut((n, 0), (m, n)).copy_from(&c);
            system.view_mut((0, n), (n, m)).copy_from(&c.transpose());
            let mut right = DVector::zeros(n + m);
            for (k, g) in gradient.iter().enumerate() {
                right.rows_mut(k * NODE, g.len()).copy_from(&-g);
            }
            for (k, c) in offset.iter().enumerate() {
                right.rows_mut(n + k * STATES, STATES).copy_from(&-c);
            }
            let expected = system.lu().solve(&right).unwrap();
            for (k, node) in step.nodes.iter().enumerate() {
                assert!((node - expected.rows(k * NODE, node.len())).amax() < 1e-10, "seed {seed}, node {k}");
            }
            for (k, costate) in step.costates.iter().enumerate() {
                assert!((costate - expected.rows(n + k * STATES, STATES)).amax() < 1e-9, "seed {seed}, {k}");
            }
        }
    }

    #[test]
    fn what_is_not_convex_is_found_and_nothing_else() {
        let mut found = [0, 0];
        for (seed, given) in (0..200).zip([false, true].into_iter().cycle()) {
            let (hessian, jacobian) = random(seed, 1.2);
            let end = if given { End::Given { weight: 1e6 } } else { End::Free };
            let least = least_curvature(&dense(&hessian), &constraints(&jacobian, given));
            if least.abs() > 1e-3 {
                let convex = !matches!(factorise(&hessian, &jacobian, end), Err(NotConvex { .. }));
                assert_eq!(convex, least > 0.0, "seed {seed}: {least}");
                found[usize::from(convex)] += 1;
            }
        }
        assert!(found[0] > 20 && found[1] > 20, "{found:?}");
    }
}
