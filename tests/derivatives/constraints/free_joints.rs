//! Floating and spherical joints under constraints of all kinds: F, forces and their derivatives in the
//! tangent space.

use super::{Rounding, are_those_of_the_dense_equations, choices, closed, independence};
use crate::free_joints::{moving, retracted};
use costate::EvalError;
use costate::constraints::{ConstrainedHamiltonian, ConstrainedHamiltonianSecondOrder, Constraints};
use costate::derivative::{Function, Hessian};
use costate::robot::Robot;
use costate::scalar::Scalar;
use costate_test_support::properties;
use costate_test_support::random_robot::{free_cases, tolerance};
use costate_test_support::rounding::close;
use nalgebra::DVector;
use num_dual::Dual64;
use proptest::prelude::*;

/// `(d, p) -> (F, mu)` at q (+) d.
struct Held<'a> {
    robot: &'a Robot,
    q: &'a [f64],
    u: &'a [f64],
    /// Number of rows.
    rows: usize,
}

impl Function for Held<'_> {
    type Workspace<S: Scalar> = ConstrainedHamiltonian<S>;
    type Error = EvalError;

    fn inputs(&self) -> usize {
        2 * self.u.len()
    }

    fn outputs(&self) -> usize {
        2 * self.u.len() + self.rows
    }

    fn workspace<S: Scalar>(&self) -> Self::Workspace<S> {
        ConstrainedHamiltonian::new(self.robot)
    }

    fn evaluate<S: Scalar>(
        &self,
        hamiltonian: &mut ConstrainedHamiltonian<S>,
        x: &[S],
        found: &mut [S],
    ) -> Result<(), EvalError> {
        let (d, p) = x.split_at(self.u.len());
        let u: Vec<S> = self.u.iter().map(|&u| S::from_f64(u)).collect();
        let rate = hamiltonian.evaluate(&retracted(self.robot, self.q, d), p, &u)?;
        let (f, mu) = found.split_at_mut(x.len());
        f.copy_from_slice(rate.f);
        mu.copy_from_slice(rate.mu);
        Ok(())
    }
}

properties! {
    48;

    #[test]
    fn derivatives_are_those_of_hyper_dual_numbers_through_the_retraction(
        case in free_cases(3),
        choices in choices(2),
    ) {
        let robot = closed(&case, &choices, true);
        let (n, q, u, y) = (case.n(), &case.q, &case.u, &case.y);
        let d: Vec<f64> = y.iter().map(|y| (5.0 * y).sin()).collect();
        let p: Vec<f64> = case.v.iter().zip(u).map(|(v, u)| v + 0.3 * u).collect();
        let of = Rounding::new(&robot, [q, &p, u, y, &d]);
        let mut ours = ConstrainedHamiltonianSecondOrder::<f64>::new(&robot);
        let all = ours.contract(q, &p, u, y).unwrap();
        let linear = all.linearisation();
        let rows = linear.mu().len();
        let found = DVector::from_vec([linear.f(), linear.mu()].concat());
        let (f_x, mu_x) = (linear.matrix().to_nalgebra(), linear.mu_x().to_nalgebra());
        let y_f_xx = all.matrix().to_nalgebra();
        let mut judge = Hessian::new(Held { robot: &robot, q, u, rows });
        let at = [vec![0.0; n], p.clone()].concat();
        let expected = judge.contract(&at, &[&y[..], &vec![0.0; rows]].concat()).unwrap();
        let expected = expected.view().to_nalgebra();
        let last = judge.last();
        let slopes = last.jacobian().view().to_nalgebra();
        close("F, mu", found.as_slice(), last.value(), of.f)?;
        close("F_x", f_x.as_slice(), slopes.rows(0, 2 * n).into_owned().as_slice(), of.f_x)?;
        close("mu_x", mu_x.as_slice(), slopes.rows(2 * n, rows).into_owned().as_slice(), of.f_x)?;
        close("y'F_xx", y_f_xx.as_slice(), expected.as_slice(), of.y_f_xx)?;
        // Products beside the matrices: entries of y and d are at most 1. lambda is the rate of mu.
        let terms = 2.0 * n as f64;
        let y = DVector::from_column_slice(y);
        let by_y = ours.first().adjoint(q, &p, u, y.as_slice()).unwrap().y_f_x;
        close("y'F_x", by_y, (f_x.transpose() * &y).as_slice(), terms * of.f_x)?;
        let product = ours.hessian_product(q, &p, y.as_slice(), &d).unwrap();
        let expected = &y_f_xx * DVector::from_column_slice(&d);
        close("y'F_xx d", product, expected.as_slice(), of.product.max(terms * of.y_f_xx))?;
        let linear = ours.first().linearise(q, &p, u).unwrap();
        close("F_x alone", linear.matrix().to_nalgebra().as_slice(), f_x.as_slice(), of.f_x)?;
        // Products with F, of which both factors are rounded.
        let f = found.rows(0, 2 * n);
        let bound = terms * (f.amax() * of.f_x + slopes.amax() * of.f);
        close("lambda", linear.lambda(), (&mu_x * f).as_slice(), bound)?;
        close("a", linear.acceleration(), (f_x.rows(0, n) * f).as_slice(), bound)?;
    }

    /// H_c and g along motions without friction; J is the derivative of g.
    #[test]
    fn energy_and_constraints_stay(case in free_cases(4), choices in choices(3)) {
        let robot = closed(&case, &choices, false);
        let (n, q) = (case.n(), &case.q);
        let bound = 10.0 * tolerance(&robot.without_constraints(), q) / independence(&robot, q).powi(2);
        let p: Vec<f64> = case.v.iter().zip(&case.u).map(|(v, u)| v + 0.3 * u).collect();
        let mut first = ConstrainedHamiltonian::<f64>::new(&robot);
        let f = first.evaluate(q, &p, &vec![0.0; n]).unwrap().f.to_vec();
        let step = retracted(&robot, q, &moving(&vec![0.0; n], &f[..n]));
        let mut along = ConstrainedHamiltonian::<Dual64>::new(&robot);
        let energy = along.energy(&step, &moving(&p, &f[n..])).unwrap();
        // The power of every force is lost to rounding alone.
        let power: f64 = f[..n].iter().zip(&f[n..]).map(|(v, rate)| (v * rate).abs()).sum();
        let change = (energy.kinetic + energy.potential).eps;
        prop_assert!(change.abs() <= bound * (1.0 + energy.kinetic.re + power), "{change:.1e}");
        let speed = f[..n].iter().fold(1.0, |most: f64, v| most.max(v.abs()));
        let far = q.iter().fold(1.0, |most: f64, q| most.max(q.abs()));
        // Distances are products of two arms.
        let far = far * far * speed;
        let still = along.constraints().values().iter().all(|g| g.eps.abs() <= bound * far);
        prop_assert!(still, "{:?}", along.constraints().values());
        let mut rows = Constraints::<Dual64>::new(&robot);
        rows.set_position(&retracted(&robot, q, &moving(&vec![0.0; n], &case.v))).unwrap();
        for (g, rate) in rows.values().iter().zip(first.constraint_rate(q, &case.v).unwrap()) {
            prop_assert!((g.eps - rate).abs() <= 1e-13 * far, "{g} {rate}");
        }
    }

    #[test]
    fn accelerations_and_forces_are_those_of_the_dense_equations(case in free_cases(5), choices in choices(3)) {
        are_those_of_the_dense_equations(&closed(&case, &choices, true), &case)?;
    }
}
