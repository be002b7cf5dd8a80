//! What programs of robots compute.

use super::error::CodegenError;

pub use crate::Coordinates;

/// What a program computes. Each also gives what stands before it in the table, unless
/// [`Options::only`](super::Options::only) says no.
///
/// | quantity | Hamiltonian: arguments, results | Lagrangian: arguments, results |
/// |---|---|---|
/// | `f` | q, p, u: f | q, v, u: qdd |
/// | `f_x` | q, p, u: f, f_x | q, v, u: qdd, qdd_z |
/// | `y_f_x` | q, p, u, y: f, y_f_x | |
/// | `y_f_xx` | q, p, u, y: f, f_x, y_f_xx | q, v, u, y: qdd, qdd_z, y_qdd_xx, y_qdd_uq |
/// | `y_f_xx_d` | q, p, y, d: y_f_xx_d | |
/// | `mass_matrix` | q: m | q: m |
/// | `energy` | q, p: kinetic, potential | q, v: kinetic, potential |
/// | `inverse_dynamics` | | q, v, a: tau |
///
/// n entries in q, p, v, u, a, qdd and tau, 2n in f, y_f_x, d and y (Lagrangian: n in y, that of the velocities), 2n x 2n
/// in f_x, y_f_xx and y_qdd_xx, n x 3n in qdd_z, z = (q, v, u), n x n in m and y_qdd_uq.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The state equation.
    F,
    /// Its Jacobian.
    FX,
    /// The product of a costate and the Jacobian.
    YFX,
    /// The contracted Hessian.
    YFXX,
    /// The product of the contracted Hessian and a vector.
    YFXXD,
    /// M(q).
    MassMatrix,
    /// Kinetic and potential energy.
    Energy,
    /// The actuation for an acceleration.
    InverseDynamics,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::F,
        Self::FX,
        Self::YFX,
        Self::YFXX,
        Self::YFXXD,
        Self::MassMatrix,
        Self::Energy,
        Self::InverseDynamics,
    ];

    /// That there is no such quantity in these coordinates, and which there are.
    pub fn undefined(self, coordinates: Coordinates) -> CodegenError {
        let defined = Self::ALL.into_iter().filter(|other| other.arguments(coordinates, false).is_some());
        CodegenError::Quantity {
            quantity: self.name(),
            coordinates: coordinates.name(),
            available: defined.map(Self::name).collect::<Vec<_>>().join(", "),
        }
    }

    /// Whether it takes the inverse of the mass matrix.
    pub fn inverts(self, coordinates: Coordinates) -> bool {
        match (self, coordinates) {
            (Self::MassMatrix | Self::InverseDynamics, _) | (Self::Energy, Coordinates::Lagrangian) => false,
            (Self::F | Self::FX | Self::YFX | Self::YFXX | Self::YFXXD, _)
            | (Self::Energy, Coordinates::Hamiltonian) => true,
        }
    }

    /// As in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::F => "f",
            Self::FX => "f_x",
            Self::YFX => "y_f_x",
            Self::YFXX => "y_f_xx",
            Self::YFXXD => "y_f_xx_d",
            Self::MassMatrix => "mass_matrix",
            Self::Energy => "energy",
            Self::InverseDynamics => "inverse_dynamics",
        }
    }

    /// Arguments, in order; `None` where there is no such quantity in these coordinates.
    pub(super) fn arguments(self, coordinates: Coordinates, only: bool) -> Option<Vec<&'static str>> {
        let all: &[&str] = match (coordinates, self) {
            (_, Self::MassMatrix) => &["q"],
            (Coordinates::Hamiltonian, Self::F) => &["q", "p", "u"],
            (Coordinates::Hamiltonian, Self::FX) => {
                if only {
                    &["q", "p"]
                } else {
                    &["q", "p", "u"]
                }
            }
            (Coordinates::Hamiltonian, Self::YFX | Self::YFXX) => {
                if only {
                    &["q", "p", "y"]
                } else {
                    &["q", "p", "u", "y"]
                }
            }
            (Coordinates::Hamiltonian, Self::YFXXD) => &["q", "p", "y", "d"],
            (Coordinates::Hamiltonian, Self::Energy) => &["q", "p"],
            (Coordinates::Lagrangian, Self::F | Self::FX) => &["q", "v", "u"],
            (Coordinates::Lagrangian, Self::YFXX) => &["q", "v", "u", "y"],
            (Coordinates::Lagrangian, Self::Energy) => &["q", "v"],
            (Coordinates::Lagrangian, Self::InverseDynamics) => &["q", "v", "a"],
            (Coordinates::Hamiltonian, Self::InverseDynamics)
            | (Coordinates::Lagrangian, Self::YFX | Self::YFXXD) => return None,
        };
        Some(all.to_vec())
    }

    /// Its name among the results.
    pub(super) fn result(self, coordinates: Coordinates) -> &'static [&'static str] {
        match (self, coordinates) {
            (Self::F, Coordinates::Lagrangian) => &["qdd"],
            (Self::FX, Coordinates::Lagrangian) => &["qdd_z"],
            (Self::YFXX, Coordinates::Lagrangian) => &["y_qdd_xx", "y_qdd_uq"],
            (Self::F, _) => &["f"],
            (Self::FX, _) => &["f_x"],
            (Self::YFX, _) => &["y_f_x"],
            (Self::YFXX, _) => &["y_f_xx"],
            (Self::YFXXD, _) => &["y_f_xx_d"],
            (Self::MassMatrix, _) => &["m"],
            (Self::Energy, _) => &["kinetic", "potential"],
            (Self::InverseDynamics, _) => &["tau"],
        }
    }
}
