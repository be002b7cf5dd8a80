//! The library's own derivatives beside automatic ones: every route against hyper-dual numbers.

// `#[inline]` in this file: compiled where it is used, with all instances of the pipeline that it needs, not by
// everyone who builds the library.

use super::called::ByCalls;
use super::function::{DerivativeError, Function, check_length};
use super::lagrangian_routes::LagrangianRoutes;
use super::report::{
    Figure, StateReport, asymmetry, in_relation, largest, relative_difference, vector_difference, worse,
};
use super::{Hessian, Jacobian, NestedHessian, PhaseVelocity};
use crate::error::EvalError;
use crate::hamiltonian::{DualPass, FullHessian, Hamiltonian, HamiltonianSecondOrder};
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
        2 * self.0.dof()
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
        let (q, p) = x.split_at(self.0.dof());
        h[0] = energy.hamiltonian(q, p)?;
        Ok(())
    }
}

/// Every route to the derivatives of one robot's state equations, set beside hyper-dual numbers through F and a.
///
/// | route | F_x | y'F_xx |
/// |---|---|---|
/// | analytic | hand-derived | 2n+1 rule |
/// | dual pass | | one dual number through the hand-derived F_x |
/// | packed tensor | | contraction of the whole tensor, by hand |
/// | tensors | Christoffel coefficients | one dual number through that |
/// | dual | dual numbers through F | dual numbers in dual numbers through F |
///
/// Besides: y'F_x and y'F_xx d without a matrix beside products with the matrix, dF/dt in (q, v), symmetries, and energy.
#[derive(Debug)]
pub struct Routes {
    analytic: HamiltonianSecondOrder<f64>,
    dual_pass: DualPass<f64>,
    full: FullHessian<f64>,
    tensors: DualPass<f64, Christoffel>,
    dual: Jacobian<ByCalls<PhaseVelocity>>,
    nested: NestedHessian<ByCalls<PhaseVelocity>>,
    hyperdual: Hessian<ByCalls<PhaseVelocity>>,
    lagrangian: LagrangianRoutes,
    conservative: Hamiltonian<f64>,
    energy: Jacobian<ByCalls<TotalEnergy>>,
    contracted: Matrix<f64>,
    natural: Natural,
    figures: Vec<Figure>,
}

/// Sizes of the terms that a quantity is the sum of.
#[derive(Clone, Copy, Debug, Default)]
struct Natural {
    /// `e = sum |p_i v_i| + max |L_q|`, for F_x.
    energy: f64,
    /// e or a thousandth of `max |F_x|`: times `max |y|` for y'F_xx, times `max |v|` for dH/dt.
    along: f64,
}

