//! Forces of constraints with first and contracted second derivatives, by (q, v, u) or (q, p, u).

use crate::Coordinates;
use crate::constraints::{ConstrainedHamiltonianSecondOrder, ConstrainedLagrangianSecondOrder};
use crate::error::{EvalError, check_length};
use crate::matrix::{Block, Matrix, add_scaled, filled};
use crate::robot::Robot;
use crate::scalar::Scalar;

/// Workspace for the forces lambda of the constraints of one robot as functions of z = (q, v, u) or z = (q,
/// p, u), with their derivatives; no call allocates.
///
/// In (q, v, u) these are those of [`ConstrainedLagrangianSecondOrder`], for every v. In (q, p, u) they are
/// those of the motion that (q, p) is a state of, with v(q, p) of the constrained Legendre transform:
///
/// $$ \lambda(q, p, u) = \lambda(q, v(q, p), u), \qquad (c \cdot \lambda)\_{zz} = T^T (c \cdot
/// \lambda)\_{(q v u)(q v u)} T + ((c \cdot \lambda)\_v \cdot v)\_{zz}, \qquad T = \begin{pmatrix} 1 & 0 & 0
/// \\\\ v\_q & v\_p & 0 \\\\ 0 & 0 & 1 \end{pmatrix} $$
///
/// whose last term is [`velocity_hessian`](ConstrainedHamiltonianSecondOrder::velocity_hessian). This is
/// `lambda = mu_x F`, the rate of the multipliers mu.
///
/// Slices q (rad, m), v (rad/s, m/s) or p (kg m^2/s, kg m/s) and u (N m, N) have n entries, lambda and its
/// weights k. Methods can fail as those of
/// [`ConstrainedLagrangian`](crate::constraints::ConstrainedLagrangian).
#[derive(Clone, Debug)]
pub struct ForceMap<S: Scalar> {
    lagrangian: ConstrainedLagrangianSecondOrder<S>,
    /// Where z has momenta.
    hamiltonian: Option<Box<ConstrainedHamiltonianSecondOrder<S>>>,
    v: Vec<S>,
    lambda: Vec<S>,
    none: [Vec<S>; 2],
    weights: Vec<S>,
    lambda_z: Matrix<S>,
    product: Matrix<S>,
    zz: Matrix<S>,
}

/// lambda and its Jacobian at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct ForceLinearisation<'a, S> {
    lambda: &'a [S],
    lambda_z: &'a Matrix<S>,
}

impl<'a, S: Scalar> ForceLinearisation<'a, S> {
    /// Forces of the constraints, k, with units and axes as in
    /// [`ConstrainedLinearisation::lambda`](crate::constraints::ConstrainedLinearisation::lambda).
    pub fn lambda(&self) -> &'a [S] {
        self.lambda
    }

    /// `lambda_z`, k x 3n, columns in the order (q, v, u) or (q, p, u).
    pub fn lambda_z(&self) -> Block<'a, S> {
        self.lambda_z.view()
    }
}

/// lambda, its Jacobian and one contracted second derivative at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct ForceContraction<'a, S> {
    linearisation: ForceLinearisation<'a, S>,
    zz: &'a Matrix<S>,
}

impl<'a, S: Scalar> ForceContraction<'a, S> {
    /// lambda and its Jacobian.
    pub fn linearisation(&self) -> ForceLinearisation<'a, S> {
        self.linearisation
    }

    /// `(c . lambda)_zz`, 3n x 3n, symmetric.
    pub fn matrix(&self) -> Block<'a, S> {
        self.zz.view()
    }
}

impl<S: Scalar> ForceMap<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot, coordinates: Coordinates) -> Self {
        let lagrangian = ConstrainedLagrangianSecondOrder::<S>::new(robot);
        let (n, k) = (lagrangian.dof(), lagrangian.constrained().constraints().count());
        let momenta = coordinates == Coordinates::Hamiltonian;
        Self {
            hamiltonian: momenta.then(|| Box::new(ConstrainedHamiltonianSecondOrder::new(robot))),
            v: filled(S::zero(), n),
            lambda: filled(S::zero(), k),
            none: [filled(S::zero(), n), filled(S::zero(), k)],
            weights: filled(S::zero(), n),
            lambda_z: Matrix::zeros(k, 3 * n),
            product: Matrix::zeros(3 * n, 3 * n),
            zz: Matrix::zeros(3 * n, 3 * n),
            lagrangian,
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.v.len()
    }

    /// Number of forces, k.
    pub fn count(&self) -> usize {
        self.lambda.len()
    }

