//! The contracted Hessian of the constrained state equation by the 2n+1 rule.

use super::ConstrainedHamiltonian;
use super::blocks::Changing;
use super::linearisation::ConstrainedContraction;
use crate::error::{EvalError, check_length};
use crate::hamiltonian::SecondKernel;
use crate::kernels::{check_entries, friction_of};
use crate::matrix::{Left, Matrix, Panel, Part, add_scaled, dot, filled};
use crate::robot::Robot;
use crate::scalar::Scalar;

/// Workspace for F, F_x and y'F_xx of a robot with constraints; no call allocates.
///
/// H_c is an extremal value over s = (v, mu), so that its third derivatives need only the response s_x of
/// [`ConstrainedHamiltonian`]:
///
/// $$ y^T F\_{xx} = -E^T \left( D\_{\tilde w} \begin{pmatrix}
/// L\_{qq} - (\mu \cdot J v)\_{qq} & PP^T \\\\ PP & MM \end{pmatrix} \right) E,
/// \qquad E = \begin{pmatrix} 1 & 0 \\\\ s\_q & s\_p \end{pmatrix}, \qquad
/// \tilde w = (w\_q, s\_x w) $$
///
/// with `w = (-y_p, y_q + D_v y_p)` and the curvature `V' (y_p . D_vv) V` of friction. D_w~ of M, P and L_qq
/// is [`KernelTwo`](crate::kernels::KernelTwo), or that in the axes of the world with floating or spherical
/// joints.
#[derive(Clone, Debug)]
pub struct ConstrainedHamiltonianSecondOrder<S: Scalar> {
    pub(super) first: ConstrainedHamiltonian<S>,
    along: SecondKernel<S>,
    changing: Changing<S>,
    pub(super) y_f_xx: Matrix<S>,
    panels: Box<Panels<S>>,
    /// Response to a direction, and the change of the derivatives of Lc by s along it.
    pub(super) response: [Vec<S>; 2],
    force: [Vec<S>; 2],
    pub(super) product: Vec<S>,
}

/// The factors of the congruence, rows of v and of mu.
#[derive(Clone, Debug)]
struct Panels<S: Scalar> {
    /// `dMM / 2`.
    half: Panel<S>,
    /// s_x, and R of [`congruence`](ConstrainedHamiltonianSecondOrder::congruence).
    response: Panel<S>,
    pull: Panel<S>,
    /// `s_x' R`, and that with its transpose.
    product: Panel<S>,
    sum: Panel<S>,
}

