//! Orders of convergence, and a scheme against another way to write it.

use super::derivatives::{by_numbers, by_scheme, filled};
use super::{flat, off, robot};
use costate::derivative::{Function, largest};
use costate::dynamics::{Automatic, Contraction, Dynamics, Linearisation, Structure};
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::LagrangianSecondOrder;
use costate::matrix::Matrix;
use costate::robot::Robot;
use costate::scalar::Scalar;
use costate::step::{
    AutomaticStep, Classical, ImplicitMidpoint, Midpoint, ModelFamily, RungeKutta4, Scheme,
    SemiImplicitEuler, Step, StoermerVerlet, Verlet,
};
use std::convert::Infallible;

/// Where a step ends after a second in equal parts.
fn after_a_second<S: Step<f64>>(mut step: S, x: &[f64], u: &[f64], parts: usize) -> Vec<f64> {
    let mut x = x.to_vec();
    for _ in 0..parts {
        x = step.evaluate(&x, u, 1.0 / parts as f64).unwrap().to_vec();
    }
    x
}

/// The order that the error of half the step shows, `log2(error(h) / error(h / 2))`.
fn order<S: Step<f64>>(step: impl Fn() -> S, x: &[f64], u: &[f64], parts: usize, exact: &[f64]) -> f64 {
    let error = |parts| {
        let end = after_a_second(step(), x, u, parts);
        largest(&end.iter().zip(exact).map(|(a, b)| a - b).collect::<Vec<_>>())
    };
    (error(parts) / error(2 * parts)).log2()
}

/// A robot with friction, springs and weight under constant u.
fn rough() -> Robot {
    let joint = |name: &str, rest: &str| {
        format!(
            "[[joint]]\nname = '{name}'\nmass = 2.0\ncom = [0.3, 0.1, 0.0]\ninertia = {{ xx = 0.1, yy = 0.2, zz = 0.25 }}\n\
             friction = {{ viscous = 0.4, coulomb = 0.5, coulomb_velocity = 1.5 }}\n\
             spring = {{ stiffness = 3.0, rest = 0.5 }}\n{rest}\n"
        )
    };
    let text = [
        "name = 'rough'\n".into(),
        joint("a", "axis = [0.0, 1.0, 0.0]"),
        joint("b", "placement = { xyz = [0.4, 0.0, 0.1], rpy = [0.3, -0.2, 1.0] }"),
    ];
    costate::robot::file::parse(&text.concat(), Default::default()).unwrap()
}

#[test]
fn orders_of_convergence_are_those_of_the_schemes() {
    for robot in [rough(), robot("two_link.toml")] {
        let (q, v, u) = ([0.3, -0.8], [1.0, 0.5], [0.4, -0.2]);
        let p = Hamiltonian::<f64>::new(&robot).momentum(&q, &v).unwrap().to_vec();
        let (x, z) = ([&q[..], &p].concat(), [q, v].concat());
        let momenta = || HamiltonianSecondOrder::<f64>::new(&robot);
        let velocities = || LagrangianSecondOrder::<f64>::new(&robot);
        let exact_x = after_a_second(RungeKutta4::new(momenta()), &x, &u, 4000);
        let exact_z = after_a_second(RungeKutta4::new(velocities()), &z, &u, 4000);
        let found = [
            (4.0, order(|| RungeKutta4::new(momenta()), &x, &u, 100, &exact_x)),
            (4.0, order(|| RungeKutta4::new(velocities()), &z, &u, 100, &exact_z)),
            (1.0, order(|| SemiImplicitEuler::new(velocities()), &z, &u, 800, &exact_z)),
            (2.0, order(|| StoermerVerlet::new(momenta()), &x, &u, 200, &exact_x)),
            (2.0, order(|| ImplicitMidpoint::new(momenta()), &x, &u, 200, &exact_x)),
            (2.0, order(|| ImplicitMidpoint::new(velocities()), &z, &u, 200, &exact_z)),
        ];
        for (expected, found) in found {
            assert!((found - expected).abs() < 0.1, "{}: {expected} {found}", robot.name());
        }
    }
}

/// A driven pendulum with drag, nonlinear in u: x = (angle, rate).
#[derive(Clone)]
struct Pendulum;

fn pendulum<S: Scalar>(x: [S; 2], u: S) -> [S; 2] {
    let (sin, cos) = x[0].sin_cos();
    [x[1], u * u * cos + u.times(0.3) - (x[1] * x[1]).times(0.2) - sin.times(9.81)]
}

impl Function for Pendulum {
    type Workspace<S: Scalar> = ();
    type Error = Infallible;
    fn inputs(&self) -> usize {
        3
    }
    fn outputs(&self) -> usize {
        2
    }
    fn workspace<S: Scalar>(&self) {}
    fn evaluate<S: Scalar>(&self, (): &mut (), z: &[S], f: &mut [S]) -> Result<(), Infallible> {
        f.copy_from_slice(&pendulum([z[0], z[1]], z[2]));
        Ok(())
    }
}

/// One classical step of it, written by hand.
#[derive(Clone)]
struct HandWritten;

impl Function for HandWritten {
    type Workspace<S: Scalar> = ();
    type Error = Infallible;
    fn inputs(&self) -> usize {
        4
    }
    fn outputs(&self) -> usize {
        2
    }
    fn workspace<S: Scalar>(&self) {}
    fn evaluate<S: Scalar>(&self, (): &mut (), z: &[S], next: &mut [S]) -> Result<(), Infallible> {
        let ([x, v, u, h], f) = ([z[0], z[1], z[2], z[3]], pendulum::<S>);
        let ahead = |k: [S; 2], a: f64| [x + h.times(a) * k[0], v + h.times(a) * k[1]];
        let k1 = f([x, v], u);
        let k2 = f(ahead(k1, 0.5), u);
        let k3 = f(ahead(k2, 0.5), u);
        let k4 = f(ahead(k3, 1.0), u);
        for i in 0..2 {
            let sum = k1[i] + (k2[i] + k3[i]).times(2.0) + k4[i];
            next[i] = z[i] + (h * sum).times(1.0 / 6.0);
        }
        Ok(())
    }
}

