//! Compares the library's own derivatives with automatic ones.

use super::bounds::{DerivativeBounds, EntryBounds, RoundingBounds};
use super::function::{DerivativeError, Function, check_length};
use super::lagrangian_routes::LagrangianRoutes;
use super::report::{Figure, StateReport};
use super::{Hessian, Jacobian, NestedHessian, PhaseVelocity};
use crate::error::EvalError;
use crate::hamiltonian::{DualPass, FullHessian, Hamiltonian, SecondOrder};
use crate::matrix::{Block, Matrix, dot};
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;
use crate::tensors::Christoffel;
use nalgebra::{DMatrix, SymmetricEigen};

/// H(q, p) as a function of 2n inputs.
struct TotalEnergy(Robot);

impl Function for TotalEnergy {
    type Workspace<S: Scalar> = Hamiltonian<S>;
    type Error = EvalError;

    fn inputs(&self) -> usize {
        2 * self.0.len()
    }

    fn outputs(&self) -> usize {
        1
    }

    fn workspace<S: Scalar>(&self) -> Hamiltonian<S> {
        Hamiltonian::new(&self.0)
    }

    fn evaluate<S: Scalar>(
        &self,
        energy: &mut Hamiltonian<S>,
        x: &[S],
        h: &mut [S],
    ) -> Result<(), EvalError> {
        let (q, p) = x.split_at(self.0.len());
        h[0] = energy.hamiltonian(q, p)?;
        Ok(())
    }
}

/// Compares all methods for the derivatives of one robot's state equations. The reference are hyper-dual numbers through F
/// and the acceleration a.
///
/// | method | F_x | y'F_xx |
/// |---|---|---|
/// | analytic | hand-derived | 2n+1 rule |
/// | dual pass | | one dual number through the hand-derived F_x |
/// | packed tensor | | contraction of the whole tensor, by hand |
/// | tensors | Christoffel coefficients | one dual number through these |
/// | dual | dual numbers through F | dual numbers in dual numbers through F |
///
/// Also compared: y'F_x and y'F_xx d without a matrix and as products with the matrix, the derivatives of a(q, v, u),
/// symmetries, and the conservation of energy.
///
/// # The bound
///
/// Every entry of a difference is judged by a bound of its own, [`SAFETY`](super::SAFETY) u e, with u = 2^-53. The error e,
/// in units of u, is propagated to first order:
///
/// 1. M, P, L_qq and their derivatives (kernels one and two) are evaluated with numbers that carry the variance of their
///    rounding error: each operation adds an independent error of its own size (Hull and Swenson 1966; Higham and Mary
///    2019). So the error of an entry is in proportion to the terms that cancel in it, not to their sum.
/// 2. Eliminating with `M = L' D L` adds `sqrt(3n + 1) |L'| D |L|` to the error `E_M` of M (Higham, Accuracy and Stability,
///    theorem 10.4, with sqrt(3n + 1) in place of 3n + 1 for independent roundings).
/// 3. With `T = |L^-1| D^-1 |L^-1|'`, which is at least |M^-1|, the error of M^-1 is `T E_M T + sqrt(n) T`.
/// 4. A product A B of k terms has the error `E_A |B| + |A| E_B + sqrt(k) |A| |B|`; v, F_x, y'F_xx, a_z and y'a_zz are
///    such products of the matrices above. Every factor M^-1 adds one factor `T E_M`, the condition of M.
///
/// All steps are entry by entry, so that the bound does not depend on the units of the joints: metres and radians are never
/// compared. [`SAFETY`](super::SAFETY) is no derived number: errors are not normally distributed, and two methods are compared.
pub struct Routes {
    analytic: SecondOrder<f64>,
    dual_pass: DualPass<f64>,
    full: FullHessian<f64>,
    tensors: DualPass<f64, Christoffel>,
    dual: Jacobian<PhaseVelocity>,
    nested: NestedHessian<PhaseVelocity>,
    hyperdual: Hessian<PhaseVelocity>,
    lagrangian: LagrangianRoutes,
    conservative: Hamiltonian<f64>,
    energy: Jacobian<TotalEnergy>,
    contracted: Matrix<f64>,
    bounds: RoundingBounds,
    figures: Vec<Figure>,
}

