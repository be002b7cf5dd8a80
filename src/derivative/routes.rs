//! Compares the library's own derivatives with automatic ones.

// `#[inline]` in this file: compiled where it is used, with all instances of the pipeline that it needs, not
// by everyone who builds the library.

use super::function::{DerivativeError, check_length};
use super::methods::Methods;
use super::other_route::OtherRoute;
use super::reference::{Automatic, Reference, Rounding};
use super::report::{StateReport, Verdict};
use super::row::{Judged, Row};
use super::state::State;
use crate::error::EvalError;
use crate::robot::Robot;
use crate::scalar::Count;
use nalgebra::{DMatrix, SymmetricEigen};
use std::fmt;

/// The error of the reference is propagated where a difference exceeds this part of the bound without it.
pub(crate) const CLOSE: f64 = 0.1;

/// Compares all methods for the derivatives of one robot's state equations. The reference are hyper-dual
/// numbers through F and the acceleration a.
///
/// | method | F_x | y'F_xx |
/// |---|---|---|
/// | analytic | hand-derived | 2n+1 rule |
/// | dual pass | | one dual number through the hand-derived F_x |
/// | packed tensor | | contraction of the whole tensor, by hand |
/// | tensors | Christoffel coefficients | one dual number through these |
/// | dual | dual numbers through F | dual numbers in dual numbers through F |
///
/// Also compared: y'F_x and y'F_xx d without a matrix and as products with the matrix, the derivatives of
/// a(q, v, u) and tau(q, v, a), symmetries, the conservation of energy, and first and second derivatives of
/// twists, positions and orientation errors, summed with fixed weights over one frame of each link, of the
/// centre of mass and of momentum; with [`with_route`](Self::with_route) those by other means.
///
/// # The bound
///
/// One rule for all rows. Both methods and their difference are evaluated once more, by the same generic code
/// (rotations by three products, where `f64` uses four), with numbers that carry the variance of their
/// rounding error: every operation adds an independent error of relative size u = 2^-53 (Hull and Swenson
/// 1966; Higham and Mary 2019), and to first order
///
/// ```text
/// var(a + b) = var a + var b + (u (a + b))^2      var(a b) = b^2 var a + a^2 var b + (u a b)^2
/// ```
///
/// So the bound knows the terms that cancel in each method, and the condition of M through the factorisation
/// itself. A difference agrees if, in each block (q or p by q or p), its largest entry is at most
/// [`SAFETY`](super::SAFETY) standard deviations, the largest of the block. Entries are measured in the
/// coordinates `q_i d_i` and `p_i / d_i`, `d_i = sqrt(M_ii)`: the verdict does not depend on the units of the
/// joints, and an entry that vanishes by cancellation is judged by its block. The safety factor is not
/// derived: it allows for errors that are correlated, and for the number of entries and states.
///
/// The error of the reference takes most of the work. So it is first taken as one rounding of each entry,
/// which is smaller, except where an entry is exact. Only in a state where a difference exceeds a tenth of
/// that bound is the error of the reference propagated, too.
pub struct Routes {
    tolerance: f64,
    methods: Methods<f64>,
    reference: Automatic,
    rounded_methods: Methods<Count>,
    rounded_reference: Rounding,
    others: Vec<OtherRoute>,
}

impl fmt::Debug for Routes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Routes").field("dof", &self.methods.conservative.dof()).finish_non_exhaustive()
    }
}

impl Routes {
    /// Builds every workspace.
    #[inline]
    pub fn new(robot: &Robot) -> Self {
        Self {
            tolerance: 1.0,
            methods: Methods::new(robot),
            reference: Automatic::new(robot),
            rounded_methods: Methods::new(robot),
            rounded_reference: Rounding::new(robot),
            others: Vec::new(),
        }
    }

    /// The tolerance that figures are judged by, see [`verdict`](super::Figure::verdict); 1 by default. The
    /// error of the reference is propagated where a difference comes close to it.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Compares one more method, in a row behind the others of its quantity.
    #[must_use]
    pub fn with_route(mut self, route: OtherRoute) -> Self {
        self.others.push(route);
        self
    }