#[test]
fn a_hand_written_step_is_that_of_the_scheme() {
    let mut by_hand: AutomaticStep<_> = AutomaticStep::new(HandWritten);
    let mut scheme = RungeKutta4::new(Automatic::<_, f64>::new(Pendulum));
    assert_eq!((by_hand.states(), by_hand.controls()), (scheme.states(), scheme.controls()));
    let (x, u, h, y) = ([0.7, -1.2], [0.9], 0.1, [0.4, -0.8]);
    let found = scheme.contract(&x, &u, h, &y).unwrap();
    let expected = by_hand.contract(&x, &u, h, &y).unwrap();
    let agree = |a: &[f64], b: &[f64]| assert!(off(a, b, 0.0) < 1e-14, "{a:?} {b:?}");
    agree(found.first.next, expected.first.next);
    agree(found.first.phi_h, expected.first.phi_h);
    agree(&flat(found.first.phi_x), &flat(expected.first.phi_x));
    agree(&flat(found.first.phi_u), &flat(expected.first.phi_u));
    agree(&flat(found.xx), &flat(expected.xx));
    agree(&filled(found.ux, 1, 2), &filled(expected.ux, 1, 2));
    agree(&filled(found.uu, 1, 1), &filled(expected.uu, 1, 1));
    assert!(largest(&filled(found.uu, 1, 1)) > 1e-3);
    let linear = by_hand.linearise(&x, &u, h).unwrap();
    agree(&flat(linear.phi_u), &flat(scheme.linearise(&x, &u, h).unwrap().phi_u));
    agree(by_hand.evaluate(&x, &u, h).unwrap(), scheme.evaluate(&x, &u, h).unwrap());
}

/// The same pendulum with its derivatives by hand, for every scalar.
struct ByHand<S> {
    f: Vec<S>,
    f_x: Matrix<S>,
    f_u: Matrix<S>,
    second: [Matrix<S>; 3],
}

impl<S: Scalar> Dynamics<S> for ByHand<S> {
    type Error = Infallible;

    fn states(&self) -> usize {
        2
    }

    fn controls(&self) -> usize {
        1
    }

    fn structure(&self) -> Structure {
        Structure { constant_f_u: false, affine_in_u: false, f_u_depends_on: 1 }
    }

    fn evaluate(&mut self, x: &[S], u: &[S]) -> Result<&[S], Infallible> {
        self.f.copy_from_slice(&pendulum([x[0], x[1]], u[0]));
        Ok(&self.f)
    }

    fn linearise(&mut self, x: &[S], u: &[S]) -> Result<Linearisation<'_, S>, Infallible> {
        self.evaluate(x, u)?;
        let (sin, cos) = x[0].sin_cos();
        (self.f_x[(0, 1)], self.f_x[(1, 0)]) = (S::one(), -(u[0] * u[0] * sin) - cos.times(9.81));
        self.f_x[(1, 1)] = x[1].times(-0.4);
        self.f_u[(1, 0)] = (u[0] * cos).times(2.0).plus(0.3);
        Ok(Linearisation { f: &self.f, f_x: self.f_x.view(), f_u: self.f_u.view() })
    }

    fn contract(&mut self, x: &[S], u: &[S], y: &[S]) -> Result<Contraction<'_, S>, Infallible> {
        self.linearise(x, u)?;
        let (sin, cos) = x[0].sin_cos();
        let [xx, ux, uu] = &mut self.second;
        (xx[(0, 0)], xx[(1, 1)]) = (y[1] * (sin.times(9.81) - u[0] * u[0] * cos), y[1].times(-0.4));
        ux[(0, 0)] = (y[1] * u[0] * sin).times(-2.0);
        uu[(0, 0)] = (y[1] * cos).times(2.0);
        let first = Linearisation { f: &self.f, f_x: self.f_x.view(), f_u: self.f_u.view() };
        Ok(Contraction { first, xx: xx.view(), ux: Some(ux.view()), uu: Some(uu.view()) })
    }
}

#[derive(Clone)]
struct Pendulums;

impl ModelFamily for Pendulums {
    type Error = Infallible;
    type Model<S: Scalar> = ByHand<S>;
    fn model<S: Scalar>(&self) -> ByHand<S> {
        let zeros = Matrix::zeros;
        let second = [zeros(2, 2), zeros(1, 1), zeros(1, 1)];
        ByHand { f: vec![S::zero(); 2], f_x: zeros(2, 2), f_u: zeros(2, 1), second }
    }
}

/// A model that is not affine in u, f_u of which depends on part of the state.
#[test]
fn every_scheme_knows_models_that_are_not_affine_in_u() {
    fn off_most<M: Scheme<Pendulums>>() -> f64 {
        let z = (&[0.7, -1.2][..], &[0.9][..], &[0.4, -0.8][..], 0.1);
        let found = by_scheme::<_, M, f64>(&Pendulums, z).unwrap();
        let expected = by_numbers::<_, M, f64>(&Pendulums, z).unwrap();
        let all = found.iter().zip(&expected).map(|(found, expected)| off(found, expected, 0.0));
        all.fold(0.0, f64::max)
    }
    let all = [off_most::<Classical>(), off_most::<Verlet>(), off_most::<Midpoint>()];
    assert!(largest(&all) < 1e-13, "{all:?}");
}
