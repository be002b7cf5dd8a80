//! Identities of mass matrix, Jacobian, contracted Hessian and flow, each test named after its identity.

use costate::derivative::largest;
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::robot::{Robot, Tree};
use costate::scalar::{Count, Scalar};
use costate_test_support::random_robot::{all_cases, cases, tolerance};
use costate_test_support::rounding::{bound, close, lift, rows, terms};
use costate_test_support::{properties, rounding};
use nalgebra::{DMatrix, DVector, Vector3};
use num_dual::Dual64;
use proptest::prelude::*;

/// `J = [0 1; -1 0]`.
fn j(n: usize) -> DMatrix<f64> {
    DMatrix::from_fn(2 * n, 2 * n, |i, j| f64::from(u8::from(i + n == j)) - f64::from(u8::from(j + n == i)))
}

fn jacobian(hamiltonian: &mut Hamiltonian<f64>, x: &[f64]) -> (DVector<f64>, DMatrix<f64>) {
    let n = hamiltonian.dof();
    let linear = hamiltonian.linearise(&x[..n], &x[n..], &vec![0.0; n]).unwrap();
    (DVector::from_column_slice(linear.f()), linear.matrix().to_nalgebra())
}

/// One step of the classical Runge-Kutta method.
fn runge_kutta<X: Clone>(
    x: &X,
    h: f64,
    rate: &mut dyn FnMut(&X) -> X,
    moved: &dyn Fn(&X, f64, &X) -> X,
) -> X {
    let first = rate(x);
    let second = rate(&moved(x, 0.5 * h, &first));
    let third = rate(&moved(x, 0.5 * h, &second));
    let fourth = rate(&moved(x, h, &third));
    let ends = moved(&moved(x, h / 6.0, &first), h / 6.0, &fourth);
    moved(&moved(&ends, h / 3.0, &second), h / 3.0, &third)
}

/// A time step that is short for every motion of the robot at x, from the size of high powers of F_x.
fn short_step(hamiltonian: &mut Hamiltonian<f64>, x: &[f64]) -> f64 {
    let f_x = jacobian(hamiltonian, x).1;
    let eighth = (0..3).fold(f_x, |power, _| &power * &power);
    let rate = largest(&eighth).powf(0.125).max(1.0);
    0.004 / rate
}

/// Steps of one trajectory.
const STEPS: usize = 20;

/// Where x goes in [`STEPS`] steps, and the variational matrix along it: S' = F_x S, S = 1 in the beginning.
fn flow(robot: &Robot, x: &[f64], h: f64) -> (DVector<f64>, DMatrix<f64>) {
    let mut hamiltonian = Hamiltonian::<f64>::new(robot);
    let mut rate = |(x, s): &(DVector<f64>, DMatrix<f64>)| {
        let (f, f_x) = jacobian(&mut hamiltonian, x.as_slice());
        (f, f_x * s)
    };
    let start = (DVector::from_column_slice(x), DMatrix::identity(x.len(), x.len()));
    (0..STEPS).fold(start, |state, _| {
        runge_kutta(&state, h, &mut rate, &|(x, s), h, (f, s_rate)| (x + f * h, s + s_rate * h))
    })
}

/// Derivative along d of where x goes, by dual numbers through F and the same steps.
fn flow_derivative(robot: &Robot, x: &[f64], d: &[f64], h: f64) -> Vec<f64> {
    let n = robot.dof();
    let mut hamiltonian = Hamiltonian::<Dual64>::new(robot);
    let rest = vec![Dual64::zero(); n];
    let mut rate = |x: &Vec<Dual64>| hamiltonian.evaluate(&x[..n], &x[n..], &rest).unwrap().to_vec();
    let start: Vec<_> = x.iter().zip(d).map(|(&x, &d)| Dual64::new(x, d)).collect();
    let end = (0..STEPS).fold(start, |state, _| {
        runge_kutta(&state, h, &mut rate, &|x, h, f| x.iter().zip(f).map(|(&x, &f)| x + f.times(h)).collect())
    });
    end.iter().map(|x| x.eps).collect()
}

/// Robots a property.
const CASES: u32 = 160;

