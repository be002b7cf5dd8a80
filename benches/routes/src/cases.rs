//! The robots to measure, with a state each.

use crate::robots::{CHAINS, FILES, chain, from_file};
use crate::routes::{Failure, State};
use costate::robot::Robot;

/// Chains up to this length are enough where only agreement is looked at.
const SMALL: usize = 12;

/// A robot, and where its quantities are evaluated.
pub struct Case {
    /// Column of the tables.
    pub title: String,
    pub robot: Robot,
    pub state: State,
    /// Whether it is one of the chains, whose times make the plots.
    pub chain: bool,
}

impl Case {
    fn new(title: &str, robot: Robot, chain: bool) -> Result<Self, Failure> {
        let state = State::random(&robot, 1)?;
        Ok(Self { title: format!("{title}, n = {}", robot.dof()), robot, state, chain })
    }

    /// The robots of files.
    pub fn files() -> Result<Vec<Self>, Failure> {
        FILES.into_iter().map(|(title, file)| Self::new(title, from_file(file)?, false)).collect()
    }

    /// The files, then the chains by length; only the small ones where `all` is false.
    pub fn list(all: bool) -> Result<Vec<Self>, Failure> {
        let mut cases = Self::files()?;
        for n in CHAINS.into_iter().filter(|&n| all || n <= SMALL) {
            cases.push(Self::new("chain", chain(n)?, true)?);
        }
        Ok(cases)
    }
}
