//! What is computed of the dynamics of a robot: the quantity behind each method, and the plan of its arrays.
//!
//! z = (q, v, tau) or (q, p, tau); f is dx/dt, 2n numbers; J = df/dz, 2n x 3n; H = d2(y'f)/dz2, 3n x 3n. With
//! quaternions q has nq > n numbers, and derivatives by q are those in the tangent space.

use crate::errors::argument;
use crate::plan::{ONE, Piece, Plan, PlanBuilder};
use costate::Coordinates;
use costate::codegen::Quantity;
use pyo3::prelude::*;

/// The methods of `Dynamics` that evaluate a quantity of `costate::codegen`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verb {
    F,
    Jacobian,
    Hessian,
    Linearise,
    Contract,
    Adjoint,
    Hvp,
    Aba,
    Rnea,
    RneaJacobian,
    RneaHessian,
    Crba,
    Energy,
}

impl Verb {
    pub const ALL: [Self; 13] = [
        Self::F,
        Self::Jacobian,
        Self::Hessian,
        Self::Linearise,
        Self::Contract,
        Self::Adjoint,
        Self::Hvp,
        Self::Aba,
        Self::Rnea,
        Self::RneaJacobian,
        Self::RneaHessian,
        Self::Crba,
        Self::Energy,
    ];

