//! Contracted Hessians and Jacobians of steps against hyper-dual numbers through the step.

use super::{made, solved};
use costate::derivative::{ByCalls, DerivativeError, Hessian, InnerNumber};
use costate::matrix::Block;
use costate::scalar::{Count, Scalar};
use costate::step::{
    Classical, HamiltonianRobot, LagrangianRobot, Midpoint, ModelFamily, OneStep, Scheme, SemiImplicit, Step,
    StepError, Verlet,
};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, cases};
use costate_test_support::rounding::{explained, lift, rows};
use proptest::prelude::*;
use std::any::type_name;
use std::ops::Range;

/// What is compared: Phi, `Phi_x`, `Phi_u`, `Phi_h`, and the blocks of y'Phi_zz.
const NAMES: [&str; 7] = ["Phi", "Phi_x", "Phi_u", "Phi_h", "xx", "ux", "uu"];

/// x, u, y and h.
type At<'a> = (&'a [f64], &'a [f64], &'a [f64], f64);

/// A block with the zeros that are so by structure, `rows` x `columns`.
pub fn filled<S: Scalar>(block: Option<Block<'_, S>>, rows: usize, columns: usize) -> Vec<S> {
    let Some(block) = block else { return vec![S::zero(); rows * columns] };
    block.iter_rows().flat_map(|row| [row, &vec![S::zero(); columns - row.len()]].concat()).collect()
}

/// The blocks of [`NAMES`] by the derivatives of the scheme.
pub fn by_scheme<F: ModelFamily, M: Scheme<F>, S: Scalar>(
    family: &F,
    (x, u, y, h): At<'_>,
) -> Result<[Vec<S>; 7], StepError<F::Error>> {
    let (states, controls) = (x.len(), u.len());
    let mut step = M::step::<S>(family.model());
    let [x, u, y] = [x, u, y].map(lift::<S>);
    let found = step.contract(&x, &u, S::from_f64(h), &y)?;
    let first = &found.first;
    Ok([
        first.next.to_vec(),
        rows(first.phi_x),
        rows(first.phi_u),
        first.phi_h.to_vec(),
        rows(found.xx),
        filled(found.ux, controls, states),
        filled(found.uu, controls, controls),
    ])
}

/// The same by hyper-dual numbers through the step.
pub fn by_numbers<F: ModelFamily + Clone, M: Scheme<F>, S: InnerNumber>(
    family: &F,
    (x, u, y, h): At<'_>,
) -> Result<[Vec<S>; 7], StepError<F::Error>> {
    let (states, inputs) = (x.len(), x.len() + u.len());
    let mut judge = Hessian::<_, S>::over(ByCalls(OneStep::<F, M>::new(family.clone())));
    let whole = match judge.contract(&lift(&[x, u, &[h]].concat()), &lift(y)) {
        Ok(whole) => whole.clone(),
        Err(DerivativeError::Function(error)) => return Err(error),
        Err(error) => panic!("{error}"),
    };
    let part = |matrix: Block<'_, S>, rows: Range<usize>, columns: Range<usize>| -> Vec<S> {
        rows.flat_map(|i| matrix.row(i)[columns.clone()].to_vec()).collect()
    };
    let slope = |columns| part(judge.last().jacobian().view(), 0..states, columns);
    let bend = |rows, columns| part(whole.view(), rows, columns);
    let (in_x, in_u) = (0..states, states..inputs);
    Ok([
        judge.last().value().to_vec(),
        slope(in_x.clone()),
        slope(in_u.clone()),
        slope(inputs..inputs + 1),
        bend(in_x.clone(), in_x.clone()),
        bend(in_u.clone(), in_x),
        bend(in_u.clone(), in_u),
    ])
}

fn derivatives_agree<F: ModelFamily + Clone, M: Scheme<F>>(
    case: &Case,
    family: &F,
    x: &[f64],
) -> Result<(), TestCaseError> {
    let at = (x, &case.u[..], &case.y[..], 0.01);
    solved::<F, M>(family, [x, &case.u], 0.01)?;
    let found = made(by_scheme::<F, M, f64>(family, at))?;
    let expected = made(by_numbers::<F, M, f64>(family, at))?;
    let of_scheme = made(by_scheme::<F, M, Count>(family, at))?;
    explained(NAMES, [&found, &expected], &of_scheme, || made(by_numbers::<F, M, Count>(family, at))).map_err(
        |error| match error {
            TestCaseError::Fail(reason) => TestCaseError::fail(format!("{}: {reason}", type_name::<M>())),
            reject => reject,
        },
    )
}

/// Robots a property.
const CASES: u32 = 64;

properties! {
    CASES;

    #[test]
    fn derivatives_agree_with_hyper_dual_numbers_in_hamiltonian_coordinates(case in cases(6)) {
        let robot = case.robot();
        let (family, x) = (HamiltonianRobot::from(&robot), case.x(&robot));
        derivatives_agree::<_, Classical>(&case, &family, &x)?;
        derivatives_agree::<_, Verlet>(&case, &family, &x)?;
        derivatives_agree::<_, Midpoint>(&case, &family, &x)?;
    }

    #[test]
    fn derivatives_agree_with_hyper_dual_numbers_in_lagrangian_coordinates(case in cases(6)) {
        let robot = case.robot();
        let (family, x) = (LagrangianRobot::from(&robot), [case.q.as_slice(), &case.v].concat());
        derivatives_agree::<_, Classical>(&case, &family, &x)?;
        derivatives_agree::<_, SemiImplicit>(&case, &family, &x)?;
        derivatives_agree::<_, Verlet>(&case, &family, &x)?;
        derivatives_agree::<_, Midpoint>(&case, &family, &x)?;
    }
}
