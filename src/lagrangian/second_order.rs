//! Contracted Hessians of inverse and forward dynamics, with values and Jacobians.

use super::chain_rule::ChainRule;
use super::choice::Routes;
use super::dual_pass::{DualPass, Pass};
use super::products::Products;
use super::{InverseDynamicsContraction, InverseDynamicsLinearisation, Lagrangian, LagrangianContraction};
use crate::error::EvalError;
use crate::kernels::{TorqueContraction, TorqueHessian, check_entries, friction_of};
use crate::matrix::{Matrix, filled};
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;

/// Workspace for tau or a, their Jacobians and their contracted Hessians of one robot; no call allocates.
///
/// For constant w, the Hessian of the power `w.tau` of inverse dynamics in z = (q, v, a) consists of scalar
/// products of pairs of joints on one branch, O(n d) for branches of d joints; d2/da dv and d2/da da are
/// zero. They come from the same forces as the Jacobian, and from those that move with the velocity that w
/// gives the links. Recorded programs take one dual number through kernels one and two instead, unless axes
/// have general directions, branches are not short or joints are floating or spherical.
///
/// Since `tau(q, v, a(q, v, u)) = u`, the contracted Hessian of forward dynamics is minus this Hessian for
/// `w = M^-1 y`, transformed by Z = (1, 0, 0; 0, 1, 0; a_q, a_v, a_u). Hence `y'a_uv = y'a_uu = 0`. No
/// factorisation is differentiated.
#[derive(Clone, Debug)]
pub struct LagrangianSecondOrder<S: Scalar> {
    pub(super) first: Lagrangian<S>,
    pub(super) pass: Pass<S>,
    pub(super) w: Vec<S>,
    hessian: TorqueHessian<S>,
    chain_rule: ChainRule<S>,
    pub(super) w_tau_zz: Matrix<S>,
    pub(super) xx: Matrix<S>,
    pub(super) uq: Matrix<S>,
    pub(super) products: Products<S>,
}

