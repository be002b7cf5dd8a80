//! Steps against automatic differentiation through q (+) d, and their orders.

use super::*;
use crate::configuration::samples::{robots, state};
use crate::step::{ImplicitMidpoint, RungeKutta4, StoermerVerlet};
use nalgebra::DMatrix;
use num_dual::HyperDual64;

/// So short (s) that the first stage decides: random trees are far from well conditioned.
const STEP: f64 = 0.01;

/// Phi of dual numbers by a scheme of the robot.
type Dual<'a> = &'a mut dyn FnMut(&[HyperDual64], &[HyperDual64]) -> Vec<HyperDual64>;

fn lifted(numbers: &[f64]) -> Vec<HyperDual64> {
    numbers.iter().map(|&number| HyperDual64::from_re(number)).collect()
}

/// phi by two of its arguments and its second derivative, by hyper-dual numbers.
fn check<P: Step<f64, Error = StepError<EvalError>>>(
    robot: &Robot,
    step: &mut FreeStep<f64, P>,
    dual: Dual<'_>,
) {
    let space = ConfigurationSpace::new(robot);
    let ([q, w, u, _], n) = (state(&space), robot.dof());
    let x = [&q[..], &w].concat();
    let (h, nq) = (STEP, robot.nq());
    let y: Vec<f64> = (0..2 * n).map(|i| (2.0 + 1.7 * i as f64).sin()).collect();
    let next = step.evaluate(&x, &u, h).unwrap().to_vec();
    space.check(&next[..nq]).unwrap();
    let all = step.contract(&x, &u, h, &y).unwrap();
    assert_eq!(all.first.next, next);
    let (mut jacobian, mut hessian) = (DMatrix::zeros(2 * n, 3 * n), vec![0.0; 9 * n * n]);
    let blocks = [all.first.phi_x.to_nalgebra(), all.first.phi_u.to_nalgebra()];
    jacobian.columns_mut(0, 2 * n).copy_from(&blocks[0]);
    jacobian.columns_mut(2 * n, n).copy_from(&blocks[1]);
    all.hessian(&mut hessian);
    let hessian = DMatrix::from_row_slice(3 * n, 3 * n, &hessian);
    let linear = step.linearise(&x, &u, h).unwrap();
    let error = (linear.phi_x.to_nalgebra() - &blocks[0]).amax() / blocks[0].amax();
    assert!(error < 1e-10, "{}: {error:.1e}", robot.name());
    let (mut first, mut second) = (DMatrix::zeros(2 * n, 3 * n), DMatrix::zeros(3 * n, 3 * n));
    let base = lifted(&next[..nq]);
    for (i, j) in (0..3 * n).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        let mut z = lifted(&vec![0.0; 3 * n]);
        z[i].eps1 = 1.0;
        z[j].eps2 = 1.0;
        let mut at = lifted(&x);
        let mut moved = lifted(&q);
        space.integrate(&lifted(&q), &z[..n], &mut moved).unwrap();
        at[..nq].copy_from_slice(&moved);
        at[nq..].iter_mut().zip(&z[n..]).for_each(|(w, e)| *w += *e);
        let tau: Vec<HyperDual64> = u.iter().zip(&z[2 * n..]).map(|(&u, e)| *e + u).collect();
        let found = dual(&at, &tau);
        let mut phi = lifted(&vec![0.0; n]);
        space.difference(&base, &found[..nq], &mut phi).unwrap();
        phi.extend_from_slice(&found[nq..]);
        for (k, phi) in phi.iter().enumerate() {
            first[(k, i)] = phi.eps1;
        }
        second[(i, j)] = phi.iter().zip(&y).map(|(phi, y)| y * phi.eps1eps2).sum();
        second[(j, i)] = second[(i, j)];
    }
    for (found, expected) in [(&jacobian, &first), (&hessian, &second)] {
        let error = (found - expected).amax() / expected.amax().max(1.0);
        assert!(error < 1e-10, "{}: {error:.1e}", robot.name());
    }
}

