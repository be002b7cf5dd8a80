//! Contracted Hessians and Jacobians of steps against hyper-dual numbers through the step.

use super::{filled, flat, made, off};
use costate::derivative::{ByCalls, DerivativeError, Hessian, largest};
use costate::dynamics::Dynamics;
use costate::matrix::Matrix;
use costate::robot::Robot;
use costate::step::{
    Classical, HamiltonianRobot, LagrangianRobot, Midpoint, ModelFamily, OneStep, Scheme, SemiImplicit, Step,
    StepError, Verlet,
};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, cases, condition};
use costate_test_support::rounding::Bounds;
use proptest::prelude::*;
use std::any::type_name;
use std::ops::Range;

/// Phi, `Phi_x`, `Phi_u`, `Phi_h`, and the blocks of y'Phi_zz against hyper-dual numbers: the worst of each.
///
/// Natural sizes: `h max |y|` times a thousandth of `max |f_x|` for the blocks of y'Phi_zz, `curvature` h if
/// that is more, times `max |Phi_u|` for each u; a thousandth of `max |f_x|` for `Phi_h`. `curvature` is the
/// size of the terms of y'f_xx, as far as their rounding is known.
pub fn differences<F: ModelFamily + Clone, M: Scheme<F>>(
    family: &F,
    (x, u, y, h): (&[f64], &[f64], &[f64], f64),
    curvature: f64,
) -> Result<[f64; 7], StepError<F::Error>> {
    let (states, inputs) = (x.len(), x.len() + u.len());
    let mut judge = Hessian::new(ByCalls(OneStep::<F, M>::new(family.clone())));
    let whole = match judge.contract(&[x, u, &[h]].concat(), y) {
        Ok(whole) => whole.clone(),
        Err(DerivativeError::Function(error)) => return Err(error),
        Err(error) => panic!("{error}"),
    };
    let jacobian = judge.last().jacobian();
    let columns = |rows: Range<usize>, columns: Range<usize>, of: &Matrix<f64>| {
        rows.flat_map(|i| of.row(i)[columns.clone()].to_vec()).collect::<Vec<_>>()
    };
    let f_x = flat(family.model::<f64>().linearise(x, u).unwrap().f_x);
    let natural = h.abs() * (1e-3 * largest(y) * largest(&f_x)).max(curvature);
    let mut step = M::step::<f64>(family.model());
    let found = step.contract(x, u, h, y)?;
    let controls = inputs - states;
    let in_u = largest(&flat(found.first.phi_u));
    let states_and = |rest| columns(0..states, rest, jacobian);
    Ok([
        off(found.first.next, judge.last().value(), 0.0),
        off(&flat(found.first.phi_x), &states_and(0..states), 0.0),
        off(&flat(found.first.phi_u), &states_and(states..inputs), 0.0),
        off(found.first.phi_h, &states_and(inputs..inputs + 1), 1e-3 * largest(&f_x)),
        off(&flat(found.xx), &columns(0..states, 0..states, &whole), natural),
        off(&filled(found.ux, controls, states), &columns(states..inputs, 0..states, &whole), natural * in_u),
        off(
            &filled(found.uu, controls, controls),
            &columns(states..inputs, states..inputs, &whole),
            natural * in_u * in_u,
        ),
    ])
}

fn derivatives_agree<F: ModelFamily + Clone, M: Scheme<F>>(
    case: &Case,
    robot: &Robot,
    family: &F,
    x: &[f64],
    rounding: f64,
) -> Result<(), TestCaseError> {
    let tolerance = 1e-11 * (condition(robot, &case.q) / 1000.0).max(1.0);
    // A step adds y'f_xx of up to four stages, each of which may round so.
    let found = made(differences::<F, M>(family, (x, &case.u, &case.y, 0.01), 4.0 * rounding / tolerance))?;
    let worst = largest(&found);
    prop_assert!(worst <= tolerance, "{}: {worst:.2e} > {tolerance:.2e}: {found:?}", type_name::<M>());
    Ok(())
}

/// Robots a property.
const CASES: u32 = 64;

properties! {
    CASES;

    #[test]
    fn derivatives_agree_with_hyper_dual_numbers_in_hamiltonian_coordinates(case in cases(6)) {
        let robot = case.robot();
        let (family, x) = (HamiltonianRobot::from(&robot), case.x(&robot));
        let rounding = Bounds::new(&robot, [&case.q, &case.v, &case.u, &case.y]).y_f_xx;
        derivatives_agree::<_, Classical>(&case, &robot, &family, &x, rounding)?;
        derivatives_agree::<_, Verlet>(&case, &robot, &family, &x, rounding)?;
        derivatives_agree::<_, Midpoint>(&case, &robot, &family, &x, rounding)?;
    }

    #[test]
    fn derivatives_agree_with_hyper_dual_numbers_in_lagrangian_coordinates(case in cases(6)) {
        let robot = case.robot();
        let (family, x) = (LagrangianRobot::from(&robot), [case.q.as_slice(), &case.v].concat());
        let rounding = Bounds::new(&robot, [&case.q, &case.v, &case.u, &case.y]).y_a_zz;
        derivatives_agree::<_, Classical>(&case, &robot, &family, &x, rounding)?;
        derivatives_agree::<_, SemiImplicit>(&case, &robot, &family, &x, rounding)?;
        derivatives_agree::<_, Verlet>(&case, &robot, &family, &x, rounding)?;
        derivatives_agree::<_, Midpoint>(&case, &robot, &family, &x, rounding)?;
    }
}
