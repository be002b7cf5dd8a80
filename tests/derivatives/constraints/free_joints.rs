//! Floating and spherical joints under constraints of all kinds: F, forces and their derivatives in the
//! tangent space.

use super::{are_those_of_the_dense_equations, choices, closed, constants_of_motion};
use crate::free_joints::retracted;
use costate::EvalError;
use costate::constraints::{ConstrainedHamiltonian, ConstrainedHamiltonianSecondOrder, Constraints};
use costate::derivative::{Function, Hessian, InnerNumber};
use costate::robot::Robot;
use costate::scalar::{Count, Scalar, Tangent};
use costate_test_support::random_robot::free_cases;
use costate_test_support::rounding::{
    apart, explained, lift, lift_rounded, moving, rows, times, transposed_times,
};
use costate_test_support::{properties, rounding};

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

/// (F, mu), its Jacobian, and y'F_xx.
type Derivatives<S> = [Vec<S>; 3];

/// By hyper-dual numbers.
fn reference<S: InnerNumber>(held: Held<'_>, p: &[f64], y: &[f64]) -> Derivatives<S> {
    let weights = lift::<S>(&[y, &vec![0.0; held.rows]].concat());
    let at = lift::<S>(&[&vec![0.0; p.len()][..], p].concat());
    let mut judge = Hessian::<_, S>::over(held);
    let y_f_xx = judge.contract(&at, &weights).unwrap().as_slice().to_vec();
    let last = judge.last();
    [last.value().to_vec(), last.jacobian().as_slice().to_vec(), y_f_xx]
}

/// By hand.
fn by_hand<S: Scalar>(robot: &Robot, [q, p, u, y]: [&[f64]; 4]) -> Derivatives<S> {
    let (q, [p, u, y]) = (lift_rounded::<S>(q), [p, u, y].map(lift::<S>));
    let mut ours = ConstrainedHamiltonianSecondOrder::<S>::new(robot);
    let all = ours.contract(&q, &p, &u, &y).unwrap();
    let linear = all.linearisation();
    let slopes = [rows(linear.matrix()), rows(linear.mu_x())].concat();
    [[linear.f(), linear.mu()].concat(), slopes, rows(all.matrix())]
}

properties! {
    48;

    #[test]
    fn derivatives_are_those_of_hyper_dual_numbers_through_the_retraction(
        case in free_cases(3),
        choices in choices(2),
    ) {
        let robot = closed(&case, &choices, true);
        let (q, u, y) = (&case.q, &case.u, &case.y);
        let p: Vec<f64> = case.v.iter().zip(u).map(|(v, u)| v + 0.3 * u).collect();
        let found = by_hand::<f64>(&robot, [q, &p, u, y]);
        let held = || Held { robot: &robot, q, u, rows: found[0].len() - 2 * case.n() };
        let expected = reference::<f64>(held(), &p, y);
        let of_hand = by_hand::<Count>(&robot, [q, &p, u, y]);
        explained(["F, mu", "F_x, mu_x", "y'F_xx"], [&found, &expected], &of_hand, || {
            Ok(reference::<Count>(held(), &p, y))
        })?;
    }

    /// Products beside the matrices, and what follows from them: lambda is the rate of mu, a that of v.
    #[test]
    fn products_are_those_with_the_matrices(case in free_cases(3), choices in choices(2)) {
        let robot = closed(&case, &choices, true);
        let n = case.n();
        rounding!(|S| {
            let (q, [v, u, y]) = (lift_rounded::<S>(&case.q), [&case.v[..], &case.u, &case.y].map(lift::<S>));
            let p: Vec<S> = v.iter().zip(&u).map(|(&v, u)| v + u.times(0.3)).collect();
            let d: Vec<S> = y.iter().map(|y| y.times(5.0).sin_cos().0).collect();
            let mut ours = ConstrainedHamiltonianSecondOrder::<S>::new(&robot);
            let by_y = ours.first().adjoint(&q, &p, &u, &y).unwrap().y_f_x.to_vec();
            let by_d = ours.hessian_product(&q, &p, &y, &d).unwrap().to_vec();
            let linear = ours.first().linearise(&q, &p, &u).unwrap();
            let (f, f_x, mu_x) = (linear.f().to_vec(), rows(linear.matrix()), rows(linear.mu_x()));
            let (lambda, a) = (linear.lambda().to_vec(), linear.acceleration().to_vec());
            let all = ours.contract(&q, &p, &u, &y).unwrap();
            vec![
                ("y'F_x", apart(&by_y, &transposed_times(&f_x, &y))),
                ("y'F_xx d", apart(&by_d, &times(&rows(all.matrix()), &d))),
                ("F_x alone", apart(&f_x, &rows(all.linearisation().matrix()))),
                ("lambda", apart(&lambda, &times(&mu_x, &f))),
                ("a", apart(&a, &times(&f_x[..2 * n * n], &f))),
            ]
        })?;
    }

    /// H_c and g along motions without friction; J is the derivative of g.
    #[test]
    fn energy_and_constraints_stay(case in free_cases(4), choices in choices(3)) {
        let robot = closed(&case, &choices, false);
        let p: Vec<f64> = case.v.iter().zip(&case.u).map(|(v, u)| v + 0.3 * u).collect();
        rounding!(|S| constants_of_motion(&robot, &case.q, &lift::<S>(&p)))?;
        rounding!(|S| {
            let (q, v) = (lift_rounded::<S>(&case.q), lift::<S>(&case.v));
            let rest = vec![S::zero(); v.len()];
            let mut first = ConstrainedHamiltonian::<S>::new(&robot);
            let mut rows = Constraints::<Tangent<S>>::new(&robot);
            rows.set_position(&retracted(&robot, &case.q, &moving(&rest, &v))).unwrap();
            let rates: Vec<S> = rows.values().iter().map(|g| g.eps).collect();
            vec![("J v - dg/dt", apart(first.constraint_rate(&q, &v).unwrap(), &rates))]
        })?;
    }

    #[test]
    fn accelerations_and_forces_are_those_of_the_dense_equations(case in free_cases(5), choices in choices(3)) {
        are_those_of_the_dense_equations(&closed(&case, &choices, true), &case)?;
    }
}
