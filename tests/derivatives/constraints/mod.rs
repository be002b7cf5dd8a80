//! Constraints of all kinds on random trees: F, F_x and y'F_xx against numbers of num-dual through a dense
//! version of H_c, accelerations and forces against the dense equations of motion.

mod exceptions;
mod free_joints;
mod half_turns;
mod impacts;
mod poses;

use crate::free_joints::retracted;
use costate::configuration::FreeKinematics;
use costate::constraints::{ConstrainedHamiltonian, ConstrainedHamiltonianSecondOrder, Constraints};
use costate::derivative::largest;
use costate::kernels::KernelOne;
use costate::lagrangian::Lagrangian;
use costate::robot::{ConstraintFrame, ConstraintRow, ConstraintSpec, Placement, Robot, Tree};
use costate::scalar::{Count, Scalar};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, cases, tolerance};
use costate_test_support::rounding::{bound, close, lift, rows};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use num_dual::{Dual64, HyperDual, HyperDual64};
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

/// How far two methods for a robot with constraints may be apart: four times the bounds of the methods by
/// hand. The dense equations take the same inverses twice, of M and of `J M^-1 J'`.
///
/// Where constraints leave nothing to move, what is zero by hand is a difference of products with both
/// inverses elsewhere. These are of the size of (F, mu) and its derivatives, and round by the condition of M
/// and the square of that of `J M^-1 J'`; four of them are in a second derivative.
struct Rounding {
    /// (F, mu) and their derivatives.
    f: f64,
    f_x: f64,
    y_f_xx: f64,
    /// y'F_xx d.
    product: f64,
}

impl Rounding {
    fn new(robot: &Robot, [q, p, u, y, d]: [&[f64]; 5]) -> Self {
        let [q, p, u, y, d] = [q, p, u, y, d].map(lift::<Count>);
        let bound = |block: &[Count]| 4.0 * bound(block);
        let mut ours = ConstrainedHamiltonianSecondOrder::<Count>::new(robot);
        let product = bound(ours.hessian_product(&q, &p, &y, &d).unwrap());
        let all = ours.contract(&q, &p, &u, &y).unwrap();
        let linear = all.linearisation();
        let values = |block: &[Count]| block.iter().map(|entry| entry.value()).collect::<Vec<f64>>();
        let size = |block: &[Count]| largest(&values(block));
        let (f_x, mu_x, y_f_xx) = (rows(linear.matrix()), rows(linear.mu_x()), rows(all.matrix()));
        let at = values(&q);
        let relative = 10.0 * tolerance(&robot.without_constraints(), &at) / independence(robot, &at).powi(2);
        let of_first = [size(linear.f()), size(linear.mu()), size(&f_x), size(&mu_x), 1.0];
        let cancelling = relative * largest(&of_first);
        let of_second = 4.0 * cancelling.max(relative * size(&y_f_xx));
        Self {
            f: bound(linear.f()).max(bound(linear.mu())) + cancelling,
            f_x: bound(&f_x).max(bound(&mu_x)) + cancelling,
            y_f_xx: bound(&y_f_xx) + of_second,
            product: product + of_second,
        }
    }
}

/// Accelerations and forces against the dense equations of motion, with friction; `J a = -(J v)_q v`.
fn are_those_of_the_dense_equations(robot: &Robot, case: &Case) -> Result<(), TestCaseError> {
    let (n, q, u) = (case.n(), &case.q, &case.u);
    let independence = independence(robot, q);
    let bound = 10.0 * tolerance(&robot.without_constraints(), q) / independence.powi(2);
    let mut constrained = ConstrainedHamiltonian::<f64>::new(robot);
    let p: Vec<f64> = case.v.iter().map(|v| 2.0 * v).collect();
    let linear = constrained.linearise(q, &p, u).unwrap();
    let (v, found) = (linear.velocity().to_vec(), [linear.acceleration(), linear.lambda()].concat());
    let f = linear.f().iter().fold(0.0, |most: f64, f| most.max(f.abs()));
    let terms = f * linear.matrix().to_nalgebra().amax().max(linear.mu_x().to_nalgebra().amax());
    let k = found.len() - n;
    prop_assert!(constrained.counted().iter().all(|&counts| counts == 1.0));
    // The curve q (+) v t has the velocity v throughout.
    let mut moving = Constraints::<HyperDual64>::new(robot);
    let along: Vec<_> = v.iter().map(|&v| HyperDual64::new(0.0, v, v, 0.0)).collect();
    moving.set_position(&retracted(robot, q, &along)).unwrap();
    let mut open = Lagrangian::<f64>::new(&robot.without_constraints());
    let m = open.mass_matrix(q).unwrap().view().to_nalgebra();
    let bias = open.inverse_dynamics(q, &v, &vec![0.0; n]).unwrap();
    let mut dense = DMatrix::zeros(n + k, n + k);
    dense.view_mut((0, 0), (n, n)).copy_from(&m);
    let j = constrained.constraints().jacobian().view().to_nalgebra();
    dense.view_mut((n, 0), (k, n)).copy_from(&j);
    dense.view_mut((0, n), (n, k)).copy_from(&-j.transpose());
    let rhs =
        DVector::from_fn(n + k, |i, _| if i < n { u[i] - bias[i] } else { -moving.values()[i - n].eps1eps2 });
    let expected = dense.lu().solve(&rhs).unwrap();
    // Rounding is in proportion to the terms of (v, mu)_x F.
    let size = terms.max(expected.amax()).max(rhs.amax());
    let worst = (DVector::from_vec(found) - expected).amax();
    prop_assert!(worst <= bound * size, "{:.1e} of {bound:.1e}", worst / size);
    Ok(())
}

