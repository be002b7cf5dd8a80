//! Lengths as parameters of robots with wrenches from outside.

use super::{everything, everything_with_wrenches, of_acceleration, of_regressor, of_state_equation};
use costate::kinematics::ExternalForces;
use costate::parameters::{HamiltonianParameters, LagrangianParameters, Parameter, ParameterSet, Regressor};
use costate::robot::JointKind;
use costate_test_support::properties;
use costate_test_support::random_robot::{all_cases, cases};
use costate_test_support::rounding::{Bounds, InverseBounds, close};
use nalgebra::{DMatrix, DVector};

/// The exact derivative by parameter `k` of what depends on the generalised forces of robots alone: they are
/// linear in a translation, and `a + b cos + c sin` of a rotation.
fn by_length(
    set: &ParameterSet,
    k: usize,
    forces: impl Fn(&mut ExternalForces<f64>) -> DVector<f64>,
) -> DVector<f64> {
    let kind = match set.parameters()[k] {
        Parameter::Translation { .. } => JointKind::Prismatic,
        Parameter::Rotation { .. } => JointKind::Revolute,
        Parameter::Displacement { displacement, .. } => displacement.kind,
        _ => return forces(&mut ExternalForces::new(set.robot())) * 0.0,
    };
    let step = if kind == JointKind::Revolute { std::f64::consts::FRAC_PI_2 } else { 0.5 };
    let at = |step: f64| {
        let mut values = set.values().to_vec();
        values[k] += step;
        let moved = set.robot_with(&values).unwrap();
        forces(&mut ExternalForces::new(&moved))
    };
    let difference = at(step) - at(-step);
    if kind == JointKind::Revolute { difference / 2.0 } else { difference }
}

/// The columns of `what` for each parameter of a set.
fn columns(set: &ParameterSet, what: impl Fn(usize) -> DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_columns(&(0..set.len()).map(what).collect::<Vec<_>>())
}

