//! The hand-derived methods over any number type, compared with given reference values.

// `#[inline]` in this file: compiled where it is used, with all instances of the pipeline that it needs, not
// by everyone who builds the library.

use super::reference::ComparedDerivative::{AZ, FX, TauZ, WTauZZ, YAZZ, YFXX};
use super::reference::Reference;
use super::row::{COSTATE, Row, matrix};
use super::state::State;
use super::weighted_frames::WeightedFrames;
use crate::configuration::FreeKinematics;
use crate::error::EvalError;
use crate::hamiltonian::{DualPass, FullHessian, Hamiltonian, HamiltonianSecondOrder};
use crate::kinematics::Kinematics;
use crate::lagrangian::LagrangianSecondOrder;
use crate::matrix::{Block, Matrix, dot, filled};
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;
use crate::tensors::Christoffel;

/// Workspaces of the methods that are compared with the reference.
#[derive(Clone, Debug)]
pub(super) struct Methods<S: Scalar> {
    analytic: HamiltonianSecondOrder<S>,
    dual_pass: DualPass<S>,
    full: FullHessian<S>,
    tensors: DualPass<S, Christoffel>,
    lagrangian: LagrangianSecondOrder<S>,
    /// Without friction and wrenches.
    pub conservative: Hamiltonian<S>,
    packed: Matrix<S>,
    frames: WeightedFrames,
    kinematics: Kinematics<S>,
    free_kinematics: FreeKinematics<S>,
    /// Whether no joint is floating or spherical: methods that take none run then.
    is_plain: bool,
}

impl<S: Scalar> Methods<S> {
    #[inline]
    pub fn new(robot: &Robot) -> Self {
        let (n, tree) = (robot.dof(), Tree::from(robot));
        Self {
            analytic: HamiltonianSecondOrder::from_tree(tree.clone()),
            dual_pass: DualPass::from_tree(tree.clone()),
            full: FullHessian::from_tree(tree.clone()),
            lagrangian: LagrangianSecondOrder::as_numbers::<f64>(tree.clone()),
            tensors: DualPass::with_route(tree, Christoffel),
            conservative: Hamiltonian::new(&robot.without_friction().without_wrenches()),
            packed: Matrix::zeros(2 * n, 2 * n),
            frames: WeightedFrames::new(robot),
            kinematics: Kinematics::new(robot),
            free_kinematics: FreeKinematics::new(robot),
            is_plain: robot.free_joints().is_empty(),
        }
    }

    /// All comparisons at one state, in the order of the report.
    #[inline]
    pub fn rows(&mut self, state: &State<S>, reference: &Reference<S>) -> Result<Vec<Row<S>>, EvalError> {
        let mut rows = Vec::new();
        self.first(state, reference, &mut rows)?;
        self.second(state, reference, &mut rows)?;
        self.forward_dynamics(state, reference, &mut rows)?;
        self.inverse_dynamics(state, reference, &mut rows)?;
        self.conserved(state, reference, &mut rows)?;
        let workspaces = (&mut self.kinematics, &mut self.free_kinematics);
        self.frames.rows(workspaces, [&state.q, &state.v], &reference.frames, &mut rows)?;
        Ok(rows)
    }

    /// F_x by every method, and y'F_x.
    #[inline]
    fn first(
        &mut self,
        state: &State<S>,
        to: &Reference<S>,
        rows: &mut Vec<Row<S>>,
    ) -> Result<(), EvalError> {
        let State { q, p, u, y, .. } = state;
        let mut add = |route, f_x: Block<'_, S>| rows.push(to.row(FX, route, f_x));
        add("analytic", self.analytic.first().linearise(q, p, u)?.matrix());
        if self.is_plain {
            add("tensors", self.tensors.first().linearise(q, p, u)?.matrix());
        }
        add("dual", to.dual_f_x.view());
        let found = self.analytic.first().adjoint(q, p, u, y)?.y_f_x;
        let product = |j| y.iter().enumerate().fold(S::zero(), |sum, (k, &y)| sum + y * to.f_x[(k, j)]);
        let (found, expected) = (matrix(1, y.len(), |_, j| found[j]), matrix(1, y.len(), |_, j| product(j)));
        rows.push(Row::new(["y'F_x", "analytic"], found.view(), expected.view(), [&[0], COSTATE]));
        Ok(())
    }