impl Routes {
    /// Builds every workspace.
    pub fn new(robot: &Robot) -> Self {
        let (conservative, tree) = (robot.without_friction(), Tree::from(robot));
        let n = robot.len();
        let function = || PhaseVelocity::new(robot);
        Self {
            analytic: SecondOrder::from_tree(tree.clone()),
            dual_pass: DualPass::from_tree(tree.clone()),
            full: FullHessian::from_tree(tree.clone()),
            tensors: DualPass::with_route(tree, Christoffel),
            dual: Jacobian::new(function()),
            nested: NestedHessian::new(function()),
            hyperdual: Hessian::new(function()),
            lagrangian: LagrangianRoutes::new(robot),
            conservative: Hamiltonian::new(&conservative),
            energy: Jacobian::new(TotalEnergy(conservative)),
            contracted: Matrix::zeros(2 * n, 2 * n),
            bounds: RoundingBounds::new(robot),
            figures: Vec::new(),
        }
    }

    /// Compares at x = (q, p) with actuation u and costate y (2n), which is also the direction of products.
    ///
    /// # Errors
    /// Those of [`Hamiltonian`].
    pub fn compare(
        &mut self,
        x: &[f64],
        u: &[f64],
        y: &[f64],
    ) -> Result<StateReport, DerivativeError<EvalError>> {
        let n = self.conservative.len();
        check_length("x", x, 2 * n)?;
        check_length("u", u, n)?;
        check_length("y", y, 2 * n)?;
        for function in [self.dual.function_mut(), self.nested.function_mut(), self.hyperdual.function_mut()]
        {
            function.u.copy_from_slice(u);
        }
        self.figures.clear();
        self.hyperdual.contracted(x, y)?;
        let (q, p) = x.split_at(n);
        let v = self.conservative.velocity(q, p)?.to_vec();
        self.lagrangian.evaluate([q, &v, u, &y[n..]])?;
        let bounds = self.bounds.at(x, u, y)?;
        self.compare_first(x, u, y, &bounds)?;
        self.compare_second(x, u, y, &bounds)?;
        self.lagrangian.compare([q, &v, u, &y[n..]], &bounds, &mut self.figures)?;
        let condition = self.compare_conservative(x, &bounds)?;
        Ok(StateReport { condition, figures: self.figures.clone() })
    }

    /// Symmetry of J F_x and drift of energy without friction and actuation; the condition of M.
    fn compare_conservative(
        &mut self,
        x: &[f64],
        bounds: &DerivativeBounds,
    ) -> Result<f64, DerivativeError<EvalError>> {
        let n = self.conservative.len();
        let (q, p) = x.split_at(n);
        let conservative = self.conservative.jacobian(q, p, &vec![0.0; n])?;
        let j_f_x = times_j(&conservative.matrix().to_nalgebra());
        let condition = condition(conservative.mass_matrix().view().to_nalgebra());
        let gradient = self.energy.evaluate(x)?.gradient();
        let drift: f64 = gradient.iter().zip(conservative.f()).map(|(g, f)| g * f).sum();
        let bound =
            EntryBounds { size: times_j(&bounds.f_x.size).abs(), error: times_j(&bounds.f_x.error).abs() };
        let off = |i, j| j_f_x[(i, j)] - j_f_x[(j, i)];
        self.push("asymmetry of J F_x, D = 0", "analytic", off, &bound.asymmetry());
        self.push("energy drift, u = D = 0", "analytic", |_, _| drift, &bounds.drift);
        Ok(condition)
    }

