//! Models and costs derived by hand against automatic ones of the same formulas.

use costate::EvalError;
use costate::derivative::{DerivativeError, Function, largest};
use costate::dynamics::{Automatic, AutomaticCost, Contraction, Cost, Dynamics, QuadraticCost};
use costate::hamiltonian::{self, Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::matrix::Block;
use costate::robot::{Robot, Tree};
use costate::scalar::Scalar;
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, cases};
use costate_test_support::rounding::{Bounds, close};
use proptest::prelude::*;
use std::convert::Infallible;

fn flat(block: Block<'_, f64>) -> Vec<f64> {
    block.iter_rows().flatten().copied().collect()
}

/// `max |a - b| / max(max |b|, natural)`.
fn off(found: &[f64], expected: &[f64], natural: f64) -> f64 {
    assert_eq!(found.len(), expected.len());
    let differences: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
    let worst = largest(&differences);
    if worst == 0.0 { 0.0 } else { worst / largest(expected).max(natural) }
}

/// The state equation in (q, p) as a function of (x, u).
#[derive(Clone)]
struct Momenta(Tree);

impl Function for Momenta {
    type Workspace<S: Scalar> = Hamiltonian<S>;
    type Error = EvalError;
    fn inputs(&self) -> usize {
        3 * self.0.dof()
    }
    fn outputs(&self) -> usize {
        2 * self.0.dof()
    }
    fn workspace<S: Scalar>(&self) -> Hamiltonian<S> {
        Hamiltonian::from_tree(self.0.clone())
    }
    fn evaluate<S: Scalar>(&self, model: &mut Hamiltonian<S>, z: &[S], f: &mut [S]) -> Result<(), EvalError> {
        let n = self.0.dof();
        f.copy_from_slice(model.evaluate(&z[..n], &z[n..2 * n], &z[2 * n..])?);
        Ok(())
    }
}

/// The state equation in (q, v) as a function of (x, u).
#[derive(Clone)]
struct Velocities(Tree);

impl Function for Velocities {
    type Workspace<S: Scalar> = Lagrangian<S>;
    type Error = EvalError;
    fn inputs(&self) -> usize {
        3 * self.0.dof()
    }
    fn outputs(&self) -> usize {
        2 * self.0.dof()
    }
    fn workspace<S: Scalar>(&self) -> Lagrangian<S> {
        Lagrangian::from_tree(self.0.clone())
    }
    fn evaluate<S: Scalar>(&self, model: &mut Lagrangian<S>, z: &[S], f: &mut [S]) -> Result<(), EvalError> {
        let n = self.0.dof();
        f.copy_from_slice(model.evaluate(&z[..n], &z[n..2 * n], &z[2 * n..])?);
        Ok(())
    }
}

/// xx, ux and uu with all zeros in their places.
fn blocks(second: &Contraction<'_, f64>) -> [Vec<f64>; 3] {
    let (states, controls) = (second.first.f.len(), second.first.f_u.columns());
    let mut ux = vec![0.0; controls * states];
    for (j, row) in second.ux.iter().flat_map(|ux| ux.iter_rows()).enumerate() {
        ux[j * states..][..row.len()].copy_from_slice(row);
    }
    let uu = second.uu.map_or(vec![0.0; controls * controls], flat);
    [flat(second.xx), ux, uu]
}

/// How far rounding may take two models of a robot apart: f, its first derivatives, y' times the second ones.
#[derive(Clone, Copy)]
struct Rounding {
    f: f64,
    first: f64,
    second: f64,
}

