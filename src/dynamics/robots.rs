//! Robots as models, in both coordinate systems.

use super::{Contraction, Dynamics, Linearisation, Structure};
use crate::error::{EvalError, check_length};
use crate::hamiltonian::{
    DualPass, Hamiltonian, HamiltonianContraction, HamiltonianLinearisation, HamiltonianSecondOrder, check,
};
use crate::kernels::Route;
use crate::lagrangian::LagrangianSecondOrder;
use crate::robot::Tree;
use crate::scalar::Scalar;

/// The structure in x = (q, p): f_u = (0; 1) is constant.
const HAMILTONIAN: Structure = Structure { constant_f_u: true, affine_in_u: true, f_u_depends_on: 0 };

/// F and its Jacobians.
fn first_order<'a, S: Scalar>(linear: HamiltonianLinearisation<'a, S>) -> Linearisation<'a, S> {
    Linearisation { f: linear.f(), f_x: linear.matrix(), f_u: linear.f_u() }
}

/// F, its Jacobians and y'F_xx.
fn contraction<'a, S: Scalar>(second: HamiltonianContraction<'a, S>) -> Contraction<'a, S> {
    Contraction { first: first_order(second.linearisation()), xx: second.matrix(), ux: None, uu: None }
}

/// y'F_x without F_x, and y'F_u.
fn adjoint<S: Scalar, R: Route>(
    first: &mut Hamiltonian<S, R>,
    [x, u, y]: [&[S]; 3],
    [y_f_x, y_f_u]: [&mut [S]; 2],
) -> Result<(), EvalError> {
    let (q, p) = halves(x, first.dof())?;
    check_length("y_f_x", y_f_x, x.len())?;
    check_length("y_f_u", y_f_u, first.dof())?;
    y_f_x.copy_from_slice(first.adjoint(q, p, u, y)?.y_f_x);
    y_f_u.copy_from_slice(&y[first.dof()..]);
    Ok(())
}

/// The part of the trait that is the same for every robot.
macro_rules! of_a_robot {
    () => {
        type Error = EvalError;

        fn states(&self) -> usize {
            2 * self.dof()
        }

        fn controls(&self) -> usize {
            self.dof()
        }
    };
}

/// The product from the whole contraction, after a check of the arguments.
macro_rules! product_by_contraction {
    () => {
        fn hessian_product(
            &mut self,
            x: &[S],
            u: &[S],
            y: &[S],
            [d_x, d_u]: [&[S]; 2],
            [x_product, u_product]: [&mut [S]; 2],
        ) -> Result<(), EvalError> {
            check_product(self.first().tree(), [u, d_x, d_u], [x_product, u_product])?;
            Dynamics::contract(self, x, u, y)?.times([d_x, d_u], [x_product, u_product]);
            Ok(())
        }
    };
}

/// The part of the trait in (q, p) that does not depend on the method for y'F_xx.
macro_rules! in_phase_space {
    () => {
        of_a_robot!();

        fn structure(&self) -> Structure {
            HAMILTONIAN
        }

        fn evaluate(&mut self, x: &[S], u: &[S]) -> Result<&[S], EvalError> {
            let (q, p) = halves(x, self.dof())?;
            self.first().evaluate(q, p, u)
        }

        fn linearise(&mut self, x: &[S], u: &[S]) -> Result<Linearisation<'_, S>, EvalError> {
            let (q, p) = halves(x, self.dof())?;
            self.first().linearise(q, p, u).map(first_order)
        }

        fn contract(&mut self, x: &[S], u: &[S], y: &[S]) -> Result<Contraction<'_, S>, EvalError> {
            let (q, p) = halves(x, self.dof())?;
            self.contract(q, p, u, y).map(contraction)
        }

        fn adjoint(
            &mut self,
            x: &[S],
            u: &[S],
            y: &[S],
            y_f_x: &mut [S],
            y_f_u: &mut [S],
        ) -> Result<(), EvalError> {
            adjoint(self.first(), [x, u, y], [y_f_x, y_f_u])
        }
    };
}

