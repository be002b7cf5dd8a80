//! Constraints of all kinds on random trees: F, F_x and y'F_xx against dual numbers through a dense version
//! of H_c, accelerations and forces in the dense equations of motion.

mod exceptions;
mod free_joints;
mod half_turns;
mod impacts;
mod poses;

use crate::free_joints::retracted;
use costate::configuration::FreeKinematics;
use costate::constraints::{ConstrainedHamiltonian, ConstrainedHamiltonianSecondOrder, Constraints};
use costate::kernels::KernelOne;
use costate::lagrangian::Lagrangian;
use costate::robot::{ConstraintFrame, ConstraintRow, ConstraintSpec, Placement, Robot, Tree};
use costate::scalar::{Scalar, Tangent};
use costate_test_support::random_robot::{Case, cases};
use costate_test_support::rounding::{
    Differences, apart, lift, lift_rounded, moving, rows, times, transposed_times,
};
use costate_test_support::{properties, rounding};
use nalgebra::{DMatrix, Matrix3, Vector3};
use proptest::prelude::*;

/// What one constraint is made of.
type Choice = (usize, usize, usize, [f64; 3], [f64; 3]);

fn choices(most: usize) -> impl Strategy<Value = Vec<Choice>> {
    let numbers = || prop::array::uniform3(-0.8..0.8);
    prop::collection::vec((0..1000_usize, 0..1000_usize, 0..64_usize, numbers(), numbers()), 1..=most)
}

/// The robot with these constraints, as far as they are between two links and independent at its state.
fn closed(case: &Case, choices: &[Choice], friction: bool) -> Robot {
    let robot = case.robot();
    let robot = if friction { robot } else { robot.without_friction() };
    let joints = case.parts.len();
    let single: Vec<usize> = (0..joints).filter(|&i| case.parts[i].kind.free().is_none()).collect();
    let name =
        |k: usize| if k % (joints + 1) == joints { "world".into() } else { format!("j{}", k % (joints + 1)) };
    choices.iter().enumerate().fold(robot, |robot, (k, &(kind, frames, rows, at, turned))| {
        let (frame, to) = (name(frames), name(frames / (joints + 1)));
        let called = format!("c{k}");
        let spec = match kind % 6 {
            0 => ConstraintSpec::pinned(called, &frame, &to),
            1 => ConstraintSpec::rigid(called, &frame, &to),
            2 | 3 => {
                let all = ConstraintRow::ALL.into_iter().enumerate();
                let some: Vec<_> = all.filter(|(i, _)| rows >> i & 1 == 1).map(|(_, row)| row).collect();
                ConstraintSpec::rows(called, &frame, &to, &some)
            }
            4 => ConstraintSpec::distance(called, &frame, &to, 0.3 + at[0].abs()),
            // Of joints of one degree of freedom.
            _ if single.is_empty() => return robot,
            _ => {
                let joint = |k: usize| format!("j{}", single[k % single.len()]);
                let (a, b) = (joint(frames), joint(rows));
                ConstraintSpec::coupling(called, &[(&a, 1.0 + at[0]), (&b, at[1] + 0.9)], at[2])
            }
        };
        let spec = spec.placed(Placement::from_xyz_rpy(at, turned));
        let spec = if kind % 2 == 0 { spec } else { spec.to_placed(Placement::from_xyz_rpy(turned, at)) };
        // Rows that depend on each other have no forces to compare.
        match robot.with_constraint(spec) {
            Ok(closed) if independence(&closed, &case.q) > 1e-3 => closed,
            _ => robot,
        }
    })
}

/// Rotation and position of a frame that a constraint holds.
fn placed(kinematics: &FreeKinematics<f64>, seat: &ConstraintFrame) -> (Matrix3<f64>, Vector3<f64>) {
    let pose = kinematics.pose(seat.frame).unwrap();
    let rotation = Matrix3::from_fn(|i, j| pose.rotation[i][j]);
    (rotation * seat.placement.rotation, Vector3::from(pose.position) + rotation * seat.placement.translation)
}

/// Eigenvalues of `J M^-1 J'` scaled to a unit diagonal: the least one, 1 without constraints.
fn independence(robot: &Robot, q: &[f64]) -> f64 {
    let mut constraints = Constraints::<f64>::new(robot);
    constraints.set_position(q).unwrap();
    if constraints.count() == 0 {
        return 1.0;
    }
    let j = constraints.jacobian().view().to_nalgebra();
    let m = Lagrangian::<f64>::new(&robot.without_constraints()).mass_matrix(q).unwrap().view().to_nalgebra();
    let c = &j * m.try_inverse().unwrap() * j.transpose();
    // Rows that no motion changes are nothing but rounding.
    if (0..c.nrows()).any(|i| c[(i, i)] < 1e-10 * c.amax().max(1.0)) {
        return 0.0;
    }
    let scale = DMatrix::from_fn(c.nrows(), c.nrows(), |i, k| c[(i, k)] / (c[(i, i)] * c[(k, k)]).sqrt());
    nalgebra::SymmetricEigen::new(scale).eigenvalues.min()
}

