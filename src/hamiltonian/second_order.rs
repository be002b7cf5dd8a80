//! The contracted Hessian of the state equation by the 2n+1 rule.

use super::congruence::Congruence;
use super::{Hamiltonian, HamiltonianContraction, SecondKernel};
use crate::error::EvalError;
use crate::kernels::{check_entries, friction_of};
use crate::matrix::{Matrix, add_scaled, dot, filled};
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;

/// Workspace for F, F_x and y'F_xx of one robot; no call allocates.
///
/// F without friction is J grad H, so `y'F = w . grad H` with `w = (-y_p, y_q)`, and y'F_xx is the third
/// derivative of H along w. H is the extremal value of p.v - L(q, v) over v; third derivatives of an extremal
/// value need only the first-order response of the extremiser (Wigner's 2n+1 rule), which is
/// `V = dv/dx = [-M^-1 P, M^-1]`:
///
/// $$ y^T F\_{xx} = -E^T \left( D\_{\tilde w} \begin{pmatrix} L\_{qq} & P^T \\\\ P & M \end{pmatrix} \right)
/// E, \qquad E = \begin{pmatrix} 1 & 0 \\\\ -M^{-1} P & M^{-1} \end{pmatrix}, \qquad \tilde w = (w\_q, V w)
/// $$
///
/// D_w~ is [`KernelTwo`](crate::kernels::KernelTwo), or the same in the axes of the world where F_x has them;
/// the rest are products of n x n matrices with the factors of M. No factorisation is differentiated.
/// Friction D(v) shifts the direction, `w = (-y_p, y_q + D_v y_p)`, and adds `V' (y_p . D_vv) V`.
///
/// ```
/// use costate::hamiltonian::HamiltonianSecondOrder;
/// use costate::robot::Robot;
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
/// let (q, p, u, y) = ([0.3, -0.8], [1.0, 0.5], [0.0, 0.0], [1.0, -2.0, 0.5, 0.3]);
/// let all = second.contract(&q, &p, &u, &y)?;
/// println!("{}{}", all.linearisation().matrix().as_nalgebra(), all.matrix().as_nalgebra());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct HamiltonianSecondOrder<S: Scalar> {
    pub(super) first: Hamiltonian<S>,
    pub(super) along: SecondKernel<S>,
    pub(super) congruence: Congruence<S>,
    pub(super) y_f_xx: Matrix<S>,
    /// V d, and the factor of V' in a product with d.
    velocity_change: Vec<S>,
    pub(super) pull: Vec<S>,
    pub(super) product: Vec<S>,
}