    /// The method of this name.
    ///
    /// # Errors
    /// `ArgumentError` with all names.
    pub fn of_name(py: Python<'_>, name: &str) -> PyResult<Self> {
        let found = Self::ALL.into_iter().find(|known| known.name() == name);
        found.ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            argument(py, "verb", format!("'{name}' has no backend; give one of {names}"))
        })
    }

    /// The name of the method.
    pub fn name(self) -> &'static str {
        match self {
            Self::F => "f",
            Self::Jacobian => "jacobian",
            Self::Hessian => "hessian",
            Self::Linearise => "linearise",
            Self::Contract => "contract",
            Self::Adjoint => "adjoint",
            Self::Hvp => "hvp",
            Self::Aba => "aba",
            Self::Rnea => "rnea",
            Self::RneaJacobian => "rnea_jacobian",
            Self::RneaHessian => "rnea_hessian",
            Self::Crba => "crba",
            Self::Energy => "energy",
        }
    }

    /// The quantity that is evaluated, for a `Dynamics` in these coordinates.
    pub fn quantity(self, coordinates: Coordinates) -> (Quantity, Coordinates) {
        let in_phase_space = coordinates == Coordinates::Hamiltonian;
        match self {
            Self::F => (Quantity::F, coordinates),
            Self::Jacobian | Self::Linearise => (Quantity::FX, coordinates),
            Self::Hessian | Self::Contract => (Quantity::YFXX, coordinates),
            Self::Adjoint if in_phase_space => (Quantity::YFX, coordinates),
            Self::Adjoint => (Quantity::FX, coordinates),
            Self::Hvp if in_phase_space => (Quantity::HessianProduct, coordinates),
            Self::Hvp => (Quantity::YFXX, coordinates),
            Self::Aba => (Quantity::F, Coordinates::Lagrangian),
            Self::Rnea => (Quantity::InverseDynamics, Coordinates::Lagrangian),
            Self::RneaJacobian => (Quantity::TauZ, Coordinates::Lagrangian),
            Self::RneaHessian => (Quantity::YTauZZ, Coordinates::Lagrangian),
            Self::Crba => (Quantity::MassMatrix, Coordinates::Lagrangian),
            Self::Energy => (Quantity::Energy, Coordinates::Lagrangian),
        }
    }

    /// Arguments and results for nq positions and n coordinates.
    pub fn plan(self, coordinates: Coordinates, sizes: [usize; 2]) -> Plan {
        match (self, coordinates) {
            (
                Self::Aba | Self::Rnea | Self::RneaJacobian | Self::RneaHessian | Self::Crba | Self::Energy,
                _,
            ) => self.in_velocities_alone(sizes),
            (_, Coordinates::Lagrangian) => self.in_velocities(sizes),
            (_, Coordinates::Hamiltonian) => self.in_momenta(sizes),
        }
    }

    fn in_velocities_alone(self, [nq, n]: [usize; 2]) -> Plan {
        let mut plan = PlanBuilder::new(0);
        plan.positions([nq, n]);
        if self == Self::Crba {
            let plan = plan.results(n * n);
            let m = plan.core_outputs.start;
            return plan.output(&[n, n], vec![Piece::copy(0, m, n * n)]);
        }
        plan.core("v", n);
        if self == Self::Energy {
            let plan = plan.results(2);
            let kinetic = plan.core_outputs.start;
            let number = |from| vec![Piece::copy(0, from, 1)];
            return plan.output(&[], number(kinetic)).output(&[], number(kinetic + 1));
        }
        plan.core(if self == Self::Aba { "tau" } else { "a" }, n);
        if self == Self::RneaHessian {
            plan.core("w", n);
            let plan = plan.results(n + 8 * n * n);
            let xx = plan.core_outputs.start + n + 3 * n * n;
            return plan.output(&[3 * n, 3 * n], bordered(xx, n));
        }
        if self == Self::RneaJacobian {
            let plan = plan.results(n + 3 * n * n);
            let tau_z = plan.core_outputs.start + n;
            return plan.output(&[n, 3 * n], vec![Piece::copy(0, tau_z, 3 * n * n)]);
        }
        let plan = plan.results(n);
        let values = plan.core_outputs.start;
        plan.output(&[n], vec![Piece::copy(0, values, n)])
    }

    fn in_velocities(self, [nq, n]: [usize; 2]) -> Plan {
        let mut plan = PlanBuilder::new(4 * n);
        plan.positions([nq, n]);
        let v = plan.core("v", n);
        plan.core("tau", n);
        let [y_q, y_v, d] = match self {
            Self::Hessian | Self::Contract => {
                let [y_q, y_v] = plan.split("y", [(n, false), (n, true)]);
                [y_q, y_v, 0]
            }
            Self::Adjoint => {
                let [y] = plan.split("y", [(2 * n, false)]);
                [y, y + n, 0]
            }
            Self::Hvp => {
                let [y_q, y_v] = plan.split("y", [(n, false), (n, true)]);
                let [d] = plan.split("d", [(3 * n, false)]);
                [y_q, y_v, d]
            }
            _ => [0; 3],
        };
        let first = n + 3 * n * n;
        let plan = plan.results(match self {
            Self::F => n,
            Self::Jacobian | Self::Linearise | Self::Adjoint => first,
            _ => first + 5 * n * n,
        });
        let a = plan.core_outputs.start;
        let (a_z, xx) = (a + n, a + first);
        let f = || vec![Piece::copy(0, v, n), Piece::copy(n, a, n)];
        let jacobian = || vec![Piece::diagonal(n, 3 * n, n), Piece::copy(3 * n * n, a_z, 3 * n * n)];
        match self {
            Self::F => plan.output(&[2 * n], f()),
            Self::Jacobian => plan.output(&[2 * n, 3 * n], jacobian()),
            Self::Linearise => plan.output(&[2 * n], f()).output(&[2 * n, 3 * n], jacobian()),
            Self::Hessian => plan.output(&[3 * n, 3 * n], bordered(xx, n)),
            Self::Contract => plan
                .output(&[2 * n], f())
                .output(&[2 * n, 3 * n], jacobian())
                .output(&[3 * n, 3 * n], bordered(xx, n)),
            Self::Adjoint => {
                let column = |j| Piece::Product { to: j, a: (y_v, 1), b: (a_z + j, 3 * n), length: n };
                let rate = |j| Piece::Product { to: n + j, a: (y_q + j, 1), b: (ONE, 0), length: 1 };
                plan.output(&[3 * n], (0..3 * n).map(column).chain((0..n).map(rate)).collect())
            }
            _ => plan.output(&[3 * n], product(xx, d, n)),
        }
    }

    fn in_momenta(self, [nq, n]: [usize; 2]) -> Plan {
        let mut plan = PlanBuilder::new(4 * n);
        plan.positions([nq, n]);
        plan.core("p", n); // the parameter v of the caller
        if self == Self::Hvp {
            plan.split("tau", [(n, false)]);
            plan.core("y", 2 * n);
            plan.split("d", [(2 * n, true), (n, false)]);
            let plan = plan.results(2 * n);
            let along = plan.core_outputs.start;
            return plan.output(&[3 * n], vec![Piece::copy(0, along, 2 * n)]);
        }
        plan.core("tau", n);
        let y = match self {
            Self::Hessian | Self::Contract | Self::Adjoint => plan.core("y", 2 * n),
            _ => 0,
        };
        let square = 4 * n * n;
        let plan = plan.results(match self {
            Self::F => 2 * n,
            Self::Jacobian | Self::Linearise => 2 * n + square,
            Self::Adjoint => 4 * n,
            _ => 2 * n + 2 * square,
        });
        let f = plan.core_outputs.start;
        let (f_x, y_f_xx) = (f + 2 * n, f + 2 * n + square);
        let value = || vec![Piece::copy(0, f, 2 * n)];
        let jacobian = || {
            let mut rows = Piece::rows(0, 3 * n, f_x, [2 * n, 2 * n]);
            rows.push(Piece::diagonal(3 * n * n + 2 * n, 3 * n, n));
            rows
        };
        let hessian = || Piece::rows(0, 3 * n, y_f_xx, [2 * n, 2 * n]);
        match self {
            Self::F => plan.output(&[2 * n], value()),
            Self::Jacobian => plan.output(&[2 * n, 3 * n], jacobian()),
            Self::Linearise => plan.output(&[2 * n], value()).output(&[2 * n, 3 * n], jacobian()),
            Self::Adjoint => {
                plan.output(&[3 * n], vec![Piece::copy(0, f_x, 2 * n), Piece::copy(2 * n, y + n, n)])
            }
            Self::Hessian => plan.output(&[3 * n, 3 * n], hessian()),
            _ => plan
                .output(&[2 * n], value())
                .output(&[2 * n, 3 * n], jacobian())
                .output(&[3 * n, 3 * n], hessian()),
        }
    }
}

