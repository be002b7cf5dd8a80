//! Contracted Hessians of inverse and forward dynamics, with values and Jacobians, by one dual pass through
//! kernels one and two.

use super::choice::Routes;
use super::inverse::{torque, torque_jacobian};
use super::{InverseDynamicsContraction, InverseDynamicsLinearisation, Lagrangian, LagrangianContraction};
use crate::error::EvalError;
use crate::kernels::{KernelOne, KernelTwo, check_entries, friction_of};
use crate::matrix::{Matrix, filled};
use crate::robot::{Robot, Tree};
use crate::scalar::{Scalar, Tangent};

/// Workspace for tau or a, their Jacobians and their contracted Hessians of one robot; no call allocates.
///
/// For constant w, the power `w.tau` of inverse dynamics consists of directional derivatives of L:
///
/// ```text
/// w.tau(q, v, a) = L''[(v, a), (0, w)] - L'[(w, 0)] - w.D ,
/// ```
///
/// so with `A = D_(0,w) L_qq`, `B = D_(0,w) P` (kernel one by a dual number along (0, w)) and the derivatives
/// `E = D_(0,w) D_(v,a) - D_(w,0)` of M, P and L_qq (kernel two along (v, a), by the same dual number, with
/// the direction's own derivative (-w, 0)), one pass gives its Hessian in (q, v, a):
///
/// $$ (w \cdot \tau)\_{zz} = \begin{pmatrix} E\_{L\_{qq}} & (E\_P + A)^T & B^T \\\\
/// E\_P + A & E\_M + B + B^T - w D\_{vv} & 0 \\\\ B & 0 & 0 \end{pmatrix} $$
///
/// The real parts of the same pass are kernel one at (q, v) and kernel two along (v, a): they give tau and
/// its Jacobian.
///
/// Since `tau(q, v, a(q, v, u)) = u`, the contracted Hessian of forward dynamics is minus this Hessian for
/// `w = M^-1 y`, transformed by Z = (1, 0, 0; 0, 1, 0; a_q, a_v, a_u). Hence `y'a_uv = y'a_uu = 0`. No
/// factorisation is differentiated.
#[derive(Clone, Debug)]
pub struct LagrangianSecondOrder<S: Scalar> {
    pub(super) first: Lagrangian<S>,
    pub(super) kernel: KernelOne<Tangent<S>>,
    pub(super) along: KernelTwo<Tangent<S>>,
    q: Vec<Tangent<S>>,
    v: Vec<Tangent<S>>,
    direction_q: Vec<Tangent<S>>,
    pub(super) direction_v: Vec<Tangent<S>>,
    pub(super) w: Vec<S>,
    pub(super) tau_a: Matrix<S>,
    pub(super) w_tau_zz: Matrix<S>,
    pub(super) xx: Matrix<S>,
    pub(super) uq: Matrix<S>,
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
        let (n, nq) = (tree.dof(), tree.nq());
        let zero = Tangent::zero();
        Self {
            kernel: KernelOne::new(&tree),
            along: KernelTwo::new(&tree),
            first: Lagrangian::with_routes(Routes::of::<T>(&tree), tree),
            q: filled(zero, nq),
            v: filled(zero, n),
            direction_q: filled(zero, n),
            direction_v: filled(zero, n),
            w: filled(S::zero(), n),
            tau_a: Matrix::zeros(n, n),
            w_tau_zz: Matrix::zeros(3 * n, 3 * n),
            xx: Matrix::zeros(2 * n, 2 * n),
            uq: Matrix::zeros(n, n),
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
        if self.first.free.is_some() {
            return self.contract_inverse_dynamics_free([q, v, a, w]);
        }
        self.first.check(&[("q", q), ("v", v), ("a", a), ("w", w)])?;
        self.first.rate[q.len()..].copy_from_slice(a);
        self.w.copy_from_slice(w);
        self.differentiate(q, v)?;
        self.take_torque_jacobian(q, v);
        self.take_torque(q, v, a);
        let Lagrangian { tau, tau_q, tau_v, .. } = &self.first;
        let inverse_dynamics = InverseDynamicsLinearisation { tau, tau_q, tau_v, tau_a: &self.tau_a };
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
        if self.first.free.is_some() {
            return self.contract_forward_dynamics_free([q, v, u, y]);
        }
        self.first.check(&[("q", q), ("v", v), ("u", u), ("y", y)])?;
        self.first.accelerate(q, v, u)?;
        self.w.copy_from_slice(y);
        self.first.factor.solve(&mut self.w);
        self.differentiate(q, v)?;
        self.take_torque_jacobian(q, v);
        self.first.pack_torque();
        self.first.solve_jacobian();
        self.first.assemble();
        self.transform();
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

    /// The dual pass at (q, v), with the acceleration of the first-order workspace, and the Hessian of w.tau
    /// from it.
    fn differentiate(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        for i in 0..v.len() {
            self.direction_v[i] = Tangent::new(self.first.acceleration()[i], S::zero());
        }
        self.pass(q, v)?;
        self.first.subtract_wrench_curvature(q, &self.w, &mut self.w_tau_zz);
        Ok(())
    }

    /// The dual pass at (q, v), with the acceleration in `direction_v`.
    pub(super) fn pass(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        let tree = &self.first.tree;
        self.q.iter_mut().zip(q).for_each(|(dual, &q)| *dual = Tangent::new(q, S::zero()));
        for (i, &w) in self.w.iter().enumerate() {
            self.v[i] = Tangent::new(v[i], w);
            self.direction_q[i] = Tangent::new(v[i], -w);
        }
        self.kernel.set_position(tree, &self.q)?;
        self.kernel.set_velocity(tree, &self.v)?;
        self.kernel.second_order(tree);
        self.along.differentiate(tree, &self.kernel, &self.direction_q, &self.direction_v)?;
        self.fill_torque_hessian(v);
        Ok(())
    }

    /// Fills tau_q and tau_v from the real parts of the dual pass.
    fn take_torque_jacobian(&mut self, q: &[S], v: &[S]) {
        let Lagrangian { tree, tau_q, tau_v, .. } = &mut self.first;
        torque_jacobian(tree, (&self.kernel, &self.along), |entry| entry.re, v, (tau_q, tau_v));
        self.first.subtract_wrench_slopes(q);
    }

    /// Fills tau and tau_a from them.
    fn take_torque(&mut self, q: &[S], v: &[S], a: &[S]) {
        let mass_matrix = self.kernel.mass_matrix();
        for i in 0..q.len() {
            let row = self.tau_a.row_mut(i).iter_mut().zip(mass_matrix.row(i));
            row.for_each(|(entry, m)| *entry = m.re);
        }
        let Lagrangian { tree, tau, .. } = &mut self.first;
        torque(tree, &self.kernel, |entry| entry.re, (v, a), tau);
        self.first.subtract_wrenches(q);
    }

    /// The blocks of the Hessian of w.tau, both triangles.
    fn fill_torque_hessian(&mut self, v: &[S]) {
        let n = self.w.len();
        let (p, l_qq) = (self.kernel.l_vq(), self.kernel.l_qq());
        let (e_m, e_p, e_l_qq) = (self.along.mass_matrix(), self.along.l_vq(), self.along.l_qq());
        let h = &mut self.w_tau_zz;
        for i in 0..n {
            for j in 0..n {
                h[(i, j)] = e_l_qq[(i, j)].eps;
                h[(n + i, n + j)] = e_m[(i, j)].eps + (p[(i, j)].eps + p[(j, i)].eps);
                let mixed = e_p[(i, j)].eps + l_qq[(i, j)].eps;
                h[(n + i, j)] = mixed;
                h[(j, n + i)] = mixed;
                h[(2 * n + i, j)] = p[(i, j)].eps;
                h[(j, 2 * n + i)] = p[(i, j)].eps;
            }
        }
        let tree = &self.first.tree;
        for &i in tree.with_friction() {
            if tree.has_coulomb_friction(i) {
                h[(n + i, n + i)] -= self.w[i] * friction_of(tree, i, v[i]).second;
            }
        }
    }

    /// `y'a_zz = -Z' (w.tau)_zz Z`, Z with the rows (1, 0, 0), (0, 1, 0), a_z; of its products only
    /// `K = a_z' B` is not trivial. It is added to the rows of z and the columns of q, and its transpose to
    /// the transposed block.
    pub(super) fn transform(&mut self) {
        let n = self.w.len();
        let (h, xx, uq) = (&self.w_tau_zz, &mut self.xx, &mut self.uq);
        for i in 0..2 * n {
            xx.row_mut(i).iter_mut().zip(h.row(i)).for_each(|(entry, &h)| *entry = -h);
        }
        uq.fill_zero();
        for k in 0..n {
            let b = &h.row(2 * n + k)[..n];
            for (i, &moved) in self.first.a_z.row(k).iter().enumerate() {
                let row = if i < 2 * n { &mut xx.row_mut(i)[..n] } else { uq.row_mut(i - 2 * n) };
                row.iter_mut().zip(b).for_each(|(entry, &b)| *entry -= moved * b);
            }
        }
        self.add_transpose();
    }

    /// Completes [`transform`](Self::transform): K' in (q, q), and the transposed block.
    fn add_transpose(&mut self) {
        let n = self.w.len();
        let (h, xx) = (&self.w_tau_zz, &mut self.xx);
        for i in 0..n {
            for j in 0..=i {
                // Each of the two holds -h - K; the sum is -2 h - K - K'.
                let entry = xx[(i, j)] + xx[(j, i)] + h[(i, j)];
                xx[(i, j)] = entry;
                xx[(j, i)] = entry;
            }
            for j in n..2 * n {
                xx[(i, j)] = xx[(j, i)];
            }
        }
    }
}
