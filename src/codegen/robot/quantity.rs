//! The quantities that programs of robots compute, with their arguments and results.

use super::shape::Shape;
pub use crate::Coordinates;
use crate::codegen::error::CodegenError;

/// A quantity of a robot. Its results include those above it in the table unless
/// [`ProgramOptions::only`](super::ProgramOptions::only) is set.
///
/// | quantity | Hamiltonian: arguments, results | Lagrangian: arguments, results |
/// |---|---|---|
/// | `f` | q, p, u: f | q, v, u: qdd |
/// | `f_x` | q, p, u: f, f_x | q, v, u: qdd, qdd_z |
/// | `y_f_x` | q, p, u, y: f, y_f_x | q, v, u, y: qdd, y_qdd_z |
/// | `y_f_xx` | q, p, u, y: f, f_x, y_f_xx | q, v, u, y: qdd, qdd_z, y_qdd_xx, y_qdd_uq |
/// | `y_f_xx_d` | q, p, y, d: y_f_xx_d | |
/// | `mass_matrix` | q: m | q: m |
/// | `energy` | q, p: kinetic, potential | q, v: kinetic, potential |
/// | `inverse_dynamics` | | q, v, a: tau |
/// | `tau_z` | | q, v, a: tau, tau_z |
/// | `y_tau_zz` | | q, v, a, y: tau, tau_z, y_tau_xx, y_tau_aq |
///
/// q has nq entries, those of [`Robot::nq`](crate::robot::Robot::nq): n, and one more for each quaternion;
/// then derivatives by q are those in the tangent space. p, v, u, a, qdd and tau have n, f, y_f_x, d and y 2n
/// (Lagrangian: y has n, those of the velocities or weights of tau), y_qdd_z 3n. With x = (q, p) or (q, v),
/// f_x, y_f_xx, y_qdd_xx and y_tau_xx are 2n x 2n; qdd_z is n x 3n with z = (q, v, u), tau_z with z = (q, v,
/// a); m, y_qdd_uq and y_tau_aq are n x n. The other second derivatives in u and a are zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Quantity {
    /// The state equation F.
    F,
    /// Its Jacobian F_x.
    FX,
    /// The product y'F_x of a costate and the Jacobian.
    YFX,
    /// The costate-contracted Hessian y'F_xx.
    YFXX,
    /// The product y'F_xx d of the contracted Hessian and a vector.
    HessianProduct,
    /// The mass matrix M(q), armature included.
    MassMatrix,
    /// Kinetic and potential energy.
    Energy,
    /// The actuation for an acceleration.
    InverseDynamics,
    /// Its Jacobian in (q, v, a).
    TauZ,
    /// Its Hessian in (q, v, a), contracted with weights y.
    YTauZZ,
}

/// An argument of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variable {
    Q,
    P,
    V,
    U,
    A,
    Y,
    D,
}

