//! What schemes keep: the symplectic form, reversibility, rest, the identity.

use super::{FREE, SWING, flat, off, robot, solved};
use costate::derivative::largest;
use costate::dynamics::Dynamics;
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::robot::{JointSpec, LinkInertia, Placement, Robot};
use costate::scalar::Scalar;
use costate::step::{
    HamiltonianRobot, ImplicitMidpoint, LagrangianRobot, Midpoint, ModelFamily, RungeKutta4, Scheme,
    SemiImplicitEuler, Step, StoermerVerlet, Verlet,
};
use costate_test_support::random_robot::{Case, cases};
use costate_test_support::rounding::{apart, close, lift, terms};
use costate_test_support::{properties, rounding};
use nalgebra::DMatrix;
use proptest::prelude::*;

fn without_friction(mut case: Case) -> Case {
    case.parts.iter_mut().for_each(|part| part.friction = [0.0, 0.0, 0.1]);
    case
}

/// Largest entry of `Phi_x' J Phi_x - J` relative to that of `|Phi_x|' |J| |Phi_x|`.
fn defect(phi_x: &DMatrix<f64>) -> f64 {
    let n = phi_x.nrows() / 2;
    let mut j = DMatrix::<f64>::zeros(2 * n, 2 * n);
    for i in 0..n {
        (j[(i, n + i)], j[(n + i, i)]) = (1.0, -1.0);
    }
    let size = phi_x.abs().transpose() * j.abs() * phi_x.abs();
    largest((phi_x.transpose() * &j * phi_x - &j).iter()) / largest(size.iter())
}

fn is_symplectic<M: Scheme<HamiltonianRobot>>(case: &Case, robot: &Robot) -> Result<(), TestCaseError> {
    let (family, x) = (HamiltonianRobot::from(robot), case.x(robot));
    solved::<_, M>(&family, [&x, &case.u], 0.02)?;
    rounding!(|S| {
        let mut step = M::step::<S>(family.model());
        let linear = step.linearise(&lift(&x), &lift(&case.u), S::from_f64(0.02)).unwrap();
        let (n, phi_x) = (case.n(), |i: usize, k: usize| linear.phi_x.row(i)[k]);
        let entry = |k: usize, l: usize| {
            let j = f64::from(u8::from(k + n == l)) - f64::from(u8::from(l + n == k));
            let add = |sum: S, i: usize| sum + phi_x(i, k) * phi_x(n + i, l) - phi_x(n + i, k) * phi_x(i, l);
            (0..n).fold(S::from_f64(-j), add)
        };
        vec![("Phi_x' J Phi_x - J", (0..4 * n * n).map(|k| entry(k / (2 * n), k % (2 * n))).collect())]
    })
}

/// A step of negative duration after one of positive duration leads back.
fn is_symmetric<F: ModelFamily, M: Scheme<F>>(
    case: &Case,
    family: &F,
    x: &[f64],
) -> Result<(), TestCaseError> {
    let there = solved::<_, M>(family, [x, &case.u], 0.005)?;
    let back = solved::<_, M>(family, [&there, &case.u], -0.005)?;
    // Friction drives in a step of negative duration: its equations may have several solutions, all of which
    // lead there, and Newton's method finds one of them.
    if off(&back, x, 1.0) > 1e-6 && off(&solved::<_, M>(family, [&back, &case.u], 0.005)?, &there, 1.0) < 1e-9
    {
        return Err(TestCaseError::reject("the step back has several solutions"));
    }
    rounding!(|S| {
        let (mut step, x, u) = (M::step::<S>(family.model()), lift::<S>(x), lift::<S>(&case.u));
        let there = step.evaluate(&x, &u, S::from_f64(0.005)).unwrap().to_vec();
        vec![("there and back", apart(step.evaluate(&there, &u, S::from_f64(-0.005)).unwrap(), &x))]
    })
}