/// `x <- A^-1 x` for columns x, A symmetric and positive: elimination without pivots.
fn solve<T: Scalar>(mut a: Vec<Vec<T>>, mut x: Vec<Vec<T>>) -> Vec<Vec<T>> {
    let n = a.len();
    for k in 0..n {
        let pivot = a[k][k].recip();
        let row = a[k].clone();
        for i in k + 1..n {
            let factor = a[i][k] * pivot;
            a[i].iter_mut().zip(&row).skip(k).for_each(|(entry, &above)| *entry -= factor * above);
            x.iter_mut().for_each(|x| {
                let entry = factor * x[k];
                x[i] -= entry;
            });
        }
    }
    for x in &mut x {
        for i in (0..n).rev() {
            let rest = (i + 1..n).fold(x[i], |rest, j| rest - a[i][j] * x[j]);
            x[i] = rest * a[i][i].recip();
        }
    }
    x
}

/// `H_c = p . v - 1/2 v'M v + V`, v from the dense equations, for any scalar.
fn hamiltonian<T: Scalar>(robot: &Robot, tree: &Tree, x: &[T]) -> T {
    let n = tree.dof();
    let (q, p) = x.split_at(n);
    let mut kernel = KernelOne::<T>::new(tree);
    kernel.set_position(tree, q).unwrap();
    let mut constraints = Constraints::<T>::new(robot);
    constraints.set_position(q).unwrap();
    let m: Vec<Vec<T>> = (0..n).map(|i| kernel.mass_matrix().row(i).to_vec()).collect();
    let j: Vec<Vec<T>> = (0..constraints.count()).map(|i| constraints.jacobian().row(i).to_vec()).collect();
    let product = |a: &[T], b: &[T]| a.iter().zip(b).fold(T::zero(), |sum, (&a, &b)| sum + a * b);
    let mut columns = j.clone();
    columns.push(p.to_vec());
    let mut responses = solve(m.clone(), columns);
    let mut v = responses.pop().unwrap();
    let schur: Vec<Vec<T>> = j.iter().map(|a| responses.iter().map(|b| product(a, b)).collect()).collect();
    let rate = j.iter().map(|row| -product(row, &v)).collect();
    let mu = solve(schur, vec![rate]).remove(0);
    for (response, &mu) in responses.iter().zip(&mu) {
        v.iter_mut().zip(response).for_each(|(v, &r)| *v += r * mu);
    }
    let moved: Vec<T> = m.iter().map(|row| product(row, &v)).collect();
    product(p, &v) - product(&v, &moved).times(0.5) + kernel.potential(tree)
}

/// F, F_x, y'F_x and y'F_xx of the dense Hamiltonian, `F = J grad H_c`, by dual numbers in dual numbers.
fn of_dense_hamiltonian<S: Scalar>(robot: &Robot, x: &[S], y: &[S]) -> [Vec<S>; 4] {
    let (tree, n) = (Tree::from(robot), y.len() / 2);
    let zero = Tangent::new(S::zero(), S::zero());
    let one = |on: bool| if on { Tangent::new(S::one(), S::zero()) } else { zero };
    // w = (-y_p, y_q): y'F is the derivative of H_c along w.
    let w: Vec<S> = y[n..].iter().map(|&y| -y).chain(y[..n].iter().copied()).collect();
    let [mut f, mut y_f_x] = [(); 2].map(|()| vec![S::zero(); 2 * n]);
    let [mut f_x, mut y_f_xx] = [(); 2].map(|()| vec![S::zero(); 4 * n * n]);
    // J moves and signs the rows of the derivatives of H_c.
    let signed = |i: usize, x: S| if i < n { (n + i, -x) } else { (i - n, x) };
    for (i, j) in (0..2 * n).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        let number = |l: usize| {
            let along = Tangent::new(Tangent::new(x[l], w[l]), one(l == i));
            Tangent::new(along, Tangent::new(one(l == j), zero))
        };
        let h = hamiltonian(robot, &tree, &(0..2 * n).map(number).collect::<Vec<_>>());
        let (row, slope) = signed(i, h.re.eps.re);
        (f[row], y_f_x[i]) = (slope, h.re.eps.eps);
        for (i, j) in [(i, j), (j, i)] {
            let (row, bend) = signed(i, h.eps.eps.re);
            f_x[row * 2 * n + j] = bend;
            y_f_xx[i * 2 * n + j] = h.eps.eps.eps;
        }
    }
    [f, f_x, y_f_x, y_f_xx]
}