impl Variable {
    pub fn name(self) -> &'static str {
        match self {
            Self::Q => "q",
            Self::P => "p",
            Self::V => "v",
            Self::U => "u",
            Self::A => "a",
            Self::Y => "y",
            Self::D => "d",
        }
    }

    /// Name and number of entries for nq positions and n coordinates.
    pub fn shape(self, coordinates: Coordinates, [nq, n]: [usize; 2]) -> Shape {
        let entries = match (self, coordinates) {
            (Self::Q, _) => nq,
            (Self::Y | Self::D, Coordinates::Hamiltonian) => 2 * n,
            _ => n,
        };
        Shape::vector(self.name(), entries)
    }
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::F,
        Self::FX,
        Self::YFX,
        Self::YFXX,
        Self::HessianProduct,
        Self::MassMatrix,
        Self::Energy,
        Self::InverseDynamics,
        Self::TauZ,
        Self::YTauZZ,
    ];

    /// The error for a quantity that is not defined in these coordinates; it names those that are.
    pub fn undefined(self, coordinates: Coordinates) -> CodegenError {
        let defined = Self::ALL.into_iter().filter(|other| other.arguments(coordinates).is_some());
        CodegenError::Quantity {
            quantity: self.name(),
            coordinates: coordinates.name(),
            available: defined.map(Self::name).collect::<Vec<_>>().join(", "),
        }
    }

    /// Whether it needs the inverse of the mass matrix.
    pub fn inverts(self, coordinates: Coordinates) -> bool {
        match (self, coordinates) {
            (Self::MassMatrix | Self::InverseDynamics | Self::TauZ | Self::YTauZZ, _)
            | (Self::Energy, Coordinates::Lagrangian) => false,
            (Self::F | Self::FX | Self::YFX | Self::YFXX | Self::HessianProduct, _)
            | (Self::Energy, Coordinates::Hamiltonian) => true,
        }
    }

    /// Whether the mass matrix is computed on the way.
    pub(super) fn contains_mass_matrix(self, coordinates: Coordinates) -> bool {
        self.inverts(coordinates) || matches!(self, Self::MassMatrix | Self::TauZ | Self::YTauZZ)
    }

    /// As in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::F => "f",
            Self::FX => "f_x",
            Self::YFX => "y_f_x",
            Self::YFXX => "y_f_xx",
            Self::HessianProduct => "y_f_xx_d",
            Self::MassMatrix => "mass_matrix",
            Self::Energy => "energy",
            Self::InverseDynamics => "inverse_dynamics",
            Self::TauZ => "tau_z",
            Self::YTauZZ => "y_tau_zz",
        }
    }

    /// Its arguments, in order; `None` where it is not defined in these coordinates.
    pub(super) fn arguments(self, coordinates: Coordinates) -> Option<&'static [Variable]> {
        use Variable::{A, D, P, Q, U, V, Y};
        Some(match (coordinates, self) {
            (_, Self::MassMatrix) => &[Q],
            (Coordinates::Hamiltonian, Self::F | Self::FX) => &[Q, P, U],
            (Coordinates::Hamiltonian, Self::YFX | Self::YFXX) => &[Q, P, U, Y],
            (Coordinates::Hamiltonian, Self::HessianProduct) => &[Q, P, Y, D],
            (Coordinates::Hamiltonian, Self::Energy) => &[Q, P],
            (Coordinates::Lagrangian, Self::F | Self::FX) => &[Q, V, U],
            (Coordinates::Lagrangian, Self::YFX | Self::YFXX) => &[Q, V, U, Y],
            (Coordinates::Lagrangian, Self::Energy) => &[Q, V],
            (Coordinates::Lagrangian, Self::InverseDynamics | Self::TauZ) => &[Q, V, A],
            (Coordinates::Lagrangian, Self::YTauZZ) => &[Q, V, A, Y],
            (Coordinates::Hamiltonian, Self::InverseDynamics | Self::TauZ | Self::YTauZZ)
            | (Coordinates::Lagrangian, Self::HessianProduct) => return None,
        })
    }

    /// Whether the quantity itself, without the results above it, is a function of this argument. The
    /// actuation adds to F alone in (q, p), so its derivatives do not depend on u.
    pub(super) fn depends_on(self, variable: Variable, coordinates: Coordinates) -> bool {
        let derivative = matches!(self, Self::FX | Self::YFX | Self::YFXX);
        !(variable == Variable::U && derivative && coordinates == Coordinates::Hamiltonian)
    }

    /// Its results in order for n joints, and how many of the last ones are the quantity itself.
    pub(super) fn results(self, coordinates: Coordinates, n: usize) -> (Vec<Shape>, usize) {
        let (vector, matrix) = (Shape::vector, Shape::matrix);
        let (tau, tau_z) = (vector("tau", n), matrix("tau_z", n, 3 * n));
        let (f, f_x) = match coordinates {
            Coordinates::Hamiltonian => (vector("f", 2 * n), matrix("f_x", 2 * n, 2 * n)),
            Coordinates::Lagrangian => (vector("qdd", n), matrix("qdd_z", n, 3 * n)),
        };
        match (self, coordinates) {
            (Self::F, _) => (vec![f], 1),
            (Self::FX, _) => (vec![f, f_x], 1),
            (Self::YFX, Coordinates::Hamiltonian) => (vec![f, vector("y_f_x", 2 * n)], 1),
            (Self::YFX, Coordinates::Lagrangian) => (vec![f, vector("y_qdd_z", 3 * n)], 1),
            (Self::YFXX, Coordinates::Hamiltonian) => (vec![f, f_x, matrix("y_f_xx", 2 * n, 2 * n)], 1),
            (Self::YFXX, Coordinates::Lagrangian) => {
                (vec![f, f_x, matrix("y_qdd_xx", 2 * n, 2 * n), matrix("y_qdd_uq", n, n)], 2)
            }
            (Self::HessianProduct, _) => (vec![vector("y_f_xx_d", 2 * n)], 1),
            (Self::MassMatrix, _) => (vec![matrix("m", n, n)], 1),
            (Self::Energy, _) => (vec![vector("kinetic", 1), vector("potential", 1)], 2),
            (Self::InverseDynamics, _) => (vec![tau], 1),
            (Self::TauZ, _) => (vec![tau, tau_z], 1),
            (Self::YTauZZ, _) => {
                (vec![tau, tau_z, matrix("y_tau_xx", 2 * n, 2 * n), matrix("y_tau_aq", n, n)], 2)
            }
        }
    }
}
