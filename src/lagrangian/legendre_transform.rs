//! The Legendre transform between (q, v) and (q, p): states, rates, Jacobians and costates.

use super::{Lagrangian, StateLinearisation};
use crate::error::{EvalError, LengthError, check_length};
use crate::matrix::{Block, Matrix, filled};
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;

/// Workspace for the change of coordinates (q, v) <-> (q, p), p = M v; no call allocates.
///
/// The map has the Jacobian T, with the rate dT/dt along the motion:
///
/// $$ T = \begin{pmatrix} 1 & 0 \\\\ P & M \end{pmatrix}, \qquad
/// \dot T = \begin{pmatrix} 0 & 0 \\\\ \dot P & \dot M \end{pmatrix}, \qquad
/// T^{-1} = \begin{pmatrix} 1 & 0 \\\\ -M^{-1} P & M^{-1} \end{pmatrix} $$
///
/// $$ F = T G, \qquad F\_x = (T G\_z + \dot T) T^{-1}, \qquad
/// G\_z = T^{-1} (F\_x T - \dot T), \qquad y\_z = T^T y\_x $$
///
/// for dz/dt = G(z), z = (q, v), and dx/dt = F(x), x = (q, p). Friction and actuation are part of F and G.
///
/// ```
/// use costate::{hamiltonian::Hamiltonian, lagrangian::LegendreTransform, robot::Robot};
///
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let (q, v, u) = ([0.3, -0.8], [1.0, 0.5], [0.2, 0.0]);
/// let mut coordinates = LegendreTransform::<f64>::new(&robot);
/// let mut state = coordinates.at(&q, &v, &u)?;
/// let p = state.momentum().to_vec();
/// let f_x = state.hamiltonian().f_x.view().to_nalgebra();
/// let direct = Hamiltonian::<f64>::new(&robot).linearise(&q, &p, &u)?.matrix().to_nalgebra();
/// assert!((f_x - direct).amax() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct LegendreTransform<S: Scalar> {
    pub(super) lagrangian: Lagrangian<S>,
    v: Vec<S>,
    f: Vec<S>,
    f_u: Matrix<S>,
    given: Matrix<S>,
    half: Matrix<S>,
    changed: Matrix<S>,
}

/// The Legendre map at one state; borrowed from the workspace.
#[derive(Debug)]
pub struct LegendreMap<'a, S: Scalar>(&'a mut LegendreTransform<S>);

impl<S: Scalar> LegendreTransform<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(Tree::from(robot))
    }

    /// As [`new`](Self::new), from an existing [`Tree`].
    pub fn from_tree(tree: Tree) -> Self {
        let n = tree.dof();
        let mut f_u = Matrix::zeros(2 * n, n);
        (0..n).for_each(|i| f_u[(n + i, i)] = S::one());
        Self {
            lagrangian: Lagrangian::from_tree(tree),
            v: filled(S::zero(), n),
            f: filled(S::zero(), 2 * n),
            f_u,
            given: Matrix::zeros(2 * n, 2 * n),
            half: Matrix::zeros(2 * n, 2 * n),
            changed: Matrix::zeros(2 * n, 2 * n),
        }
    }

    /// The map at (q, v) under the actuation u.
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub fn at(&mut self, q: &[S], v: &[S], u: &[S]) -> Result<LegendreMap<'_, S>, EvalError> {
        self.lagrangian.linearise_by_kernels(q, v, u)?;
        Ok(LegendreMap(self))
    }

    /// The map at (q, p) under the actuation u: at `v = M^-1 p`.
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub fn at_momentum(&mut self, q: &[S], p: &[S], u: &[S]) -> Result<LegendreMap<'_, S>, EvalError> {
        self.lagrangian.check_plain(q, &[("p", p), ("u", u)])?;
        self.lagrangian.factor(q)?;
        self.v.copy_from_slice(p);
        self.lagrangian.factor.solve(&mut self.v);
        self.lagrangian.linearise_by_kernels(q, &self.v, u)?;
        Ok(LegendreMap(self))
    }
}