properties! {
    48;

    #[test]
    fn the_columns_of_lengths_are_those_without_wrenches_and_the_change_of_their_arms(case in all_cases(6)) {
        let (set, without) = (everything_with_wrenches(&case), everything(&case));
        let q_theta = columns(&set, |k| {
            by_length(&set, k, |forces| DVector::from_column_slice(forces.evaluate(&case.q).unwrap()))
        });
        let (q, v, a) = (&case.q, &case.v, &case.u);
        let w = &case.y[..case.n()];
        // The change of the arms is a difference of forces, which are entries of the columns by the wrenches'
        // sizes.
        let bounds = [&set, &without].map(|set| of_regressor(set, [q, v, a, w]));
        let [of_tau, of_w_tau, _, of_force, _] = [0, 1, 2, 3, 4].map(|k: usize| bounds[0][k] + bounds[1][k]);
        let [mut ours, mut bare] = [&set, &without].map(Regressor::<f64>::new);
        let expected = bare.inverse_dynamics(q, v, a).unwrap().view().to_nalgebra() - &q_theta;
        let found = ours.inverse_dynamics(q, v, a).unwrap().view().to_nalgebra();
        close("tau_theta", found.as_slice(), expected.as_slice(), of_tau)?;
        let force = bare.momentum(q, v).unwrap().force.view().to_nalgebra() + &q_theta;
        let found = ours.momentum(q, v).unwrap().force.view().to_nalgebra();
        close("force", found.as_slice(), force.as_slice(), of_force)?;
        let along = expected.tr_mul(&DVector::from_column_slice(w));
        close("w'tau_theta", ours.adjoint(q, v, a, w).unwrap(), along.as_slice(), of_w_tau.max(case.n() as f64 * of_tau))?;
    }

    #[test]
    fn in_momenta_arms_change_the_rates_of_momenta_and_their_slopes(case in cases(4)) {
        let (set, without, n) = (everything_with_wrenches(&case), everything(&case), case.n());
        let (p, y) = (case.p(&case.robot()), &case.y);
        let q_theta = columns(&set, |k| {
            by_length(&set, k, |forces| DVector::from_column_slice(forces.evaluate(&case.q).unwrap()))
        });
        let y_q_theta = columns(&set, |k| {
            by_length(&set, k, |forces| {
                let slopes = forces.jacobian(&case.q).unwrap().view().to_nalgebra();
                slopes.tr_mul(&DVector::from_column_slice(&y[n..]))
            })
        });
        let [mut ours, mut bare] = [&set, &without].map(HamiltonianParameters::<f64>::new);
        let bare = bare.contract(&case.q, &p, y).unwrap();
        let bounds = [&set, &without].map(|set| of_state_equation(set, [&case.q, &case.v, y]));
        let [of_f, of_y_f, of_y_f_x] = [0, 1, 2].map(|k: usize| bounds[0][k] + bounds[1][k]);
        let mut f_theta = bare.f_theta().view().to_nalgebra();
        f_theta.rows_mut(n, n).zip_apply(&q_theta, |entry, force| *entry += force);
        let mut mixed = bare.y_f_x_theta().view().to_nalgebra();
        mixed.rows_mut(0, n).zip_apply(&y_q_theta, |entry, slope| *entry += slope);
        let product = f_theta.tr_mul(&DVector::from_column_slice(y));
        let found = ours.contract(&case.q, &p, y).unwrap();
        close("F_theta", found.f_theta().view().to_nalgebra().as_slice(), f_theta.as_slice(), of_f)?;
        close("y'F_x,theta", found.y_f_x_theta().view().to_nalgebra().as_slice(), mixed.as_slice(), of_y_f_x.max(n as f64 * of_f))?;
        close("y'F_theta", found.y_f_theta(), product.as_slice(), of_y_f.max(2.0 * n as f64 * of_f))?;
    }

    /// `M a_theta = -tau_theta` at the acceleration that the wrenches and u cause.
    #[test]
    fn in_velocities_arms_change_the_acceleration(case in cases(4)) {
        let set = everything_with_wrenches(&case);
        let (q, v, u, n) = (&case.q, &case.v, &case.u, case.n());
        let mut parameters = LagrangianParameters::<f64>::new(&set);
        let linear = parameters.linearise_forward_dynamics(q, v, u).unwrap();
        let mut lagrangian = costate::lagrangian::Lagrangian::<f64>::new(set.robot());
        let bounds = Bounds::new(set.robot(), [q, v, u, &case.y]);
        close("a", linear.acceleration, lagrangian.forward_dynamics(q, v, u).unwrap(), bounds.a)?;
        let (a, a_theta) = (linear.acceleration.to_vec(), linear.a_theta.view().to_nalgebra());
        let tau_theta = Regressor::<f64>::new(&set).inverse_dynamics(q, v, &a).unwrap().view().to_nalgebra();
        let m = lagrangian.mass_matrix(q).unwrap().view().to_nalgebra();
        let [of_a_theta, of_y_a] = of_acceleration(&set, [q, v, u, &case.y[..n]]);
        // Rounding of M a_theta: M times that of a_theta, which has the error of a, too.
        let of_m = InverseBounds::new(set.robot(), [q, v, &a, u]).m;
        let [of_tau, ..] = of_regressor(&set, [q, v, &a, u]);
        let bound = of_tau + n as f64 * (m.amax() * of_a_theta + of_m * a_theta.amax());
        close("M a_theta", (m * &a_theta).as_slice(), (-tau_theta).as_slice(), bound)?;
        let along = a_theta.tr_mul(&DVector::from_column_slice(&case.y[..n]));
        let found = parameters.adjoint_forward_dynamics(q, v, u, &case.y[..n]).unwrap();
        close("y'a_theta", found, along.as_slice(), of_y_a.max(n as f64 * of_a_theta))?;
    }
}