/// F of (17), (19): x = (q, p), u the actuation; f_u = (0; 1) is constant.
impl<S: Scalar> Dynamics<S> for HamiltonianSecondOrder<S> {
    in_phase_space!();

    fn hessian_product(
        &mut self,
        x: &[S],
        u: &[S],
        y: &[S],
        [d_x, d_u]: [&[S]; 2],
        [x_product, u_product]: [&mut [S]; 2],
    ) -> Result<(), EvalError> {
        let (q, p) = halves(x, self.dof())?;
        check_product(self.first().tree(), [u, d_x, d_u], [x_product, u_product])?;
        x_product.copy_from_slice(HamiltonianSecondOrder::hessian_product(self, q, p, y, d_x)?);
        u_product.fill(S::zero());
        Ok(())
    }
}

/// The same by any route, y'F_xx by one dual pass.
impl<S: Scalar, R: Route> Dynamics<S> for DualPass<S, R> {
    in_phase_space!();
    product_by_contraction!();
}

/// (9): x = (q, v), u the actuation; f_u = (0; M^-1) depends on q.
impl<S: Scalar> Dynamics<S> for LagrangianSecondOrder<S> {
    of_a_robot!();
    product_by_contraction!();

    fn structure(&self) -> Structure {
        Structure { constant_f_u: false, affine_in_u: true, f_u_depends_on: self.dof() }
    }

    fn evaluate(&mut self, x: &[S], u: &[S]) -> Result<&[S], EvalError> {
        let (q, v) = halves(x, self.dof())?;
        self.first().evaluate(q, v, u)
    }

    fn linearise(&mut self, x: &[S], u: &[S]) -> Result<Linearisation<'_, S>, EvalError> {
        let (q, v) = halves(x, self.dof())?;
        let state = self.first().linearise(q, v, u)?;
        Ok(Linearisation { f: state.f, f_x: state.f_x.view(), f_u: state.f_u.view() })
    }

    fn contract(&mut self, x: &[S], u: &[S], y: &[S]) -> Result<Contraction<'_, S>, EvalError> {
        let (q, v) = halves(x, self.dof())?;
        let second = self.contract(q, v, u, y)?;
        let state = second.linearisation();
        let first = Linearisation { f: state.f, f_x: state.f_x.view(), f_u: state.f_u.view() };
        Ok(Contraction { first, xx: second.xx(), ux: Some(second.uq()), uu: None })
    }

    fn adjoint(
        &mut self,
        x: &[S],
        u: &[S],
        y: &[S],
        y_f_x: &mut [S],
        y_f_u: &mut [S],
    ) -> Result<(), EvalError> {
        let n = self.dof();
        check(self.first().tree(), "y", y, 2 * n)?;
        check_length("y_f_x", y_f_x, x.len())?;
        check_length("y_f_u", y_f_u, u.len())?;
        self.linearise(x, u)?.adjoint(y, [y_f_x, y_f_u]);
        Ok(())
    }
}

/// Checks the lengths of the arguments of a product other than x and y.
fn check_product<S: Scalar>(
    tree: &Tree,
    [u, d_x, d_u]: [&[S]; 3],
    [x_product, u_product]: [&[S]; 2],
) -> Result<(), EvalError> {
    let n = tree.dof();
    check(tree, "u", u, n)?;
    check(tree, "d_x", d_x, 2 * n)?;
    check(tree, "d_u", d_u, n)?;
    check_length("x_product", x_product, 2 * n)?;
    check_length("u_product", u_product, n)
}

/// The first n and the last n of 2n components.
fn halves<S>(x: &[S], n: usize) -> Result<(&[S], &[S]), EvalError> {
    check_length("x", x, 2 * n)?;
    Ok(x.split_at(n))
}