impl<S: Scalar> ConstrainedHamiltonianSecondOrder<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        let first = ConstrainedHamiltonian::new(robot);
        let (n, k) = (first.dof(), first.mu.len());
        let both = [filled(S::zero(), n), filled(S::zero(), k)];
        Self {
            along: SecondKernel::new(&first.tree, &first.kernel),
            changing: Changing::new(&first.tree),
            y_f_xx: Matrix::zeros(2 * n, 2 * n),
            panels: Box::new(Panels {
                half: Panel::zeros(n + k, n + k),
                response: Panel::zeros(n + k, 2 * n),
                pull: Panel::zeros(n + k, 2 * n),
                product: Panel::zeros(2 * n, 2 * n),
                sum: Panel::zeros(2 * n, 2 * n),
            }),
            response: both.clone(),
            force: both,
            product: filled(S::zero(), 2 * n),
            first,
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.first.dof()
    }

    /// The first-order workspace: F, F_x and y'F_x.
    pub fn first(&mut self) -> &mut ConstrainedHamiltonian<S> {
        &mut self.first
    }

    /// The same, to read from.
    pub(crate) fn constrained(&self) -> &ConstrainedHamiltonian<S> {
        &self.first
    }

    /// F, F_x and `sum_k y_k d2 F_k / dx dx` for the costate y = (y_q, y_p) of length 2n.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`].
    pub fn contract(
        &mut self,
        q: &[S],
        p: &[S],
        u: &[S],
        y: &[S],
    ) -> Result<ConstrainedContraction<'_, S>, EvalError> {
        let n = self.dof();
        self.first.check(&[("q", q), ("p", p), ("u", u)])?;
        check_entries(&self.first.tree, "y", y, 2 * n)?;
        self.first.prepare(q, p)?;
        self.differentiate([q, p], y)?;
        self.first.rate([q, p, u]);
        self.first.conservative();
        self.congruence();
        self.first.brackets.add_curvature(&y[n..], &self.first.f_x, &mut self.y_f_xx);
        self.first.add_slopes([q, p]);
        self.first.balance();
        self.add_friction(&y[n..]);
        if let Some(external) = &mut self.first.external {
            let curvature = external.curvature(q, &y[n..]);
            for i in 0..n {
                add_scaled(&mut self.y_f_xx.row_mut(i)[..n], S::one(), curvature.row(i));
            }
        }
        Ok(ConstrainedContraction { linearisation: self.first.linearisation(), y_f_xx: &self.y_f_xx })
    }

    /// `y'F_xx d` for the costate y and a direction d = (d_q, d_p), 2n each, without the matrix and without
    /// F_x.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`].
    pub fn hessian_product(&mut self, q: &[S], p: &[S], y: &[S], d: &[S]) -> Result<&[S], EvalError> {
        let n = self.dof();
        self.first.check(&[("q", q), ("p", p)])?;
        check_entries(&self.first.tree, "y", y, 2 * n)?;
        check_entries(&self.first.tree, "d", d, 2 * n)?;
        if !self.first.tree.free().is_empty() {
            // The actuation does not enter.
            let mut none = std::mem::take(&mut self.response[0]);
            none.fill(S::zero());
            let outcome = self.contract(q, p, &none, y).map(drop);
            self.response[0] = none;
            outcome?;
            self.product.iter_mut().zip(0..).for_each(|(entry, i)| *entry = dot(self.y_f_xx.row(i), d));
            return Ok(&self.product);
        }
        self.first.prepare(q, p)?;
        self.differentiate([q, p], y)?;
        let (d_q, d_p) = d.split_at(n);
        let Self { first, along, changing: Changing { blocks, .. }, .. } = self;
        let [dv, dmu] = &mut self.response;
        first.respond(d_q, d_p, [dv, dmu]);
        let [r_v, r_mu] = &mut self.force;
        // dPP d_q + dMM s_x d.
        for (i, r) in r_v.iter_mut().enumerate() {
            let moved = dot(along.body.l_vq().row(i), d_q) - dot(blocks.curvature.row(i), d_q);
            *r = moved + dot(along.body.mass_matrix().row(i), dv);
            if first.tree.has_coulomb_friction(i) {
                *r -= y[n + i] * friction_of(&first.tree, i, first.v[i]).second * dv[i];
            }
        }
        for (i, r) in r_mu.iter_mut().enumerate() {
            *r = -(dot(blocks.slope.row(i), d_q) + dot(blocks.jacobian.row(i), dv));
            add_scaled(r_v, -dmu[i], blocks.jacobian.row(i));
        }
        let (product_q, product_p) = self.product.split_at_mut(n);
        for (i, entry) in product_q.iter_mut().enumerate() {
            *entry = dot(blocks.bend.row(i), d_q) - dot(along.body.l_qq().row(i), d_q);
        }
        for (i, &dv) in dv.iter().enumerate() {
            add_scaled(product_q, -dv, along.body.l_vq().row(i));
            add_scaled(product_q, dv, blocks.curvature.row(i));
        }
        for (i, &dmu) in dmu.iter().enumerate() {
            add_scaled(product_q, dmu, blocks.slope.row(i));
        }
        // s_q' r = -PP' MM^-1 r, s_p' r = the part of v of MM^-1 r.
        first.kkt.solve(&first.factor, r_v, r_mu);
        for (i, &r) in r_v.iter().enumerate() {
            add_scaled(product_q, r, first.cross.row(i));
            product_p[i] = -r;
        }
        for (i, &r) in r_mu.iter().enumerate() {
            add_scaled(product_q, -r, first.moving.blocks.slope.row(i));
        }
        if let Some(external) = &mut first.external {
            let curvature = external.curvature(q, &y[n..]);
            for (i, entry) in product_q.iter_mut().enumerate() {
                *entry += dot(curvature.row(i), d_q);
            }
        }
        Ok(&self.product)
    }

    /// `sum_i y_i d2 v_i / dx dx + sum_i c_i d2 mu_i / dx dx`, 2n x 2n, symmetric, for weights y (n) of the
    /// velocities and c (k) of the multipliers; v_x and mu_x are those of
    /// [`linearise`](ConstrainedHamiltonian::linearise).
    ///
    /// The formula is that of y'F_xx with `w~ = (0, MM^-1 (y; c))`.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`].
    pub fn velocity_hessian(&mut self, q: &[S], p: &[S], y: &[S], c: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.first.check(&[("q", q), ("p", p), ("y", y)])?;
        check_length("c", c, self.first.mu.len())?;
        self.first.responses_at(q, p)?;
        self.first.set_weights(y, c);
        self.along_response(q)?;
        self.congruence();
        Ok(&self.y_f_xx)
    }

    /// The derivatives of all blocks along `w~`.
    fn differentiate(&mut self, [q, p]: [&[S]; 2], y: &[S]) -> Result<(), EvalError> {
        self.first.set_costate(p, y);
        self.along_response(q)
    }

    /// The same for the direction that is set.
    fn along_response(&mut self, q: &[S]) -> Result<(), EvalError> {
        let ConstrainedHamiltonian { tree, kernel, v, mu, direction, change: [dv, dmu], .. } =
            &mut self.first;
        let [w_q, _] = direction;
        self.along.differentiate(tree, kernel, v, [w_q, dv])?;
        self.changing.place([q, v, mu], [w_q, dv, dmu]);
        Ok(())
    }

    /// `-(dLL_qq + s_x' R + R' s_x)` with `R = dPP [1 0] + dMM s_x / 2`, both triangles.
    #[inline(never)]
    fn congruence(&mut self) {
        let n = self.dof();
        let Self { first, along, changing: Changing { blocks, .. }, panels, y_f_xx, .. } = self;
        let [m, p, l_qq] = along.blocks();
        let Panels { half, response, pull, product, sum } = &mut **panels;
        for i in 0..n {
            response.read_row::<0>(i, first.f_x.row(i));
            (0..n).for_each(|j| half.set(i, j, m.entry(i, j).times(0.5)));
        }
        for l in 0..first.mu.len() {
            response.read_row::<0>(n + l, first.mu_x.row(l));
            for (j, &entry) in blocks.jacobian.row(l).iter().enumerate() {
                half.set(n + l, j, entry.times(-0.5));
                half.set(j, n + l, entry.times(-0.5));
            }
        }
        pull.set_product::<0, 0>(Left::Rows(half), response, Part::Whole);
        for i in 0..n {
            for (j, &curvature) in blocks.curvature.row(i).iter().enumerate() {
                pull.set(i, j, pull.get(i, j) + p.entry(i, j) - curvature);
            }
        }
        for l in 0..first.mu.len() {
            for (j, &slope) in blocks.slope.row(l).iter().enumerate() {
                pull.set(n + l, j, pull.get(n + l, j) - slope);
            }
        }
        product.set_product::<0, 0>(Left::Columns(response), pull, Part::Whole);
        sum.add_transpose(product);
        (0..2 * n).for_each(|i| sum.write_row::<0>(i, y_f_xx.row_mut(i), |pack| -pack));
        for i in 0..n {
            for j in 0..=i {
                let entry = y_f_xx[(i, j)] + blocks.bend[(i, j)] - l_qq.entry(i, j);
                y_f_xx[(i, j)] = entry;
                y_f_xx[(j, i)] = entry;
            }
        }
    }

    /// `V' (y_p . D_vv) V`, V the rows of v in F_x.
    fn add_friction(&mut self, y_p: &[S]) {
        let Self { first, y_f_xx, .. } = self;
        for &l in first.tree.with_friction() {
            if !first.tree.has_coulomb_friction(l) {
                continue;
            }
            let (curvature, v) = (y_p[l] * first.friction[l].second, first.f_x.row(l));
            for (i, &along) in v.iter().enumerate() {
                add_scaled(y_f_xx.row_mut(i), curvature * along, v);
            }
        }
    }
}
