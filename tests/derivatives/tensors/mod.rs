//! Properties of the paper's route: agreement with the other routes. `relations` and `storage` test the
//! coefficients.

mod bench;
mod relations;
mod storage;

use bench::{revolute, serial};
use costate::EvalError;
use costate::derivative::{Function, Hessian, Jacobian, PhaseVelocity, largest};
use costate::hamiltonian::{DualPass, Hamiltonian, HamiltonianSecondOrder};
use costate::kernels::{KernelOne, LagrangianHessian};
use costate::robot::Tree;
use costate::scalar::{Count, Scalar};
use costate::tensors::{Christoffel, ChristoffelKernel};
use costate_test_support::properties;
use costate_test_support::random_position::Kind;
use costate_test_support::random_robot::{Case, all_cases, cases, condition};
use costate_test_support::rounding::{Bounds, bound, close, lift, of_joints, rows};
use proptest::prelude::*;

/// Robots a property.
const CASES: u32 = 192;

/// What the three stages of a kernel give.
fn stages<K: LagrangianHessian<f64>>(tree: &Tree, case: &Case) -> (K, f64) {
    let mut kernel = K::new(tree);
    kernel.set_position(tree, &case.q).unwrap();
    kernel.set_velocity(tree, &case.v).unwrap();
    kernel.second_order(tree);
    let potential = kernel.potential(tree);
    (kernel, potential)
}

/// M, p, L_q, P, L_qq and V of both kernels, without a matrix to invert.
fn kernels_agree(case: &Case) -> Result<(), TestCaseError> {
    let robot = case.robot();
    let tree = Tree::from(&robot);
    let (tensors, v_tensors) = stages::<ChristoffelKernel<f64>>(&tree, case);
    let (contracted, v_contracted) = stages::<KernelOne<f64>>(&tree, case);
    let sizes: Vec<f64> = (0..case.n()).map(|k| tensors.size_of_entry(&tree, k)).collect();
    for (k, size) in sizes.iter().enumerate() {
        let bound = contracted.size_of_entry(&tree, k);
        prop_assert!(*size <= bound + of_joints(&robot, bound), "size of entry {k}: {size} > {bound}");
    }
    // Sizes of the terms: inertia times rates, weights and springs.
    let (inertia, rate) = (largest(&sizes), case.v.iter().map(|v| v.abs()).sum::<f64>());
    let weight =
        largest(&case.gravity) * (inertia + tree.joints().iter().map(|j| j.subtree_mass).sum::<f64>());
    let stiffness = tree.joints().iter().map(|joint| joint.spring.stiffness).fold(0.0, f64::max);
    let stretch = largest(&case.q) + 1.0;
    let force = inertia * rate * rate + weight + stiffness * stretch;
    let close = |what: &str, ours: &[f64], theirs: &[f64], size: f64| {
        close(what, ours, theirs, of_joints(&robot, size))
    };
    close("M", tensors.mass_matrix().as_slice(), contracted.mass_matrix().as_slice(), inertia)?;
    close("p", tensors.momentum(), contracted.momentum(), inertia * rate)?;
    close("L_q", tensors.l_q(), contracted.l_q(), force)?;
    close("V", &[v_tensors], &[v_contracted], weight + stiffness * stretch * stretch)?;
    close("P", tensors.l_vq().as_slice(), contracted.l_vq().as_slice(), inertia * rate)?;
    close("L_qq", tensors.l_qq().as_slice(), contracted.l_qq().as_slice(), force)
}

/// The state equation by the tensors, as a function to differentiate.
struct TensorPhaseVelocity {
    tree: Tree,
    u: Vec<f64>,
}

impl Function for TensorPhaseVelocity {
    type Workspace<S: Scalar> = Hamiltonian<S, Christoffel>;
    type Error = EvalError;

    fn inputs(&self) -> usize {
        2 * self.tree.dof()
    }

    fn outputs(&self) -> usize {
        2 * self.tree.dof()
    }

    fn workspace<S: Scalar>(&self) -> Self::Workspace<S> {
        Hamiltonian::with_route(self.tree.clone(), Christoffel)
    }

    fn evaluate<S: Scalar>(
        &self,
        tensors: &mut Self::Workspace<S>,
        x: &[S],
        f: &mut [S],
    ) -> Result<(), EvalError> {
        let (q, p) = x.split_at(self.tree.dof());
        let u: Vec<S> = self.u.iter().map(|&u| S::from_f64(u)).collect();
        f.copy_from_slice(tensors.evaluate(q, p, &u)?);
        Ok(())
    }
}