impl<S: Scalar> LegendreMap<'_, S> {
    fn n(&self) -> usize {
        self.0.lagrangian.dof()
    }

    /// v, n (rad/s, m/s).
    pub fn velocity(&self) -> &[S] {
        &self.0.lagrangian.rate[..self.n()]
    }

    /// `p = M v`, n (kg m^2/s, kg m/s).
    pub fn momentum(&self) -> &[S] {
        self.0.lagrangian.kernel.momentum()
    }

    /// The state equation in (q, v): G, G_z and G_u.
    pub fn lagrangian(&self) -> StateLinearisation<'_, S> {
        let Lagrangian { rate, f_x, f_u, .. } = &self.0.lagrangian;
        StateLinearisation { f: rate, f_x, f_u }
    }

    /// The state equation in (q, p), transformed from that in (q, v): F = (v, P v + M a), F_x and
    /// `F_u = (0 ; 1)`.
    pub fn hamiltonian(&mut self) -> StateLinearisation<'_, S> {
        let LegendreTransform { lagrangian, f, given, .. } = &mut *self.0;
        let (v, a) = lagrangian.rate.split_at(lagrangian.dof());
        let (f_q, f_p) = f.split_at_mut(v.len());
        f_q.copy_from_slice(v);
        for (i, rate) in f_p.iter_mut().enumerate() {
            let in_q = lagrangian.kernel.l_vq().row(i).iter().zip(v);
            let in_v = lagrangian.kernel.mass_matrix().row(i).iter().zip(a);
            *rate = in_q.chain(in_v).fold(S::zero(), |sum, (&entry, &rate)| sum + entry * rate);
        }
        given.copy_from(&lagrangian.f_x);
        self.change_to_hamiltonian();
        StateLinearisation { f: &self.0.f, f_x: &self.0.changed, f_u: &self.0.f_u }
    }

    /// `F_x = (T G_z + dT/dt) T^-1`, 2n x 2n: transforms the Jacobian G_z in (q, v) of any G with this rate
    /// dz/dt.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`] unless G_z is 2n x 2n.
    pub fn jacobian_to_hamiltonian(&mut self, g_z: Block<'_, S>) -> Result<&Matrix<S>, EvalError> {
        self.take("g_z", g_z)?;
        self.change_to_hamiltonian();
        Ok(&self.0.changed)
    }

    /// `G_z = T^-1 (F_x T - dT/dt)`, 2n x 2n: transforms the Jacobian F_x in (q, p) of any F with this rate
    /// dx/dt.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`] unless F_x is 2n x 2n.
    pub fn jacobian_to_lagrangian(&mut self, f_x: Block<'_, S>) -> Result<&Matrix<S>, EvalError> {
        self.take("f_x", f_x)?;
        self.change_to_lagrangian();
        Ok(&self.0.changed)
    }

    /// `y_z = T' y_x`: transforms a costate (or gradient) of (q, p), 2n, into that of (q, v), in place.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`].
    pub fn costate_to_lagrangian(&mut self, y: &mut [S]) -> Result<(), EvalError> {
        let (n, LegendreTransform { lagrangian, f, .. }) = (self.n(), &mut *self.0);
        check_length("y", y, 2 * n)?;
        let (p, m) = (lagrangian.kernel.l_vq(), lagrangian.kernel.mass_matrix());
        let (y_q, y_p) = y.split_at_mut(n);
        f[..n].copy_from_slice(y_p);
        y_p.fill(S::zero());
        for (i, &weight) in f[..n].iter().enumerate() {
            y_q.iter_mut().zip(p.row(i)).for_each(|(y, &p)| *y += weight * p);
            y_p.iter_mut().zip(m.row(i)).for_each(|(y, &m)| *y += weight * m);
        }
        Ok(())
    }

    /// `y_x = T'^-1 y_z`: transforms a costate (or gradient) of (q, v), 2n, into that of (q, p), in place.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`].
    pub fn costate_to_hamiltonian(&mut self, y: &mut [S]) -> Result<(), EvalError> {
        check_length("y", y, 2 * self.n())?;
        let lagrangian = &self.0.lagrangian;
        let (y_q, y_p) = y.split_at_mut(self.n());
        lagrangian.factor.solve(y_p);
        for (i, &weight) in y_p.iter().enumerate() {
            y_q.iter_mut().zip(lagrangian.kernel.l_vq().row(i)).for_each(|(y, &p)| *y -= weight * p);
        }
        Ok(())
    }

    /// Copies a Jacobian into the workspace.
    fn take(&mut self, what: &'static str, jacobian: Block<'_, S>) -> Result<(), EvalError> {
        let size = 2 * self.n();
        for found in [jacobian.rows(), jacobian.columns()] {
            LengthError::check(what, size, found)?;
        }
        (0..size).for_each(|i| self.0.given.row_mut(i).copy_from_slice(jacobian.row(i)));
        Ok(())
    }

    /// `X = T G_z + dT/dt`, then `F_x = X T^-1`, with `[X1 X2] T^-1 = [X1 - X2 M^-1 P, X2 M^-1]`.
    fn change_to_hamiltonian(&mut self) {
        let LegendreTransform { lagrangian, given, half, changed, .. } = &mut *self.0;
        let n = lagrangian.dof();
        let (p, m) = (lagrangian.kernel.l_vq(), lagrangian.kernel.mass_matrix());
        let inverse = lagrangian.a_z.block(0, 2 * n, n, n);
        for i in 0..n {
            half.row_mut(i).copy_from_slice(given.row(i));
        }
        set_rate(lagrangian, half);
        add_product(half, (n, 0), 1.0, p.view(), given.block(0, 0, n, 2 * n));
        add_product(half, (n, 0), 1.0, m.view(), given.block(n, 0, n, 2 * n));
        given.fill_zero();
        add_product(given, (0, 0), 1.0, half.block(0, n, 2 * n, n), inverse);
        for i in 0..2 * n {
            let (left, right) = changed.row_mut(i).split_at_mut(n);
            left.copy_from_slice(&half.row(i)[..n]);
            right.copy_from_slice(&given.row(i)[..n]);
        }
        add_product(changed, (0, 0), -1.0, given.block(0, 0, 2 * n, n), p.view());
    }

    /// `X = F_x T - dT/dt`, then `G_z = T^-1 X`, with `T^-1 [X1 ; X2] = [X1 ; M^-1 (X2 - P X1)]`.
    fn change_to_lagrangian(&mut self) {
        let LegendreTransform { lagrangian, given, half, changed, .. } = &mut *self.0;
        let n = lagrangian.dof();
        let (p, m) = (lagrangian.kernel.l_vq(), lagrangian.kernel.mass_matrix());
        let inverse = lagrangian.a_z.block(0, 2 * n, n, n);
        half.fill_zero();
        set_rate(lagrangian, half);
        for i in 0..2 * n {
            half.row_mut(i).iter_mut().for_each(|entry| *entry = -*entry);
            half.row_mut(i)[..n].iter_mut().zip(given.row(i)).for_each(|(entry, &given)| *entry += given);
        }
        add_product(half, (0, 0), 1.0, given.block(0, n, 2 * n, n), p.view());
        add_product(half, (0, n), 1.0, given.block(0, n, 2 * n, n), m.view());
        changed.fill_zero();
        for i in 0..n {
            changed.row_mut(i).copy_from_slice(half.row(i));
        }
        add_product(half, (n, 0), -1.0, p.view(), changed.block(0, 0, n, 2 * n));
        add_product(changed, (n, 0), 1.0, inverse, half.block(n, 0, n, 2 * n));
    }
}

/// Fills the lower half of a matrix with the lower half of dT/dt, `[Pdot Mdot]`.
fn set_rate<S: Scalar>(lagrangian: &Lagrangian<S>, target: &mut Matrix<S>) {
    let n = lagrangian.dof();
    for i in 0..n {
        let (left, right) = target.row_mut(n + i).split_at_mut(n);
        left.copy_from_slice(lagrangian.along.l_vq().row(i));
        right.copy_from_slice(lagrangian.along.mass_matrix().row(i));
    }
}

/// Adds `sign A B` to the block of `target` that starts at (top, left).
fn add_product<S: Scalar>(
    target: &mut Matrix<S>,
    (top, left): (usize, usize),
    sign: f64,
    a: Block<'_, S>,
    b: Block<'_, S>,
) {
    for i in 0..a.rows() {
        let row = &mut target.row_mut(top + i)[left..];
        for (k, &a) in a.row(i).iter().enumerate() {
            let factor = a.times(sign);
            for (entry, &b) in row.iter_mut().zip(b.row(k)) {
                *entry += factor * b;
            }
        }
    }
}
