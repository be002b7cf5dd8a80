//! Contact forces and their margins at a state, with first and contracted second derivatives.

use super::force_map::{ForceLinearisation, ForceMap};
use super::margin::Margin;
use super::stance::Stance;
use crate::Coordinates;
use crate::error::{EvalError, check_length};
use crate::matrix::{Block, Matrix, add_scaled, filled};
use crate::scalar::Scalar;

/// Workspace for the contact forces of one stance and by how much they are inside their limits, as functions
/// of z = (q, v, u) or z = (q, p, u), with their derivatives; no call allocates.
///
/// With the margins c(lambda) of the stance, weights w of them and weights e of the forces,
///
/// $$ c\_z = c\_\lambda \lambda\_z, \qquad (w \cdot c + e \cdot \lambda)\_{zz} = \lambda\_z^T (w \cdot
/// c)\_{\lambda \lambda} \lambda\_z + (g \cdot \lambda)\_{zz}, \quad g = e + (w \cdot c)\_\lambda $$
///
/// with the derivatives of [`ForceMap`]. Where lambda is an unknown of its own, as in a direct method,
/// [`Margin`] alone has what is needed.
///
/// Slices are as in [`ForceMap`]; m is the number of [`Stance::margins`]. Methods can fail as those of
/// [`ConstrainedLagrangian`](crate::constraints::ConstrainedLagrangian).
///
/// ```
/// use costate::Coordinates;
/// use costate::contacts::{Contact, ContactForces, Stance};
/// use costate::robot::{Placement, Robot};
///
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let arm = Robot::from_file("robots/two_link.toml")?;
/// let tip = Placement::from_xyz_rpy([1.0, 0.0, 0.0], [0.0; 3]);
/// let lean = Contact::point("tip", "elbow").placed(tip).up([-1.0, 0.0, 0.0]).friction(0.6);
/// let stance = Stance::new(&arm, &[lean])?;
/// let mut forces = ContactForces::<f64>::new(&stance, Coordinates::Lagrangian);
/// let all = forces.linearise(&[0.3, -0.8], &[0.0; 2], &[5.0, -2.0])?;
/// println!("margins {:?} N, by the torques {:?}", all.margins(), &all.margins_z().row(0)[4..]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ContactForces<S: Scalar> {
    forces: ForceMap<S>,
    limits: Vec<Margin>,
    margins: Vec<S>,
    margins_z: Matrix<S>,
    gradient: Vec<S>,
    by_force: Matrix<S>,
    row: Vec<S>,
    zz: Matrix<S>,
}

/// Contact forces, margins and their Jacobians at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct ContactLinearisation<'a, S> {
    forces: ForceLinearisation<'a, S>,
    margins: &'a [S],
    margins_z: &'a Matrix<S>,
}

impl<'a, S: Scalar> ContactLinearisation<'a, S> {
    /// All multipliers, k: [`Stance::wrench`] makes forces of them.
    pub fn lambda(&self) -> &'a [S] {
        self.forces.lambda()
    }

    /// `lambda_z`, k x 3n.
    pub fn lambda_z(&self) -> Block<'a, S> {
        self.forces.lambda_z()
    }

    /// The margins, m.
    pub fn margins(&self) -> &'a [S] {
        self.margins
    }

    /// Their Jacobian, m x 3n.
    pub fn margins_z(&self) -> Block<'a, S> {
        self.margins_z.view()
    }
}

/// Contact forces, margins, their Jacobians and one contracted second derivative at one state; borrowed from
/// the workspace.
#[derive(Clone, Copy, Debug)]
pub struct ContactContraction<'a, S> {
    linearisation: ContactLinearisation<'a, S>,
    zz: &'a Matrix<S>,
}

impl<'a, S: Scalar> ContactContraction<'a, S> {
    /// Forces, margins and their Jacobians.
    pub fn linearisation(&self) -> ContactLinearisation<'a, S> {
        self.linearisation
    }

    /// `(w . c + e . lambda)_zz`, 3n x 3n, symmetric.
    pub fn matrix(&self) -> Block<'a, S> {
        self.zz.view()
    }
}