    /// Compares at x = (q, p) with actuation u and costate y (2n), which is also the direction of products.
    ///
    /// With floating and spherical joints q has nq entries, derivatives are those in the tangent space, and
    /// the reference differentiates through q (+) d. Tensors, the dual pass, the symmetry of J F_x and most
    /// second derivatives of frames have no rows then.
    ///
    /// # Errors
    /// A wrong length, numbers that are not finite, a singular mass matrix.
    #[inline]
    pub fn compare(
        &mut self,
        x: &[f64],
        u: &[f64],
        y: &[f64],
    ) -> Result<StateReport, DerivativeError<EvalError>> {
        let at = self.evaluate(x, u, y)?;
        let d = scales(&at.mass_matrix);
        let mut rows = self.judged(&at, at.reference.rounded_once())?;
        if rows.iter().any(|row| row.judge(&d).verdict(CLOSE * self.tolerance) == Verdict::Differs) {
            let reference = self.rounded_reference.evaluate(&at.counted, [&x[..at.counted.q.len()], u])?;
            rows = self.judged(&at, reference)?;
        }
        let figures = rows.iter().map(|row| row.judge(&d)).collect();
        // M^-1 is a block of F_x, the first row.
        let inverse_error = rows.first().map_or(0.0, |f_x| f_x.bound([0, 1], &d));
        Ok(StateReport { condition: condition(at.mass_matrix), inverse_error, figures })
    }

    /// The rows, as (quantity, method), that let a relative change of the largest entry of some block pass.
    /// For tests.
    ///
    /// # Errors
    /// As for [`compare`](Self::compare).
    #[doc(hidden)]
    #[inline]
    pub fn undetected(
        &mut self,
        x: &[f64],
        u: &[f64],
        y: &[f64],
        change: f64,
    ) -> Result<Vec<[&'static str; 2]>, DerivativeError<EvalError>> {
        let at = self.evaluate(x, u, y)?;
        let d = scales(&at.mass_matrix);
        let reference = self.rounded_reference.evaluate(&at.counted, [&x[..at.counted.q.len()], u])?;
        let rows = self.judged(&at, reference)?;
        Ok(rows.iter().filter(|row| !row.detects(change, &d)).map(|row| row.row.name).collect())
    }

    /// All methods in `f64`.
    #[inline]
    fn evaluate(&mut self, x: &[f64], u: &[f64], y: &[f64]) -> Result<Evaluated, DerivativeError<EvalError>> {
        let tree = self.methods.conservative.tree();
        let (nq, n) = (tree.nq(), tree.dof());
        check_length("x", x, nq + n)?;
        check_length("u", u, n)?;
        check_length("y", y, 2 * n)?;
        let (q, p) = x.split_at(nq);
        let v = self.methods.conservative.velocity(q, p)?.to_vec();
        let mass_matrix = self.methods.conservative.mass_matrix(q)?.view().to_nalgebra();
        let state = State { q: q.to_vec(), p: p.to_vec(), v, u: u.to_vec(), y: y.to_vec() };
        let reference = self.reference.evaluate(&state)?;
        let mut rows = self.methods.rows(&state, &reference)?;
        for route in &mut self.others {
            insert(&mut rows, route.row(&state, &reference)?);
        }
        Ok(Evaluated { counted: state.map(Count::variable), mass_matrix, reference, rows })
    }

    /// The rows with their rounding errors, those of the reference given.
    #[inline]
    fn judged(&mut self, at: &Evaluated, reference: Reference<Count>) -> Result<Vec<Judged>, EvalError> {
        let mut rounded = self.rounded_methods.rows(&at.counted, &reference)?;
        for route in &mut self.others {
            insert(&mut rounded, route.rounded_row(&at.counted, &reference)?);
        }
        Ok(at.rows.iter().cloned().zip(rounded).map(|(row, rounded)| Judged { row, rounded }).collect())
    }
}

/// All methods at one state.
struct Evaluated {
    counted: State<Count>,
    mass_matrix: DMatrix<f64>,
    reference: Reference<f64>,
    rows: Vec<Row<f64>>,
}

/// Puts a row behind the others of its quantity.
fn insert<S>(rows: &mut Vec<Row<S>>, row: Row<S>) {
    let last = rows.iter().rposition(|other| other.name[0] == row.name[0]);
    rows.insert(last.map_or(rows.len(), |last| last + 1), row);
}

/// `d_i = sqrt(M_ii)`.
pub(crate) fn scales(mass_matrix: &DMatrix<f64>) -> Vec<f64> {
    mass_matrix.diagonal().iter().map(|m| m.sqrt()).collect()
}

/// Largest over smallest eigenvalue of a symmetric positive definite matrix.
fn condition(mass_matrix: DMatrix<f64>) -> f64 {
    let values = SymmetricEigen::new(mass_matrix).eigenvalues;
    values.max() / values.min()
}