impl<S: Scalar> HamiltonianSecondOrder<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(Tree::from(robot))
    }

    /// As [`new`](Self::new), from an existing [`Tree`].
    pub fn from_tree(tree: Tree) -> Self {
        let n = tree.dof();
        let first = Hamiltonian::from_tree(tree);
        Self {
            along: SecondKernel::new(first.tree(), &first.flow.kernel),
            congruence: Congruence::new(&first.flow.factor),
            first,
            y_f_xx: Matrix::zeros(2 * n, 2 * n),
            velocity_change: filled(S::zero(), n),
            pull: filled(S::zero(), n),
            product: filled(S::zero(), 2 * n),
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.first.dof()
    }

    /// The first-order workspace: F, F_x and y'F_x.
    pub fn first(&mut self) -> &mut Hamiltonian<S> {
        &mut self.first
    }

    /// F, F_x and `sum_k y_k d2 F_k / dx dx` for the costate y = (y_q, y_p) of length 2n, from one sweep.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn contract(
        &mut self,
        q: &[S],
        p: &[S],
        u: &[S],
        y: &[S],
    ) -> Result<HamiltonianContraction<'_, S>, EvalError> {
        self.first.check(&[("q", q), ("p", p), ("u", u)])?;
        check_entries(&self.first.tree, "y", y, 2 * self.dof())?;
        self.first.prepare([q, p, u])?;
        self.differentiate(p, y)?;
        // F_x is put together here: what kernel two has stored entry by entry just before is read whole next.
        self.first.assemble();
        self.congruence.apply(self.along.blocks(), &self.first.flow, &mut self.y_f_xx);
        let (first, y_p) = (&mut self.first, &y[p.len()..]);
        first.brackets.add_curvature(y_p, &first.state.f_x, &mut self.y_f_xx);
        first.add_slopes([q, p]);
        first.state.add_curvature(&first.tree, y_p, &mut self.y_f_xx);
        first.state.add_wrench_curvature(q, y_p, &mut self.y_f_xx);
        let linearisation = first.state.linearisation(first.flow.mass_matrix());
        Ok(HamiltonianContraction { linearisation, y_f_xx: &self.y_f_xx })
    }

    /// `y'F_xx d` for the costate y and a direction d = (d_q, d_p), 2n each, without the matrix and without
    /// F_x.
    ///
    /// With `e = V d`, A, B, C the blocks of kernel two as above, and `b = B d_q + C e` minus the curvature
    /// of friction: `y'F_xx d = -( A d_q + B' e - P' M^-1 b , M^-1 b )`. All products are matrix-vector
    /// products.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    #[inline(never)]
    pub fn hessian_product(&mut self, q: &[S], p: &[S], y: &[S], d: &[S]) -> Result<&[S], EvalError> {
        let n = self.dof();
        self.first.check(&[("q", q), ("p", p)])?;
        check_entries(&self.first.tree, "y", y, 2 * n)?;
        check_entries(&self.first.tree, "d", d, 2 * n)?;
        if !self.first.tree.free().is_empty() {
            return self.product_by_matrix([q, p, y, d]);
        }
        self.first.flow.first_order(&self.first.tree, q, p)?;
        self.first.flow.kernel.second_order(&self.first.tree);
        self.differentiate(p, y)?;
        let Hamiltonian { tree, flow, .. } = &self.first;
        let (d_q, d_p) = d.split_at(n);
        flow.velocity_change(d_q, d_p, &mut self.velocity_change);
        let (b, c) = (self.along.body.l_vq(), self.along.body.mass_matrix());
        for i in 0..n {
            self.pull[i] = dot(b.row(i), d_q) + dot(c.row(i), &self.velocity_change);
            if tree.has_coulomb_friction(i) {
                let curvature = friction_of(tree, i, flow.v[i]).second;
                self.pull[i] -= y[n + i] * curvature * self.velocity_change[i];
            }
        }
        flow.factor.solve(&mut self.pull);
        let (product_q, product_p) = self.product.split_at_mut(n);
        for i in 0..n {
            product_q[i] = -dot(self.along.body.l_qq().row(i), d_q);
            product_p[i] = -self.pull[i];
        }
        for k in 0..n {
            add_scaled(product_q, -self.velocity_change[k], b.row(k));
            add_scaled(product_q, self.pull[k], flow.kernel.body.l_vq().row(k));
        }
        self.first.state.add_wrench_product(q, &y[n..], d_q, &mut self.product);
        Ok(&self.product)
    }

    /// With floating and spherical joints.
    fn product_by_matrix(&mut self, [q, p, y, d]: [&[S]; 4]) -> Result<&[S], EvalError> {
        // The actuation does not enter.
        let mut none = std::mem::take(&mut self.pull);
        none.fill(S::zero());
        let outcome = self.contract(q, p, &none, y).map(drop);
        self.pull = none;
        outcome?;
        self.product.iter_mut().enumerate().for_each(|(i, entry)| *entry = dot(self.y_f_xx.row(i), d));
        Ok(&self.product)
    }

    /// Kernel two along w~. Kernel one must be at its third stage, and M factored.
    fn differentiate(&mut self, p: &[S], y: &[S]) -> Result<(), EvalError> {
        let Hamiltonian { tree, flow, direction, brackets, .. } = &mut self.first;
        direction.set_costate(tree, &flow.v, y);
        brackets.add_weights(p, &direction.q, &mut direction.p);
        flow.velocity_change(&direction.q, &direction.p, &mut direction.v);
        self.along.differentiate(tree, &mut flow.kernel, &flow.v, [&direction.q, &direction.v])
    }

    /// The third derivative of H along the axis of q_l, at the state of the last Jacobian; 2n x 2n.
    pub(super) fn along_joint(&mut self, l: usize) -> Result<&Matrix<S>, EvalError> {
        let Hamiltonian { tree, flow, direction, state, .. } = &mut self.first;
        direction.q.fill(S::zero());
        direction.p.fill(S::zero());
        direction.q[l] = S::one();
        for (i, v) in direction.v.iter_mut().enumerate() {
            *v = state.f_x[(i, l)];
        }
        self.along.differentiate(tree, &mut flow.kernel, &flow.v, [&direction.q, &direction.v])?;
        self.congruence.apply(self.along.blocks(), flow, &mut self.y_f_xx);
        Ok(&self.y_f_xx)
    }
}
