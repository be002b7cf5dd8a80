//! Identities of mass matrix, Jacobian, contracted Hessian and flow, each test named after its identity.

use costate::derivative::largest;
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::robot::{Robot, Tree};
use costate::scalar::{Count, Scalar, Tangent};
use costate_test_support::random_robot::{all_cases, cases};
use costate_test_support::rounding::{
    apart, bound, close, lift, moving, product, rows, terms, times, within,
};
use costate_test_support::{properties, rounding};
use proptest::prelude::*;

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
fn short_step(robot: &Robot, x: &[f64]) -> f64 {
    let (n, mut hamiltonian) = (robot.dof(), Hamiltonian::<f64>::new(robot));
    let f_x = hamiltonian.linearise(&x[..n], &x[n..], &vec![0.0; n]).unwrap().matrix().to_nalgebra();
    let eighth = (0..3).fold(f_x, |power, _| &power * &power);
    let rate = largest(&eighth).powf(0.125).max(1.0);
    0.004 / rate
}

/// Steps of one trajectory.
const STEPS: usize = 20;

/// Of a method of fourth order: by how much the error of a step exceeds the change by half of the step, 16 /
/// 15, and as much for higher orders.
const ERROR: f64 = 2.0;

/// Where x goes in so many steps, and the variational matrix along it, row by row: S' = F_x S, S = 1 in the
/// beginning.
fn flow<S: Scalar>(robot: &Robot, x: &[f64], h: f64, steps: usize) -> (Vec<S>, Vec<S>) {
    let (n, states) = (robot.dof(), x.len());
    let (mut hamiltonian, rest) = (Hamiltonian::<S>::new(robot), vec![S::zero(); n]);
    let mut rate = |state: &Vec<S>| {
        let (x, s) = state.split_at(states);
        let linear = hamiltonian.linearise(&x[..n], &x[n..], &rest).unwrap();
        [linear.f(), &product(&rows(linear.matrix()), s, states)].concat()
    };
    let one = (0..states * states).map(|k| f64::from(u8::from(k % (states + 1) == 0)));
    let start = lift::<S>(&x.iter().copied().chain(one).collect::<Vec<_>>());
    let mut end =
        (0..steps).fold(start, |state, _| runge_kutta(&state, h, &mut rate, &|x, h, f| moved(x, h, f)));
    let s = end.split_off(states);
    (end, s)
}

/// `x + h f`.
fn moved<S: Scalar>(x: &[S], h: f64, f: &[S]) -> Vec<S> {
    x.iter().zip(f).map(|(&x, f)| x + f.times(h)).collect()
}

/// Derivative along d of where x goes, by dual numbers through F and the same steps.
fn flow_derivative<S: Scalar>(robot: &Robot, x: &[f64], d: &[S], h: f64) -> Vec<S> {
    let n = robot.dof();
    let mut hamiltonian = Hamiltonian::<Tangent<S>>::new(robot);
    let rest = vec![Tangent::new(S::zero(), S::zero()); n];
    let mut rate = |x: &Vec<Tangent<S>>| hamiltonian.evaluate(&x[..n], &x[n..], &rest).unwrap().to_vec();
    let start = moving(&lift::<S>(x), d);
    let end = (0..STEPS).fold(start, |state, _| runge_kutta(&state, h, &mut rate, &|x, h, f| moved(x, h, f)));
    end.iter().map(|x| x.eps).collect()
}

