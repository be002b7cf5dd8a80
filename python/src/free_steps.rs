//! Steps of robots with floating and spherical joints.

use crate::errors::argument;
use crate::schemes::{AnyStep, Plain};
use costate::Coordinates;
use costate::robot::Robot;
use costate::scalar::Scalar;
use costate::step::{FreeStep, ImplicitMidpoint, RungeKutta4, StoermerVerlet};
use pyo3::prelude::*;

/// The schemes that step states with quaternions.
#[derive(Clone, Copy)]
pub enum FreeScheme {
    RungeKutta4,
    Midpoint,
    /// In (q, p) alone.
    Verlet,
}

impl FreeScheme {
    /// The scheme of this name.
    ///
    /// # Errors
    /// `ArgumentError` for those that need as many positions as velocities.
    pub fn of_name(py: Python<'_>, name: &str) -> PyResult<Self> {
        match name {
            "rk4" => Ok(Self::RungeKutta4),
            "midpoint" => Ok(Self::Midpoint),
            "verlet" => Ok(Self::Verlet),
            name => {
                let message = format!(
                    "the scheme '{name}' needs as many positions as velocities, and quaternions have more; give \
                     'rk4', 'midpoint' or, for \"qp\", 'verlet'"
                );
                Err(argument(py, "scheme", message))
            }
        }
    }

    /// The workspace of a robot in these coordinates.
    pub fn step<S: Scalar + Send + 'static>(self, robot: &Robot, coordinates: Coordinates) -> AnyStep<S> {
        let found: FreeStep<S, Plain<S>> = match (self, coordinates) {
            (Self::RungeKutta4, Coordinates::Hamiltonian) => {
                FreeStep::in_momenta(robot, |model| Box::new(RungeKutta4::new(model)) as Plain<S>)
            }
            (Self::RungeKutta4, Coordinates::Lagrangian) => {
                FreeStep::in_rates(robot, |model| Box::new(RungeKutta4::new(model)) as Plain<S>)
            }
            (Self::Midpoint, Coordinates::Hamiltonian) => {
                FreeStep::in_momenta(robot, |model| Box::new(ImplicitMidpoint::new(model)) as Plain<S>)
            }
            (Self::Verlet, Coordinates::Hamiltonian) => {
                FreeStep::in_momenta(robot, |model| Box::new(StoermerVerlet::new(model)) as Plain<S>)
            }
            // `scheme_of` has refused Verlet in (q, v).
            (Self::Midpoint | Self::Verlet, Coordinates::Lagrangian) => {
                FreeStep::in_rates(robot, |model| Box::new(ImplicitMidpoint::new(model)) as Plain<S>)
            }
        };
        AnyStep::Free(Box::new(found))
    }
}