properties! {
    64;

    #[test]
    fn verlet_and_midpoint_are_symplectic(case in cases(6).prop_map(without_friction)) {
        let robot = case.robot();
        is_symplectic::<Verlet>(&case, &robot)?;
        is_symplectic::<Midpoint>(&case, &robot)?;
    }

    #[test]
    fn a_negative_step_undoes_a_symmetric_one(case in cases(6)) {
        let robot = case.robot();
        let (momenta, velocities) = (HamiltonianRobot::from(&robot), LagrangianRobot::from(&robot));
        let z = [case.q.as_slice(), &case.v].concat();
        is_symmetric::<_, Verlet>(&case, &momenta, &case.x(&robot))?;
        is_symmetric::<_, Midpoint>(&case, &momenta, &case.x(&robot))?;
        is_symmetric::<_, Midpoint>(&case, &velocities, &z)?;
    }

    /// Reversed momenta retrace the path: `R Phi R Phi = 1` with R = (1, -1).
    #[test]
    fn verlet_is_reversible(case in cases(6).prop_map(without_friction)) {
        let robot = case.robot();
        let (family, x, n) = (HamiltonianRobot::from(&robot), case.x(&robot), case.n());
        fn turned<S: Scalar>(x: &[S], n: usize) -> Vec<S> {
            x[..n].iter().copied().chain(x[n..].iter().map(|&p| -p)).collect()
        }
        let there = solved::<_, Verlet>(&family, [&x, &case.u], 0.01)?;
        solved::<_, Verlet>(&family, [&turned(&there, n), &case.u], 0.01)?;
        rounding!(|S| {
            let mut step = StoermerVerlet::new(HamiltonianSecondOrder::<S>::new(&robot));
            let (x, u, h) = (lift::<S>(&x), lift::<S>(&case.u), S::from_f64(0.01));
            let there = turned(step.evaluate(&x, &u, h).unwrap(), n);
            let back = turned(step.evaluate(&there, &u, h).unwrap(), n);
            vec![("there and back", apart(&back, &x))]
        })?;
    }

    /// h = 0: Phi = x, Phi_x = 1, Phi_u = 0, Phi_h = f, no second derivatives.
    #[test]
    fn no_time_changes_nothing(case in cases(6)) {
        let robot = case.robot();
        let (x, u, y) = (case.x(&robot), &case.u, &case.y);
        let f = Hamiltonian::<f64>::new(&robot).evaluate(&case.q, &x[case.n()..], u).unwrap().to_vec();
        let model = || HamiltonianSecondOrder::<f64>::new(&robot);
        let (mut a, mut b, mut c) = (RungeKutta4::new(model()), StoermerVerlet::new(model()), ImplicitMidpoint::new(model()));
        let all = [a.contract(&x, u, 0.0, y).unwrap(), b.contract(&x, u, 0.0, y).unwrap(), c.contract(&x, u, 0.0, y).unwrap()];
        for step in all {
            prop_assert_eq!(step.first.next, &x[..]);
            prop_assert_eq!(step.first.phi_x.to_nalgebra(), DMatrix::identity(x.len(), x.len()));
            // A mean of stages that are all f: at most four products with weights and as many sums.
            close("Phi_h", step.first.phi_h, &f, terms(8, &[largest(&f)]))?;
            prop_assert!([Some(step.first.phi_u), Some(step.xx), step.ux, step.uu].iter().flatten().all(|block| largest(&flat(*block)) == 0.0));
        }
    }
}

/// RK4 and semi-implicit Euler do not keep the symplectic form of a robot whose mass matrix depends on q.
#[test]
fn explicit_schemes_are_not_symplectic() {
    let arm = robot("two_link.toml");
    let mut rk4 = RungeKutta4::new(HamiltonianSecondOrder::<f64>::new(&arm));
    let found = defect(&rk4.linearise(&SWING, &FREE, 0.5).unwrap().phi_x.to_nalgebra());
    assert!(found > 1e-6, "RK4: {found:.1e}");
    let mut hamiltonian = Hamiltonian::<f64>::new(&arm);
    let v = hamiltonian.velocity(&SWING[..2], &SWING[2..]).unwrap().to_vec();
    let z = [&SWING[..2], &v].concat();
    let mut euler = SemiImplicitEuler::new(LagrangianSecondOrder::<f64>::new(&arm));
    let first = euler.linearise(&z, &FREE, 0.5).unwrap();
    let mut legendre = |z: &[f64]| {
        let map = hamiltonian.linearise_momentum(&z[..2], &z[2..]).unwrap();
        let mut t = DMatrix::identity(4, 4);
        t.view_mut((2, 0), (2, 2)).copy_from(&map.dp_dq.view().as_nalgebra());
        t.view_mut((2, 2), (2, 2)).copy_from(&map.dp_dv.view().as_nalgebra());
        t
    };
    let mapped = legendre(first.next) * first.phi_x.as_nalgebra() * legendre(&z).try_inverse().unwrap();
    let found = defect(&mapped);
    assert!(found > 1e-3, "semi-implicit Euler: {found:.1e}");
}

