//! Why a loop was not closed.

use crate::error::EvalError;
use crate::robot::{ConstraintRow, printable};

/// Why constraints could not be satisfied. The workspace remains usable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConstraintError {
    /// The robot cannot be evaluated there.
    #[error(transparent)]
    Evaluation(#[from] EvalError),
    /// The loop cannot be closed, or not from this position.
    #[error(
        "constraint '{}' cannot be satisfied: at the nearest position that was found it misses by {miss:.3e} \
         (m, rad); correct its frames or lengths, release held joints, or start nearer to where it is closed",
        printable(constraint)
    )]
    CannotClose {
        /// The constraint with the row that misses most.
        constraint: String,
        /// By how much (m, rad).
        miss: f64,
    },
    /// A row misses that no motion changes: something asks for another value.
    #[error("{}", contradiction(constraint, *miss, because))]
    Contradiction {
        /// The constraint with the redundant row that misses most.
        constraint: String,
        /// By how much (m, rad).
        miss: f64,
        /// What it contradicts.
        because: Box<Conflict>,
    },
}

/// What a row of a constraint contradicts.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Conflict {
    /// Constraints before it.
    Earlier {
        /// Their names.
        constraints: Vec<String>,
    },
    /// Other rows of the same constraint.
    Itself,
    /// No motion of the robot changes the row.
    Still {
        /// What the row holds; none for a distance or a coupling.
        row: Option<ConstraintRow>,
    },
    /// Joints that are held; without them the row would count.
    Held {
        /// Their names.
        joints: Vec<String>,
    },
}

fn contradiction(constraint: &str, miss: f64, because: &Conflict) -> String {
    let constraint = format!("constraint '{}'", printable(constraint));
    let quoted = |names: &[String]| {
        names.iter().map(|name| format!("'{}'", printable(name))).collect::<Vec<_>>().join(", ")
    };
    match because {
        Conflict::Earlier { constraints } => format!(
            "{constraint} contradicts those before it ({}): where they are satisfied it misses by {miss:.3e} (m, \
             rad), and no motion that they allow changes that; correct or remove one of them",
            quoted(constraints)
        ),
        Conflict::Itself => format!(
            "{constraint} contradicts itself: where its other rows are satisfied it misses by {miss:.3e} (m, rad), \
             and no motion that they allow changes that; correct its frames, or hold fewer rows"
        ),
        Conflict::Still { row } => {
            let row = row.map_or_else(String::new, |row| format!("row {} of ", row.name()));
            format!(
                "{row}{constraint} cannot be satisfied: it misses by {miss:.3e} (m, rad), and no motion of the robot \
                 changes that; correct its frames, or leave the row out"
            )
        }
        Conflict::Held { joints } => format!(
            "{constraint} cannot be satisfied while {} {} held: it misses by {miss:.3e} (m, rad), and no motion of \
             the other joints changes that; release {}",
            quoted(joints),
            if joints.len() == 1 { "is" } else { "are" },
            if joints.len() == 1 { "it" } else { "some of them" }
        ),
    }
}