/// A model against the automatic one of its equations; every answer of the trait.
fn models_agree(
    model: &mut impl Dynamics<f64, Error = EvalError>,
    judge: &mut impl Dynamics<f64, Error = DerivativeError<EvalError>>,
    (case, x): (&Case, &[f64]),
    of: Rounding,
) -> Result<(), TestCaseError> {
    let (u, y) = (&case.u[..], &case.y[..]);
    let structure = model.structure();
    prop_assert_eq!((model.states(), model.controls()), (judge.states(), judge.controls()));
    let value = model.evaluate(x, u).unwrap().to_vec();
    let expected = judge.contract(x, u, y).unwrap();
    let expected_blocks = blocks(&expected);
    let first = model.linearise(x, u).unwrap();
    let (f_x, f_u) = (flat(first.f_x), flat(first.f_u));
    close("f", &value, expected.first.f, of.f)?;
    close("f of f_x", first.f, &value, of.f)?;
    close("f_x", &f_x, &flat(expected.first.f_x), of.first)?;
    close("f_u", &f_u, &flat(expected.first.f_u), of.first)?;
    let second = model.contract(x, u, y).unwrap();
    prop_assert!(second.ux.is_none() == structure.constant_f_u);
    prop_assert!(second.uu.is_none() == (structure.constant_f_u || structure.affine_in_u));
    prop_assert!(second.ux.is_none_or(|ux| ux.columns() == structure.f_u_depends_on));
    close("f of y'f_xx", second.first.f, &value, of.f)?;
    close("f_x of y'f_xx", &flat(second.first.f_x), &f_x, of.first)?;
    let found = blocks(&second);
    for (name, (found, expected)) in ["xx", "ux", "uu"].iter().zip(found.iter().zip(&expected_blocks)) {
        close(name, found, expected, of.second)?;
    }
    let product = |rows: &[f64], columns: usize, d: &[f64], transposed: bool| -> Vec<f64> {
        let m = nalgebra::DMatrix::from_row_slice(rows.len() / columns, columns, rows);
        let d = nalgebra::DVector::from_column_slice(d);
        if transposed { m.tr_mul(&d) } else { m * d }.as_slice().to_vec()
    };
    let (states, controls) = (x.len(), u.len());
    let (mut in_x, mut in_u) = (vec![f64::NAN; states], vec![f64::NAN; controls]);
    model.adjoint(x, u, y, &mut in_x, &mut in_u).unwrap();
    // Each term of a product rounds as its entry of the matrix does, times its factor.
    let terms = |factors: &[f64]| 2.0 * factors.iter().map(|factor| factor.abs()).sum::<f64>();
    close("y'f_x", &in_x, &product(&f_x, states, y, true), terms(y) * of.first)?;
    close("y'f_u", &in_u, &product(&f_u, controls, y, true), terms(y) * of.first)?;
    let (d_x, d_u): (Vec<f64>, Vec<f64>) = (y.iter().rev().copied().collect(), u.to_vec());
    model.hessian_product(x, u, y, [&d_x, &d_u], [&mut in_x, &mut in_u]).unwrap();
    let add = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(b).map(|(a, b)| a + b).collect::<Vec<_>>();
    let [xx, ux, uu] = &found;
    let bound = (terms(&d_x) + terms(&d_u)) * of.second;
    close("in x", &in_x, &add(product(xx, states, &d_x, false), product(ux, states, &d_u, true)), bound)?;
    close("in u", &in_u, &add(product(ux, states, &d_x, false), product(uu, controls, &d_u, false)), bound)
}

properties! {
    128;

    #[test]
    fn robots_are_the_automatic_models_of_their_equations(case in cases(6)) {
        let robot = case.robot();
        let tree = || Tree::from(&robot);
        let of = Bounds::new(&robot, [&case.q, &case.v, &case.u, &case.y]);
        let in_momenta = Rounding { f: of.f, first: of.f_x, second: of.y_f_xx };
        let mut model = HamiltonianSecondOrder::from_tree(tree());
        let mut judge = Automatic::new(Momenta(tree()));
        models_agree(&mut model, &mut judge, (&case, &case.x(&robot)), in_momenta)?;
        let mut model = hamiltonian::DualPass::from_tree(tree());
        models_agree(&mut &mut model, &mut judge, (&case, &case.x(&robot)), in_momenta)?;
        let in_velocities = Rounding { f: of.a, first: of.a_z, second: of.y_a_zz };
        let mut model = LagrangianSecondOrder::from_tree(tree());
        let z = [case.q.as_slice(), &case.v].concat();
        models_agree(&mut model, &mut Automatic::new(Velocities(tree())), (&case, &z), in_velocities)?;
    }
}

/// `1/2 sum Q (x - x*)^2 + 1/2 sum R (u - u*)^2` for two states and one control.
#[derive(Clone)]
struct Off;

const WEIGHTS: ([f64; 2], [f64; 1]) = ([2.0, 0.3], [0.5]);
const TARGETS: ([f64; 2], [f64; 1]) = ([1.0, -0.4], [0.7]);

impl Function for Off {
    type Workspace<S: Scalar> = ();
    type Error = Infallible;
    fn inputs(&self) -> usize {
        3
    }
    fn outputs(&self) -> usize {
        1
    }
    fn workspace<S: Scalar>(&self) {}
    fn evaluate<S: Scalar>(&self, (): &mut (), z: &[S], l: &mut [S]) -> Result<(), Infallible> {
        let (weights, targets) =
            ([WEIGHTS.0[0], WEIGHTS.0[1], WEIGHTS.1[0]], [TARGETS.0[0], TARGETS.0[1], TARGETS.1[0]]);
        l[0] = S::zero();
        for ((&z, w), t) in z.iter().zip(weights).zip(targets) {
            l[0] += (z.plus(-t) * z.plus(-t)).times(0.5 * w);
        }
        Ok(())
    }
}