    /// y'F_xx by every method, and its product with y.
    #[inline]
    fn second(
        &mut self,
        state: &State<S>,
        to: &Reference<S>,
        rows: &mut Vec<Row<S>>,
    ) -> Result<(), EvalError> {
        let State { q, p, u, y, .. } = state;
        let mut add = |route, y_f_xx: Block<'_, S>| rows.push(to.row(YFXX, route, y_f_xx));
        add("analytic", self.analytic.contract(q, p, u, y)?.matrix());
        if self.is_plain {
            add("dual pass", self.dual_pass.contract(q, p, u, y)?.matrix());
            self.full.hessian_tensor(q, p)?.contract(y, &mut self.packed)?;
            add("packed tensor", self.packed.view());
            add("tensors", self.tensors.contract(q, p, u, y)?.matrix());
        }
        add("dual", to.nested_y_f_xx.view());
        rows.push(Row::asymmetry(["asymmetry of y'F_xx", "dual"], &to.nested_y_f_xx, COSTATE));
        let found = self.analytic.hessian_product(q, p, y, y)?;
        let product = matrix(1, y.len(), |_, i| dot(to.y_f_xx.row(i), y));
        let found = matrix(1, y.len(), |_, j| found[j]);
        rows.push(Row::new(["y'F_xx y", "analytic"], found.view(), product.view(), [&[0], COSTATE]));
        Ok(())
    }

    /// a_z and y'a_zz, z = (q, v, u), for the second half of y.
    #[inline]
    fn forward_dynamics(
        &mut self,
        state: &State<S>,
        to: &Reference<S>,
        rows: &mut Vec<Row<S>>,
    ) -> Result<(), EvalError> {
        let State { q, v, u, y, .. } = state;
        let second = self.lagrangian.contract_forward_dynamics(q, v, u, &y[v.len()..])?;
        rows.push(to.row(AZ, "analytic", second.forward_dynamics().matrix()));
        rows.push(to.row(AZ, "dual", to.dual_a_z.view()));
        rows.push(to.row(YAZZ, "analytic", second.to_matrix().view()));
        rows.push(to.row(YAZZ, "dual", to.nested_y_a_zz.view()));
        Ok(())
    }

    /// (w.tau)_z and (w.tau)_zz, z = (q, v, a), at accelerations with the numbers of u, for the second half
    /// of y.
    #[inline]
    fn inverse_dynamics(
        &mut self,
        state: &State<S>,
        to: &Reference<S>,
        rows: &mut Vec<Row<S>>,
    ) -> Result<(), EvalError> {
        let State { q, v, u: a, y, .. } = state;
        let (n, w) = (v.len(), &y[v.len()..]);
        let second = self.lagrangian.contract_inverse_dynamics(q, v, a, w)?;
        let linear = second.inverse_dynamics();
        let parts = [linear.tau_q, linear.tau_v, linear.tau_a];
        let found = matrix(n, 3 * n, |i, j| parts[j / n][(i, j % n)]);
        rows.push(to.row(TauZ, "analytic", found.view()));
        rows.push(to.row(WTauZZ, "analytic", second.zz().view()));
        Ok(())
    }

    /// Without friction, wrenches and actuation: symmetry of J F_x, and dH/dt = 0.
    #[inline]
    fn conserved(
        &mut self,
        state: &State<S>,
        to: &Reference<S>,
        rows: &mut Vec<Row<S>>,
    ) -> Result<(), EvalError> {
        let State { q, p, .. } = state;
        let n = p.len();
        let first = self.conservative.linearise(q, p, &filled(S::zero(), n))?;
        let f_x = first.matrix();
        let j_f_x = matrix(2 * n, 2 * n, |i, j| if i < n { f_x.row(n + i)[j] } else { -f_x.row(i - n)[j] });
        let products: Vec<S> = to.energy_gradient.iter().zip(first.f()).map(|(&g, &f)| g * f).collect();
        // The bracket of twists and momenta in a moved frame is another one.
        if self.is_plain {
            rows.push(Row::asymmetry(["asymmetry of J F_x, D = 0", "analytic"], &j_f_x, COSTATE));
        }
        let sum = |terms: &dyn Fn(S) -> S| {
            matrix(1, 1, |_, _| products.iter().fold(S::zero(), |sum, &product| sum + terms(product)))
        };
        rows.push(Row {
            name: ["energy drift, u = D = 0", "analytic"],
            difference: sum(&|product| product),
            size: sum(&Scalar::abs),
            scales: [&[0], &[0]],
        });
        Ok(())
    }
}