impl<S: Scalar> ContactForces<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(stance: &Stance, coordinates: Coordinates) -> Self {
        let forces = ForceMap::<S>::new(stance.robot(), coordinates);
        let (n, k, m) = (forces.dof(), forces.count(), stance.margins().len());
        Self {
            limits: stance.margins().to_vec(),
            margins: filled(S::zero(), m),
            margins_z: Matrix::zeros(m, 3 * n),
            gradient: filled(S::zero(), k),
            by_force: Matrix::zeros(k, k),
            row: filled(S::zero(), 3 * n),
            zz: Matrix::zeros(3 * n, 3 * n),
            forces,
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.forces.dof()
    }

    /// lambda (k) and the margins (m).
    ///
    /// # Errors
    /// See [`ContactForces`].
    pub fn evaluate(&mut self, q: &[S], rate: &[S], u: &[S]) -> Result<(&[S], &[S]), EvalError> {
        let lambda = self.forces.evaluate(q, rate, u)?;
        self.margins.iter_mut().zip(&self.limits).for_each(|(to, limit)| *to = limit.value(lambda));
        Ok((lambda, &self.margins))
    }

    /// lambda, the margins, and their Jacobians.
    ///
    /// # Errors
    /// See [`ContactForces`].
    pub fn linearise(
        &mut self,
        q: &[S],
        rate: &[S],
        u: &[S],
    ) -> Result<ContactLinearisation<'_, S>, EvalError> {
        let Self { forces, limits, margins, margins_z, gradient, .. } = self;
        let forces = forces.linearise(q, rate, u)?;
        slopes(limits, forces, margins, margins_z, gradient);
        Ok(ContactLinearisation { forces, margins, margins_z })
    }

    /// The same, and `(w . c + e . lambda)_zz` for weights w of the margins (m) and e of the forces (k).
    ///
    /// # Errors
    /// See [`ContactForces`].
    pub fn contract(
        &mut self,
        [q, rate, u]: [&[S]; 3],
        w: &[S],
        e: &[S],
    ) -> Result<ContactContraction<'_, S>, EvalError> {
        let Self { forces, limits, margins, margins_z, gradient, by_force, row, zz } = self;
        check_length("w", w, limits.len())?;
        check_length("e", e, gradient.len())?;
        let lambda = forces.evaluate(q, rate, u)?;
        gradient.copy_from_slice(e);
        by_force.fill_zero();
        for (limit, &w) in limits.iter().zip(w) {
            limit.add_gradient(lambda, w, gradient);
            limit.add_hessian(lambda, w, by_force);
        }
        let all = forces.contract(q, rate, u, gradient)?;
        let linear = all.linearisation();
        slopes(limits, linear, margins, margins_z, gradient);
        for i in 0..row.len() {
            zz.row_mut(i).copy_from_slice(all.matrix().row(i));
        }
        for a in 0..by_force.rows() {
            // The Hessian of the limits by forces has few entries.
            row.fill(S::zero());
            for (b, &entry) in by_force.row(a).iter().enumerate() {
                add_scaled(row, entry, linear.lambda_z().row(b));
            }
            for (i, &along) in linear.lambda_z().row(a).iter().enumerate() {
                add_scaled(&mut zz.row_mut(i)[..=i], along, &row[..=i]);
            }
        }
        for i in 0..row.len() {
            for j in 0..i {
                zz[(j, i)] = zz[(i, j)];
            }
        }
        Ok(ContactContraction {
            linearisation: ContactLinearisation { forces: linear, margins, margins_z },
            zz,
        })
    }
}

/// Margins and their Jacobians from the forces.
fn slopes<S: Scalar>(
    limits: &[Margin],
    forces: ForceLinearisation<'_, S>,
    margins: &mut [S],
    margins_z: &mut Matrix<S>,
    gradient: &mut [S],
) {
    for (i, (limit, to)) in limits.iter().zip(margins).enumerate() {
        *to = limit.value(forces.lambda());
        gradient.fill(S::zero());
        limit.add_gradient(forces.lambda(), S::one(), gradient);
        let row = margins_z.row_mut(i);
        row.fill(S::zero());
        for (l, &by) in gradient.iter().enumerate() {
            add_scaled(row, by, forces.lambda_z().row(l));
        }
    }
}