/// Condition of M, and what friction and actuation would spoil.
type Conserved = (f64, [(&'static str, f64); 2]);

impl Routes {
    /// Builds every workspace.
    #[inline]
    pub fn new(robot: &Robot) -> Self {
        let (conservative, tree) = (robot.without_friction(), Tree::from(robot));
        let n = robot.dof();
        let function = || ByCalls(PhaseVelocity::new(robot));
        Self {
            analytic: HamiltonianSecondOrder::from_tree(tree.clone()),
            dual_pass: DualPass::from_tree(tree.clone()),
            full: FullHessian::from_tree(tree.clone()),
            tensors: DualPass::with_route(tree, Christoffel),
            dual: Jacobian::new(function()),
            nested: NestedHessian::new(function()),
            hyperdual: Hessian::new(function()),
            lagrangian: LagrangianRoutes::new(robot),
            conservative: Hamiltonian::new(&conservative),
            energy: Jacobian::new(ByCalls(TotalEnergy(conservative))),
            contracted: Matrix::zeros(2 * n, 2 * n),
            natural: Natural::default(),
            figures: Vec::new(),
        }
    }

    /// Compares at x = (q, p) with actuation u and costate y (2n), which is also the direction of products.
    ///
    /// Differences are relative to the largest entry or, where a quantity vanishes, to its natural size (see
    /// [`relative_difference`]): `e = sum |p_i v_i| + max |L_q|` for F_x; `max |y|` times e or a thousandth of `max |F_x|`
    /// for y'F_xx; `max |v|` times the same for dH/dt; the largest entry of the matrix times that of the vector for products.
    ///
    /// # Errors
    /// Those of [`Hamiltonian`].
    #[inline]
    pub fn compare(
        &mut self,
        x: &[f64],
        u: &[f64],
        y: &[f64],
    ) -> Result<StateReport, DerivativeError<EvalError>> {
        let n = self.conservative.dof();
        check_length("x", x, 2 * n)?;
        check_length("u", u, n)?;
        check_length("y", y, 2 * n)?;
        for function in [self.dual.function_mut(), self.nested.function_mut(), self.hyperdual.function_mut()]
        {
            function.0.u.copy_from_slice(u);
        }
        self.figures.clear();
        self.hyperdual.contract(x, y)?;
        let (condition, conservative) = self.compare_conservative(x)?;
        self.compare_first(x, u, y)?;
        self.compare_second(x, u, y)?;
        let (q, p) = x.split_at(n);
        let v = self.conservative.velocity(q, p)?;
        self.lagrangian.compare([q, v, u, &y[n..]], &mut self.figures)?;
        conservative.into_iter().for_each(|(quantity, value)| self.push(quantity, "analytic", value));
        Ok(StateReport { condition, figures: self.figures.clone() })
    }

    /// Natural sizes; the condition of M; symmetry of J F_x and drift of energy without friction and actuation.
    #[inline]
    fn compare_conservative(&mut self, x: &[f64]) -> Result<Conserved, DerivativeError<EvalError>> {
        let n = self.conservative.dof();
        let (q, p) = x.split_at(n);
        let conservative = self.conservative.linearise(q, p, &vec![0.0; n])?;
        let rate = conservative.f().to_vec();
        let f_x = conservative.matrix().to_nalgebra();
        let condition = condition(conservative.mass_matrix().view().to_nalgebra());
        let energy = p.iter().zip(&rate).map(|(p, v)| (p * v).abs()).sum::<f64>() + largest(&rate[n..]);
        self.natural = Natural { energy, along: worse(energy, 1e-3 * largest(&f_x)) };
        let gradient = self.energy.linearise(x)?.gradient();
        let drift = drift(gradient, &rate, largest(&rate[..n]) * self.natural.along);
        let asymmetry = asymmetry(&times_j(&f_x), energy);
        Ok((condition, [("asymmetry of J F_x, D = 0", asymmetry), ("energy drift dH/dt, u = D = 0", drift)]))
    }

    /// F_x by every route, and y'F_x.
    #[inline]
    fn compare_first(&mut self, x: &[f64], u: &[f64], y: &[f64]) -> Result<(), DerivativeError<EvalError>> {
        let (q, p) = x.split_at(u.len());
        let expected = self.hyperdual.last().jacobian();
        let energy = self.natural.energy;
        let off = |f_x: Block<'_, f64>| relative_difference(f_x, expected.view(), energy);
        let by_hand = off(self.analytic.first().linearise(q, p, u)?.matrix());
        let tensors = off(self.tensors.first().linearise(q, p, u)?.matrix());
        let dual = off(self.dual.linearise(x)?.jacobian.view());
        let product: Vec<f64> =
            (0..x.len()).map(|j| y.iter().enumerate().map(|(k, y)| y * expected[(k, j)]).sum()).collect();
        let found = self.analytic.first().adjoint(q, p, u, y)?.y_f_x;
        let natural = worse(energy, largest(expected.as_slice())) * largest(y);
        let adjoint = vector_difference(found, &product, natural);
        for (route, value) in [("analytic", by_hand), ("tensors", tensors), ("dual", dual)] {
            self.push("F_x", route, value);
        }
        self.push("y'F_x", "analytic", adjoint);
        Ok(())
    }

    /// y'F_xx by every route, and its product with y.
    #[inline]
    fn compare_second(&mut self, x: &[f64], u: &[f64], y: &[f64]) -> Result<(), DerivativeError<EvalError>> {
        let (q, p) = x.split_at(u.len());
        let expected = self.hyperdual.last_contraction();
        let natural = largest(y) * self.natural.along;
        let off = |y_f_xx: Block<'_, f64>| relative_difference(y_f_xx, expected.view(), natural);
        let analytic = off(self.analytic.contract(q, p, u, y)?.matrix());
        let dual_pass = off(self.dual_pass.contract(q, p, u, y)?.matrix());
        let tensors = off(self.tensors.contract(q, p, u, y)?.matrix());
        self.full.hessian_tensor(q, p)?.contract(y, &mut self.contracted)?;
        let packed = off(self.contracted.view());
        let by_dual = self.nested.contract(x, y)?;
        let nested = off(by_dual.view());
        let asymmetry = asymmetry(&by_dual.view().to_nalgebra(), natural);
        let product: Vec<f64> = (0..x.len()).map(|i| dot(expected.row(i), y)).collect();
        let found = self.analytic.hessian_product(q, p, y, y)?;
        let along = worse(natural, largest(expected.as_slice())) * largest(y);
        let product = vector_difference(found, &product, along);
        for (route, value) in [("analytic", analytic), ("dual pass", dual_pass), ("packed tensor", packed)] {
            self.push("y'F_xx", route, value);
        }
        // They round M in another way, and M^-1 enters three times.
        self.figures.push(Figure { quantity: "y'F_xx", route: "tensors", value: tensors, sensitivity: 10.0 });
        self.push("y'F_xx", "dual", nested);
        self.push("asymmetry of y'F_xx", "dual", asymmetry);
        self.push("y'F_xx y", "analytic", product);
        Ok(())
    }

    fn push(&mut self, quantity: &'static str, route: &'static str, value: f64) {
        self.figures.push(Figure { quantity, route, value, sensitivity: 1.0 });
    }
}

/// `|sum_i g_i f_i| / sum_i |g_i f_i|`, see [`relative_difference`].
fn drift(gradient: &[f64], rate: &[f64], natural: f64) -> f64 {
    let terms = || gradient.iter().zip(rate).map(|(g, f)| g * f);
    in_relation(terms().sum::<f64>().abs(), terms().map(f64::abs).sum(), natural)
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