/// `[ xx  uq' ; uq  0 ]`, 3n x 3n, of xx (2n x 2n) and uq (n x n), which lie one after the other: uq' in the
/// rows of q.
fn bordered(xx: usize, n: usize) -> Vec<Piece> {
    let uq = xx + 4 * n * n;
    let mut pieces = Piece::rows(0, 3 * n, xx, [2 * n, 2 * n]);
    pieces.extend(Piece::rows(6 * n * n, 3 * n, uq, [n, n]));
    pieces.extend((0..n).map(|i| Piece::Move { to: (2 * n + i, 3 * n), from: (uq + i * n, 1), length: n }));
    pieces
}

/// The product of the same matrix with the 3n numbers d.
fn product(xx: usize, d: usize, n: usize) -> Vec<Piece> {
    let uq = xx + 4 * n * n;
    let in_x = |i| Piece::Product { to: i, a: (xx + 2 * n * i, 1), b: (d, 1), length: 2 * n };
    let in_q = |i| Piece::Product { to: i, a: (uq + i, n), b: (d + 2 * n, 1), length: n };
    let in_u = |i| Piece::Product { to: 2 * n + i, a: (uq + i * n, 1), b: (d, 1), length: n };
    (0..2 * n).map(in_x).chain((0..n).map(in_q)).chain((0..n).map(in_u)).collect()
}