    /// F_x by every method, and y'F_x.
    fn compare_first(
        &mut self,
        x: &[f64],
        u: &[f64],
        y: &[f64],
        bounds: &DerivativeBounds,
    ) -> Result<(), DerivativeError<EvalError>> {
        let Self { analytic, tensors, dual, hyperdual, figures, .. } = self;
        let (q, p) = x.split_at(u.len());
        let expected = hyperdual.last().jacobian();
        let mut judge = |route, f_x: Block<'_, f64>| {
            let off = |i, j| f_x.row(i)[j] - expected[(i, j)];
            figures.push(Figure::judge("F_x", route, off, &bounds.f_x));
        };
        judge("analytic", analytic.first().jacobian(q, p, u)?.matrix());
        judge("tensors", tensors.first().jacobian(q, p, u)?.matrix());
        judge("dual", dual.evaluate(x)?.jacobian.view());
        let product: Vec<f64> =
            (0..x.len()).map(|j| y.iter().enumerate().map(|(k, y)| y * expected[(k, j)]).sum()).collect();
        let found = analytic.first().adjoint(q, p, u, y)?.y_f_x;
        let off = |_, j: usize| found[j] - product[j];
        figures.push(Figure::judge("y'F_x", "analytic", off, &bounds.f_x.row_product(y)));
        Ok(())
    }

    /// y'F_xx by every method, and its product with y.
    fn compare_second(
        &mut self,
        x: &[f64],
        u: &[f64],
        y: &[f64],
        bounds: &DerivativeBounds,
    ) -> Result<(), DerivativeError<EvalError>> {
        let Self { analytic, dual_pass, tensors, full, nested, hyperdual, contracted, figures, .. } = self;
        let (q, p) = x.split_at(u.len());
        let expected = hyperdual.last_contracted();
        let bound = &bounds.y_f_xx;
        let mut judge = |route, y_f_xx: Block<'_, f64>| {
            let off = |i, j| y_f_xx.row(i)[j] - expected[(i, j)];
            figures.push(Figure::judge("y'F_xx", route, off, bound));
        };
        judge("analytic", analytic.contracted_hessian(q, p, u, y)?.matrix());
        judge("dual pass", dual_pass.contracted_hessian(q, p, u, y)?.matrix());
        full.evaluate(q, p)?.contract(y, contracted)?;
        judge("packed tensor", contracted.view());
        judge("tensors", tensors.contracted_hessian(q, p, u, y)?.matrix());
        let nested = nested.contracted(x, y)?;
        judge("dual", nested.view());
        let off = |i, j| nested[(i, j)] - nested[(j, i)];
        figures.push(Figure::judge("asymmetry of y'F_xx", "dual", off, &bound.asymmetry()));
        let product: Vec<f64> = (0..x.len()).map(|i| dot(expected.row(i), y)).collect();
        let found = analytic.hessian_product(q, p, y, y)?;
        let off = |i: usize, _| found[i] - product[i];
        figures.push(Figure::judge("y'F_xx y", "analytic", off, &bound.column_product(y)));
        Ok(())
    }

    fn push(
        &mut self,
        quantity: &'static str,
        route: &'static str,
        off: impl Fn(usize, usize) -> f64,
        bound: &EntryBounds,
    ) {
        self.figures.push(Figure::judge(quantity, route, off, bound));
    }
}

/// `J F_x` with `J = [0 1; -1 0]`.
fn times_j(f_x: &DMatrix<f64>) -> DMatrix<f64> {
    let n = f_x.nrows() / 2;
    DMatrix::from_fn(2 * n, 2 * n, |i, j| if i < n { f_x[(n + i, j)] } else { -f_x[(i - n, j)] })
}

/// Largest over smallest eigenvalue of a symmetric positive definite matrix.
fn condition(mass_matrix: DMatrix<f64>) -> f64 {
    let values = SymmetricEigen::new(mass_matrix).eigenvalues;
    values.max() / values.min()
}