/// A scheme, in numbers and in hyper-dual ones, against each other.
macro_rules! agrees {
    ($robot:expr, $space:ident, $scheme:ident) => {{
        let mut dual = FreeStep::$space($robot, $scheme::<HyperDual64, _>::new);
        let h = HyperDual64::from_re(STEP);
        let mut at = |x: &[HyperDual64], u: &[HyperDual64]| dual.evaluate(x, u, h).unwrap().to_vec();
        check($robot, &mut FreeStep::$space($robot, $scheme::new), &mut at);
    }};
}

#[test]
fn derivatives_are_those_of_hyper_dual_numbers_through_the_retraction() {
    for robot in robots() {
        agrees!(&robot, in_momenta, RungeKutta4);
        agrees!(&robot, in_rates, RungeKutta4);
    }
}

/// The iterations of implicit schemes take long in hyper-dual numbers: trees of up to 15 degrees of freedom.
#[test]
fn derivatives_of_implicit_schemes_are_those_through_their_iterations() {
    for robot in robots().iter().take(4) {
        agrees!(robot, in_momenta, ImplicitMidpoint);
        agrees!(robot, in_momenta, StoermerVerlet);
        agrees!(robot, in_rates, ImplicitMidpoint);
    }
}

type Plain = Box<dyn Step<f64, Error = StepError<EvalError>>>;

/// Half of the step has 2^-order of the error.
#[test]
fn steps_have_the_order_of_their_scheme() {
    let robot = robots().remove(1);
    let space = ConfigurationSpace::new(&robot);
    let ([q, w, u, _], n, nq) = (state(&space), robot.dof(), robot.nq());
    let x = [&q[..], &w].concat();
    let run = |step: &mut FreeStep<f64, Plain>, steps: usize| {
        let mut x = x.clone();
        for _ in 0..steps {
            x = step.evaluate(&x, &u, 0.1 / steps as f64).unwrap().to_vec();
        }
        x
    };
    macro_rules! boxed {
        ($space:ident, $scheme:ident) => {
            FreeStep::$space(&robot, |model| Box::new($scheme::new(model)) as Plain)
        };
    }
    let in_momenta = run(&mut boxed!(in_momenta, RungeKutta4), 512);
    let in_rates = run(&mut boxed!(in_rates, RungeKutta4), 512);
    for (mut step, exact, order) in [
        (boxed!(in_momenta, StoermerVerlet), &in_momenta, 2),
        (boxed!(in_momenta, ImplicitMidpoint), &in_momenta, 2),
        (boxed!(in_momenta, RungeKutta4), &in_momenta, 4),
        (boxed!(in_rates, ImplicitMidpoint), &in_rates, 2),
        (boxed!(in_rates, RungeKutta4), &in_rates, 4),
    ] {
        let errors = [16, 32].map(|steps| {
            let found = run(&mut step, steps);
            let mut d = vec![0.0; n];
            space.difference(&exact[..nq], &found[..nq], &mut d).unwrap();
            let off = found[nq..].iter().zip(&exact[nq..]).map(|(a, b)| a - b);
            d.into_iter().chain(off).map(f64::abs).fold(0.0, f64::max)
        });
        let measured = (errors[0] / errors[1]).log2();
        assert!((measured - f64::from(order)).abs() < 0.4, "{order}: {measured} {errors:?}");
    }
}

#[test]
fn what_is_not_a_state_is_refused() {
    let robot = robots().remove(1);
    let [q, w, u, _] = state(&ConfigurationSpace::new(&robot));
    let mut x = [&q[..], &w].concat();
    let mut step = FreeStep::in_momenta(&robot, RungeKutta4::<f64, _>::new);
    assert_eq!((step.nq(), step.dof()), (robot.nq(), robot.dof()));
    let wrong = step.contract(&x, &u, 0.1, &x).unwrap_err();
    assert!(matches!(wrong, StepError::WrongLength(_)), "{wrong}");
    assert!(matches!(step.evaluate(&x, &u, f64::NAN), Err(StepError::NonFiniteDuration)));
    let at = robot.free_joints()[0].quaternion();
    x[at..at + 4].iter_mut().for_each(|entry| *entry *= 1.1);
    let wrong = step.linearise(&x, &u, 0.1).unwrap_err();
    assert!(matches!(wrong, StepError::Dynamics(EvalError::NotUnit { .. })), "{wrong}");
}
