//! Compares the derivatives of steps in time with hyper-dual numbers.

// `#[inline]` in this file: compiled where it is used, with all instances of the pipeline that it needs, not
// by everyone who builds the library.

mod compared;
mod kinds;

use super::error::check;
use super::{Classical, HamiltonianRobot, LagrangianRobot, Midpoint, SemiImplicit, StepError, Verlet};
use crate::derivative::{Figure, Judged, scales};
use crate::error::{EvalError, LengthError};
use crate::hamiltonian::Hamiltonian;
use crate::robot::Robot;
use compared::{Compared, MOMENTA, VELOCITIES};
use kinds::{FreeMomenta, FreeRates, Plain};
use std::fmt;

/// Compares the derivatives of one step of a robot, by every scheme, with hyper-dual numbers through the step
/// itself (through the iterations of implicit schemes, too).
///
/// Phi_z, z = (x, u, h), and the product of `y'Phi_zz`, z = (x, u), with a direction. The bound is that of
/// [`Routes`](crate::derivative::Routes). With floating and spherical joints the steps are those of
/// [`FreeStep`](super::FreeStep): derivatives are those in the tangent spaces at both ends, 2n for x, and the
/// reference differentiates through q (+) d and (-) of the next configuration.
pub struct StepRoutes {
    tolerance: f64,
    momenta: Hamiltonian<f64>,
    schemes: Schemes,
}

/// Every scheme of a robot.
enum Schemes {
    Plain(Box<PlainSchemes>),
    Free(Box<FreeSchemes>),
}

/// Where all joints have one degree of freedom.
struct PlainSchemes {
    runge_kutta: Compared<Plain<HamiltonianRobot, Classical>>,
    verlet: Compared<Plain<HamiltonianRobot, Verlet>>,
    midpoint: Compared<Plain<HamiltonianRobot, Midpoint>>,
    semi_implicit: Compared<Plain<LagrangianRobot, SemiImplicit>>,
}

/// With floating and spherical joints.
struct FreeSchemes {
    runge_kutta: Compared<FreeMomenta<Classical>>,
    verlet: Compared<FreeMomenta<Verlet>>,
    midpoint: Compared<FreeMomenta<Midpoint>>,
    in_rates: Compared<FreeRates<Classical>>,
}

/// Tolerance that lets the error of the reference be propagated whatever the differences.
const ALWAYS: f64 = 0.0;

impl fmt::Debug for StepRoutes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StepRoutes").field("dof", &self.momenta.dof()).finish_non_exhaustive()
    }
}

impl StepRoutes {
    /// Builds every workspace.
    #[inline]
    pub fn new(robot: &Robot) -> Self {
        let schemes = match robot.free_joints().is_empty() {
            true => Schemes::Plain(Box::new(PlainSchemes {
                runge_kutta: Compared::new("RK4 (q, p)", robot, MOMENTA),
                verlet: Compared::new("Verlet (q, p)", robot, MOMENTA),
                midpoint: Compared::new("midpoint (q, p)", robot, MOMENTA),
                semi_implicit: Compared::new("semi-implicit (q, v)", robot, VELOCITIES),
            })),
            false => Schemes::Free(Box::new(FreeSchemes {
                runge_kutta: Compared::new("RK4 (q, p)", robot, MOMENTA),
                verlet: Compared::new("Verlet (q, p)", robot, MOMENTA),
                midpoint: Compared::new("midpoint (q, p)", robot, MOMENTA),
                in_rates: Compared::new("RK4 (q, v)", robot, VELOCITIES),
            })),
        };
        Self { tolerance: 1.0, momenta: Hamiltonian::new(robot), schemes }
    }

    /// As [`Routes::with_tolerance`](crate::derivative::Routes::with_tolerance).
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Compares a step of duration h from x = (q, p), nq + n entries, under u with the costate y (2n). The
    /// direction of the Hessian product is (y, u). Appends all figures, or none on an error.
    ///
    /// # Errors
    /// A wrong length, a state that the model refuses, or an implicit equation that was not solved to
    /// rounding.
    #[inline]
    pub fn compare(
        &mut self,
        x: &[f64],
        u: &[f64],
        h: f64,
        y: &[f64],
        figures: &mut Vec<Figure>,
    ) -> Result<(), StepError<EvalError>> {
        let (rows, d) = self.rows([x, u, y], h, self.tolerance)?;
        figures.extend(rows.iter().map(|row| row.judge(&d)));
        Ok(())
    }

    /// As [`Routes::undetected`](crate::derivative::Routes::undetected).
    ///
    /// # Errors
    /// As for [`compare`](Self::compare).
    #[doc(hidden)]
    #[inline]
    pub fn undetected(
        &mut self,
        x: &[f64],
        u: &[f64],
        h: f64,
        y: &[f64],
        change: f64,
    ) -> Result<Vec<[&'static str; 2]>, StepError<EvalError>> {
        let (rows, d) = self.rows([x, u, y], h, ALWAYS)?;
        Ok(rows.iter().filter(|row| !row.detects(change, &d)).map(|row| row.row.name).collect())
    }

    /// All rows, and the scales of the coordinates.
    #[inline]
    fn rows(
        &mut self,
        [x, u, y]: [&[f64]; 3],
        h: f64,
        tolerance: f64,
    ) -> Result<(Vec<Judged>, Vec<f64>), StepError<EvalError>> {
        let (nq, n) = (self.momenta.tree().nq(), self.momenta.dof());
        check([nq + n, n], [x, u], h, None)?;
        LengthError::check("y", 2 * n, y.len()).map_err(StepError::WrongLength)?;
        let (q, p) = x.split_at(nq);
        let in_velocities = &[q, self.momenta.velocity(q, p)?].concat()[..];
        let d = &scales(&self.momenta.mass_matrix(q)?.view().to_nalgebra())[..];
        let (of_momenta, of_velocities) = ([x, u, y], [in_velocities, u, y]);
        let found = match &mut self.schemes {
            Schemes::Plain(all) => [
                all.runge_kutta.rows(of_momenta, h, d, tolerance)?,
                all.verlet.rows(of_momenta, h, d, tolerance)?,
                all.midpoint.rows(of_momenta, h, d, tolerance)?,
                all.semi_implicit.rows(of_velocities, h, d, tolerance)?,
            ],
            Schemes::Free(all) => [
                all.runge_kutta.rows(of_momenta, h, d, tolerance)?,
                all.verlet.rows(of_momenta, h, d, tolerance)?,
                all.midpoint.rows(of_momenta, h, d, tolerance)?,
                all.in_rates.rows(of_velocities, h, d, tolerance)?,
            ],
        };
        let mut found = found.concat();
        found.sort_by_key(|judged| judged.row.name[0]);
        Ok((found, d.to_vec()))
    }
}