properties! {
    CASES;

    /// `M_ij`, i <= j in tree order, depends on the joints beyond i alone; on different branches it is
    /// constant.
    #[test]
    fn mass_matrix_entries_do_not_depend_on_joints_before_them(
        case in all_cases(10),
        elsewhere in prop::collection::vec(-3.0..3.0, 10),
    ) {
        let case = case.all_independent();
        let (robot, n) = (case.robot(), case.n());
        let tree = Tree::from(&robot);
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        let m = hamiltonian.mass_matrix(&case.q).unwrap().view().to_nalgebra();
        let mut rounded = Hamiltonian::<Count>::new(&robot);
        let mut rounding = |q: &[f64]| bound(rounded.mass_matrix(&lift(q)).unwrap().as_slice());
        let of_m = rounding(&case.q);
        for i in 0..n {
            let beyond = &tree.subtree(i)[1..];
            let q: Vec<f64> = (0..n).map(|k| if beyond.contains(&k) { case.q[k] } else { elsewhere[k] }).collect();
            let (moved, of_moved) = (hamiltonian.mass_matrix(&q).unwrap(), rounding(&q));
            for &k in tree.subtree(i) {
                // Inertias about both axes are turned with the joints beyond, and turned back.
                let turned = terms(45, &[m[(i, i)].max(m[(k, k)])]);
                close(&format!("M[{i}][{k}]"), &[moved[(i, k)]], &[m[(i, k)]], of_m + of_moved + turned)?;
            }
            for k in (0..n).filter(|&k| !tree.subtree(i).contains(&k) && !tree.subtree(k).contains(&i)) {
                prop_assert_eq!(moved[(i, k)], robot.armature_entry(i, k));
            }
        }
    }

    /// The characteristic polynomial of F_x (no friction) is even: all odd powers of F_x have trace 0
    /// (Newton's identities).
    #[test]
    fn eigenvalues_of_the_jacobian_come_in_pairs_of_opposite_sign(case in cases(8)) {
        let robot = case.robot().without_friction();
        let x = case.x(&robot);
        let (_, f_x) = jacobian(&mut Hamiltonian::new(&robot), &x);
        let (size, square) = (f_x.abs(), &f_x * &f_x);
        let (mut power, mut size_of_power) = (f_x.clone(), size.clone());
        for k in 0..case.n() {
            let odd = 2 * k + 1;
            prop_assert!(power.trace().abs() <= 1e-13 * size_of_power.trace(), "trace of power {odd}");
            power = &power * &square;
            size_of_power = &size_of_power * &size * &size;
        }
    }

    #[test]
    fn contracted_hessian_is_symmetric_and_linear_in_the_costate(case in cases(10), scale in -3.0..3.0) {
        let robot = case.robot();
        rounding!(|S| {
            let [q, v, u, y] = [&case.q[..], &case.v, &case.u, &case.y].map(lift::<S>);
            let other: Vec<S> = y.iter().rev().map(|&y| S::one() - y).collect();
            let sum: Vec<S> = y.iter().zip(&other).map(|(&a, &b)| a + b.times(scale)).collect();
            let mut second = HamiltonianSecondOrder::<S>::new(&robot);
            let p = second.first().momentum(&q, &v).unwrap().to_vec();
            let mut of = |y: &[S]| rows(second.contract(&q, &p, &u, y).unwrap().matrix());
            let (h_one, h_other, h_sum) = (of(&y), of(&other), of(&sum));
            vec![("linear in y", (0..h_sum.len()).map(|k| h_one[k] + h_other[k].times(scale) - h_sum[k]).collect())]
        })?;
        let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
        let h = second.contract(&case.q, &case.p(&robot), &case.u, &case.y).unwrap().matrix().to_nalgebra();
        prop_assert_eq!(&h, &h.transpose());
    }

    /// `S'JS = J` for the variational matrix S along the flow (u = D = 0): S' = F_x S by the classical
    /// Runge-Kutta method, twenty steps of 0.004 of the fastest time constant, so that its error is about
    /// 1e-10.
    #[test]
    fn flow_is_symplectic(case in cases(4)) {
        let robot = case.robot().without_friction();
        let x = case.x(&robot);
        let h = short_step(&mut Hamiltonian::new(&robot), &x);
        let (_, s) = flow(&robot, &x, h);
        let j = j(case.n());
        let size = s.abs().transpose() * j.abs() * s.abs();
        let off = s.transpose() * &j * &s - &j;
        let rounding = 10.0 * tolerance(&robot, &case.q);
        prop_assert!(largest(&off) <= 1e-8_f64.max(rounding) * largest(&size), "{:.2e}", largest(&off) / largest(&size));
    }

    /// The variational matrix is the derivative of the flow: both by the same steps, so that only rounding is
    /// between them.
    #[test]
    fn variational_matrix_is_the_derivative_of_the_flow(case in cases(4)) {
        let robot = case.robot();
        let x = case.x(&robot);
        let h = short_step(&mut Hamiltonian::new(&robot), &x);
        let (_, s) = flow(&robot, &x, h);
        let expected = flow_derivative(&robot, &x, &case.y, h);
        let found = s.clone() * DVector::from_column_slice(&case.y);
        let size = s.abs() * DVector::from_column_slice(&case.y).abs();
        let off = largest(&(found - DVector::from_column_slice(&expected)));
        prop_assert!(off <= 10.0 * tolerance(&robot, &case.q) * largest(&size), "{:.2e}", off / largest(&size));
    }

    /// `H(x(t)) = H(x(0))` when nothing drives and nothing rubs, to the accuracy of the steps.
    #[test]
    fn energy_is_constant_along_the_flow(case in cases(6)) {
        let robot = case.robot().without_friction();
        let (x, n) = (case.x(&robot), case.n());
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        let h = short_step(&mut hamiltonian, &x);
        let (end, _) = flow(&robot, &x, h);
        let before = hamiltonian.energy(&x[..n], &x[n..]).unwrap();
        let after = hamiltonian.energy(&end.as_slice()[..n], &end.as_slice()[n..]).unwrap();
        let reach: f64 = case.parts.iter().map(|part| 1.0 + Vector3::from(part.xyz).norm()).sum();
        let weight: f64 = robot.joints().iter().map(|joint| joint.inertia.mass).sum::<f64>();
        let springs: f64 = case.parts.iter().map(|part| 20.0 * part.spring[0]).sum();
        let size = before.kinetic + after.kinetic + springs + weight * reach * largest(&case.gravity);
        let drift = (before.kinetic - after.kinetic) + (before.potential - after.potential);
        let rounding = 10.0 * tolerance(&robot, &case.q);
        prop_assert!(drift.abs() <= 1e-9_f64.max(rounding) * size.max(1e-3), "{:.2e}", drift / size);
    }
}