/// M, F, F_x and y'F_xx: tensors beside analytic and (hyper-)dual, which round M in another way.
fn routes_agree(case: &Case) -> Result<(), TestCaseError> {
    let robot = case.robot();
    let (q, p, u, y) = (&case.q, case.p(&robot), &case.u, &case.y);
    let tree = Tree::from(&robot);
    let bounds = Bounds::new(&robot, [q, &case.v, u, y]);
    let [of_m, of_f, of_f_x, of_y_f_xx] = rounding_of_tensors(&tree, [q, &p, u, y]);
    let mut tensors = DualPass::<f64, _>::with_route(tree.clone(), Christoffel);
    let mut first = Hamiltonian::<f64, _>::with_route(tree.clone(), Christoffel);
    let mut analytic = HamiltonianSecondOrder::<f64>::from_tree(tree);
    let mut dual: Jacobian<_> = Jacobian::new(PhaseVelocity::new(&robot).under(u));
    let mut hyperdual = Hessian::new(PhaseVelocity::new(&robot).under(u));
    let x = case.x(&robot);
    let ours = tensors.contract(q, &p, u, y).unwrap();
    let theirs = analytic.contract(q, &p, u, y).unwrap();
    let linear = first.linearise(q, &p, u).unwrap();
    let by_dual = dual.linearise(&x).unwrap();
    let by_hyperdual = hyperdual.contract(&x, y).unwrap();
    let (m, f_x, y_f_xx) = (linear.mass_matrix(), rows(linear.matrix()), rows(ours.matrix()));
    close("M", m.as_slice(), theirs.linearisation().mass_matrix().as_slice(), of_m + bounds.m)?;
    close("F, analytic", linear.f(), theirs.linearisation().f(), of_f + bounds.f)?;
    close("F, dual", ours.linearisation().f(), by_dual.value, of_f + bounds.f)?;
    close("F_x, analytic", &f_x, &rows(theirs.linearisation().matrix()), of_f_x + bounds.f_x)?;
    close("F_x, one sweep", &rows(ours.linearisation().matrix()), &f_x, 2.0 * of_f_x + bounds.f_x)?;
    close("F_x, dual", &f_x, by_dual.jacobian.as_slice(), of_f_x + bounds.f_x)?;
    let mut own = Hessian::new(TensorPhaseVelocity { tree: first.tree().clone(), u: u.clone() });
    close(
        "y'F_xx, hyperdual through tensors",
        &y_f_xx,
        own.contract(&x, y).unwrap().as_slice(),
        2.0 * of_y_f_xx + bounds.y_f_xx,
    )?;
    close("y'F_xx, analytic", &y_f_xx, &rows(theirs.matrix()), of_y_f_xx + bounds.y_f_xx)?;
    close("y'F_xx, hyperdual", &y_f_xx, by_hyperdual.as_slice(), of_y_f_xx + bounds.y_f_xx)
}

/// Twice the bounds of M, F, F_x and y'F_xx by tensors.
fn rounding_of_tensors(tree: &Tree, [q, p, u, y]: [&[f64]; 4]) -> [f64; 4] {
    let [q, p, u, y] = [q, p, u, y].map(lift::<Count>);
    let mut tensors = DualPass::<Count, _>::with_route(tree.clone(), Christoffel);
    let all = tensors.contract(&q, &p, &u, &y).unwrap();
    let linear = all.linearisation();
    let m = bound(linear.mass_matrix().as_slice());
    let bounds = [m, bound(linear.f()), bound(&rows(linear.matrix())), bound(&rows(all.matrix()))];
    bounds.map(|bound| 2.0 * bound)
}

properties! {
    CASES;

    #[test]
    fn tensors_agree_with_analytic_and_dual_on_random_trees(case in cases(12)) {
        routes_agree(&case)?;
    }

    #[test]
    fn tensors_agree_with_analytic_and_dual_on_serial_chains(case in all_cases(12).prop_map(serial)) {
        prop_assume!((0.0..1e9).contains(&condition(&case.robot(), &case.q)));
        routes_agree(&case)?;
    }

    #[test]
    fn kernels_agree_where_joints_are_redundant_too(case in all_cases(12)) {
        kernels_agree(&case)?;
    }

    /// Every mixture of revolute and prismatic joints on a chain of five, and on a tree.
    #[test]
    fn kernels_agree_for_every_mixture_of_joints(mut case in all_cases(5)) {
        for mixture in 0..1_usize << case.parts.len() {
            for (i, part) in case.parts.iter_mut().enumerate() {
                part.kind = if (mixture >> i) % 2 == 1 { Kind::Prismatic } else { Kind::Revolute };
            }
            kernels_agree(&case)?;
            kernels_agree(&serial(case.clone()))?;
        }
    }
}

/// The stages may be repeated, in any number, without a trace.
#[test]
fn stages_can_be_repeated() {
    let tree = revolute(5, |i| i.checked_sub(1));
    let q: Vec<f64> = (0..5).map(|i| 0.2 * f64::from(i)).collect();
    let mut once = ChristoffelKernel::<f64>::new(&tree);
    let mut again = once.clone();
    again.set_position(&tree, &[1.0; 5]).unwrap();
    again.set_velocity(&tree, &[2.0; 5]).unwrap();
    again.second_order(&tree);
    for kernel in [&mut once, &mut again] {
        kernel.set_position(&tree, &q).unwrap();
        kernel.set_velocity(&tree, &q).unwrap();
        kernel.second_order(&tree);
    }
    again.second_order(&tree);
    assert_eq!(once.l_vq().as_slice(), again.l_vq().as_slice());
    assert_eq!(once.l_qq().as_slice(), again.l_qq().as_slice());
    assert_eq!((once.l_q(), once.momentum()), (again.l_q(), again.momentum()));
    assert!(once.set_velocity(&tree, &q[..4]).is_err());
}
