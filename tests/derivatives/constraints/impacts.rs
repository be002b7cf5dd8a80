//! Impacts, and accelerations with forces, on random trees with random constraints.

use super::{choices, closed, independence};
use costate::constraints::{ConstrainedLagrangian, ConstrainedLagrangianSecondOrder, Impact};
use costate_test_support::properties;
use costate_test_support::random_robot::{cases, tolerance};
use nalgebra::DVector;
use num_dual::HyperDual64;
use proptest::prelude::*;

fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |most, value| most.max(value.abs()))
}

properties! {
    96;

    /// The impulses change the momentum as they act, the constraints hold after them, and energy is lost.
    #[test]
    fn impacts_balance_and_lose_energy(case in cases(8), choices in choices(3)) {
        let robot = closed(&case, &choices, true);
        let bound = 10.0 * tolerance(&robot.without_constraints(), &case.q) / independence(&robot, &case.q);
        let mut impact = Impact::<f64>::new(&robot);
        let p = DVector::from_column_slice(impact.hamiltonian().momentum(&case.q, &case.v).unwrap());
        let after = impact.evaluate(&case.q, p.as_slice()).unwrap();
        let (v, impulse, loss) = (after.velocity.to_vec(), after.impulse.to_vec(), after.loss);
        let momentum = DVector::from_column_slice(after.momentum);
        let size = largest(&v).max(largest(&p)).max(largest(&impulse)).max(1.0);
        prop_assert!(loss >= 0.0, "{loss}");
        let expected = DVector::from_column_slice(impact.hamiltonian().momentum(&case.q, &v).unwrap());
        prop_assert!((&momentum - &expected).amax() <= bound * size, "p+ = M v+");
        let rate = largest(impact.hamiltonian().constraint_rate(&case.q, &v).unwrap());
        prop_assert!(rate <= bound * size, "J v+ = {rate}");
        // Half of the product of the change of the velocity and of the impulse.
        let kinetic = |p: &DVector<f64>, v: &[f64]| 0.5 * p.dot(&DVector::from_column_slice(v));
        let lost = kinetic(&p, &case.v) - kinetic(&momentum, &v);
        prop_assert!((lost - loss).abs() <= bound * size * size, "{lost} {loss}");
    }

    /// First and second derivatives along two directions.
    #[test]
    fn accelerations_and_forces_have_exact_derivatives(
        case in cases(6),
        choices in choices(2),
        seed in 0.0..10.0_f64,
    ) {
        let robot = closed(&case, &choices, true);
        let independence = independence(&robot, &case.q);
        let bound = 10.0 * tolerance(&robot.without_constraints(), &case.q) / independence.powi(3);
        let n = robot.dof();
        let wave = |from: f64, count: usize| -> Vec<f64> {
            (0..count).map(|i| (from + seed + 1.3 * i as f64).sin()).collect()
        };
        let mut second = ConstrainedLagrangianSecondOrder::<f64>::new(&robot);
        let k = second.constrained().constraints().count();
        let (e, c) = (wave(0.2, n), wave(1.2, k));
        let (along, across) = (wave(2.1, 3 * n), wave(0.7, 3 * n));
        let z = [&case.q[..], &case.v, &case.u].concat();
        let all = second.contract([&case.q, &case.v, &case.u], &e, &c).unwrap();
        let linear = all.linearisation();
        let (a_z, lambda_z) = (linear.a_z().to_nalgebra(), linear.lambda_z().to_nalgebra());
        let (found, zz) = (linear.acceleration().iter().chain(linear.lambda()).copied().collect::<Vec<_>>(), all.matrix().to_nalgebra());
        let seeds: Vec<HyperDual64> =
            (0..3 * n).map(|i| HyperDual64::new(z[i], along[i], across[i], 0.0)).collect();
        let mut judge = ConstrainedLagrangian::<HyperDual64>::new(&robot);
        let (a, lambda) = judge.evaluate(&seeds[..n], &seeds[n..2 * n], &seeds[2 * n..]).unwrap();
        let expected: Vec<HyperDual64> = a.iter().chain(lambda).copied().collect();
        let (along, across) = (DVector::from_vec(along), DVector::from_vec(across));
        let slopes = [&a_z * &along, &lambda_z * &along];
        let slopes: Vec<f64> = slopes.iter().flat_map(|slopes| slopes.iter().copied()).collect();
        let weights = [&e[..], &c].concat();
        let size = largest(&found).max(largest(a_z.iter())).max(largest(lambda_z.iter())).max(1.0);
        for (i, expected) in expected.iter().enumerate() {
            prop_assert!((found[i] - expected.re).abs() <= bound * size, "{i}");
            prop_assert!((slopes[i] - expected.eps1).abs() <= bound * size * n as f64, "{i}");
        }
        let curvature: f64 = expected.iter().zip(&weights).map(|(x, w)| x.eps1eps2 * w).sum();
        let difference = (along.dot(&(&zz * across)) - curvature).abs();
        let size = size.max(zz.amax());
        prop_assert!(difference <= 4.0 * bound * size * (n * n) as f64, "{difference:.1e} of {size:.1e}");
    }
}
