//! Contracted Hessians of inverse and forward dynamics, by one dual pass through kernels one and two.

use super::inverse::torque_jacobian;
use super::{ForwardDynamicsLinearisation, Lagrangian, StateLinearisation};
use crate::error::EvalError;
use crate::hamiltonian::check;
use crate::kernels::{KernelOne, KernelTwo, friction_of};
use crate::matrix::{Block, Matrix, filled};
use crate::robot::{Robot, Tree};
use crate::scalar::{Scalar, Tangent};

/// Workspace for a, its Jacobian and its contracted Hessian of one robot; no call allocates.
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
/// Since `tau(q, v, a(q, v, u)) = u`, the contracted Hessian of forward dynamics is minus this Hessian for
/// `w = M^-1 y`, transformed by Z = (1, 0, 0; 0, 1, 0; a_q, a_v, a_u). Hence `y'a_uv = y'a_uu = 0`. No
/// factorisation is differentiated.
#[derive(Clone, Debug)]
pub struct LagrangianSecondOrder<S: Scalar> {
    first: Lagrangian<S>,
    kernel: KernelOne<Tangent<S>>,
    along: KernelTwo<Tangent<S>>,
    q: Vec<Tangent<S>>,
    v: Vec<Tangent<S>>,
    direction_q: Vec<Tangent<S>>,
    direction_v: Vec<Tangent<S>>,
    w: Vec<S>,
    w_tau_zz: Matrix<S>,
    xx: Matrix<S>,
    uq: Matrix<S>,
}

/// Forward dynamics, its Jacobian and its contracted Hessian at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct LagrangianContraction<'a, S> {
    forward_dynamics: ForwardDynamicsLinearisation<'a, S>,
    linearisation: StateLinearisation<'a, S>,
    xx: &'a Matrix<S>,
    uq: &'a Matrix<S>,
}

impl<'a, S: Scalar> LagrangianContraction<'a, S> {
    /// a and its Jacobian in z = (q, v, u).
    pub fn forward_dynamics(&self) -> ForwardDynamicsLinearisation<'a, S> {
        self.forward_dynamics
    }

    /// dx/dt = (v, a) and its Jacobians in x = (q, v) and u.
    pub fn linearisation(&self) -> StateLinearisation<'a, S> {
        self.linearisation
    }

    /// `sum_k y_k d2 a_k / dx dx`, x = (q, v), 2n x 2n, symmetric.
    pub fn xx(&self) -> Block<'a, S> {
        self.xx.view()
    }

    /// `sum_k y_k d2 a_k / du dq`, n x n: all other blocks in u are zero by structure.
    pub fn uq(&self) -> Block<'a, S> {
        self.uq.view()
    }

    /// A copy as a full symmetric 3n x 3n matrix, in the order z = (q, v, u).
    pub fn to_matrix(&self) -> Matrix<S> {
        whole_hessian(self.xx(), self.uq())
    }
}

/// The contracted Hessian of forward dynamics in z = (q, v, u) from its blocks
/// [`xx`](LagrangianContraction::xx), 2n x 2n, and [`uq`](LagrangianContraction::uq), n x n, as a full
/// symmetric 3n x 3n matrix.
pub fn whole_hessian<S: Scalar>(xx: Block<'_, S>, uq: Block<'_, S>) -> Matrix<S> {
    let n = uq.rows();
    let mut whole = Matrix::zeros(3 * n, 3 * n);
    for i in 0..2 * n {
        whole.row_mut(i)[..2 * n].copy_from_slice(xx.row(i));
    }
    for i in 0..n {
        for j in 0..n {
            whole[(2 * n + i, j)] = uq[(i, j)];
            whole[(j, 2 * n + i)] = uq[(i, j)];
        }
    }
    whole
}

impl<S: Scalar> LagrangianSecondOrder<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(Tree::from(robot))
    }

    /// As [`new`](Self::new), from an existing [`Tree`].
    pub fn from_tree(tree: Tree) -> Self {
        let n = tree.dof();
        let zero = Tangent::zero();
        Self {
            kernel: KernelOne::new(&tree),
            along: KernelTwo::new(&tree),
            first: Lagrangian::from_tree(tree),
            q: filled(zero, n),
            v: filled(zero, n),
            direction_q: filled(zero, n),
            direction_v: filled(zero, n),
            w: filled(S::zero(), n),
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

    /// `sum_k w_k d2 tau_k / dz dz`, z = (q, v, a): 3n x 3n, symmetric, for weights w of length n.
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
    ) -> Result<&Matrix<S>, EvalError> {
        self.first.check(&[("q", q), ("v", v), ("a", a), ("w", w)])?;
        self.first.rate[q.len()..].copy_from_slice(a);
        self.w.copy_from_slice(w);
        self.differentiate(q, v)?;
        Ok(&self.w_tau_zz)
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
        self.first.check(&[("q", q), ("v", v), ("u", u), ("y", y)])?;
        self.first.accelerate(q, v, u)?;
        self.w.copy_from_slice(y);
        self.first.factor.solve(&mut self.w);
        self.differentiate(q, v)?;
        let Lagrangian { tree, tau_q, tau_v, .. } = &mut self.first;
        torque_jacobian(tree, (&self.kernel, &self.along), |entry| entry.re, v, (tau_q, tau_v));
        self.first.subtract_wrench_slopes(q);
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
        check(self.first.tree(), "y", y, 2 * n)?;
        self.contract_forward_dynamics(q, v, u, &y[n..])
    }

    /// The dual pass at (q, v), with the acceleration of the first-order workspace, and the Hessian of w.tau
    /// from it.
    fn differentiate(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        let (tree, a) = (&self.first.tree, self.first.acceleration());
        for (i, &w) in self.w.iter().enumerate() {
            self.q[i] = Tangent::new(q[i], S::zero());
            self.v[i] = Tangent::new(v[i], w);
            self.direction_q[i] = Tangent::new(v[i], -w);
            self.direction_v[i] = Tangent::new(a[i], S::zero());
        }
        self.kernel.set_position(tree, &self.q)?;
        self.kernel.set_velocity(tree, &self.v)?;
        self.kernel.second_order(tree);
        self.along.differentiate(tree, &self.kernel, &self.direction_q, &self.direction_v)?;
        self.fill_torque_hessian(v);
        self.first.subtract_wrench_curvature(q, &self.w, &mut self.w_tau_zz);
        Ok(())
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
    fn transform(&mut self) {
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
