//! The two coordinate systems of the state equation.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// The coordinates in which the state equation is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Coordinates {
    /// Positions and conjugate momenta, x = (q, p) with p = M v.
    #[default]
    Hamiltonian,
    /// Positions and velocities, x = (q, v).
    Lagrangian,
}

/// A name that is none of `hamiltonian`, `lagrangian`, `qp` and `qv`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown coordinates '{0}'; use 'hamiltonian' or 'qp', 'lagrangian' or 'qv'")]
#[non_exhaustive]
pub struct UnknownCoordinates(pub String);

impl Coordinates {
    /// Both coordinate systems.
    pub const ALL: [Self; 2] = [Self::Hamiltonian, Self::Lagrangian];

    /// `hamiltonian` or `lagrangian`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hamiltonian => "hamiltonian",
            Self::Lagrangian => "lagrangian",
        }
    }

    /// `qp` or `qv`, which are read as well.
    pub fn short_name(self) -> &'static str {
        match self {
            Self::Hamiltonian => "qp",
            Self::Lagrangian => "qv",
        }
    }
}

impl fmt::Display for Coordinates {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Coordinates {
    type Err = UnknownCoordinates;

    fn from_str(name: &str) -> Result<Self, UnknownCoordinates> {
        let found = Self::ALL
            .into_iter()
            .find(|coordinates| [coordinates.name(), coordinates.short_name()].contains(&name));
        found.ok_or_else(|| UnknownCoordinates(name.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for coordinates in Coordinates::ALL {
            assert_eq!(coordinates.to_string().parse(), Ok(coordinates));
            assert_eq!(coordinates.short_name().parse(), Ok(coordinates));
        }
        let error = "cartesian".parse::<Coordinates>().unwrap_err();
        assert!(error.to_string().contains("'cartesian'"), "{error}");
    }
}
