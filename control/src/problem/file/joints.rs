//! Lists of joints.

use crate::problem::Problem;
use crate::problem::error::ProblemError;
use crate::problem::file::fault::Fault;
use crate::problem::file::table::{Table, string, whole};
use crate::problem::key::Key;

/// A joint by its name, or by its index from 0.
pub(super) enum JointName {
    Name(String),
    Index(usize),
}

/// A list of joints.
pub(super) fn joints(table: &Table<'_>, name: &str) -> Result<Option<Vec<JointName>>, Fault> {
    table.list(name, "a list of joints, by name or by index from 0", |value| {
        let index = || whole(value).and_then(|index| usize::try_from(index).ok()).map(JointName::Index);
        string(value).map(JointName::Name).or_else(index)
    })
}

/// Indices of joints, sorted; none may be given twice.
pub(super) fn indices(problem: &Problem, key: Key, names: &[JointName]) -> Result<Vec<usize>, ProblemError> {
    let index = |name: &JointName| match name {
        JointName::Index(index) => Ok(*index),
        JointName::Name(name) => {
            let found = problem.robot.independent_joints().position(|joint| joint.name == *name);
            found.ok_or_else(|| problem.unknown_joint(key, format!("'{name}'")))
        }
    };
    let mut indices: Vec<usize> = names.iter().map(index).collect::<Result<_, _>>()?;
    indices.sort_unstable();
    match indices.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => match problem.robot.independent_joints().nth(pair[0]) {
            Some(joint) => Err(ProblemError::GivenTwice { key, joint: joint.name.clone() }),
            None => Err(problem.unknown_joint(key, pair[0].to_string())),
        },
        None => Ok(indices),
    }
}