properties! {
    96;

    #[test]
    fn derivatives_are_those_of_the_dense_hamiltonian(case in cases(4), choices in choices(2)) {
        let robot = closed(&case, &choices, false);
        let (n, q, y) = (case.n(), &case.q, &case.y);
        let p: Vec<f64> = case.v.iter().zip(&case.u).map(|(v, u)| v + 0.3 * u).collect();
        let (zero, d) = (vec![0.0; n], y.iter().map(|y| (5.0 * y).sin()).collect::<Vec<f64>>());
        let of = Rounding::new(&robot, [q, &p, &zero, y, &d]);
        let mut ours = ConstrainedHamiltonianSecondOrder::<f64>::new(&robot);
        let all = ours.contract(q, &p, &zero, y).unwrap();
        let (f, f_x) = (DVector::from_column_slice(all.linearisation().f()), all.linearisation().matrix().to_nalgebra());
        let (y_f_xx, x, tree) = (all.matrix().to_nalgebra(), [&q[..], &p].concat(), Tree::from(&robot));
        // w = (-y_p, y_q): y'F is the derivative of H_c along w.
        let along: Vec<f64> = y[n..].iter().map(|y| -y).chain(y[..n].iter().copied()).collect();
        let (mut gradient, mut adjoint) = (DVector::zeros(2 * n), DVector::zeros(2 * n));
        let (mut hessian, mut curvature) = (DMatrix::zeros(2 * n, 2 * n), DMatrix::zeros(2 * n, 2 * n));
        for i in 0..2 * n {
            for j in 0..=i {
                let one = |on: bool| Dual64::from_re(f64::from(u8::from(on)));
                let seeds: Vec<HyperDual<Dual64>> = (0..2 * n)
                    .map(|l| HyperDual::new(Dual64::new(x[l], along[l]), one(l == i), one(l == j), one(false)))
                    .collect();
                let h = hamiltonian(&robot, &tree, &seeds);
                (gradient[i], adjoint[i]) = (h.eps1.re, h.eps1.eps);
                (hessian[(i, j)], hessian[(j, i)]) = (h.eps1eps2.re, h.eps1eps2.re);
                (curvature[(i, j)], curvature[(j, i)]) = (h.eps1eps2.eps, h.eps1eps2.eps);
            }
        }
        // F = J grad H_c.
        let of_h = DMatrix::from_fn(2 * n, 2 * n, |i, k| if i < n { hessian[(n + i, k)] } else { -hessian[(i - n, k)] });
        let f_of_h = DVector::from_fn(2 * n, |i, _| if i < n { gradient[n + i] } else { -gradient[i - n] });
        // Entries of y and d are at most 1: each of the 2n terms of a product rounds as an entry does.
        let terms = 2.0 * n as f64;
        close("F", f.as_slice(), f_of_h.as_slice(), of.f)?;
        close("F_x", f_x.as_slice(), of_h.as_slice(), of.f_x)?;
        let by_y = f_x.transpose() * DVector::from_column_slice(y);
        close("y'F_x", by_y.as_slice(), adjoint.as_slice(), terms * of.f_x)?;
        close("y'F_xx", y_f_xx.as_slice(), curvature.as_slice(), of.y_f_xx)?;
        let j = DMatrix::from_fn(2 * n, 2 * n, |i, k| if i < n { f_x[(n + i, k)] } else { -f_x[(i - n, k)] });
        prop_assert_eq!(&j, &j.transpose(), "J F_x is symmetric");
        // Products beside the matrices.
        let product = ours.hessian_product(q, &p, y, &d).unwrap();
        let expected = &y_f_xx * DVector::from_column_slice(&d);
        close("y'F_xx d", product, expected.as_slice(), of.product.max(terms * of.y_f_xx))?;
        // H_c and g are constant along motions.
        let mut moving = ConstrainedHamiltonian::<Dual64>::new(&robot);
        let rate: Vec<f64> = ours.first().evaluate(q, &p, &zero).unwrap().f.to_vec();
        let along: Vec<Dual64> = x.iter().zip(&rate).map(|(&x, &rate)| Dual64::new(x, rate)).collect();
        let energy = moving.energy(&along[..n], &along[n..]).unwrap();
        // Both are sums of products with F: H_x, whose entries are those of F, and J.
        let largest = rate.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
        close("dH/dt", &[(energy.kinetic + energy.potential).eps], &[0.0], 2.0 * terms * largest * of.f)?;
        let arms = ours.first().constraints().jacobian().view().to_nalgebra().amax();
        let bound = n as f64 * (1.0 + arms) * of.f;
        let still = moving.constraints().values().iter().all(|g| g.eps.abs() <= bound);
        prop_assert!(still, "{:?}", moving.constraints().values());
    }

    #[test]
    fn accelerations_and_forces_are_those_of_the_dense_equations(case in cases(8), choices in choices(3)) {
        are_those_of_the_dense_equations(&closed(&case, &choices, true), &case)?;
    }
}