    /// lambda at (q, v, u) or (q, p, u).
    ///
    /// # Errors
    /// See [`ForceMap`].
    pub fn evaluate(&mut self, q: &[S], rate: &[S], u: &[S]) -> Result<&[S], EvalError> {
        self.take_velocity(q, rate)?;
        let (_, lambda) = self.lagrangian.first().evaluate(q, &self.v, u)?;
        self.lambda.copy_from_slice(lambda);
        Ok(&self.lambda)
    }

    /// lambda and its Jacobian.
    ///
    /// # Errors
    /// See [`ForceMap`].
    pub fn linearise(
        &mut self,
        q: &[S],
        rate: &[S],
        u: &[S],
    ) -> Result<ForceLinearisation<'_, S>, EvalError> {
        self.take_velocity(q, rate)?;
        let linear = self.lagrangian.first().linearise(q, &self.v, u)?;
        self.lambda.copy_from_slice(linear.lambda());
        for i in 0..self.lambda.len() {
            self.lambda_z.row_mut(i).copy_from_slice(linear.lambda_z().row(i));
        }
        if let Some(hamiltonian) = &mut self.hamiltonian {
            let first = hamiltonian.first();
            first.linearise_velocity(q, rate)?;
            change_columns(first.velocity_x(), &mut self.weights, &mut self.lambda_z);
        }
        Ok(ForceLinearisation { lambda: &self.lambda, lambda_z: &self.lambda_z })
    }

    /// lambda, its Jacobian and `sum c_i d2 lambda_i / dz dz` for the weights c (k).
    ///
    /// # Errors
    /// See [`ForceMap`].
    pub fn contract(
        &mut self,
        q: &[S],
        rate: &[S],
        u: &[S],
        c: &[S],
    ) -> Result<ForceContraction<'_, S>, EvalError> {
        check_length("c", c, self.lambda.len())?;
        self.take_velocity(q, rate)?;
        let Self { lagrangian, hamiltonian, v, lambda, none, weights, lambda_z, product, zz } = self;
        let n = v.len();
        let all = lagrangian.contract([q, v, u], &none[0], c)?;
        lambda.copy_from_slice(all.linearisation().lambda());
        for i in 0..lambda.len() {
            lambda_z.row_mut(i).copy_from_slice(all.linearisation().lambda_z().row(i));
        }
        for i in 0..3 * n {
            zz.row_mut(i).copy_from_slice(all.matrix().row(i));
        }
        if let Some(hamiltonian) = hamiltonian {
            weights.fill(S::zero());
            for (i, &c) in c.iter().enumerate() {
                add_scaled(weights, c, &lambda_z.row(i)[n..2 * n]);
            }
            let curvature = hamiltonian.velocity_hessian(q, rate, weights, &none[1])?;
            for i in 0..3 * n {
                product.row_mut(i).fill(S::zero());
            }
            for i in 0..2 * n {
                product.row_mut(i)[..2 * n].copy_from_slice(curvature.row(i));
            }
            let v_x = hamiltonian.constrained().velocity_x();
            change_columns(v_x, weights, zz);
            // T' times it.
            for i in 0..n {
                add_scaled(product.row_mut(i), S::one(), zz.row(i));
                add_scaled(product.row_mut(2 * n + i), S::one(), zz.row(2 * n + i));
            }
            for l in 0..n {
                for (i, &along) in v_x.row(l).iter().enumerate() {
                    add_scaled(product.row_mut(i), along, zz.row(n + l));
                }
            }
            // Both triangles are one to the last digit.
            for i in 0..3 * n {
                for j in 0..=i {
                    let entry = (product[(i, j)] + product[(j, i)]).times(0.5);
                    zz[(i, j)] = entry;
                    zz[(j, i)] = entry;
                }
            }
            change_columns(v_x, weights, lambda_z);
        }
        Ok(ForceContraction { linearisation: ForceLinearisation { lambda, lambda_z }, zz })
    }

    /// v, itself or at (q, p).
    fn take_velocity(&mut self, q: &[S], rate: &[S]) -> Result<(), EvalError> {
        match &mut self.hamiltonian {
            Some(hamiltonian) => self.v.copy_from_slice(hamiltonian.first().velocity(q, rate)?.0),
            None => {
                check_length("v", rate, self.v.len())?;
                self.v.copy_from_slice(rate);
            }
        }
        Ok(())
    }
}

/// Rows by (q, v, u) become rows by (q, p, u): times T, with v_x, n x 2n.
fn change_columns<S: Scalar>(v_x: Block<'_, S>, buffer: &mut [S], rows: &mut Matrix<S>) {
    let n = buffer.len();
    for i in 0..rows.rows() {
        let row = rows.row_mut(i);
        let (in_x, _) = row.split_at_mut(2 * n);
        buffer.copy_from_slice(&in_x[n..]);
        in_x[n..].fill(S::zero());
        for (&by_v, along) in buffer.iter().zip(v_x.iter_rows()) {
            add_scaled(in_x, by_v, along);
        }
    }
}