/// H_c and g along the motion from (q, p) at which nothing drives and nothing rubs: their rates vanish.
fn constants_of_motion<S: Scalar>(robot: &Robot, q: &[f64], p: &[S]) -> Differences<S> {
    let (n, rest) = (p.len(), vec![S::zero(); p.len()]);
    let mut first = ConstrainedHamiltonian::<S>::new(robot);
    let f = first.evaluate(&lift_rounded::<S>(q), p, &rest).unwrap().f.to_vec();
    let mut along = ConstrainedHamiltonian::<Tangent<S>>::new(robot);
    let energy = along.energy(&retracted(robot, q, &moving(&rest, &f[..n])), &moving(p, &f[n..])).unwrap();
    let rates = along.constraints().values().iter().map(|g| g.eps).collect();
    vec![("dH/dt", vec![(energy.kinetic + energy.potential).eps]), ("dg/dt", rates)]
}

/// Accelerations and forces in the equations of motion, with friction: `tau(q, v, a) = u + J'lambda` of the
/// robot without constraints, and `J a = -(J v)_q v`.
fn are_those_of_the_dense_equations(robot: &Robot, case: &Case) -> Result<(), TestCaseError> {
    let (open, p) = (robot.without_constraints(), case.v.iter().map(|v| 2.0 * v).collect::<Vec<_>>());
    let mut constrained = ConstrainedHamiltonian::<f64>::new(robot);
    constrained.evaluate(&case.q, &p, &case.u).unwrap();
    prop_assert!(constrained.counted().iter().all(|&counts| counts == 1.0));
    rounding!(|S| {
        let (q, [p, u]) = (lift_rounded::<S>(&case.q), [&p[..], &case.u].map(lift::<S>));
        let mut constrained = ConstrainedHamiltonian::<S>::new(robot);
        let linear = constrained.linearise(&q, &p, &u).unwrap();
        let (v, a, lambda) =
            (linear.velocity().to_vec(), linear.acceleration().to_vec(), linear.lambda().to_vec());
        let j = constrained.constraints().jacobian();
        let force = |i: usize| (0..lambda.len()).fold(u[i], |sum, k| sum + j[(k, i)] * lambda[k]);
        let forces: Vec<S> = (0..u.len()).map(force).collect();
        let tau = apart(Lagrangian::<S>::new(&open).inverse_dynamics(&q, &v, &a).unwrap(), &forces);
        // The curve q (+) v t has the velocity v throughout.
        let along = |&v: &S| Tangent::new(Tangent::new(S::zero(), v), Tangent::new(v, S::zero()));
        let mut moved = Constraints::<Tangent<Tangent<S>>>::new(robot);
        moved.set_position(&retracted(robot, &case.q, &v.iter().map(along).collect::<Vec<_>>())).unwrap();
        let bends = moved
            .values()
            .iter()
            .enumerate()
            .map(|(k, g)| j.row(k).iter().zip(&a).fold(g.eps.eps, |sum, (&j, &a)| sum + j * a));
        vec![("tau - u - J'lambda", tau), ("J a + (J v)_q v", bends.collect())]
    })
}

properties! {
    96;

    #[test]
    fn derivatives_are_those_of_the_dense_hamiltonian(case in cases(4), choices in choices(2)) {
        let robot = closed(&case, &choices, false);
        let (n, q) = (case.n(), &case.q);
        let p: Vec<f64> = case.v.iter().zip(&case.u).map(|(v, u)| v + 0.3 * u).collect();
        rounding!(|S| {
            let [q, p, y] = [&q[..], &p, &case.y].map(lift::<S>);
            let d: Vec<S> = y.iter().map(|&y| y.times(5.0).sin_cos().0).collect();
            let mut ours = ConstrainedHamiltonianSecondOrder::<S>::new(&robot);
            let by_d = ours.hessian_product(&q, &p, &y, &d).unwrap().to_vec();
            let all = ours.contract(&q, &p, &vec![S::zero(); n], &y).unwrap();
            let (f_x, y_f_xx) = (rows(all.linearisation().matrix()), rows(all.matrix()));
            let [f, dense_f_x, y_f_x, dense] = of_dense_hamiltonian(&robot, &[&q[..], &p].concat(), &y);
            let mut blocks = vec![("F", apart(all.linearisation().f(), &f)), ("F_x", apart(&f_x, &dense_f_x))];
            blocks.push(("y'F_x", apart(&transposed_times(&f_x, &y), &y_f_x)));
            blocks.push(("y'F_xx", apart(&y_f_xx, &dense)));
            blocks.push(("y'F_xx d", apart(&by_d, &times(&y_f_xx, &d))));
            blocks
        })?;
        rounding!(|S| constants_of_motion(&robot, q, &lift::<S>(&p)))?;
        let mut ours = ConstrainedHamiltonian::<f64>::new(&robot);
        let f_x = ours.linearise(q, &p, &vec![0.0; n]).unwrap().matrix().to_nalgebra();
        let j = DMatrix::from_fn(2 * n, 2 * n, |i, k| if i < n { f_x[(n + i, k)] } else { -f_x[(i - n, k)] });
        prop_assert_eq!(&j, &j.transpose(), "J F_x is symmetric");
    }

    #[test]
    fn accelerations_and_forces_are_those_of_the_dense_equations(case in cases(8), choices in choices(3)) {
        are_those_of_the_dense_equations(&closed(&case, &choices, true), &case)?;
    }
}