/// A robot that its actuation holds against weight stays where it is; Newton's method sees it at once, and
/// looks once more.
#[test]
fn a_held_robot_stays() {
    for name in ["panda.urdf", "puma560.toml", "manutec_r3.toml"] {
        let robot = robot(name);
        let n = robot.dof();
        for q in [vec![0.0; n], vec![0.4; n]] {
            let hold = Lagrangian::<f64>::new(&robot).gravity(&q).unwrap().to_vec();
            let x = [q, vec![0.0; n]].concat();
            let mut verlet = StoermerVerlet::new(HamiltonianSecondOrder::<f64>::new(&robot));
            let next = verlet.evaluate(&x, &hold, 0.01).unwrap();
            assert!(off(next, &x, 1.0) < 1e-13, "{name}: {next:?}");
            assert!((2..=4).contains(&verlet.iterations()), "{name}");
            let mut midpoint = ImplicitMidpoint::new(LagrangianSecondOrder::<f64>::new(&robot));
            let next = midpoint.evaluate(&x, &hold, 0.01).unwrap();
            assert!(off(next, &x, 1.0) < 1e-13, "{name}: {next:?}");
            assert!((1..=2).contains(&midpoint.iterations()), "{name}");
            assert_eq!(midpoint.model_mut().states(), 2 * n);
        }
    }
}

/// The step of semi-implicit Euler has the zeros of its model, and stores none of them.
#[test]
fn what_is_zero_by_structure_is_not_stored() {
    let arm = robot("two_link.toml");
    let mut step = SemiImplicitEuler::new(LagrangianSecondOrder::<f64>::new(&arm));
    let second = step.contract(&[0.3, -0.8, 1.0, 0.5], &[0.2, 0.1], 0.01, &[0.4, -0.2, 0.7, 0.1]).unwrap();
    assert!(second.uu.is_none());
    assert_eq!(second.ux.map(|ux| (ux.rows(), ux.columns())), Some((2, 2)));
}

/// An arm that is lighter by a factor moves alike, its momenta lighter by the same: small states are solved
/// as far as others.
#[test]
fn steps_do_not_depend_on_the_unit_of_mass() {
    let arm = |scale: f64| {
        let link =
            || LinkInertia::about_com(scale, [0.3, 0.1, 0.0], nalgebra::Matrix3::identity() * (0.1 * scale));
        let upper = JointSpec::revolute("shoulder").carrying(link());
        let elbow = Placement::from_xyz_rpy([0.6, 0.0, 0.0], [0.0; 3]);
        let lower = JointSpec::revolute("elbow").on("shoulder").placed(elbow).carrying(link());
        Robot::builder("arm").joint(upper).joint(lower).build().unwrap()
    };
    let next = |scale: f64| {
        let model = HamiltonianSecondOrder::<f64>::new(&arm(scale));
        let (x, h) = ([0.3, -0.8, scale, 0.5 * scale], 0.02);
        let verlet = StoermerVerlet::new(model.clone()).evaluate(&x, &[0.0; 2], h).unwrap().to_vec();
        let midpoint = ImplicitMidpoint::new(model).evaluate(&x, &[0.0; 2], h).unwrap().to_vec();
        [verlet, midpoint].map(|mut next| {
            next[2..].iter_mut().for_each(|p| *p /= scale);
            next
        })
    };
    for scale in [1e-12, 1e-6, 1e6] {
        for (found, expected) in next(scale).iter().zip(&next(1.0)) {
            assert!(off(found, expected, 0.0) < 1e-14, "{scale:.0e}: {found:?} {expected:?}");
        }
    }
}
