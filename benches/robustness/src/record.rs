//! The searches of the study, and what is kept of each.

use crate::problems::{PAIRS, RobotName, Variant};
use costate_control::{Coordinates, JacobianRoute};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// One search: a problem, and how it is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Search {
    pub robot: RobotName,
    pub variant: Variant,
    /// Number of the pair of start and end, and seed of all that is drawn for it.
    pub pair: usize,
    pub coordinates: Coordinates,
    pub matrix: JacobianRoute,
}

impl fmt::Display for Search {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { robot, variant, pair, coordinates, matrix } = self;
        write!(f, "{} {} {pair} {coordinates:?} {matrix:?}", robot.name(), variant.name())
    }
}

pub const MATRICES: [JacobianRoute; 3] =
    [JacobianRoute::Exact, JacobianRoute::Differences, JacobianRoute::WithoutHessian];
pub const COORDINATES: [Coordinates; 2] = [Coordinates::Hamiltonian, Coordinates::Lagrangian];

/// All searches: first one pair of each robot and variant, then the next.
pub fn study() -> impl Iterator<Item = Search> {
    let problems = (0..PAIRS).flat_map(|pair| {
        let variants = move |robot| Variant::of(pair).map(move |variant| (pair, robot, variant));
        RobotName::ALL.into_iter().flat_map(variants)
    });
    problems.flat_map(|(pair, robot, variant)| {
        let with =
            move |coordinates| MATRICES.map(|matrix| Search { robot, variant, pair, coordinates, matrix });
        COORDINATES.into_iter().flat_map(with)
    })
}

/// A search and what came of it: one line of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    #[serde(flatten)]
    pub search: Search,
    /// [`Status::name`](costate_control::Status::name).
    pub status: String,
    /// Largest miss at the end after an independent integration (rad, rad/s); none where it was not made.
    pub end_defect: Option<f64>,
    /// Drift of H*.
    pub drift: f64,
    /// Cost, penalties included.
    pub cost: f64,
    /// Newton steps.
    pub steps: usize,
    /// Nodes of the last mesh.
    pub nodes: usize,
    /// Evaluations of the right-hand side, those of Jacobians apart.
    pub rates: usize,
    /// Evaluations of the right-hand side with its Jacobian.
    pub jacobians: usize,
    /// What one of the latter takes, in evaluations of the right-hand side: 8n + 1 by differences, else
    /// measured.
    pub jacobian_cost: f64,
    /// Time of the search without the check of its result.
    pub milliseconds: f64,
}

/// The lines of a file.
pub struct Results {
    pub records: Vec<Record>,
    path: PathBuf,
}

impl Results {
    /// Reads what is there; no file is an empty one.
    pub fn open(path: &Path) -> Result<Self, String> {
        let at = |line: usize, error: &dyn fmt::Display| format!("{}:{line}: {error}", path.display());
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(format!("{}: {error}", path.display())),
        };
        let lines = text.lines().enumerate();
        let read = |(number, line)| serde_json::from_str(line).map_err(|error| at(number + 1, &error));
        Ok(Self { records: lines.map(read).collect::<Result<_, _>>()?, path: path.into() })
    }

    /// Whether a search was made already.
    pub fn holds(&self, search: &Search) -> bool {
        self.records.iter().any(|record| record.search == *search)
    }

    /// Appends a line.
    pub fn add(&mut self, record: Record) -> io::Result<()> {
        let mut file = OpenOptions::new().create(true).append(true).open(&self.path)?;
        writeln!(file, "{}", serde_json::to_string(&record)?)?;
        self.records.push(record);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::run;
    use std::collections::HashSet;

    #[test]
    fn a_study_that_was_stopped_goes_on_where_it_was() {
        let path = std::env::temp_dir().join(format!("costate_robustness_{}.jsonl", std::process::id()));
        let _ = std::fs::remove_file(&path);
        let arm = || study().filter(|search| search.robot == RobotName::VerticalArm);
        let mut first = Results::open(&path).unwrap();
        for search in arm().take(3) {
            first.add(run(&search).unwrap()).unwrap();
        }
        let mut second = Results::open(&path).unwrap();
        assert_eq!(second.records, first.records);
        let next = arm().find(|search| !second.holds(search)).unwrap();
        assert_eq!(next, arm().nth(3).unwrap());
        second.add(run(&next).unwrap()).unwrap();
        let lines = Results::open(&path).unwrap().records;
        std::fs::remove_file(&path).unwrap();
        assert_eq!(
            lines.iter().map(|record| record.search).collect::<Vec<_>>(),
            arm().take(4).collect::<Vec<_>>()
        );
    }

    #[test]
    fn a_damaged_line_is_named() {
        let path = std::env::temp_dir().join(format!("costate_damaged_{}.jsonl", std::process::id()));
        std::fs::write(&path, "{}\n").unwrap();
        let error = Results::open(&path).err().unwrap();
        std::fs::remove_file(&path).unwrap();
        assert!(error.contains(".jsonl:1: missing field"), "{error}");
    }

    #[test]
    fn the_study_has_more_than_two_hundred_pairs_and_no_search_twice() {
        let all: Vec<Search> = study().collect();
        let pairs: HashSet<_> = all.iter().map(|search| (search.robot.name(), search.pair)).collect();
        assert!(pairs.len() >= 200, "{}", pairs.len());
        let searches: HashSet<_> = all.iter().map(Search::to_string).collect();
        assert_eq!(searches.len(), all.len());
    }
}