/// `S'JS - J` of a matrix row by row.
fn symplectic_defect<S: Scalar>(s: &[S], n: usize) -> Vec<S> {
    let at = |i: usize, k: usize| s[2 * n * i + k];
    let entry = |k: usize, l: usize| {
        let j = f64::from(u8::from(k + n == l)) - f64::from(u8::from(l + n == k));
        let add = |sum: S, i: usize| sum + at(i, k) * at(n + i, l) - at(n + i, k) * at(i, l);
        (0..n).fold(S::from_f64(-j), add)
    };
    (0..4 * n * n).map(|k| entry(k / (2 * n), k % (2 * n))).collect()
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
        let (p, mut hamiltonian) = (case.p(&robot), Hamiltonian::<f64>::new(&robot));
        let f_x = hamiltonian.linearise(&case.q, &p, &vec![0.0; case.n()]).unwrap().matrix().to_nalgebra();
        let (size, square) = (f_x.abs(), &f_x * &f_x);
        let (mut power, mut size_of_power) = (f_x.clone(), size.clone());
        for k in 0..case.n() {
            let odd = 2 * k + 1;
            // So many products, and the trace, of sums of 2n terms each.
            let bound = terms(2 * case.n() * odd, &[size_of_power.trace()]);
            close(&format!("trace of power {odd}"), &[power.trace()], &[0.0], bound)?;
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
    /// Runge-Kutta method, twenty steps of 0.004 of the fastest time constant.
    #[test]
    fn flow_is_symplectic(case in cases(4)) {
        let (robot, n) = (case.robot().without_friction(), case.n());
        let x = case.x(&robot);
        let h = short_step(&robot, &x);
        let (_, s) = flow::<f64>(&robot, &x, h, STEPS);
        let (_, finer) = flow::<f64>(&robot, &x, 0.5 * h, 2 * STEPS);
        let (_, rounded) = flow::<Count>(&robot, &x, h, STEPS);
        // An error E of S changes S'JS by E'JS + S'JE, sums of 2n terms each.
        let of_steps = ERROR * 4.0 * n as f64 * largest(&apart(&s, &finer)) * largest(&s);
        let bound = of_steps + bound(&symplectic_defect(&rounded, n));
        within("S'JS - J", &symplectic_defect(&s, n), bound)?;
    }

    /// The variational matrix is the derivative of the flow: both by the same steps, so that only rounding is
    /// between them.
    #[test]
    fn variational_matrix_is_the_derivative_of_the_flow(case in cases(4)) {
        let robot = case.robot();
        let x = case.x(&robot);
        let h = short_step(&robot, &x);
        rounding!(|S| {
            let (y, (_, s)) = (lift::<S>(&case.y), flow::<S>(&robot, &x, h, STEPS));
            vec![("S y", apart(&times(&s, &y), &flow_derivative(&robot, &x, &y, h)))]
        })?;
    }

    /// `H(x(t)) = H(x(0))` when nothing drives and nothing rubs, to the accuracy of the steps.
    #[test]
    fn energy_is_constant_along_the_flow(case in cases(6)) {
        fn drift<S: Scalar>(robot: &Robot, x: &[f64], end: &[S]) -> S {
            let (n, mut hamiltonian) = (robot.dof(), Hamiltonian::<S>::new(robot));
            let mut energy = |x: &[S]| {
                let energy = hamiltonian.energy(&x[..n], &x[n..]).unwrap();
                energy.kinetic + energy.potential
            };
            energy(end) - energy(&lift(x))
        }
        let (robot, n) = (case.robot().without_friction(), case.n());
        let x = case.x(&robot);
        let h = short_step(&robot, &x);
        let end = flow::<f64>(&robot, &x, h, STEPS).0;
        let finer = flow::<f64>(&robot, &x, 0.5 * h, 2 * STEPS).0;
        let rounded = flow::<Count>(&robot, &x, h, STEPS).0;
        // An error e of the end changes H by H_x e; the entries of H_x are those of F. Not the drifts at two
        // steps are compared, whose leading terms cancel in linear systems, but the terms of H_x e.
        let f = Hamiltonian::<f64>::new(&robot).evaluate(&end[..n], &end[n..], &vec![0.0; n]).unwrap().to_vec();
        let slopes = f.iter().map(|f| f.abs()).sum::<f64>();
        let of_steps = ERROR * slopes * largest(&apart(&end, &finer));
        within("drift of H", &[drift(&robot, &x, &end)], of_steps + bound(&[drift::<Count>(&robot, &x, &rounded)]))?;
    }
}