impl<S: Scalar> LagrangianSecondOrder<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(Tree::from(robot))
    }

    /// As [`new`](Self::new), from an existing [`Tree`].
    pub fn from_tree(tree: Tree) -> Self {
        Self::as_numbers::<S>(tree)
    }

    /// As [`from_tree`](Self::from_tree), by the algorithms that numbers of type T take: rounding errors that
    /// other numbers carry are those of T only then. Where one algorithm has a zero by structure, another one
    /// may have rounding errors.
    pub(crate) fn as_numbers<T: Scalar>(tree: Tree) -> Self {
        Self::with_routes(Routes::for_second_derivatives::<T>(&tree), tree)
    }

    /// As [`from_tree`](Self::from_tree), by these algorithms.
    #[inline(never)]
    pub(super) fn with_routes(routes: Routes, tree: Tree) -> Self {
        let n = tree.dof();
        let first = Lagrangian::with_routes(routes, tree);
        let pass = match &first.world {
            Some(world) if routes.derivatives => Pass::World(Box::new(TorqueContraction::new(world))),
            _ => Pass::Dual(Box::new(DualPass::new(&first.tree))),
        };
        Self {
            pass,
            products: Products::new(&first.tree),
            w: filled(S::zero(), n),
            hessian: TorqueHessian::zeros(n),
            chain_rule: ChainRule::new(&first.factor),
            w_tau_zz: Matrix::zeros(3 * n, 3 * n),
            xx: Matrix::zeros(2 * n, 2 * n),
            uq: Matrix::zeros(n, n),
            first,
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.first.dof()
    }

    /// The first-order workspace: a and its Jacobian.
    pub fn first(&mut self) -> &mut Lagrangian<S> {
        &mut self.first
    }

    /// tau, its Jacobian and `sum_k w_k d2 tau_k / dz dz`, z = (q, v, a), for weights w of length n.
    ///
    /// ```
    /// use costate::lagrangian::LagrangianSecondOrder;
    /// use costate::robot::Robot;
    /// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
    /// let robot = Robot::from_file("robots/two_link.toml")?;
    /// let mut second = LagrangianSecondOrder::<f64>::new(&robot);
    /// let all = second.contract_inverse_dynamics(&[0.3, -0.8], &[1.0, 0.5], &[0.2, -4.0], &[1.0, 0.0])?;
    /// let linear = all.inverse_dynamics();
    /// println!("tau = {:?}, dtau/dq = {}", linear.tau, linear.tau_q.view().to_nalgebra());
    /// println!("d2 tau_0 / dx dx = {}", all.xx().to_nalgebra());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// See [`Lagrangian`]; a singular mass matrix is not an error here.
    #[inline(never)]
    pub fn contract_inverse_dynamics(
        &mut self,
        q: &[S],
        v: &[S],
        a: &[S],
        w: &[S],
    ) -> Result<InverseDynamicsContraction<'_, S>, EvalError> {
        self.first.check(q, &[("v", v), ("a", a), ("w", w)])?;
        self.w.copy_from_slice(w);
        if let Pass::Dual(dual) = &mut self.pass {
            let (rate_q, rate_v) = self.first.rate.split_at_mut(v.len());
            rate_q.copy_from_slice(v);
            rate_v.copy_from_slice(a);
            dual.contract(&mut self.first, q, &self.w, &mut self.hessian)?;
            dual.take_torque(&mut self.first, q);
        } else {
            self.first.set_torque_jacobian(q, v, a)?;
            self.first.unpack_torque();
            self.contract_torque();
        }
        self.add_joint_curvature(q, v);
        self.chain_rule.write_torque_hessian(&self.hessian, &mut self.w_tau_zz);
        let inverse_dynamics = match &self.pass {
            Pass::Dual(dual) => {
                InverseDynamicsLinearisation { tau_a: &dual.mass_matrix, ..self.first.inverse_jacobian() }
            }
            Pass::World(_) => self.first.inverse_jacobian(),
        };
        Ok(InverseDynamicsContraction { inverse_dynamics, zz: &self.w_tau_zz })
    }

    /// a, its Jacobian and `sum_k y_k d2 a_k / dz dz`, z = (q, v, u), for the costate y of the velocities,
    /// length n.
    ///
    /// The other half of the state equation, dq/dt = v, is linear: for a costate (y_q, y_v) of x = (q, v),
    /// pass y_v.
    ///
    /// # Errors
    /// See [`Lagrangian`].
    #[inline(never)]
    pub fn contract_forward_dynamics(
        &mut self,
        q: &[S],
        v: &[S],
        u: &[S],
        y: &[S],
    ) -> Result<LagrangianContraction<'_, S>, EvalError> {
        self.first.check(q, &[("v", v), ("u", u), ("y", y)])?;
        self.first.accelerate(q, v, u)?;
        self.w.copy_from_slice(y);
        self.first.factor.solve(&mut self.w);
        if let Pass::Dual(dual) = &mut self.pass {
            dual.contract(&mut self.first, q, &self.w, &mut self.hessian)?;
        } else {
            self.first.differentiate_torque_after_bias(q, v)?;
            self.contract_torque();
        }
        self.add_joint_curvature(q, v);
        self.first.solve_jacobian();
        self.first.assemble();
        self.chain_rule.transform(&mut self.first, &self.hessian, (&mut self.xx, &mut self.uq));
        let (forward_dynamics, linearisation) = (self.first.forward_jacobian(), self.first.state());
        Ok(LagrangianContraction { forward_dynamics, linearisation, xx: &self.xx, uq: &self.uq })
    }

    /// dx/dt = (v, a), its Jacobians and `sum_k y_k d2 f_k / dx dx` for the costate y = (y_q, y_v) of x = (q,
    /// v), length 2n. dq/dt = v is linear, so that y_q has no influence.
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub fn contract(
        &mut self,
        q: &[S],
        v: &[S],
        u: &[S],
        y: &[S],
    ) -> Result<LagrangianContraction<'_, S>, EvalError> {
        let n = self.dof();
        check_entries(self.first.tree(), "y", y, 2 * n)?;
        self.contract_forward_dynamics(q, v, u, &y[n..])
    }

    /// The Hessian of w.tau in the axes of the world, where tau_q and tau_v were computed.
    fn contract_torque(&mut self) {
        if let (Pass::World(work), Some(world)) = (&mut self.pass, &mut self.first.world) {
            world.contract_torque(work, &self.w, &mut self.hessian);
        }
    }

    /// What friction and wrenches from outside add to the Hessian of w.tau.
    fn add_joint_curvature(&mut self, q: &[S], v: &[S]) {
        let (tree, vv) = (&self.first.tree, &mut self.hessian.vv);
        for &i in tree.with_friction() {
            if tree.has_coulomb_friction(i) {
                vv.set(i, i, vv.get(i, i) - self.w[i] * friction_of(tree, i, v[i]).second);
            }
        }
        self.first.subtract_wrench_curvature(q, &self.w, &mut self.hessian.qq);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::test_robot::robot;
    use crate::robot::{JointSpec, LinkInertia, Placement, Spring};
    use nalgebra::{DMatrix, Matrix3};

    fn in_body_frames<S: Scalar>(tree: &Tree) -> LagrangianSecondOrder<S> {
        LagrangianSecondOrder::with_routes(Routes::BODY_FRAMES, tree.clone())
    }

    fn compare(robot: &Robot) {
        let (tree, n) = (Tree::from(robot), robot.dof());
        let numbers = |from: f64| (0..n).map(|i| (from + 1.3 * i as f64).sin()).collect::<Vec<f64>>();
        let mut world = LagrangianSecondOrder::<f64>::from_tree(tree.clone());
        let mut dual = in_body_frames::<f64>(&tree);
        // The second time, nothing may be left of the first.
        for from in [0.3, 1.1] {
            let (q, v, u, w) = (numbers(from), numbers(0.5 * from), numbers(0.7), numbers(2.0 * from));
            let close = |what: &str, found: DMatrix<f64>, expected: DMatrix<f64>| {
                let error = (&found - &expected).amax();
                // Terms are of the size of one or larger, also where they cancel.
                assert!(
                    error < 1e-11 * expected.amax().max(1.0),
                    "n = {n}: {what}: {error}\n{:.2e}",
                    found - expected
                );
            };
            let dense = |found: InverseDynamicsContraction<'_, f64>| found.zz().view().to_nalgebra();
            close(
                "w'tau_zz",
                dense(world.contract_inverse_dynamics(&q, &v, &u, &w).unwrap()),
                dense(dual.contract_inverse_dynamics(&q, &v, &u, &w).unwrap()),
            );
            let dense = |found: LagrangianContraction<'_, f64>| found.to_matrix().view().to_nalgebra();
            let found = dense(world.contract_forward_dynamics(&q, &v, &u, &w).unwrap());
            assert_eq!(found, found.transpose());
            close("y'a_zz", found, dense(dual.contract_forward_dynamics(&q, &v, &u, &w).unwrap()));
        }
    }

    /// Revolute and prismatic joints, links without mass, springs, armature, a mimic; no order of branches.
    fn mixed(n: usize, gravity: [f64; 3]) -> Robot {
        let mut builder = Robot::builder("mixed").gravity(gravity);
        for k in 0..n {
            let (x, name) = (k as f64, format!("j{k}"));
            let mut joint = match k % 3 {
                1 => JointSpec::prismatic(name),
                _ => JointSpec::revolute(name),
            };
            joint = joint
                .axis([x.sin(), 1.0, x.cos()])
                .placed(Placement::from_xyz_rpy([0.2, 0.1 * x.cos(), 0.3], [x, 0.4, -x]))
                .armature(0.2);
            if k % 4 != 2 {
                let inertia = Matrix3::new(0.3, 0.02, 0.01, 0.02, 0.4, 0.03, 0.01, 0.03, 0.35);
                joint =
                    joint.carrying(LinkInertia::about_com(1.0 + x.sin().abs(), [0.1, 0.2, x.cos()], inertia));
            }
            if k % 5 == 0 {
                joint = joint.spring(Spring { stiffness: 3.0, rest: 0.2 });
            }
            if k + 1 == n && n > 3 {
                joint = joint.mimicking("j1", -0.7, 0.3);
            }
            builder = builder.joint(if k > 1 { joint.on(format!("j{}", (k / 2 + 1) % k)) } else { joint });
        }
        builder.build().unwrap()
    }

    #[test]
    fn all_kinds_of_joints_give_what_the_dual_pass_gives() {
        for n in [2, 5, 9, 14, 17, 30] {
            compare(&mixed(n, [0.3, -1.0, -9.81]));
            compare(&mixed(n, [0.0; 3]));
        }
    }

    #[test]
    fn chains_and_bushes_of_a_hundred_joints_give_what_the_dual_pass_gives() {
        compare(&robot(100, |k| k.wrapping_sub(1), false));
        compare(&robot(100, |k| k / 7, false));
    }

    /// Also where a workspace has been used before.
    #[test]
    fn pairs_on_different_branches_have_no_entries() {
        let (n, parent) = (19, |k: usize| k.wrapping_sub(3));
        let robot = robot(n, parent, false);
        let on_one_branch = |i: usize, j: usize| {
            let (low, mut high) = (i.min(j), i.max(j));
            while high > low && parent(high) < high {
                high = parent(high);
            }
            high == low
        };
        let mut second = LagrangianSecondOrder::<f64>::new(&robot);
        for from in [0.3, 1.1] {
            let [q, v, a, w] = [1.0, 2.0, 3.0, 4.0]
                .map(|k| (0..n).map(|i| (from + k + 1.3 * i as f64).sin()).collect::<Vec<f64>>());
            let zz = second.contract_inverse_dynamics(&q, &v, &a, &w).unwrap().zz();
            for i in 0..3 * n {
                for j in 0..3 * n {
                    assert!(on_one_branch(i % n, j % n) || zz[(i, j)] == 0.0, "{i}, {j}: {}", zz[(i, j)]);
                }
            }
            assert_eq!(zz.view().to_nalgebra(), zz.view().to_nalgebra().transpose());
        }
    }

    #[test]
    fn products_of_pairs_give_what_the_dual_pass_gives() {
        for n in [1, 2, 3, 5, 7, 12, 13, 16, 23] {
            compare(&robot(n, |k| k.wrapping_sub(1), false));
            compare(&robot(n, |k| k / 2 + k % 3, false));
            // Not in the order of the branches.
            compare(&robot(n, |k| k.wrapping_sub(3), false));
            compare(&robot(n, |k| (k * k + 1) % (k + 2), true));
        }
    }
}