#[test]
fn a_quadratic_cost_is_the_automatic_one_of_its_formula() {
    let mut cost = QuadraticCost::<f64>::running(&WEIGHTS.0, &WEIGHTS.1).about(&TARGETS.0, &TARGETS.1);
    let mut judge: AutomaticCost<_> = AutomaticCost::running(Off, 2);
    assert_eq!((cost.states(), cost.controls()), (judge.states(), judge.controls()));
    let (x, u) = ([0.3, -2.0], [1.5]);
    let value = judge.evaluate(&x, &u).unwrap();
    assert!((cost.evaluate(&x, &u).unwrap() - value).abs() < 1e-15);
    let agree = |a: &[f64], b: &[f64]| assert!(off(a, b, 1.0) < 1e-15, "{a:?} {b:?}");
    let (found, expected) = (cost.gradient(&x, &u).unwrap(), judge.gradient(&x, &u).unwrap());
    agree(&[found.value], &[expected.value]);
    agree(found.x, expected.x);
    agree(found.u, expected.u);
    let (found, expected) = (cost.hessian(&x, &u).unwrap(), judge.hessian(&x, &u).unwrap());
    agree(&[found.gradient.value], &[value]);
    agree(found.gradient.x, expected.gradient.x);
    agree(found.gradient.u, expected.gradient.u);
    agree(&flat(found.xx), &flat(expected.xx));
    agree(&flat(found.uu), &flat(expected.uu));
    assert!(found.ux.is_none() && largest(&flat(expected.ux.unwrap())) == 0.0);
}

#[test]
fn wrong_lengths_are_errors() {
    fn model_refuses<D: Dynamics<f64>>(mut model: D) {
        let (x, u) = (vec![0.1; model.states()], vec![0.2; model.controls()]);
        assert!(model.contract(&x, &u, &x).is_ok());
        assert!(model.evaluate(&x[1..], &u).is_err() && model.evaluate(&x, &x).is_err());
        assert!(model.linearise(&x[1..], &u).is_err() && model.linearise(&x, &x).is_err());
        assert!(model.contract(&x[1..], &u, &x).is_err() && model.contract(&x, &x, &x).is_err());
        let error = model.contract(&x, &u, &u).map(|_| ()).unwrap_err();
        assert!(error.to_string().contains('y') && error.to_string().contains("entries"), "{error}");
        let (mut in_x, mut in_u) = (x.clone(), u.clone());
        assert!(model.adjoint(&x, &u, &x, &mut in_x, &mut in_u).is_ok());
        assert!(model.adjoint(&x, &u, &u, &mut in_x, &mut in_u).is_err());
        assert!(model.adjoint(&x, &u, &[&x[..], &u].concat(), &mut in_x, &mut in_u).is_err());
        assert!(model.hessian_product(&x, &u, &u, [&x, &u], [&mut in_x, &mut in_u]).is_err());
        assert!(model.hessian_product(&x, &u, &x, [&u, &u], [&mut in_x, &mut in_u]).is_err());
        assert!(model.hessian_product(&x, &u, &x, [&x, &[]], [&mut in_x, &mut in_u]).is_err());
        assert!(model.hessian_product(&x, &u, &x, [&x, &u], [&mut in_x, &mut []]).is_err());
        assert!(model.adjoint(&x, &u, &x, &mut in_u, &mut []).is_err());
        let mut bad = x.clone();
        for k in [0, x.len() - 1] {
            bad[k] = f64::NAN;
            assert!(model.evaluate(&bad, &u).is_err() && model.contract(&x, &u, &bad).is_err());
            assert!(model.adjoint(&x, &u, &bad, &mut in_x, &mut in_u).is_err());
            assert!(model.hessian_product(&x, &u, &x, [&bad, &u], [&mut in_x, &mut in_u]).is_err());
            bad[k] = 0.0;
        }
        assert!(model.hessian_product(&x, &u, &x, [&x, &u], [&mut in_x, &mut in_u]).is_ok());
        assert!(model.evaluate(&x, &u).is_ok());
    }
    fn cost_refuses<C: Cost<f64>>(mut cost: C) {
        let (x, u) = (vec![0.1; cost.states()], vec![0.2; cost.controls()]);
        assert!(cost.hessian(&x, &u).is_ok());
        assert!(cost.evaluate(&x[1..], &u).is_err() && cost.evaluate(&x, &[0.0; 7]).is_err());
        assert!(cost.gradient(&x[1..], &u).is_err() && cost.gradient(&x, &[0.0; 7]).is_err());
        assert!(cost.hessian(&x[1..], &u).is_err() && cost.hessian(&x, &[0.0; 7]).is_err());
    }
    let robot = Robot::from_file(format!("{}/robots/two_link.toml", env!("CARGO_MANIFEST_DIR"))).unwrap();
    model_refuses(HamiltonianSecondOrder::new(&robot));
    model_refuses(hamiltonian::DualPass::new(&robot));
    model_refuses(LagrangianSecondOrder::new(&robot));
    model_refuses(Automatic::<_, f64>::new(Momenta(Tree::from(&robot))));
    cost_refuses(QuadraticCost::<f64>::running(&WEIGHTS.0, &WEIGHTS.1));
    cost_refuses(QuadraticCost::<f64>::terminal(&WEIGHTS.0));
    cost_refuses(AutomaticCost::<_, f64>::running(Off, 2));
    cost_refuses(AutomaticCost::<_, f64>::terminal(Off));
}
